"""Plain HTML of notebooks: badges and tables in the notebook's colours."""

from collections.abc import Iterable, Sequence
from html import escape
from typing import Literal

Grade = Literal["ok", "poor", "fail"]
GRADE_COLOURS: dict[Grade, str] = {"ok": "#1f7a3d", "poor": "#a0348f", "fail": "#c02626"}  # background of badges
MAX_TABLE_ROWS = 60  # largest number of rows shown of a table


def badge(grade: Grade) -> str:
    """Return a coloured HTML label with a grade."""
    look = f"background:{GRADE_COLOURS[grade]};color:#fff;border-radius:9px;padding:1px 9px;font-weight:600"
    return f'<span style="{look}">{grade}</span>'


def line(text: str, *, before: str = "") -> str:
    """Return an HTML paragraph: optional HTML, then an escaped text."""
    return f'<p style="margin:.4em 0">{before}{escape(text)}</p>'


def folded_table(title: str, headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a collapsed HTML table, or an empty text without rows."""
    cells = list(rows)
    if not cells:
        return ""
    more = f"<p>and {len(cells) - MAX_TABLE_ROWS} more</p>" if len(cells) > MAX_TABLE_ROWS else ""
    shown = table(headings, cells[:MAX_TABLE_ROWS])
    return f'<details style="margin:.3em 0"><summary>{escape(title)}</summary>{shown}{more}</details>'


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return an HTML table with escaped texts."""
    head = "".join(_cell("th", text) for text in headings)
    body = "".join(f"<tr>{''.join(_cell('td', text) for text in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(tag: str, text: str) -> str:
    return f'<{tag} style="text-align:left">{escape(text)}</{tag}>'
