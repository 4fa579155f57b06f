"""Where tables go: as wide as the terminal, and wide enough for every column in a file or a pipe."""

import sys

from rich.console import Console

WIDTH = 160  # [characters]


def console() -> Console:
    """A console on standard output."""
    return Console() if sys.stdout.isatty() else Console(width=WIDTH)
