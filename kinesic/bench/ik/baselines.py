"""The solvers that the thesis and its successors are compared with, on ball chains without limits, all in one kernel.

Twelve methods share types, forward kinematics and compiler, so that a difference in time is one of method. The sources
of the algorithms stand in `kernel/chain_*.h`. The line does not use them: `solve` is for robots with hinges.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.ik import KERNEL

if KERNEL == "compiled":
    from kinesic.ik import _kernel

Method = Literal[
    "force_verlet",  # the thesis's method 1: masses and springs, the end drawn by a force
    "pinned_verlet",  # the thesis's method 2: masses and springs, the end pinned
    "tridiagonal",  # the same springs relaxed all at once
    "fabrik",
    "triangulation",
    "ccd",
    "transpose",
    "pinv",  # pseudo-inverse by the 3 x 3 normal matrix
    "pinv_svd",  # by a general singular value decomposition
    "dls",  # damped least squares by the 3 x 3 normal matrix
    "dls_dense",  # by the 3n x 3n normal matrix
    "sdls",  # selectively damped least squares
]
METHODS: tuple[Method, ...] = get_args(Method)
TOLERANCE = 1e-3
MOST = 300
LARGEST = 1e100  # [m]; squares of larger numbers overflow
MOST_ITERATIONS = 1_000_000  # so that a solve ends


@dataclass(frozen=True, eq=False)
class Solved:
    """A chain at its goal, or as near as the method came: an unreachable target is a residual, not an error."""

    points: Floats  # (n + 1, 3) [m] from the base to the tip, made from the rotations
    rotations: Floats  # (n, 4) w, x, y, z: of each bone from rest, in the frame of its parent bone
    iterations: int
    residual: float  # tip to clamped target, as a share of the chain's length


@dataclass(frozen=True, eq=False)
class Runs:
    """Many solves of one chain, each from rest."""

    iterations: Floats  # (m,)
    residuals: Floats  # (m,) tip to clamped target, as shares of the chain's length
    nanoseconds: Floats  # (m,) of the whole process, points and rotations; the shortest of three repeats


def curved(bones: int, *, bend: float = np.pi / 18.0) -> Floats:
    """A chain of length one that bends evenly: a start from which no method is stuck.

    Args:
        bones: how many, of equal length.
        bend: [rad] from bone to bone.

    Returns:
        (bones + 1, 3) points from the origin, in the plane of x and z.
    """
    angles = bend * np.arange(bones)
    along = np.stack([np.cos(angles), np.zeros(bones), -np.sin(angles)], axis=1) / bones
    return sealed(np.vstack([np.zeros(3), np.cumsum(along, axis=0)]))


def solve_chain(
    method: Method, rest: Floats, target: Floats, *, tolerance: float = TOLERANCE, most: int = MOST
) -> Solved:
    """Brings the tip of a ball chain to a target.

    A straight chain whose target lies on its own line moves with no iterative method: let the rest be bent.

    Args:
        method: one of `METHODS`.
        rest: (n + 1, 3) [m] points of the chain to begin with; n is 1 to 32.
        target: (3,) [m]; clamped to the chain's reach.
        tolerance: residual that suffices, as a share of the chain's length.
        most: iterations.

    Raises:
        RuntimeError: the kernel is not compiled.
        ValueError: the method is unknown, a shape is wrong, a number is not finite, or a bone has no length.
    """
    _check(tolerance, most)
    if np.shape(target) != (3,):
        raise ValueError(f"target has shape {np.shape(target)}; it needs three numbers (run_chain takes many targets)")
    chain, goal = _points("rest", rest), _points("target", np.reshape(target, (1, 3)))[0]
    points, rotations = np.empty(chain.shape), np.empty((max(len(chain) - 1, 0), 4))
    iterations, residual = _kernel.solve_chain(method, chain, goal, points, rotations, tolerance, most)
    return Solved(sealed(points), sealed(rotations), iterations, residual)


def run_chain(method: Method, rest: Floats, targets: Floats, *, tolerance: float = TOLERANCE, most: int = MOST) -> Runs:
    """Solves for many targets and times each solve inside the kernel.

    Args:
        method: one of `METHODS`.
        rest: (n + 1, 3) [m] points that every solve begins with.
        targets: (m, 3) [m].
        tolerance: residual that suffices, as a share of the chain's length.
        most: iterations.

    Raises:
        RuntimeError: the kernel is not compiled.
        ValueError: as in `solve_chain`.
    """
    _check(tolerance, most)
    chain, goals = _points("rest", rest), _points("targets", targets)
    iterations = np.empty(len(goals), dtype=np.int64)
    residuals, nanoseconds = np.empty(len(goals)), np.empty(len(goals))
    _kernel.run_chain(method, chain, goals, tolerance, most, iterations, residuals, nanoseconds)
    return Runs(sealed(iterations), sealed(residuals), sealed(nanoseconds))


def _check(tolerance: float, most: int) -> None:
    if KERNEL != "compiled":
        raise RuntimeError(
            "the baselines exist only in the compiled kernel, and this process runs without it; "
            "with a C++ compiler, `pip install --editable .` builds it (KINESIC_KERNEL=numpy turns it off)"
        )
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance is {tolerance}; it is a share of the chain's length, between 0 and 1")
    if not 0 <= most <= MOST_ITERATIONS:
        raise ValueError(f"most is {most} iterations; it must be 0 to {MOST_ITERATIONS}")


def _points(name: str, values: Floats) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has shape {np.shape(values)}; it needs three numbers per point")
    wrong = np.flatnonzero(~(np.abs(array) < LARGEST).all(axis=1))
    if wrong.size:
        row = int(wrong[0])
        raise ValueError(
            f"point {row} of {name} is {array[row].tolist()}; every number must be finite, and below {LARGEST:g}"
        )
    return array
