"""The terminal: tables as wide as it is, and keys as they are pressed while something else goes on."""

import os
import select
import sys
import termios
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from rich.console import Console
from rich.text import Text

from kinesic.cli.plain_words import printable

WIDTH = 160  # [characters]
MOST_INPUT = 64  # [bytes] taken at once


def console() -> Console:
    """Opens standard output for tables: as wide as the terminal, or as `WIDTH` in a file."""
    return Console() if sys.stdout.isatty() else Console(width=WIDTH)


def error_console() -> Console:
    """Opens standard error for lines with colours; in a file, without."""
    return Console(stderr=True) if sys.stderr.isatty() else Console(stderr=True, width=WIDTH)


def quote_text(words: str) -> Text:
    """Makes a cell of a table of words that may come from strangers: as they stand, without markup."""
    return Text(printable(words))


@contextmanager
def pressed_keys() -> Iterator[Callable[[], str]]:
    """Yields a function that gives the keys since its last call, at once; none where there is no terminal."""
    if not sys.stdin.isatty():
        yield lambda: ""
        return
    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    tty.setcbreak(terminal)
    try:
        yield lambda: _waiting(terminal)
    finally:
        with suppress(termios.error):  # it has closed meanwhile
            termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def _waiting(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    return os.read(terminal, MOST_INPUT).decode(errors="replace")
