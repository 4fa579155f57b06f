"""What fits on a figure: labels that are short enough, and as many points as can be seen."""

from collections.abc import Iterable

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.report.plots.axes import INCH, SMALL

POINTS = 1000  # of one line; more cannot be seen
_LETTER = 0.55 * SMALL / INCH  # [in] mean width


def fit_text(words: str, width: float) -> str:
    """Cuts a text to a width [in]."""
    letters = int(width / _LETTER)
    return words if len(words) <= letters else words[: letters - 1] + "\u2026" if letters > 1 else ""


def spaced_indices(times: Iterable[float], least: float) -> list[int]:
    """Picks times, in increasing order, that leave at least `least` [s] between them, by their indices."""
    kept: list[int] = []
    last = -np.inf
    for k, time in enumerate(times):
        if time - last >= least:
            kept.append(k)
            last = time
    return kept


def thin_line(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Thins a line of (m,) times and values to about `POINTS` points that show the same extremes."""
    size = int(np.ceil(2 * len(times) / POINTS))
    if size < 3:
        return times, values
    starts = np.arange(0, len(times), size)
    pieces = np.split(values, starts[1:])
    extremes = [
        sorted({start + int(p.argmin()), start + int(p.argmax())}) for start, p in zip(starts, pieces, strict=True)
    ]
    kept = np.unique([0, len(times) - 1, *(k for pair in extremes for k in pair)])
    return times[kept], values[kept]
