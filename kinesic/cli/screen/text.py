"""Text with colours, measured and wrapped in terminal columns."""

import re
import unicodedata
from collections.abc import Iterator

import click

FONT_STYLES = frozenset({"bold", "italic"})  # text styles that are font attributes instead of colours
ZERO_WIDTH_CATEGORIES = frozenset({"Mn", "Me", "Cf"})  # Unicode categories of combining and invisible characters
ELLIPSIS_SIGN = "…"
WORD_PATTERN = re.compile(r"\s*\S+")


class Text:
    """Immutable text whose pieces have styles.

    Attributes:
        pieces: text and style of each piece. A style is empty, a colour of `click.style`, `bold` or `italic`.
    """

    def __init__(self, text: str = "", style: str = "") -> None:
        self.pieces: tuple[tuple[str, str], ...] = ((text, style),) if text else ()

    def __str__(self) -> str:
        return self.plain

    def __add__(self, other: "Text | str") -> "Text":
        return _join((*self.pieces, *as_text(other).pieces))

    def __getitem__(self, span: slice) -> "Text":
        """Return the characters of a span with their styles."""
        kept = range(len(self.plain))[span]
        pieces, position = [], 0
        for text, style in self.pieces:
            part = text[max(kept.start - position, 0) : max(kept.stop - position, 0)]
            position += len(text)
            pieces.append((part, style))
        return _join(tuple(piece for piece in pieces if piece[0]))

    @property
    def plain(self) -> str:
        """Whole text without its styles."""
        return "".join(text for text, _ in self.pieces)

    @property
    def width(self) -> int:
        """Width of the longest line [terminal columns]."""
        return max(map(cell_width, self.plain.split("\n")))

    def with_style(self, style: str) -> "Text":
        """Return the text with one style for all pieces that have none."""
        return _join(tuple((text, own_style or style) for text, own_style in self.pieces))

    def wrapped(self, width: int) -> "list[Text]":
        """Break the text into lines at spaces, and inside too long words."""
        return [self[start:stop] for start, stop in _wrap(self.plain, max(width, 1))]

    def shortened(self, width: int) -> "Text":
        """Return the text, shortened with an ellipsis to fit a width."""
        if self.width <= width:
            return self
        return self[: _fitting_length(self.plain, width - 1)] + ELLIPSIS_SIGN

    def render(self) -> str:
        """Return the text with ANSI escape codes."""
        return "".join(_paint(text, style) for text, style in self.pieces)


def as_text(content: Text | str) -> Text:
    """Convert a string to unstyled text, and return a text unchanged."""
    return content if isinstance(content, Text) else Text(content)


def cell_width(line: str) -> int:
    """Return the width of a line without control characters [terminal columns]."""
    return len(line) if line.isascii() else sum(map(_character_width, line))


def _character_width(character: str) -> int:
    if unicodedata.category(character) in ZERO_WIDTH_CATEGORIES:
        return 0
    return 2 if unicodedata.east_asian_width(character) in {"W", "F"} else 1


def _join(pieces: tuple[tuple[str, str], ...]) -> Text:
    text = Text()
    text.pieces = pieces
    return text


def _paint(text: str, style: str) -> str:
    if not style:
        return text
    if style in FONT_STYLES:
        return click.style(text, bold=style == "bold" or None, italic=style == "italic" or None)
    return click.style(text, fg=style)


def _wrap(plain: str, width: int) -> Iterator[tuple[int, int]]:
    """Yield the start and end character indices of each wrapped line."""
    offset = 0
    for line in plain.split("\n"):
        start = stop = 0
        for word in WORD_PATTERN.finditer(line):
            if cell_width(line[start : word.end()]) > width and stop > start:
                yield offset + start, offset + stop
                start = word.start() + len(word[0]) - len(word[0].lstrip())
            while (length := max(_fitting_length(line[start : word.end()], width), 1)) < word.end() - start:
                yield offset + start, offset + start + length
                start += length
            stop = word.end()
        yield offset + start, offset + stop
        offset += len(line) + 1


def _fitting_length(line: str, width: int) -> int:
    """Return the number of leading characters that fit into a width."""
    if cell_width(line) <= width:
        return len(line)
    used = 0
    for length, character in enumerate(line):
        used += _character_width(character)
        if used > width:
            return length
    return len(line)
