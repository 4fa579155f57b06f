"""Inverse kinematics."""

from collections.abc import Sequence
from pathlib import Path

from kinesic.controller.bench import reach, table71, table71_plot, tasks, tracking
from kinesic.controller.bench.figure import Figure


def bench() -> list[Figure]:
    """Every figure of the room."""
    return [*reach.bench(), *tracking.bench(), *tasks.bench(), *table71.bench()]


def draw(figures: Sequence[Figure], folder: Path) -> list[Path]:
    """Draws what was measured.

    Args:
        figures: of `bench`, in any order, others among them.
        folder: for the pictures.

    Returns:
        The pictures; none without the kernel.
    """
    values = {figure.name: figure.value for figure in figures if figure.value is not None}
    return [table71_plot.draw(values, folder / "ik-table71.png")] if values else []
