"""Levenberg-Marquardt method with an active set, for one hand.

A hinge that meets its stop stays there and the others take over what it cannot give: the thesis' rule of pushing
the excess to the parent (algorithm 3), for all hinges at once and to second order.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from kinesic.ik.arm.linkage import Linkage
from kinesic.ik.scalar3 import Vector, cross, dot, minus, norm, scaled

MAX_ITERATIONS = 24  # largest number of iterations
TOLERANCE = 1e-7  # [arm lengths] largest remaining distance
ERROR_DAMPING = 0.3  # lambda^2 = ERROR_DAMPING e^2 + MIN_DAMPING size^2 (after Sugihara)
MIN_DAMPING = 1e-7  # damping at zero error
POSTURE_GAIN = 0.4  # fraction of the distance to the preferred posture per iteration
POSTURE_DECAY = 0.7  # factor on `POSTURE_GAIN` per iteration, from the first on
STALL_RATIO = 0.98  # error ratio of successive iterations above which progress has stalled
MAX_STALLED_STEPS = 6  # successive stalled iterations that end the solver
DAMPING_GROWTH = 8.0  # factor on the damping after a rejected step, divisor after an accepted one


@dataclass(frozen=True)
class Polished:
    """Angles within the ranges, with the remaining error."""

    angles: tuple[float, ...]  # [rad] angles of all hinges except those of the hand
    miss: float  # [m] remaining distance of the hand from the target
    rounds: int


@dataclass(frozen=True)
class HandSlope:
    """Linear model of the hand position as a function of the hinge angles."""

    moves: Sequence[Vector]  # [m] hand displacement per radian of each hinge
    pulls: Sequence[float]  # [rad] change of each hinge towards the preferred posture
    mobility: Sequence[float]  # 1 for an ordinary hinge, 0 for one that is fixed
    damping: float  # [m^2] damping of the least-squares step


def polish(
    linkage: Linkage,
    target: Vector,
    angles: Sequence[float],
    *,
    posture: Sequence[float],
    mobility: Sequence[float],
    rounds: int = MAX_ITERATIONS,
) -> Polished:
    """Move the hand to a target by damped least squares.

    Args:
        linkage: the arm.
        target: [m] of the wrist's centre, in the base.
        angles: [rad] to begin with, inside the ranges.
        posture: [rad] to which springs pull what the hand does not need.
        mobility: how readily each hinge moves; 1 for an ordinary one, 0 for one that is fixed.
        rounds: at most.

    Returns:
        The best angles met.
    """
    size = linkage.farthest
    now = list(angles[: linkage.links[-1].first])
    hand, moves = columns(linkage, now)
    error = minus(target, hand)
    caution, fading, stalled, done = 1.0, 1.0, 0, 0
    while norm(error) > TOLERANCE * size and stalled < MAX_STALLED_STEPS and done < rounds:
        done += 1
        fading *= POSTURE_DECAY
        damping = caution * (ERROR_DAMPING * dot(error, error) + MIN_DAMPING * size * size)
        share = POSTURE_GAIN * fading / caution
        pulls = [share * (home - angle) for home, angle in zip(posture, now, strict=False)]
        tried = polish_step(linkage, now, error, HandSlope(moves, pulls, mobility, damping))
        hand, tried_moves = columns(linkage, tried)
        tried_error = minus(target, hand)
        gain = norm(tried_error) / norm(error)
        stalled = stalled + 1 if gain > STALL_RATIO else 0
        caution = DAMPING_GROWTH * caution if gain >= 1.0 else max(1.0, caution / DAMPING_GROWTH)
        if gain < 1.0:
            now, error, moves = tried, tried_error, tried_moves
    return Polished(tuple(now), norm(error), done)


def columns(linkage: Linkage, angles: Sequence[float]) -> tuple[Vector, list[Vector]]:
    """Return the hand position [m] and the columns of its Jacobian."""
    hand, lines = linkage.hinge_lines(angles)
    return hand, [cross(axis, minus(hand, pole)) for axis, pole in lines]


def polish_step(linkage: Linkage, angles: Sequence[float], error: Vector, slope: HandSlope) -> list[float]:
    """Return the angles after one damped step within the ranges.

    Args:
        linkage: the arm.
        angles: [rad] of the hinges before the hand's own, inside the ranges.
        error: [m] from the hand to its target.
        slope: at these angles.
    """
    moved, pivots = list(angles), linkage.pivots
    moves, pulls, mobility = slope.moves, slope.pulls, slope.mobility
    free = [k for k in range(len(moved)) if mobility[k] > 0.0]
    while free:
        left = error
        for k in free:
            left = minus(left, scaled(moves[k], pulls[k]))
        push = _solved([moves[k] for k in free], [mobility[k] for k in free], slope.damping, left)
        wanted = {k: angles[k] + pulls[k] + mobility[k] * dot(moves[k], push) for k in free}
        stopped = [k for k in free if not pivots[k].lower <= wanted[k] <= pivots[k].upper]
        for k in stopped or list(free):
            moved[k] = min(max(wanted[k], pivots[k].lower), pivots[k].upper)
            error = minus(error, scaled(moves[k], moved[k] - angles[k]))
            free.remove(k)
    return moved


def _solved(columns: Sequence[Vector], mobility: Sequence[float], damping: float, error: Vector) -> Vector:
    """Solve the 3 x 3 damped normal equations by Cramer's rule."""
    xx = yy = zz = damping
    xy = xz = yz = 0.0
    for (x, y, z), w in zip(columns, mobility, strict=True):
        xx, yy, zz = xx + w * x * x, yy + w * y * y, zz + w * z * z
        xy, xz, yz = xy + w * x * y, xz + w * x * z, yz + w * y * z
    first, second, third = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
    a, b, c = cross(second, third), cross(third, first), cross(first, second)
    volume = dot(first, a)
    return (
        (a[0] * error[0] + b[0] * error[1] + c[0] * error[2]) / volume,
        (a[1] * error[0] + b[1] * error[1] + c[1] * error[2]) / volume,
        (a[2] * error[0] + b[2] * error[1] + c[2] * error[2]) / volume,
    )
