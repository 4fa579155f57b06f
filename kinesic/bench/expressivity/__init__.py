"""Measures what each parameter of expressivity changes, whether gestures stay distinct, and what fingers do."""

from pathlib import Path

from kinesic.bench.expressivity import fingers, lexicon, sweeps
from kinesic.bench.figure import Figure

PARTS = (sweeps, lexicon, fingers)


def bench() -> list[Figure]:
    """Measures every figure of the part."""
    return [figure for part in PARTS for figure in part.bench()]


def draw(folder: Path) -> list[Path]:
    """Draws what was measured: each parameter's own measure in all gestures, and what a gesture looks like."""
    return [
        sweeps.draw(sweeps.swept(), folder / "expressivity-measures.png"),
        sweeps.draw_paths(sweeps.swept(), folder / "expressivity-paths.png"),
    ]
