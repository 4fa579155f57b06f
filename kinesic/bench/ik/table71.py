"""Thesis Table 7.1 (IK methods) measured again with further methods.

The chains have 6 or 10 ball joints without limits.

All methods run in one kernel; the measured time covers points and a rotation for every joint. The time of one solve is
the shortest of its repeats; the table has the median over targets and its ratio to method 2 of the thesis. All methods
solve batches of targets in turn, twice, so that other load affects no method alone. The plots show iterations and time
of every method next to the thesis' values.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from kinesic.bench.ik.baselines import IK_METHODS, RESIDUAL_TOLERANCE, ChainRuns, Method, make_curved_chain, run_chain
from kinesic.bench.metric import (
    CONTRAST_COLOUR,
    INK_COLOUR,
    LABEL_SIZE,
    MAIN_COLOUR,
    OTHER_COLOUR,
    SECOND_COLOUR,
    Metric,
    name_rows,
    picture,
)
from kinesic.body.arrays import Floats

Quantity = Literal["iterations", "us", "ratio", "success", "unreachable"]

CHAIN_SIZES = (6, 10)  # bones of the two measured chains
REACHABLE_TARGETS = 2000  # number of reachable targets, uniform in volume
UNREACHABLE_TARGETS = 500  # number of unreachable targets
MIN_DISTANCE = 0.1  # [chain lengths] smallest distance of a reachable target from the base
MAX_DISTANCE = 0.97  # [chain lengths] largest distance of a reachable target from the base
MIN_FAR_DISTANCE = 1.02  # [chain lengths] smallest distance of an unreachable target from the base
MAX_FAR_DISTANCE = 2.0  # [chain lengths] largest distance of an unreachable target from the base
POINTING_RESIDUAL = 1e-2  # residual / chain length below which a chain counts as pointing at an unreachable target
BATCH_COUNT = 8  # batches in which the targets are solved
TIMING_PASSES = 2  # number of timed passes over all targets
REFERENCE_METHOD: Method = "pinned_verlet"  # method whose time is the unit of all other times
QUANTITY_UNITS: dict[Quantity, str] = {
    "iterations": "mean",
    "us": "us",
    "ratio": "x method 2",
    "success": "share",
    "unreachable": "share",
}
METHOD_LABELS: dict[Method, str] = {
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
FIRST_HEURISTIC_ROW = IK_METHODS.index("fabrik")  # index of the first heuristic method
FIRST_JACOBIAN_ROW = IK_METHODS.index("transpose")  # index of the first method with a Jacobian


@dataclass(frozen=True)
class ThesisRow:
    """Values printed in Table 7.1 for one IK method and chain size."""

    iterations: float
    milliseconds: float


THESIS_ROWS: dict[tuple[Method, int], ThesisRow] = {
    ("force_verlet", 6): ThesisRow(49.6, 0.195),
    ("force_verlet", 10): ThesisRow(60.5, 0.253),
    ("pinned_verlet", 6): ThesisRow(26.9, 0.132),
    ("pinned_verlet", 10): ThesisRow(40.1, 0.169),
    ("ccd", 6): ThesisRow(33.2, 0.131),
    ("ccd", 10): ThesisRow(39.7, 0.148),
    ("pinv_svd", 6): ThesisRow(51.8, 1.095),
    ("pinv_svd", 10): ThesisRow(55.9, 1.310),
    ("transpose", 6): ThesisRow(6.8, 0.124),
    ("transpose", 10): ThesisRow(17.1, 0.235),
    ("dls_dense", 6): ThesisRow(55.6, 1.237),
    ("dls_dense", 10): ThesisRow(68.7, 1.450),
}


def table_name(method: Method, bones: int, quantity: Quantity) -> str:
    """Return the metric name of one cell of thesis Table 7.1."""
    return f"ik.table71_{method}_n{bones}_{quantity}"


def thesis_value(method: Method, bones: int, quantity: Quantity) -> float | None:
    """Return a value of thesis Table 7.1, times relative to method 2.

    The result is None if not printed.
    """
    row = THESIS_ROWS.get((method, bones))
    if row is None or quantity not in ("iterations", "ratio"):
        return None
    return (
        row.iterations
        if quantity == "iterations"
        else row.milliseconds / THESIS_ROWS[REFERENCE_METHOD, bones].milliseconds
    )


def bench() -> list[Metric]:
    """Measure iterations, times and successes of every IK method and chain size.

    It is a comparison without goals.
    """
    return [metric for bones in CHAIN_SIZES for metric in _metrics(bones)]


def _metrics(bones: int) -> list[Metric]:
    values = _measure(bones)
    metrics = []
    for method in IK_METHODS:
        for quantity, unit in QUANTITY_UNITS.items():
            value, thesis = values[method, quantity], thesis_value(method, bones, quantity)
            why = "" if thesis is None else f"thesis {thesis:.3g}"
            better: Literal["lower", "higher"] = "higher" if unit == "share" else "lower"
            metrics.append(Metric(table_name(method, bones, quantity), value, unit, None, better, why))
    return metrics


def _measure(bones: int) -> dict[tuple[Method, Quantity], float]:
    inside = _draw_targets(REACHABLE_TARGETS, MIN_DISTANCE, MAX_DISTANCE)
    passes = [_run_all(bones, inside) for _ in range(TIMING_PASSES)]
    outside = _run_all(bones, _draw_targets(UNREACHABLE_TARGETS, MIN_FAR_DISTANCE, MAX_FAR_DISTANCE))
    shortest = {method: np.min([runs[method].nanoseconds for runs in passes], axis=0) for method in IK_METHODS}
    times = {method: 1e-3 * float(np.median(nanoseconds)) for method, nanoseconds in shortest.items()}
    values: dict[tuple[Method, Quantity], float] = {}
    for method, runs in passes[0].items():
        values[method, "iterations"] = float(runs.iterations.mean())
        values[method, "us"] = times[method]
        values[method, "ratio"] = times[method] / times[REFERENCE_METHOD]
        values[method, "success"] = float((runs.residuals <= RESIDUAL_TOLERANCE).mean())
        values[method, "unreachable"] = float((outside[method].residuals < POINTING_RESIDUAL).mean())
    return values


def _run_all(bones: int, targets: Floats) -> dict[Method, ChainRuns]:
    rest = make_curved_chain(bones)
    parts: dict[Method, list[ChainRuns]] = {method: [] for method in IK_METHODS}
    for batch in np.array_split(targets, BATCH_COUNT):
        for method, runs in parts.items():
            runs.append(run_chain(method, rest, batch))
    return {method: _join_runs(runs) for method, runs in parts.items()}


def _join_runs(parts: Sequence[ChainRuns]) -> ChainRuns:
    iterations = np.concatenate([part.iterations for part in parts])
    residuals = np.concatenate([part.residuals for part in parts])
    return ChainRuns(iterations, residuals, np.concatenate([part.nanoseconds for part in parts]))


def _draw_targets(count: int, nearest: float, farthest: float) -> Floats:
    """Sample targets (count, 3) [chain lengths], uniform in volume between two spheres."""
    random = np.random.default_rng(71)
    directions = random.normal(size=(count, 3))
    distances = np.cbrt(random.uniform(nearest**3, farthest**3, count))
    return np.asarray(directions / np.linalg.norm(directions, axis=1)[:, None] * distances[:, None])


def draw(values: Mapping[str, float], path: Path) -> Path:
    """Draw the iterations and times of Table 7.1 as bar charts.

    Args:
        values: metric values by name, as listed by `kinesic bench ik --json`; others are ignored.
        path: path of the PNG file.

    Returns:
        The path.

    Raises:
        KeyError: a metric of the table is missing.
    """
    with picture(path, 11.0, 7.6) as drawn:
        axes = drawn.subplots(2, 2, sharey=True)
        for column, bones in enumerate(CHAIN_SIZES):
            _draw_bars(axes[0, column], values, bones, "iterations")
            _draw_bars(axes[1, column], values, bones, "ratio")
            axes[0, column].set_title(f"{bones} ball joints", fontsize=11, color=INK_COLOUR)
        drawn.suptitle(
            "Reach without limits: residual below 1/1000 of the chain's length, at most 300 iterations", fontsize=11
        )
        diamond = axes[0, 0].plot(
            [], [], "D", markerfacecolor="white", markeredgecolor=CONTRAST_COLOUR, linestyle="none"
        )
        drawn.legend(diamond, ["printed in the thesis"], loc="outside lower right", fontsize=LABEL_SIZE, frameon=False)
    return path


def _draw_bars(axes: Axes, values: Mapping[str, float], bones: int, quantity: Quantity) -> None:
    """Draw one quantity of all IK methods on a logarithmic axis.

    Times are multiples of method 2's time; faster methods extend to the left.
    """
    is_count = quantity == "iterations"
    begin = 0.8 if is_count else 1.0
    for row, method in enumerate(IK_METHODS):
        value, thesis = values[table_name(method, bones, quantity)], thesis_value(method, bones, quantity)
        axes.barh(-row, value - begin, left=begin, height=0.66, color=_colour(method), zorder=2)
        if thesis is not None:
            axes.plot(
                thesis, -row, "D", markersize=6, markerfacecolor="white", markeredgecolor=CONTRAST_COLOUR, zorder=4
            )
        metric = f"{value:.1f}" if is_count else f"{value:.2f}"
        axes.text(
            1.01, -row, metric, transform=axes.get_yaxis_transform(), va="center", fontsize=LABEL_SIZE, color=INK_COLOUR
        )
        success = values[table_name(method, bones, "success")]
        if is_count and success < 1.0:
            axes.text(0.9, -row, f"reaches {100.0 * success:.1f} %", va="center", fontsize=LABEL_SIZE, color="white")
    axes.set_xscale("log")
    axes.set_xlim((begin, 130.0) if is_count else (0.25, 17.0))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    reference_us = values[table_name(REFERENCE_METHOD, bones, "us")]
    unit = f"median time relative to method 2 of the thesis ({reference_us:.1f} \u00b5s)"
    axes.set_xlabel("iterations, mean" if is_count else unit, fontsize=LABEL_SIZE)
    name_rows(axes, [METHOD_LABELS[method] for method in IK_METHODS])
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=True, axis="x", color="#e4e4e4", linewidth=0.6)


def _colour(method: Method) -> str:
    row = IK_METHODS.index(method)
    return MAIN_COLOUR if row < FIRST_HEURISTIC_ROW else SECOND_COLOUR if row < FIRST_JACOBIAN_ROW else OTHER_COLOUR
