"""What benches give: measured figures beside their goals, and pictures of them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

OURS, SECOND, OTHERS, ALARM, INK = "#2b7a78", "#d98e2b", "#5b6fb5", "#b3261e", "#333333"  # colours
SMALL = 8.5  # [pt] of what stands beside the axes


@dataclass(frozen=True)
class Figure:
    """A figure; `value` is None with a `why` where this machine cannot measure it."""

    name: str
    value: float | None
    unit: str
    goal: float | None
    better: Literal["lower", "higher"]
    why: str = ""

    @property
    def ok(self) -> bool | None:
        """Whether the goal is met; None without a value or a goal."""
        if self.value is None or self.goal is None:
            return None
        return self.value >= self.goal if self.better == "higher" else self.value <= self.goal


@contextmanager
def picture(path: Path, width: float, height: float, *, dpi: int = 110) -> Iterator["Picture"]:
    """Gives an empty picture to draw in, and writes it in the end, without a screen and the same at each run.

    Args:
        path: of the PNG.
        width: of the picture [in].
        height: likewise.
        dpi: pixels to the inch.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - slow to import, and few figures are drawn
    from matplotlib.figure import Figure as Picture  # noqa: PLC0415 - as above

    drawn = Picture(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(drawn)
    yield drawn
    drawn.savefig(path, dpi=dpi, metadata={"Software": None})


def label_axes(axes: "Axes", across: str, up: str = "", *, title: str = "") -> None:
    """Says what runs across, what runs up, and what is shown."""
    axes.set_xlabel(across, fontsize=SMALL, color=INK)
    axes.set_ylabel(up, fontsize=SMALL, color=INK)
    if title:
        axes.set_title(title, fontsize=10, color=INK)


def name_rows(axes: "Axes", names: Sequence[str]) -> None:
    """Names bars that lie below one another, the first at height 0, and takes the frame away."""
    axes.set_yticks([-row for row in range(len(names))], names)
    axes.tick_params(labelsize=SMALL, length=2)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
