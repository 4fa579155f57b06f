"""Output stream that prints styled text and tables."""

import os
from dataclasses import dataclass
from typing import TextIO, TypeAlias

import click

from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text, as_text

Content: TypeAlias = str | Text | Table

DEFAULT_WIDTH = 80  # [terminal columns] if the terminal does not report its width
DEFAULT_HEIGHT = 24  # [lines] likewise


@dataclass(frozen=True, eq=False)
class Console:
    """Stream with the size of its window; only terminals get colours."""

    file: TextIO
    width: int  # [terminal columns]
    height: int = DEFAULT_HEIGHT  # [lines]
    is_terminal: bool = False

    @classmethod
    def on(cls, file: TextIO, *, file_width: int) -> "Console":
        """Return the console of a stream.

        Args:
            file: standard output or standard error.
            file_width: width [characters] without a terminal.
        """
        if not file.isatty():
            return cls(file, file_width)
        try:
            columns, lines = os.get_terminal_size(file.fileno())
        except OSError:  # The terminal has no size.
            columns, lines = 0, 0
        chosen = os.environ.get("COLUMNS", "")
        width = int(chosen) if chosen.isdigit() else columns
        return cls(file, width or DEFAULT_WIDTH, lines or DEFAULT_HEIGHT, is_terminal=True)

    def print(self, *contents: Content) -> None:
        """Print each content on lines of its own; long lines of text are not broken."""
        for content in contents or ("",):
            lines = content.lines(self.width) if isinstance(content, Table) else [as_text(content)]
            for line in lines:
                self.write((line.render() if self.has_colour else line.plain) + "\n")

    def write(self, text: str) -> None:
        """Write text with escape codes, also on terminals of Windows."""
        click.echo(text, self.file, nl=False, color=self.is_terminal)

    @property
    def has_colour(self) -> bool:
        """Whether colours are printed; the variable NO_COLOR switches them off."""
        return self.is_terminal and not os.environ.get("NO_COLOR")

    def fit(self, *contents: Content) -> list[Text]:
        """Return contents as lines that fit into the window."""
        lines = [
            line
            for content in contents
            for line in (
                content.lines(self.width) if isinstance(content, Table) else as_text(content).wrapped(self.width)
            )
        ]
        return lines[: self.height - 1]
