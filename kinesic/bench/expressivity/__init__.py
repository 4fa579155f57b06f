"""Benchmark of expressivity: effects of parameters, gesture errors and finger clearance."""

from pathlib import Path

from kinesic.bench.expressivity import fingers, lexicon, sweeps
from kinesic.bench.metric import Metric

EXPRESSIVITY_PARTS = (sweeps, lexicon, fingers)


def bench() -> list[Metric]:
    """Measure effects of expressivity parameters, errors of gestures and finger clearance."""
    return [metric for part in EXPRESSIVITY_PARTS for metric in part.bench()]


def draw(folder: Path) -> list[Path]:
    """Plot the measured effect of each parameter, and example hand paths."""
    return [
        sweeps.draw(sweeps.sweep_all(), folder / "expressivity-measures.png"),
        sweeps.draw_paths(sweeps.sweep_all(), folder / "expressivity-paths.png"),
    ]
