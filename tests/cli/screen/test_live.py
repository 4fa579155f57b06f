"""Lines that are redrawn at the end of a terminal, and output printed above them."""

import io
import sys

import click
import pytest

from kinesic.cli.screen.console import Console
from kinesic.cli.screen.live import LiveLines

SLOW_RATE = 1e-3  # [Hz] redraw rate so low that the thread draws only once


class Terminal(io.StringIO):
    """Text stream that claims to be a terminal."""

    def isatty(self) -> bool:
        return True


def screen_of(output: str) -> list[str]:
    """Return the lines that a terminal shows after this output."""
    lines = [""]
    for piece in output.replace("\x1b[1A\x1b[2K", "\0").splitlines(keepends=True):
        for part in piece.split("\0")[:-1]:
            assert part == ""
            assert lines[-1] == ""
            lines[-2:] = [""]
        text = piece.rpartition("\0")[2]
        lines[-1] += text.rstrip("\n")
        lines += [""] if text.endswith("\n") else []
    return lines


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Terminal with colours."""
    monkeypatch.delenv("NO_COLOR", raising=False)
    return Terminal()


def test_printed_output_appears_above_redrawn_terminal_lines_which_disappear_at_the_end(
    terminal: Terminal, monkeypatch
):
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(sys, "stdout", terminal)
    lines = LiveLines(Console(terminal, 40, is_terminal=True), lambda: ("first", "second"), rate=SLOW_RATE)
    with lines.shown():
        lines.redraw()
        assert screen_of(terminal.getvalue()) == ["first", "second", ""]
        click.echo(click.style("warning", fg="red"), err=True)
        click.echo("no end", nl=False)
        assert screen_of(terminal.getvalue()) == ["\x1b[31mwarning\x1b[0m", "first", "second", ""]
    assert screen_of(terminal.getvalue()) == ["\x1b[31mwarning\x1b[0m", "no end"]
    assert sys.stderr is terminal


def test_long_redrawn_lines_are_wrapped_and_cut_to_the_terminal_size(terminal: Terminal):
    lines = LiveLines(Console(terminal, 5, height=3, is_terminal=True), lambda: ("one two three",), rate=SLOW_RATE)
    with lines.shown():
        lines.redraw()
        assert screen_of(terminal.getvalue()) == ["one", "two", ""]


def test_output_to_a_pipe_is_not_redirected_to_the_terminal(terminal: Terminal, monkeypatch: pytest.MonkeyPatch):
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stdout", pipe)
    with LiveLines(Console(terminal, 40, is_terminal=True), lambda: ("line",), rate=SLOW_RATE).shown():
        click.echo("result")
    assert pipe.getvalue() == "result\n"
    assert "result" not in terminal.getvalue()


def test_redrawn_status_lines_are_omitted_without_a_terminal():
    pipe = io.StringIO()
    with LiveLines(Console(pipe, 40), lambda: ("line",), rate=SLOW_RATE).shown():
        pass
    assert pipe.getvalue() == ""


def test_only_terminals_get_colours_and_the_variable_no_color_disables_them(terminal: Terminal, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    assert not Console.on(terminal, file_width=160).has_colour
    monkeypatch.delenv("NO_COLOR")
    monkeypatch.setenv("COLUMNS", "70")
    for stream, width, has_colour in ((terminal, 70, True), (io.StringIO(), 160, False)):
        console = Console.on(stream, file_width=160)
        assert (console.width, console.has_colour) == (width, has_colour)
