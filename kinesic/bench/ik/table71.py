"""The thesis's Table 7.1 measured again, with the methods that it left out: ball chains of 6 and 10 bones, no limits.

All in one kernel; the whole process counts: points, and a rotation for every joint. The time of one solve is the
shortest of its repeats; then the median over targets, and its ratio to the thesis's method 2. Targets come in batches
that all methods solve in turn, twice, so that a busy moment of the machine falls on no method alone. Drawn as bars:
iterations and time of every method, the thesis's figures beside.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from kinesic.bench.figure import ALARM, INK, OTHERS, OURS, SECOND, SMALL, Figure, name_rows, picture
from kinesic.bench.ik.baselines import METHODS, TOLERANCE, Method, Runs, curved, run_chain
from kinesic.body.arrays import Floats
from kinesic.ik import KERNEL

Quantity = Literal["iterations", "us", "ratio", "success", "unreachable"]

SIZES = (6, 10)  # bones
REACHABLE, UNREACHABLE = 2000, 500  # targets, even in volume
NEAR, INSIDE, BEYOND, FAR = 0.1, 0.97, 1.02, 2.0  # chain lengths from the base
STRAIGHT = 1e-2  # residual at which an unreachable target counts as pointed at
BATCHES = 8
PASSES = 2  # over the targets that are timed
REFERENCE: Method = "pinned_verlet"
UNITS: dict[Quantity, str] = {
    "iterations": "mean",
    "us": "us",
    "ratio": "x method 2",
    "success": "share",
    "unreachable": "share",
}
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
FIRST_HEURISTIC, FIRST_JACOBIAN = METHODS.index("fabrik"), METHODS.index("transpose")


@dataclass(frozen=True)
class Printed:
    """What the thesis prints for one method and size."""

    iterations: float
    milliseconds: float


THESIS: dict[tuple[Method, int], Printed] = {
    ("force_verlet", 6): Printed(49.6, 0.195),
    ("force_verlet", 10): Printed(60.5, 0.253),
    ("pinned_verlet", 6): Printed(26.9, 0.132),
    ("pinned_verlet", 10): Printed(40.1, 0.169),
    ("ccd", 6): Printed(33.2, 0.131),
    ("ccd", 10): Printed(39.7, 0.148),
    ("pinv_svd", 6): Printed(51.8, 1.095),
    ("pinv_svd", 10): Printed(55.9, 1.310),
    ("transpose", 6): Printed(6.8, 0.124),
    ("transpose", 10): Printed(17.1, 0.235),
    ("dls_dense", 6): Printed(55.6, 1.237),
    ("dls_dense", 10): Printed(68.7, 1.450),
}


def table_name(method: Method, bones: int, quantity: Quantity) -> str:
    """Names a figure."""
    return f"ik.table71_{method}_n{bones}_{quantity}"


def printed(method: Method, bones: int, quantity: Quantity) -> float | None:
    """What the thesis says of a figure, the time as a multiple of method 2's; None where it says nothing."""
    row = THESIS.get((method, bones))
    if row is None or quantity not in ("iterations", "ratio"):
        return None
    return row.iterations if quantity == "iterations" else row.milliseconds / THESIS[REFERENCE, bones].milliseconds


def bench() -> list[Figure]:
    """Measures iterations, times and successes of every method at both sizes: a comparison, without goals."""
    return [figure for bones in SIZES for figure in _figures(bones)]


def _figures(bones: int) -> list[Figure]:
    values = _measured(bones) if KERNEL == "compiled" else {}
    figures = []
    for method in METHODS:
        for quantity, unit in UNITS.items():
            value, thesis = values.get((method, quantity)), printed(method, bones, quantity)
            why = "the kernel is not compiled" if value is None else "" if thesis is None else f"thesis {thesis:.3g}"
            better: Literal["lower", "higher"] = "higher" if unit == "share" else "lower"
            figures.append(Figure(table_name(method, bones, quantity), value, unit, None, better, why))
    return figures


def _measured(bones: int) -> dict[tuple[Method, Quantity], float]:
    inside = _targets(REACHABLE, NEAR, INSIDE)
    passes = [_runs(bones, inside) for _ in range(PASSES)]
    outside = _runs(bones, _targets(UNREACHABLE, BEYOND, FAR))
    shortest = {method: np.min([runs[method].nanoseconds for runs in passes], axis=0) for method in METHODS}
    times = {method: 1e-3 * float(np.median(nanoseconds)) for method, nanoseconds in shortest.items()}
    values: dict[tuple[Method, Quantity], float] = {}
    for method, runs in passes[0].items():
        values[method, "iterations"] = float(runs.iterations.mean())
        values[method, "us"] = times[method]
        values[method, "ratio"] = times[method] / times[REFERENCE]
        values[method, "success"] = float((runs.residuals <= TOLERANCE).mean())
        values[method, "unreachable"] = float((outside[method].residuals < STRAIGHT).mean())
    return values


def _runs(bones: int, targets: Floats) -> dict[Method, Runs]:
    rest = curved(bones)
    parts: dict[Method, list[Runs]] = {method: [] for method in METHODS}
    for batch in np.array_split(targets, BATCHES):
        for method, found in parts.items():
            found.append(run_chain(method, rest, batch))
    return {method: _joined(found) for method, found in parts.items()}


def _joined(parts: Sequence[Runs]) -> Runs:
    iterations = np.concatenate([part.iterations for part in parts])
    residuals = np.concatenate([part.residuals for part in parts])
    return Runs(iterations, residuals, np.concatenate([part.nanoseconds for part in parts]))


def _targets(count: int, nearest: float, farthest: float) -> Floats:
    """Even in volume between two spheres around the base, (count, 3) in chain lengths."""
    random = np.random.default_rng(71)
    lines = random.normal(size=(count, 3))
    far = np.cbrt(random.uniform(nearest**3, farthest**3, count))
    return np.asarray(lines / np.linalg.norm(lines, axis=1)[:, None] * far[:, None])


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
    with picture(path, 11.0, 7.6) as drawn:
        axes = drawn.subplots(2, 2, sharey=True)
        for column, bones in enumerate(SIZES):
            _bars(axes[0, column], values, bones, "iterations")
            _bars(axes[1, column], values, bones, "ratio")
            axes[0, column].set_title(f"{bones} ball joints", fontsize=11, color=INK)
        drawn.suptitle(
            "Reach without limits: residual below 1/1000 of the chain's length, at most 300 iterations", fontsize=11
        )
        diamond = axes[0, 0].plot([], [], "D", markerfacecolor="white", markeredgecolor=ALARM, linestyle="none")
        drawn.legend(diamond, ["printed in the thesis"], loc="outside lower right", fontsize=SMALL, frameon=False)
    return path


def _bars(axes: Axes, values: Mapping[str, float], bones: int, quantity: Quantity) -> None:
    """One quantity of all methods on a logarithmic axis; times as multiples of method 2's, left of it the faster."""
    counted = quantity == "iterations"
    begin = 0.8 if counted else 1.0
    for row, method in enumerate(METHODS):
        value, thesis = values[table_name(method, bones, quantity)], printed(method, bones, quantity)
        axes.barh(-row, value - begin, left=begin, height=0.66, color=_colour(method), zorder=2)
        if thesis is not None:
            axes.plot(thesis, -row, "D", markersize=6, markerfacecolor="white", markeredgecolor=ALARM, zorder=4)
        figure = f"{value:.1f}" if counted else f"{value:.2f}"
        axes.text(1.01, -row, figure, transform=axes.get_yaxis_transform(), va="center", fontsize=SMALL, color=INK)
        success = values[table_name(method, bones, "success")]
        if counted and success < 1.0:
            axes.text(0.9, -row, f"reaches {100.0 * success:.1f} %", va="center", fontsize=SMALL, color="white")
    axes.set_xscale("log")
    axes.set_xlim((begin, 130.0) if counted else (0.25, 17.0))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    unit = f"median time, in those of thesis method 2 ({values[table_name(REFERENCE, bones, 'us')]:.1f} \u00b5s)"
    axes.set_xlabel("iterations, mean" if counted else unit, fontsize=SMALL)
    name_rows(axes, [WORDS[method] for method in METHODS])
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=True, axis="x", color="#e4e4e4", linewidth=0.6)


def _colour(method: Method) -> str:
    row = METHODS.index(method)
    return OURS if row < FIRST_HEURISTIC else SECOND if row < FIRST_JACOBIAN else OTHERS
