"""Newton's method for the least distance to an unreachable target.

Levenberg-Marquardt crawls where the error does not vanish: it leaves out how the Jacobian itself turns. For hinges
that part is one more product, d2p / dqi dqj = ai x (aj x (p - cj)) for i before j, so the last steps are Newton's.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.ik.arm.linkage import Linkage
from kinesic.ik.scalar3 import Vector, cross, dot, minus, norm

from .polish import Polished

MAX_ITERATIONS = 30  # largest number of iterations
MIN_GAIN = 1e-9  # relative decrease of the squared distance below which the search ends
MIN_DAMPING = 1e-6  # [arm lengths^2] smallest damping added to the Hessian
MAX_DAMPING = 1e6  # [arm lengths^2] damping above which the search ends
MIN_IMPROVEMENT = 2.5e-3  # [arm lengths] smallest gain for which the elbow may change its side
DAMPING_GROWTH = 8.0  # factor on the damping after a rejected step, divisor after an accepted one


@dataclass(frozen=True, eq=False)
class _Shape:
    """Second-order model of half the squared distance to the target."""

    distance: float  # [m] distance to the target
    slope: Floats  # (n,) [m^2/rad] gradient
    curvature: Floats  # (n, n) [m^2/rad^2] Hessian


def finish(linkage: Linkage, target: Vector, beginnings: Sequence[Sequence[float]]) -> Polished:
    """Minimise the distance to a target from the nearest start posture.

    Args:
        linkage: the arm.
        target: [m] of the wrist's centre, in the base: where it was asked for, not where it was clamped to.
        beginnings: postures [rad] inside the ranges, of all hinges or of those before the hand's own; the first is
            the one to keep if the others do not lead nearer.

    Returns:
        Angles inside the ranges that bring the hand nearer by a millimetre or more; else those of the first posture.
    """
    pivots = linkage.pivots[: linkage.links[-1].first]
    lower, upper = sealed([pivot.lower for pivot in pivots]), sealed([pivot.upper for pivot in pivots])
    postures = [np.array(angles[: len(pivots)]) for angles in beginnings]
    shapes = [_shape(linkage, target, posture) for posture in postures]
    nearest = min(range(len(shapes)), key=lambda k: shapes[k].distance)
    now, here = postures[nearest], shapes[nearest]
    damping, rounds = MIN_DAMPING, 0
    while rounds < MAX_ITERATIONS and damping < MAX_DAMPING:
        rounds += 1
        free = ((now > lower) | (here.slope < 0.0)) & ((now < upper) | (here.slope > 0.0))
        step = _newton(here.slope[free], here.curvature[np.ix_(free, free)], damping * linkage.farthest**2)
        tried = now.copy()
        tried[free] = np.clip(now[free] + step, lower[free], upper[free])
        there = _shape(linkage, target, tried)
        won = here.distance**2 - there.distance**2
        if won <= 0.0 and np.any(tried != now):
            damping *= DAMPING_GROWTH
            continue
        now, here, damping = tried, there, max(MIN_DAMPING, damping / DAMPING_GROWTH)
        if won <= MIN_GAIN * here.distance**2:
            break
    if shapes[0].distance - here.distance < MIN_IMPROVEMENT * linkage.farthest:
        now, here = postures[0], shapes[0]
    return Polished(tuple(now.tolist()), here.distance, rounds)


def _newton(slope: Floats, curvature: Floats, damping: float) -> Floats:
    """Return a damped Newton step with positive curvature."""
    lowest = float(np.linalg.eigvalsh(curvature)[0]) if len(slope) else 0.0
    raised = curvature + (damping + max(0.0, -2.0 * lowest)) * np.eye(len(slope))
    return np.asarray(np.linalg.solve(raised, -slope), dtype=np.float64)


def _shape(linkage: Linkage, target: Vector, angles: Floats) -> _Shape:
    """Return distance model with gradient and Hessian at a posture."""
    hand, lines = linkage.hinge_lines(angles.tolist())
    error = minus(target, hand)
    columns = [cross(axis, minus(hand, pole)) for axis, pole in lines]
    curvature = np.empty((len(lines), len(lines)))
    for j, column in enumerate(columns):
        for i in range(j + 1):
            turning = cross(lines[i][0], column)
            curvature[i, j] = curvature[j, i] = dot(columns[i], column) - dot(error, turning)
    return _Shape(norm(error), np.array([-dot(error, column) for column in columns]), curvature)
