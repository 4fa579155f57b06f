"""Output stream that prints styled text and tables."""

import os
from dataclasses import dataclass
from typing import TextIO, TypeAlias

import click

from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text, as_text

Content: TypeAlias = str | Text | Table

DEFAULT_WIDTH = 80  # [terminal columns] width if the terminal does not report its size
DEFAULT_HEIGHT = 24  # [lines] height if the terminal does not report its size


@dataclass(frozen=True, eq=False)
class Console:
    """Output stream with the size of its terminal window."""

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
        """Print each table or text on new lines, without wrapping texts."""
        for content in contents or ("",):
            lines = content.lines(self.width) if isinstance(content, Table) else [as_text(content)]
            for line in lines:
                self.write((line.render() if self.has_colour else line.plain) + "\n")

    def write(self, text: str) -> None:
        """Write text, with its escape codes only on terminals."""
        click.echo(text, self.file, nl=False, color=self.is_terminal)

    @property
    def has_colour(self) -> bool:
        """Whether colours are printed: on terminals, unless NO_COLOR is set."""
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
