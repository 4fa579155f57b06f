"""Text tables without border lines, laid out for the terminal width."""

from dataclasses import dataclass
from itertools import zip_longest
from typing import Literal, TypeAlias

from kinesic.cli.screen.text import Text, as_text

Justification: TypeAlias = Literal["left", "right"]


@dataclass(frozen=True)
class Column:
    """Heading and layout of one column."""

    heading: Text
    justify: Justification = "left"
    no_wrap: bool = False  # whether cells are shortened, not wrapped
    width: int | None = None  # fixed width [terminal columns]; None: width of the widest cell


class Table:
    """Rows of cells under bold headings.

    Columns that may wrap share the remaining width. If it does not suffice, all columns
    without a fixed width are shortened.
    """

    def __init__(self, *headings: str | Text, title: str | Text = "", is_compact: bool = False) -> None:
        """Create a table without rows, whose columns may wrap.

        Args:
            headings: headings of the columns.
            title: line above the headings.
            is_compact: whether columns are one space apart, without a margin.
        """
        self._columns = [Column(as_text(heading)) for heading in headings]
        self._rows: list[tuple[Text, ...]] = []
        self._title = as_text(title)
        self._gap, self._margin = (1, 0) if is_compact else (2, 1)

    def add_column(
        self,
        heading: str | Text,
        *,
        justify: Justification = "left",
        no_wrap: bool = False,
        width: int | None = None,
    ) -> None:
        """Add a column on the right."""
        self._columns.append(Column(as_text(heading), justify, no_wrap, width))

    def add_row(self, *cells: str | Text, style: str = "") -> None:
        """Add a row, filled with empty cells on the right."""
        self._rows.append(tuple(as_text(cell).with_style(style) for cell in cells))

    def lines(self, width: int) -> list[Text]:
        """Return the lines of the table for a width [terminal columns]."""
        headings = tuple(column.heading.with_style("bold") for column in self._columns)
        rows = [_fill_row(row, len(self._columns)) for row in (headings, *self._rows)]
        widths = self._fit_widths(rows, width)
        title = [line.with_style("italic") for line in self._title.wrapped(width)] if self._title.plain else []
        return title + [line for k, row in enumerate(rows) for line in self._layout(row, widths, is_heading=k == 0)]

    def _fit_widths(self, rows: list[tuple[Text, ...]], width: int) -> list[int]:
        """Return the column widths [terminal columns], reduced to fit the total width."""
        widths = [
            max(row[k].width for row in rows) if column.width is None else column.width
            for k, column in enumerate(self._columns)
        ]
        available = width - 2 * self._margin - self._gap * (len(widths) - 1)
        wrappable = [k for k, column in enumerate(self._columns) if not column.no_wrap and column.width is None]
        _shrink_widest(widths, wrappable, available)
        _shrink_widest(widths, [k for k, column in enumerate(self._columns) if column.width is None], available)
        return widths

    def _layout(self, row: tuple[Text, ...], widths: list[int], *, is_heading: bool) -> list[Text]:
        """Return the lines of a row, with headings aligned at the bottom."""
        cells = [
            [line.shortened(width) for line in _split_lines(cell)] if column.no_wrap else cell.wrapped(width)
            for cell, column, width in zip(row, self._columns, widths, strict=True)
        ]
        if is_heading:
            height = max(map(len, cells), default=0)
            cells = [[Text()] * (height - len(lines)) + lines for lines in cells]
        return [self._join(line, widths) for line in zip_longest(*cells, fillvalue=Text())]

    def _join(self, cells: tuple[Text, ...], widths: list[int]) -> Text:
        line, gap = Text(), self._margin
        for cell, column, width in zip(cells, self._columns, widths, strict=True):
            fill = max(width - cell.width, 0)
            before = fill if column.justify == "right" else 0
            if cell.plain:
                line += Text(" " * (gap + before)) + cell
                gap = 0
            gap += self._gap + (fill - before if cell.plain else width)
        return line


def _fill_row(row: tuple[Text, ...], count: int) -> tuple[Text, ...]:
    return (*row, *(Text() for _ in range(count - len(row))))


def _split_lines(cell: Text) -> list[Text]:
    return cell.wrapped(max(cell.width, 1))


def _shrink_widest(widths: list[int], columns: list[int], available: int) -> None:
    """Narrow the widest column repeatedly until all columns fit.

    Each column keeps at least one character.
    """
    while sum(widths) > available:
        widest = max(columns, key=widths.__getitem__, default=None)
        if widest is None or widths[widest] <= 1:
            return
        widths[widest] -= 1
