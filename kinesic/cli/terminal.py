"""Terminal output as wide as the window, and non-blocking key input."""

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from kinesic.cli.plain_words import printable
from kinesic.cli.screen.console import Console
from kinesic.cli.screen.text import Text

if sys.platform != "win32":
    import termios
    import tty

FILE_WIDTH = 160  # [characters] width of tables in files and pipes
MAX_KEY_BYTES = 64  # [bytes] largest key input per read


def console() -> Console:
    """Return a console for standard output, `FILE_WIDTH` wide without a terminal."""
    return Console.on(sys.stdout, file_width=FILE_WIDTH)


def error_console() -> Console:
    """Return a console for standard error, in colour only on a terminal."""
    return Console.on(sys.stderr, file_width=FILE_WIDTH)


def quote_text(text: str, *, style: str = "") -> Text:
    """Return untrusted text as a table cell, with control characters escaped.

    Args:
        text: text of a file, a device or the user.
        style: colour or weight, such as `red` or `bold`.
    """
    return Text(printable(text), style)


@contextmanager
def pressed_keys() -> Iterator[Callable[[], str]]:
    """Yield a non-blocking function that returns newly pressed keys.

    Without a terminal, and on Windows, it returns no keys.
    """
    if sys.platform != "win32" and sys.stdin.isatty():
        terminal = sys.stdin.fileno()
        settings = termios.tcgetattr(terminal)
        tty.setcbreak(terminal)
        try:
            yield lambda: _read_waiting_keys(terminal)
        finally:
            with suppress(termios.error):  # The terminal may have been closed.
                termios.tcsetattr(terminal, termios.TCSADRAIN, settings)
    else:
        yield lambda: ""


def _read_waiting_keys(terminal: int) -> str:
    if not select.select([terminal], [], [], 0)[0]:
        return ""
    return os.read(terminal, MAX_KEY_BYTES).decode(errors="replace")
