"""Measures what each parameter of expressivity changes, and whether gestures stay distinct."""

from pathlib import Path

from kinesic.bench.expressivity import lexicon, sweeps
from kinesic.bench.figure import Figure

PARTS = (sweeps, lexicon)


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    return [figure for part in PARTS for figure in part.bench()]


def draw(folder: Path) -> list[Path]:
    """Draws what was measured: each parameter's own measure in all gestures, and what a gesture looks like."""
    return [
        sweeps.draw(sweeps.swept(), folder / "expressivity-measures.png"),
        sweeps.draw_paths(sweeps.swept(), folder / "expressivity-paths.png"),
    ]
