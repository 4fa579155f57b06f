"""Aims a direction with one hinge, or with two, in closed form: the subproblems of Paden and Kahan."""

from math import pi, sqrt

from kinesic.ik.angles import arccosine, arctangent
from kinesic.ik.scalar3 import Vector, cross, dot

UNDEFINED = 1e-9  # of a bone's length: nearer than this to the axis, a direction defines no angle


def turn_towards(axis: Vector, rest: Vector, wanted: Vector) -> float | None:
    """Subproblem 1: the turn about an axis that brings one direction nearest to another.

    Args:
        axis: unit, of the hinge.
        rest: unit, the direction at angle zero.
        wanted: unit.

    Returns:
        th = atan2(a.(r x v), r.v - (a.r)(a.v)) [rad], or None where either direction lies along the axis.
    """
    s = dot(axis, cross(rest, wanted))
    c = dot(rest, wanted) - dot(axis, rest) * dot(axis, wanted)
    return None if sqrt(s * s + c * c) < UNDEFINED else arctangent(s, c)


def first_of_two(first: Vector, second: Vector, rest: Vector, wanted: Vector) -> tuple[float, ...]:
    """Subproblem 2, its first hinge: about(first, q1) about(second, q2) rest = wanted.

    The second hinge keeps the part of `rest` along its own axis, so q1 solves A cos q1 + B sin q1 = C
    (subproblem 4); q2 follows by subproblem 1. The axes need not be perpendicular.

    Returns:
        The two branches of q1 [rad]; one where no angle aims exactly (the nearest); none where every angle is as
        good (the wanted direction lies along the first axis: gimbal lock).
    """
    along = dot(first, wanted)
    a = dot(second, wanted) - dot(second, first) * along
    b = -dot(second, cross(first, wanted))
    c = dot(second, rest) - dot(second, first) * along
    rho = sqrt(a * a + b * b)
    if rho < UNDEFINED:
        return ()
    middle = arctangent(b, a)
    if abs(c) >= rho:
        return (middle if c > 0.0 else middle + pi,)
    spread = arccosine(c / rho)
    return middle + spread, middle - spread
