"""The thesis's Table 7.1 measured again, with the methods that it left out: ball chains of 6 and 10 bones, no limits.

All in one kernel; the whole process counts: points, and a rotation for every joint. The time of one solve is the
shortest of its repeats; then the median over targets, and its ratio to the thesis's method 2. Targets come in batches
that all methods solve in turn, twice, so that a busy moment of the machine falls on no method alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.bench.figure import Figure
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


def name(method: Method, bones: int, quantity: Quantity) -> str:
    """The name of a figure."""
    return f"ik.table71_{method}_n{bones}_{quantity}"


def printed(method: Method, bones: int, quantity: Quantity) -> float | None:
    """What the thesis says of a figure, the time as a multiple of method 2's; None where it says nothing."""
    row = THESIS.get((method, bones))
    if row is None or quantity not in ("iterations", "ratio"):
        return None
    return row.iterations if quantity == "iterations" else row.milliseconds / THESIS[REFERENCE, bones].milliseconds


def bench() -> list[Figure]:
    """Iterations, times and successes of every method at both sizes: a comparison, without goals."""
    return [figure for bones in SIZES for figure in _figures(bones)]


def _figures(bones: int) -> list[Figure]:
    values = _measured(bones) if KERNEL == "compiled" else {}
    figures = []
    for method in METHODS:
        for quantity, unit in UNITS.items():
            value, thesis = values.get((method, quantity)), printed(method, bones, quantity)
            why = "the kernel is not compiled" if value is None else "" if thesis is None else f"thesis {thesis:.3g}"
            better: Literal["lower", "higher"] = "higher" if unit == "share" else "lower"
            figures.append(Figure(name(method, bones, quantity), value, unit, None, better, why))
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
    """All methods, batch by batch."""
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
