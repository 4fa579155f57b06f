"""Baseline IK solvers of the thesis and later work, without joint limits.

Twelve methods share types, forward kinematics and compiler, so that time differences come from the method. The
algorithms' sources are cited in `kernel/chain_*.h`. Motion planning does not use these solvers: `solve` handles robots
with joint limits.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from kinesic._kernel import ik as kernel
from kinesic.body.arrays import Floats, sealed

Method = Literal[
    "force_verlet",  # method 1 of the thesis: masses and springs, the end drawn by a force
    "pinned_verlet",  # method 2 of the thesis: masses and springs, the end pinned
    "tridiagonal",  # the same springs solved simultaneously
    "fabrik",
    "triangulation",
    "ccd",
    "transpose",
    "pinv",  # pseudo-inverse by the 3 x 3 normal matrix
    "pinv_svd",  # pseudo-inverse by a general singular value decomposition
    "dls",  # damped least squares by the 3 x 3 normal matrix
    "dls_dense",  # damped least squares by the 3n x 3n normal matrix
    "sdls",  # selectively damped least squares
]
IK_METHODS: tuple[Method, ...] = get_args(Method)
RESIDUAL_TOLERANCE = 1e-3  # default residual / chain length at which a solve ends
MAX_ITERATIONS = 300  # default iteration limit of a solve
MAX_COORDINATE = 1e100  # [m] largest coordinate of points and targets, so that squares cannot overflow
ITERATION_LIMIT = 1_000_000  # largest iteration limit that callers may set


@dataclass(frozen=True, eq=False)
class ChainSolution:
    """Ball chain solved for a target, with iterations and residual.

    An unreachable target gives a residual, not an error.
    """

    points: Floats  # (n + 1, 3) [m] positions of the joints from base to tip, computed from the rotations
    rotations: Floats  # (n, 4) quaternions w, x, y, z of each bone from rest, in its parent's frame
    iterations: int
    residual: float  # distance of the tip from the clamped target / chain length


@dataclass(frozen=True, eq=False)
class ChainRuns:
    """Results of many solves of one chain, each from its rest posture."""

    iterations: Floats  # (m,)
    residuals: Floats  # (m,) distances of the tip from the clamped target / chain length
    nanoseconds: Floats  # (m,) [ns] duration of a solve with points and rotations; shortest of three repeats


def make_curved_chain(bones: int, *, bend: float = np.pi / 18.0) -> Floats:
    """Return a chain of length one that bends evenly.

    From this start no method gets stuck.

    Args:
        bones: number of bones of equal length.
        bend: angle between bones [rad].

    Returns:
        Points (bones + 1, 3) from the origin, in the x-z plane.
    """
    angles = bend * np.arange(bones)
    along = np.stack([np.cos(angles), np.zeros(bones), -np.sin(angles)], axis=1) / bones
    return sealed(np.vstack([np.zeros(3), np.cumsum(along, axis=0)]))


def solve_chain(
    method: Method,
    rest: Floats,
    target: Floats,
    *,
    tolerance: float = RESIDUAL_TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> ChainSolution:
    """Move the tip of a ball chain to a target.

    Iterative methods cannot move a straight chain whose target lies on its own line, so the rest posture should be
    bent.

    Args:
        method: one of `IK_METHODS`.
        rest: (n + 1, 3) [m] points of the start posture; n is 1 to 32.
        target: (3,) [m]; clamped to the chain's reach.
        tolerance: sufficient residual / chain length.
        max_iterations: largest number of iterations.

    Raises:
        ValueError: the method is unknown, a shape is wrong, a number is not finite, or a bone has no length.
    """
    _check(tolerance, max_iterations)
    if np.shape(target) != (3,):
        raise ValueError(f"target has shape {np.shape(target)}; it needs three numbers (run_chain takes many targets)")
    chain, goal = _points("rest", rest), _points("target", np.reshape(target, (1, 3)))[0]
    points, rotations = np.empty(chain.shape), np.empty((max(len(chain) - 1, 0), 4))
    iterations, residual = kernel.solve_chain(method, chain, goal, points, rotations, tolerance, max_iterations)
    return ChainSolution(sealed(points), sealed(rotations), iterations, residual)


def run_chain(
    method: Method,
    rest: Floats,
    targets: Floats,
    *,
    tolerance: float = RESIDUAL_TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> ChainRuns:
    """Solve for many targets and time each solve inside the compiled kernel.

    Args:
        method: one of `IK_METHODS`.
        rest: (n + 1, 3) [m] points of the start posture of every solve.
        targets: (m, 3) [m].
        tolerance: sufficient residual / chain length.
        max_iterations: largest number of iterations.

    Raises:
        ValueError: as in `solve_chain`.
    """
    _check(tolerance, max_iterations)
    chain, goals = _points("rest", rest), _points("targets", targets)
    iterations = np.empty(len(goals), dtype=np.int64)
    residuals, nanoseconds = np.empty(len(goals)), np.empty(len(goals))
    kernel.run_chain(method, chain, goals, tolerance, max_iterations, iterations, residuals, nanoseconds)
    return ChainRuns(sealed(iterations), sealed(residuals), sealed(nanoseconds))


def _check(tolerance: float, max_iterations: int) -> None:
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance is {tolerance}; it is relative to the chain's length and must be between 0 and 1")
    if not 0 <= max_iterations <= ITERATION_LIMIT:
        raise ValueError(f"max_iterations is {max_iterations}; it must be 0 to {ITERATION_LIMIT}")


def _points(name: str, values: Floats) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has shape {np.shape(values)}; it needs three numbers per point")
    wrong = np.flatnonzero(~(np.abs(array) < MAX_COORDINATE).all(axis=1))
    if wrong.size:
        row = int(wrong[0])
        raise ValueError(
            f"point {row} of {name} is {array[row].tolist()}; every number must be finite, and below {MAX_COORDINATE:g}"
        )
    return array
