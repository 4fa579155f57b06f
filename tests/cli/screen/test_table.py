"""Layout of tables in wide and narrow windows."""

from kinesic.cli.screen.table import Table


def drawn(table: Table, width: int) -> list[str]:
    return [line.plain for line in table.lines(width)]


def test_table_columns_are_as_wide_as_their_widest_cell():
    table = Table("name", title="Robots")
    table.add_column("hinges", justify="right")
    table.add_row("upper22", "22")
    table.add_row("human")
    assert drawn(table, 80) == ["Robots", " name     hinges", " upper22      22", " human"]


def test_widest_table_columns_are_wrapped_until_the_table_fits():
    table = Table("key", "effect", "more")
    table.add_row("amplitude", "how far the hands go", "and the rest")
    lines = drawn(table, 34)
    assert lines == [
        " key        effect     more",
        " amplitude  how far    and the",
        "            the hands  rest",
        "            go",
    ]


def test_unwrappable_table_column_is_shortened_only_after_all_other_columns_are_wrapped():
    table = Table("effect")
    table.add_column("time", no_wrap=True)
    table.add_row("wide", "12.00 s")
    assert drawn(table, 14) == [" eff", " ect  time", " wid  12.00 s", " e"]
    assert drawn(table, 10) == [" e", " f", " f", " e", " c", " t  time", " w  12.0…", " i", " d", " e"]


def test_table_columns_have_one_character_in_a_window_narrower_than_the_table():
    table = Table("ab", "cd")
    assert drawn(table, 1) == [" a  c", " b  d"]


def test_one_line_table_heading_is_aligned_with_the_last_line_of_a_two_line_heading():
    table = Table("design")
    table.add_column("mass\nkg", justify="right")
    table.add_row("light\narm", "1.5")
    assert drawn(table, 80) == ["         mass", " design    kg", " light    1.5", " arm"]


def test_compact_table_has_one_space_between_columns_and_no_left_margin():
    table = Table("a", "b", is_compact=True)
    table.add_row("one", "two")
    assert drawn(table, 80) == ["a   b", "one two"]


def test_style_of_a_table_row_colours_its_cells_and_headings_are_bold():
    table = Table("a")
    table.add_row("x", style="red")
    heading, row = table.lines(80)
    assert heading.render() == " \x1b[1ma\x1b[0m"
    assert row.render() == " \x1b[31mx\x1b[0m"


def test_table_columns_stay_aligned_after_wide_characters():
    table = Table("a", "b")
    table.add_row("手話", "x")
    table.add_row("abcd", "y")
    assert drawn(table, 80)[1:] == [" 手話  x", " abcd  y"]
