"""Measured metrics of benchmarks and helpers for their plots."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

MAIN_COLOUR = "#2b7a78"  # plot colour of kinesic's own results
SECOND_COLOUR = "#d98e2b"  # plot colour of a second series
OTHER_COLOUR = "#5b6fb5"  # plot colour of other libraries' results
CONTRAST_COLOUR = "#b3261e"  # plot colour of goals, targets and reference values
INK_COLOUR = "#333333"  # plot colour of text and lines
LABEL_SIZE = 8.5  # [pt] font size of axis labels


@dataclass(frozen=True)
class Metric:
    """Measured value of a benchmark with its unit and goal.

    `value` is None if this machine cannot measure it; `why` then gives the reason.
    """

    name: str
    value: float | None
    unit: str
    goal: float | None
    better: Literal["lower", "higher"]
    why: str = ""

    @property
    def ok(self) -> bool | None:
        """Whether the measured value meets the goal.

        The result is None without a value or a goal.
        """
        if self.value is None or self.goal is None:
            return None
        return self.value >= self.goal if self.better == "higher" else self.value <= self.goal


@contextmanager
def picture(path: Path, width: float, height: float, *, dpi: int = 110) -> Iterator["Picture"]:
    """Yield an empty matplotlib figure and save it as PNG on exit.

    No screen is needed, and equal drawings give equal files.

    Args:
        path: path of the PNG file.
        width: width of the figure [in].
        height: height of the figure [in].
        dpi: pixels per inch.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - slow import, rarely needed
    from matplotlib.figure import Figure as Picture  # noqa: PLC0415 - as above

    drawn = Picture(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(drawn)
    yield drawn
    drawn.savefig(path, dpi=dpi, metadata={"Software": None})


def label_axes(axes: "Axes", across: str, up: str = "", *, title: str = "") -> None:
    """Set a plot's axis labels and title."""
    axes.set_xlabel(across, fontsize=LABEL_SIZE, color=INK_COLOUR)
    axes.set_ylabel(up, fontsize=LABEL_SIZE, color=INK_COLOUR)
    if title:
        axes.set_title(title, fontsize=10, color=INK_COLOUR)


def name_rows(axes: "Axes", names: Sequence[str]) -> None:
    """Label the rows of a horizontal bar chart and hide its frame.

    The first row lies at height 0, all others below it.
    """
    axes.set_yticks([-row for row in range(len(names))], names)
    axes.tick_params(labelsize=LABEL_SIZE, length=2)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
