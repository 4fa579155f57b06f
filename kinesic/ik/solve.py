"""Arm inverse kinematics for a hand target (thesis 7.3).

For an unreachable target, the arm points at it and the result has a residual.
"""

import numpy as np
from msgspec import Struct

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import arm_of

REACHED_DISTANCE = 1e-3  # [m] largest distance at which a target counts as reached


class Solution(Struct, frozen=True, eq=False):
    """Arm posture for a hand target, with its remaining errors."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the requested position
    pointing_error: float | None  # [rad]; None without a requested pointing
    palm_error: float | None  # [rad]; None without a requested palm
    reached: bool  # residual within 1 mm
    iterations: int  # of all solver stages, in all attempts
    target: Floats  # (3,) [m] after clamping to the reach, in the base
    pulled_in: float  # [rad] largest distance of a start angle outside its range


def solve(
    chain: Chain,
    reach: Reach,
    *,
    start: Floats,
    rest: Floats | None = None,
    mobility: Floats | None = None,
) -> Solution:
    """Solve the joint angles of an arm for a hand target.

    Args:
        chain: the arm.
        reach: of its hand, in the frame of the chain's base.
        start: (k,) [rad] posture to stay close to; clipped to the ranges.
        rest: (k,) [rad] preferred angles for redundant hinges; the chain's rest by default.
        mobility: (k,) relative mobility of each hinge if closed forms do not suffice; the girdle 0.1, others 1.

    Returns:
        Angles inside the ranges, and the remaining errors of these angles.

    Raises:
        ValueError: a shape is wrong or a number is not finite; or the chain is no arm.
    """
    answer = arm_of(chain).solve(reach.position, reach.pointing, reach.palm, reach.swivel, start, rest, mobility)
    if answer is None:  # the kernel rejects other types and invalid values
        return _solve_checked(chain, _checked(reach), start, rest, mobility)
    return Solution(*answer)


def solve_path(chain: Chain, targets: Floats, swivels: Floats, *, start: Floats, settling: int) -> Floats:
    """Solve successive hand targets, each from the solution of the previous one.

    Args:
        chain: the arm.
        targets: (m, 3) [m] of the hand, in the frame of the chain's base.
        swivels: (m,) [rad] of the elbow.
        start: (k,) [rad] posture before the first target; clipped to the ranges.
        settling: number of additional solutions of the first target, which settle redundant hinges.

    Returns:
        Angles (m, k) [rad] inside the ranges.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    angles = np.empty((len(targets), len(chain.rest)))
    targets, swivels, start = (np.ascontiguousarray(values, dtype=np.float64) for values in (targets, swivels, start))
    arm_of(chain).solve_path(targets, swivels, start, settling, angles)
    return angles


def _solve_checked(chain: Chain, reach: Reach, start: Floats, rest: Floats | None, mobility: Floats | None) -> Solution:
    shape = (len(chain.rest),)
    start = as_floats("start", start, shape)
    rest = None if rest is None else as_floats("rest", rest, shape)
    mobility = None if mobility is None else as_floats("mobility", mobility, shape)
    answer = arm_of(chain).solve(reach.position, reach.pointing, reach.palm, reach.swivel, start, rest, mobility)
    if answer is None:
        raise ValueError(f"reach {reach} cannot be solved: a direction is the null vector")
    return Solution(*answer)


def _checked(reach: Reach) -> Reach:
    position = as_floats("reach.position", reach.position, (3,))
    pointing, palm = (
        None if direction is None else _direction(name, direction)
        for name, direction in (("reach.pointing", reach.pointing), ("reach.palm", reach.palm))
    )
    swivel = None if reach.swivel is None else float(as_floats("reach.swivel", np.array([reach.swivel]), (1,))[0])
    return Reach(position, pointing, palm, swivel)


def _direction(name: str, values: Floats) -> Floats:
    direction = as_floats(name, values, (3,))
    if not np.linalg.norm(direction) > 0.0:
        raise ValueError(f"{name} is the null vector; give a direction such as [1, 0, 0], or None")
    return direction


def as_floats(name: str, values: Floats, shape: tuple[int, ...]) -> Floats:
    """Convert values to a finite float64 array of given shape, or raise.

    Returns:
        The values as contiguous float64.

    Raises:
        ValueError: the shape is wrong or a number is not finite.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}; it needs shape {shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}; every number must be finite")
    return np.ascontiguousarray(array)


def as_triple(name: str, values: Floats) -> Floats:
    """Convert values to an array of three finite numbers, or raise.

    Returns:
        (3,) float64.

    Raises:
        ValueError: it is not three finite numbers.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}; it needs three finite numbers")
    return array
