"""Table 7.1 as bars: iterations and time of every method, the thesis's figures beside."""

from collections.abc import Mapping
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from kinesic.bench.ik.baselines import METHODS, Method
from kinesic.bench.ik.table71 import REFERENCE, SIZES, Quantity, name, printed

WORDS: dict[Method, str] = {
    "force_verlet": "thesis 1: springs, force",
    "pinned_verlet": "thesis 2: springs, pinned",
    "tridiagonal": "springs solved directly",
    "fabrik": "FABRIK",
    "triangulation": "triangulation",
    "ccd": "CCD",
    "transpose": "Jacobian transpose",
    "pinv": "pseudo-inverse, 3x3",
    "pinv_svd": "pseudo-inverse, SVD",
    "dls": "DLS, 3x3",
    "dls_dense": "DLS, 3n x 3n",
    "sdls": "SDLS",
}
SPRINGS, HEURISTICS, JACOBIANS, THESIS, INK = "#2b7a78", "#d98e2b", "#5b6fb5", "#b3261e", "#333333"
FIRST_HEURISTIC, FIRST_JACOBIAN = METHODS.index("fabrik"), METHODS.index("transpose")
SMALL = 8.5  # [pt]


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draws the table.

    Args:
        values: figures by name, as `kinesic bench ik --json` lists them; others are ignored.
        path: of the picture, PNG.

    Returns:
        The path.

    Raises:
        KeyError: a figure of the table is missing.
    """
    figure = Figure(figsize=(11.0, 7.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 2, sharey=True)
    for column, bones in enumerate(SIZES):
        _bars(axes[0, column], values, bones, "iterations")
        _bars(axes[1, column], values, bones, "ratio")
        axes[0, column].set_title(f"{bones} ball joints", fontsize=11, color=INK)
    figure.suptitle(
        "Reach without limits: residual below 1/1000 of the chain's length, at most 300 iterations", fontsize=11
    )
    diamond = axes[0, 0].plot([], [], "D", markerfacecolor="white", markeredgecolor=THESIS, linestyle="none")
    figure.legend(diamond, ["printed in the thesis"], loc="outside lower right", fontsize=SMALL, frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    return path


def _bars(axes: Axes, values: Mapping[str, float], bones: int, quantity: Quantity) -> None:
    """One quantity of all methods on a logarithmic axis; times as multiples of method 2's, left of it the faster."""
    counted = quantity == "iterations"
    begin = 0.8 if counted else 1.0
    for row, method in enumerate(METHODS):
        value, thesis = values[name(method, bones, quantity)], printed(method, bones, quantity)
        axes.barh(-row, value - begin, left=begin, height=0.66, color=_colour(method), zorder=2)
        if thesis is not None:
            axes.plot(thesis, -row, "D", markersize=6, markerfacecolor="white", markeredgecolor=THESIS, zorder=4)
        figure = f"{value:.1f}" if counted else f"{value:.2f}"
        axes.text(1.01, -row, figure, transform=axes.get_yaxis_transform(), va="center", fontsize=SMALL, color=INK)
        success = values[name(method, bones, "success")]
        if counted and success < 1.0:
            axes.text(0.9, -row, f"reaches {100.0 * success:.1f} %", va="center", fontsize=SMALL, color="white")
    axes.set_xscale("log")
    axes.set_xlim((begin, 130.0) if counted else (0.25, 17.0))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    unit = f"median time, in those of thesis method 2 ({values[name(REFERENCE, bones, 'us')]:.1f} \u00b5s)"
    axes.set_xlabel("iterations, mean" if counted else unit, fontsize=SMALL)
    axes.set_yticks([-row for row in range(len(METHODS))], [WORDS[method] for method in METHODS])
    axes.tick_params(labelsize=SMALL, length=2)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=True, axis="x", color="#e4e4e4", linewidth=0.6)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def _colour(method: Method) -> str:
    row = METHODS.index(method)
    return SPRINGS if row < FIRST_HEURISTIC else HEURISTICS if row < FIRST_JACOBIAN else JACOBIANS
