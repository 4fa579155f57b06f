"""Untrusted texts in tables, printed with their brackets and colons."""

import pytest

from kinesic.bench.metric import Metric
from kinesic.cli import bench
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, error_console, quote_text

UNTRUSTED_TEXT = "kinesic[face] [red]red[/] :smile:"


@pytest.mark.parametrize("open_console", [console, error_console])
def test_text_from_a_document_is_printed_with_its_brackets_and_not_as_markup(
    open_console, capsys: pytest.CaptureFixture[str]
):
    screen = open_console()
    table = Table(UNTRUSTED_TEXT, title=UNTRUSTED_TEXT)
    table.add_row(UNTRUSTED_TEXT)
    screen.print(table)
    screen.print(f"rejected: {quote_text(UNTRUSTED_TEXT)}")
    printed = "".join(capsys.readouterr())
    assert printed.count(UNTRUSTED_TEXT) == 4


def test_install_commands_in_benchmark_notes_are_printed_with_their_brackets(kinesic, monkeypatch: pytest.MonkeyPatch):
    metrics = [
        Metric("a.missing", None, "s", 1.0, "lower", UNTRUSTED_TEXT),
        Metric("a.measured", 0.5, "s", 1.0, "lower", UNTRUSTED_TEXT),
        Metric("a.late", 1.5, "s", 1.0, "lower"),
    ]
    monkeypatch.setattr(bench, "measure", lambda name, stage: metrics)
    printed = kinesic("bench", "ik").out
    assert printed.count(UNTRUSTED_TEXT) == 2
    assert [line.split()[-1] for line in printed.splitlines() if line.split()[:1] == ["a.late"]] == ["missed"]
