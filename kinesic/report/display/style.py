"""HTML of styles: a bar for each parameter of each modality."""

from html import escape

from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, MODALITIES, Style
from kinesic.report.display.tables import line

BAR_WIDTH = 90  # [pixels] width of a style parameter's bar at full range
BAR_COLOUR = "#1769c2"  # colour of the bars of style parameters


def style_html(style: Style) -> str:
    """Return the HTML of a style: parameters by modality, with bars."""
    head = "".join(f'<th style="text-align:left">{modality}</th>' for modality in ("", *MODALITIES))
    body = "".join(_row(style, parameter) for parameter in EXPRESSIVITY_RANGES)
    return line(str(style)) + f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _row(style: Style, parameter: str) -> str:
    cells = "".join(f"<td>{_bar(getattr(style.of(part), parameter), parameter)}</td>" for part in MODALITIES)
    return f'<tr><th style="text-align:left">{escape(parameter)}</th>{cells}</tr>'


def _bar(value: float, parameter: str) -> str:
    """Draw a value as a bar from zero within the parameter's range."""
    low, high = EXPRESSIVITY_RANGES[parameter]
    left, right = sorted(BAR_WIDTH * (number - low) / (high - low) for number in (0.0, value))
    zero = BAR_WIDTH * (0.0 - low) / (high - low)
    axis = f'<path d="M{zero:.1f} 0V12M0 6H{BAR_WIDTH}" stroke="currentColor" stroke-opacity=".3"/>'
    bar = f'<rect x="{left:.1f}" y="2" width="{right - left:.1f}" height="8" fill="{BAR_COLOUR}"/>'
    text = f"{value:+.2f}".replace("-", "\u2212") if value else "0"
    svg = f'<svg width="{BAR_WIDTH}" height="12" viewBox="0 0 {BAR_WIDTH} 12" overflow="visible">{axis}{bar}</svg>'
    return f'{svg} <span style="display:inline-block;width:3.2em;text-align:right">{text}</span>'
