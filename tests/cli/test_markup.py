"""Texts of files, devices and users in tables: printed as they are, with brackets and colons."""

import pytest

from kinesic.bench.metric import Metric
from kinesic.cli import bench
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, error_console, quote_text

FOREIGN = "kinesic[face] [red]red[/] :smile:"


@pytest.mark.parametrize("open_console", [console, error_console])
def test_untrusted_text_is_printed_with_its_brackets(open_console, capsys: pytest.CaptureFixture[str]):
    screen = open_console()
    table = Table(FOREIGN, title=FOREIGN)
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
