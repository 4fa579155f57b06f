"""Texts of files, devices and users in coloured tables: printed as they are, never read as markup."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from rich.console import Console
from rich.table import Table

from kinesic.bench.metric import Metric
from kinesic.cli import bench
from kinesic.cli.terminal import console, error_console, quote_text

PACKAGE = Path(__file__).resolve().parents[2] / "kinesic"
TERMINAL = PACKAGE / "cli" / "terminal.py"
FOREIGN = "kinesic[face] [red]red[/] :smile:"


def list_calls(name: str) -> Iterator[tuple[Path, ast.Call]]:
    """Yield the calls of a class by files that use rich."""
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "from rich" in text and name in text else ():
            if isinstance(node, ast.Call) and ast.unparse(node.func) == name:
                yield path, node


def test_only_the_terminal_module_opens_consoles_and_without_markup():
    assert {path for path, _ in list_calls("Console")} == {TERMINAL}
    assert [ast.unparse(call) for _, call in list_calls("Console") if "markup=False" not in ast.unparse(call)] == []


def test_progress_columns_do_not_interpret_markup():
    columns = [ast.unparse(call) for _, call in list_calls("TextColumn")]
    assert len(columns) >= 3
    assert [column for column in columns if "{" in column and "markup=False" not in column] == []


def test_program_texts_contain_no_rich_markup():
    written = [
        (path.name, node.value)
        for path in sorted((PACKAGE / "cli").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and "[/" in node.value
    ]
    assert written == []


@pytest.mark.parametrize("open_console", [console, error_console])
def test_untrusted_text_is_printed_with_its_brackets(open_console, capsys: pytest.CaptureFixture[str]):
    screen: Console = open_console()
    table = Table(FOREIGN, title=FOREIGN, box=None)
    table.add_row(FOREIGN)
    screen.print(table)
    screen.print(f"rejected: {quote_text(FOREIGN)}")
    printed = "".join(capsys.readouterr())
    assert printed.count(FOREIGN) == 4


def test_benchmark_notes_are_printed_with_the_brackets_of_an_extra(kinesic, monkeypatch: pytest.MonkeyPatch):
    metrics = [
        Metric("a.missing", None, "s", 1.0, "lower", FOREIGN),
        Metric("a.measured", 0.5, "s", 1.0, "lower", FOREIGN),
        Metric("a.late", 1.5, "s", 1.0, "lower"),
    ]
    monkeypatch.setattr(bench, "measure", lambda name, stage: metrics)
    printed = kinesic("bench", "ik").out
    assert printed.count(FOREIGN) == 2
    assert [line.split()[-1] for line in printed.splitlines() if line.split()[:1] == ["a.late"]] == ["missed"]
