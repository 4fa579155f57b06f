"""Closed-form Paden-Kahan subproblems for one or two hinges."""

from math import pi, sqrt

from kinesic.ik.angles import arccosine, arctangent
from kinesic.ik.scalar3 import Vector, cross, dot

AXIS_TOLERANCE = 1e-9  # [bone lengths] distance to the hinge axis below which no angle is defined


def turn_towards(axis: Vector, rest: Vector, target: Vector) -> float | None:
    """Return the hinge angle [rad] aligning two directions, None if undefined.

    Args:
        axis: unit, of the hinge.
        rest: unit, the direction at angle zero.
        target: unit.

    Returns:
        th = atan2(a.(r x v), r.v - (a.r)(a.v)) [rad], or None where either direction lies along the axis.
    """
    s = dot(axis, cross(rest, target))
    c = dot(rest, target) - dot(axis, rest) * dot(axis, target)
    return None if sqrt(s * s + c * c) < AXIS_TOLERANCE else arctangent(s, c)


def first_of_two(first: Vector, second: Vector, rest: Vector, target: Vector) -> tuple[float, ...]:
    """Return candidate angles [rad] of the first of two direction-aligning hinges.

    It solves about(first, q1) about(second, q2) rest = target, subproblem 2. The second hinge keeps the part of `rest`
    along its own axis, so q1 solves A cos q1 + B sin q1 = C (subproblem 4); q2 follows by subproblem 1. The axes need
    not be perpendicular.

    Returns:
        The two branches of q1 [rad]; one where no angle aims exactly (the nearest); none where every angle is as
        good (the target direction lies along the first axis: gimbal lock).
    """
    along = dot(first, target)
    a = dot(second, target) - dot(second, first) * along
    b = -dot(second, cross(first, target))
    c = dot(second, rest) - dot(second, first) * along
    rho = sqrt(a * a + b * b)
    if rho < AXIS_TOLERANCE:
        return ()
    middle = arctangent(b, a)
    if abs(c) >= rho:
        return (middle if c > 0.0 else middle + pi,)
    spread = arccosine(c / rho)
    return middle + spread, middle - spread
