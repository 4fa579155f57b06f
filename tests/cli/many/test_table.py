import io
from pathlib import Path

from rich.console import Console

from kinesic.cli.many.table import _group_folders, summarise
from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks import Check


def test_result_table_keeps_names_and_numbers_whole_in_a_narrow_window():
    check = Check("timing.stroke_median", "warn", 0.0123, 0.0105, "s", "at 3.21 s, gesture with a long name")
    verdict = DocumentVerdict(f"folder/{'long_' * 20}name.bml", "performed", 0, checks=(check,))
    text = io.StringIO()
    summarise([verdict], Console(file=text, width=80))
    row = next(line for line in text.getvalue().splitlines() if "stroke_median" in line)
    assert row.split()[:7] == ["timing.stroke_median", "0", "1", "0", "0", "0.0123", "0.0105"]
    assert "long_" in row


def test_folders_are_grouped_by_the_deepest_names_that_fit_the_table(tmp_path, monkeypatch):
    folders = [tmp_path / "a", tmp_path / "b" / "c", tmp_path / "b" / "d"]
    assert _group_folders(folders) == ["a", str(Path("b", "c")), str(Path("b", "d"))]
    monkeypatch.setattr("kinesic.cli.many.table.MAX_FOLDER_ROWS", 2)
    assert _group_folders(folders) == ["a", "b", "b"]
    assert _group_folders([tmp_path, tmp_path]) == [tmp_path.name] * 2
