"""Lines at the end of the terminal that are redrawn in place."""

import io
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from threading import Event, RLock, Thread
from typing import TextIO

from kinesic.cli.screen.console import Console, Content

ERASE_LINE = "\x1b[2K"
CURSOR_UP = "\x1b[1A"


class LiveLines:
    """Lines at the end of the terminal, redrawn until they are closed.

    A thread redraws them, so that displayed times advance while the program computes. Other output of the program
    appears above them. Without a terminal, nothing is drawn.
    """

    def __init__(self, console: Console, draw: Callable[[], tuple[Content, ...]], *, rate: float) -> None:
        """Create live lines that are not drawn yet.

        Args:
            console: terminal on which they are drawn.
            draw: returns the current contents of the lines.
            rate: redraw rate [Hz].
        """
        self._console, self._draw, self._rate = console, draw, rate
        self._lock = RLock()
        self._is_closed = Event()
        self._drawn_count = 0  # lines that stand on the terminal

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Draw the lines within the context, and erase them at its end."""
        if not self._console.is_terminal:
            yield
            return
        thread = Thread(target=self._redraw_until_closed, name="live lines", daemon=True)
        redirections = [redirect_stderr, *([redirect_stdout] if sys.stdout.isatty() else [])]
        with ExitStack() as stack:
            for redirect in redirections:
                stream = PrintedAbove(self._console.file, self.print_above)
                stack.callback(stream.finish)
                stack.enter_context(redirect(stream))
            thread.start()
            try:
                yield
            finally:
                self._is_closed.set()
                thread.join()
                with self._lock:
                    self._erase()

    def redraw(self) -> None:
        """Replace the drawn lines by the current contents."""
        with self._lock:
            lines = self._console.fit(*self._draw())
            self._erase()
            self._console.print(*lines)
            self._drawn_count = len(lines)

    def print_above(self, text: str) -> None:
        """Print complete lines above the live lines."""
        with self._lock:
            self._erase()
            self._console.write(text)
            if not self._is_closed.is_set():
                self.redraw()

    def _erase(self) -> None:
        if self._drawn_count:
            self._console.write(f"{CURSOR_UP}{ERASE_LINE}" * self._drawn_count)
        self._drawn_count = 0

    def _redraw_until_closed(self) -> None:
        while True:
            self.redraw()
            if self._is_closed.wait(1.0 / self._rate):
                return


class PrintedAbove(io.StringIO):
    """Replacement of a terminal stream that prints complete lines above live lines."""

    def __init__(self, terminal: TextIO, print_above: Callable[[str], None]) -> None:
        super().__init__()
        self._terminal, self._print_above = terminal, print_above
        self._rest = ""  # characters of an unfinished line

    def write(self, text: str, /) -> int:
        """Print all complete lines, and keep an incomplete last line."""
        lines, end, self._rest = (self._rest + text).rpartition("\n")
        if end:
            self._print_above(lines + end)
        return len(text)

    def finish(self) -> None:
        """Print the kept incomplete line, if any."""
        if self._rest:
            self._print_above(self._rest)
        self._rest = ""

    def isatty(self) -> bool:
        """Return whether the replaced stream is a terminal."""
        return self._terminal.isatty()

    def fileno(self) -> int:
        """Return the file descriptor of the replaced stream."""
        return self._terminal.fileno()
