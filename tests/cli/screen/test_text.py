"""Styled text: its width, its lines and its escape codes."""

import pytest

from kinesic.cli.screen.text import Text, cell_width


@pytest.mark.parametrize(
    ("line", "width"), [("abc", 3), ("naïve", 5), ("e\u0301", 1), ("手話", 4), ("", 0), ("a\u200db", 2)]
)
def test_terminal_text_width_counts_wide_characters_twice_and_combining_marks_not_at_all(line: str, width: int):
    assert cell_width(line) == width


@pytest.mark.parametrize(
    ("text", "width", "lines"),
    [
        ("one two three", 7, ["one two", "three"]),
        ("one two three", 20, ["one two three"]),
        ("one  two", 5, ["one", "two"]),
        ("unbreakable", 4, ["unbr", "eaka", "ble"]),
        ("an unbreakable", 6, ["an", "unbrea", "kable"]),
        ("first\nsecond line", 6, ["first", "second", "line"]),
        ("手話手話", 5, ["手話", "手話"]),
        ("", 5, [""]),
        ("a\n\nb", 5, ["a", "", "b"]),
        ("手", 1, ["手"]),
    ],
)
def test_terminal_text_is_wrapped_at_spaces_and_inside_words_that_are_too_long(text: str, width: int, lines: list[str]):
    assert [line.plain for line in Text(text).wrapped(width)] == lines


def test_wrapped_lines_of_a_styled_text_keep_the_styles_of_their_characters():
    first, second = (Text("red and", "red") + " " + Text("green", "green")).wrapped(7)
    assert first.pieces == (("red and", "red"),)
    assert second.pieces == (("green", "green"),)
    assert (Text("ab", "red") + "cd")[1:3].pieces == (("b", "red"), ("c", ""))


def test_terminal_text_that_is_too_wide_ends_with_an_ellipsis():
    assert Text("welcome").shortened(7).plain == "welcome"
    assert Text("welcome").shortened(6).plain == "welco…"
    assert Text("welcome").shortened(1).plain == "…"


def test_text_styles_become_terminal_escape_codes_that_are_reset_at_the_end_of_the_style():
    text = Text("a", "red") + Text("b", "bold") + "c"
    assert text.render() == "\x1b[31ma\x1b[0m\x1b[1mb\x1b[0mc"
    assert text.with_style("green").render() == "\x1b[31ma\x1b[0m\x1b[1mb\x1b[0m\x1b[32mc\x1b[0m"
