import io
from pathlib import Path

import pytest

from kinesic.cli.many.table import MAX_FOLDER_ROWS, _group_folders, print_batch_summary
from kinesic.cli.screen.console import Console
from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks import Check

FAILED_CHECK = Check("limits.speed", "fail", 1.5, 1.0, "ratio", "at 1 s")
PASSED_CHECK = Check("limits.speed", "pass", 0.25, 1.0, "ratio", "")
POOR_CHECK = Check("timing.lag", "poor", 0.02, 0.01, "s", "at 2 s, [nod] late")
FAILED_DOCUMENT = DocumentVerdict(
    "a/one.bml",
    "performed",
    1,
    behaviours=(("head", "realised"), ("gesture", "dropped")),
    checks=(FAILED_CHECK, POOR_CHECK),
)
PASSED_DOCUMENT = DocumentVerdict("a/two.bml", "performed", 0, checks=(PASSED_CHECK,))
REFUSED_DOCUMENT = DocumentVerdict("b/three.bml", "refused", 0, error="b/three.bml:1:2: [no] end" + 20 * " of it")
CRASHED_DOCUMENT = DocumentVerdict("b/four.bml", "crashed", 3, error="b/four.bml: out of memory")
NARROW_WIDTH = 79  # [characters] width that leaves 16 for the columns of place and file


def summary(verdicts: list[DocumentVerdict], width: int, *, colour: bool = False) -> list[str]:
    text = io.StringIO()
    print_batch_summary(
        verdicts,
        Console(text, width, is_terminal=colour),
    )
    return [line.rstrip() for line in text.getvalue().splitlines()]


def test_result_table_truncates_no_names_and_numbers_in_a_narrow_terminal():
    check = Check("timing.stroke_median", "warn", 0.0123, 0.0105, "s", "at 3.21 s, gesture with a long name")
    verdict = DocumentVerdict(f"folder/{'long_' * 20}name.bml", "performed", 0, checks=(check,))
    row = next(line for line in summary([verdict], 80) if "stroke_median" in line)
    assert row.split()[:7] == ["timing.stroke_median", "0", "1", "0", "0", "0.0123", "0.0105"]
    assert "long_" in row


def test_batch_summary_prints_failures_before_the_folder_and_check_tables():
    assert summary([FAILED_DOCUMENT, PASSED_DOCUMENT, REFUSED_DOCUMENT], 120) == [
        f"refused  {REFUSED_DOCUMENT.error}",
        "failed   a/one.bml: limits.speed 1.5 ratio (limit 1) at 1 s",
        "poor     a/one.bml: timing.lag 0.02 s (limit 0.01) at 2 s, [nod] late",
        "",
        " folder  documents  performed  refused  failed  poor  realised  partly  substituted  dropped",
        " a               2          2        0       1     0         1       0            0        1",
        " b               1          0        1       0     0         0       0            0        0",
        " all             3          2        1       1     0         1       0            0        1",
        " check         pass  warn  poor  fail  worst  limit  unit   worst where         in",
        " limits.speed     1     0     0     1    1.5      1  ratio  at 1 s              one.bml",
        " timing.lag       0     0     1     0   0.02   0.01  s      at 2 s, [nod] late  one.bml",
    ]


def test_summary_of_one_folder_has_no_total_and_passed_checks_name_no_file():
    assert summary([PASSED_DOCUMENT], 120) == [
        " folder  documents  performed  refused  failed  poor  realised  partly  substituted  dropped",
        " a               1          1        0       0     0         0       0            0        0",
        " check         pass  warn  poor  fail  worst  limit  unit   worst where  in",
        " limits.speed     1     0     0     0   0.25      1  ratio",
    ]


def test_summary_has_a_column_for_crashed_documents_only_if_one_crashed():
    header, row, _ = summary([CRASHED_DOCUMENT], 120)[2:]
    assert header.split()[:5] == ["folder", "documents", "performed", "refused", "crashed"]
    assert row.split()[:5] == ["b", "1", "0", "0", "1"]


def test_summary_of_no_documents_is_one_line():
    assert summary([], 80) == ["no documents"]


@pytest.mark.parametrize(
    ("width", "heading", "row"),
    [
        (NARROW_WIDTH + 3, "worst wh…  in", "at 2 s, …  one.bml"),  # An odd remainder goes to the file.
        (NARROW_WIDTH, "worst w…  in", "at 2 s,…  one.bml"),
        (NARROW_WIDTH - 1, "in", "one.bml"),
        (NARROW_WIDTH - 13, "in", "one.…"),
    ],
)
def test_columns_of_location_and_file_divide_the_remaining_terminal_width(width, heading, row):
    *_, header, _, late = summary([FAILED_DOCUMENT], width)
    assert header.split("unit   ")[1] == heading
    assert late.split("0.01  s      ")[1] == row


def test_narrow_terminal_truncates_only_the_text_columns_of_the_check_table():
    *_, header, _, late = summary([FAILED_DOCUMENT], NARROW_WIDTH - 17)
    assert header == " check         pass  warn  poor  fail  worst  limit  unit   …"
    assert late == " timing.lag       0     0     1     0   0.02   0.01  s      …"


def test_check_counts_of_a_summary_are_coloured_by_status_unless_they_are_zero():
    lines = summary([FAILED_DOCUMENT, PASSED_DOCUMENT, REFUSED_DOCUMENT], 120, colour=True)
    assert lines[0] == f"refused  {REFUSED_DOCUMENT.error}"  # no word of an error is highlighted
    fast, late = lines[-2:]
    assert fast.startswith(" limits.speed     \x1b[32m1\x1b[0m     0     0     \x1b[31m1\x1b[0m    1.5")
    assert late.startswith(" timing.lag       0     0     \x1b[35m1\x1b[0m     0   0.02")


def test_only_the_total_row_of_a_validation_summary_is_bold():
    *_, header, first, second, total, _, _, _ = summary(
        [FAILED_DOCUMENT, PASSED_DOCUMENT, REFUSED_DOCUMENT], 120, colour=True
    )
    assert ["\x1b[1m" in line for line in (header, first, second, total)] == [True, False, False, True]


def test_validation_summary_lists_the_deepest_folder_levels_that_fit_its_row_limit(tmp_path, monkeypatch):
    folders = [tmp_path / "a", tmp_path / "b" / "c", tmp_path / "b" / "d"]
    assert _group_folders(folders) == ["a", str(Path("b", "c")), str(Path("b", "d"))]
    monkeypatch.setattr("kinesic.cli.many.table.MAX_FOLDER_ROWS", 2)
    assert _group_folders(folders) == ["a", "b", "b"]
    assert _group_folders([tmp_path, tmp_path]) == [tmp_path.name] * 2


@pytest.mark.parametrize("count", [16, 17])
def test_validation_summary_groups_more_than_sixteen_folders_by_their_parents(tmp_path, count):
    assert MAX_FOLDER_ROWS == 16
    folders = [tmp_path / "a" / str(number) for number in range(count - 1)] + [tmp_path / "b"]
    expected = [str(Path("a", str(number))) if count == 16 else "a" for number in range(count - 1)]
    assert _group_folders(folders) == [*expected, "b"]


def test_validation_summary_lists_many_sibling_folders_without_their_subfolders(tmp_path):
    names = [str(number) for number in range(MAX_FOLDER_ROWS + 1)]
    assert _group_folders([tmp_path / name / "inside" for name in names]) == names
