"""Smooth transitions from one motion to another, within all limits."""

from collections.abc import Iterable
from dataclasses import replace
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import at_knots, grid
from kinesic.motion.segments import NO_KNOT_POSITIONS, SplineSegment
from kinesic.motion.spline_program import nearest_motion
from kinesic.motion.trajectory import KNOT_INTERVAL, KNOT_TOLERANCE, spline_weights

MIN_TRANSITION = 3  # [knot intervals] shortest transition, so that its start and end share no control point
LIMIT_WIDENING = 1.0008  # factor on limits, because a motion at a limit may have only one continuation
SAME_ANGLE = 1e-9  # [rad] smaller angle differences count as zero
CORRECTION_MARGINS = (15, 40, 10000)  # [knots] ranges around a violation that may change, tried in turn


def knot_at(time: float) -> int:
    """Return the first knot at or after a performance time [s].

    It may lie beyond the end of the motion.
    """
    return max(0, ceil(time / KNOT_INTERVAL - KNOT_TOLERANCE))


def widen_limits(limits: Limits) -> Limits:
    """Widen limits slightly, within the tolerance of limit checks."""
    return replace(
        limits,
        speed=sealed(LIMIT_WIDENING * limits.speed),
        acceleration=sealed(LIMIT_WIDENING * limits.acceleration),
        jerk=sealed(LIMIT_WIDENING * limits.jerk),
        duty=sealed(LIMIT_WIDENING * limits.duty),
    )


def cross_over(
    current: Floats,
    following: Floats,
    knots: tuple[int, int],
    limits: Limits,
    hinge: int,
    *,
    passing: Floats = NO_KNOT_POSITIONS,
) -> Floats | None:
    """Return control points of a transition from one motion to another.

    Their initial difference fades as smoothly as possible.

    Args:
        current: (k + 3,) [rad] control points of the current motion.
        following: (k + 3,) [rad] control points of the following motion.
        knots: at which the transition begins and ends.
        limits: of all hinges.
        hinge: index of the hinge.
        passing: (m,) knot positions in between at which the following motion is already met.

    Returns:
        (k + 3,) [rad] control points; None if the hinge has too little time.
    """
    first, last = knots
    begin, end = current[first : first + 3], following[last : last + 3]
    if np.abs(begin - following[first : first + 3]).max() <= SAME_ANGLE:
        return np.concatenate([current[:first], following[first:]])
    pieces = last - first
    if pieces < MIN_TRANSITION:
        return None
    segment = SplineSegment.between(
        hinge, pieces, begin, end, places=passing - first, angles=_angles(following, passing)
    )
    desired = at_knots(following[first : last + 3]) + _fade(begin - following[first : first + 3], pieces)
    transition = nearest_motion(segment, desired, limits)
    return None if transition is None else np.concatenate([current[: first + 3], transition[3:-3], following[last:]])


def join_columns(columns: Iterable[Floats | None]) -> Floats | None:
    """Stack the control points of several hinges as columns, or None.

    None if one is missing, or without hinges.
    """
    present: list[Floats] = []
    for column in columns:
        if column is None:
            return None
        present.append(column)
    return np.stack(present, axis=1) if present else None


def keep_limits(controls: Floats, first: int, last: int, limits: Limits, hinge: int) -> Floats | None:
    """Correct control points where a motion exceeds its limits.

    Args:
        controls: (k + 3,) [rad].
        first: knot from which they may differ.
        last: knot until which they may differ.
        limits: of all hinges.
        hinge: index of the hinge.

    Returns:
        None if no motion within the limits joins the unchanged parts.
    """
    begin, end = _find_violations(controls, first, last, limits, hinge)
    if begin > end:
        return controls
    for margin in CORRECTION_MARGINS:
        low, high = max(first, begin - margin), min(last, end + margin)
        corrected = _correct_between(controls, low, high, limits, hinge)
        if corrected is not None or (low, high) == (first, last):
            return corrected
    return None


def _find_violations(controls: Floats, first: int, last: int, limits: Limits, hinge: int) -> tuple[int, int]:
    ratios = grid(last - first, KNOT_INTERVAL).limit_ratios(controls[first : last + MIN_TRANSITION], limits, hinge)
    places = np.concatenate([np.flatnonzero(np.abs(ratio) > 1.0) for ratio in ratios])
    return first + int(places.min(initial=last - first)), first + int(places.max(initial=0))


def _correct_between(controls: Floats, first: int, last: int, limits: Limits, hinge: int) -> Floats | None:
    """Correct a hinge's control points between two knots to keep its limits.

    None if no motion within the limits joins the rest.
    """
    part = controls[first : last + MIN_TRANSITION]
    segment = SplineSegment.between(hinge, last - first, part[:MIN_TRANSITION], part[-MIN_TRANSITION:])
    corrected = nearest_motion(segment, at_knots(part), limits)
    return (
        None
        if corrected is None
        else np.concatenate(
            [controls[: first + MIN_TRANSITION], corrected[MIN_TRANSITION:-MIN_TRANSITION], controls[last:]]
        )
    )


def largest_limit_ratios(controls: Floats, limits: Limits) -> Floats:
    """Return each hinge's largest ratio to any limit, (n,)."""
    whole = grid(len(controls) - 3, KNOT_INTERVAL)
    columns = enumerate(controls.T)
    return np.array(
        [whole.largest_limit_ratio(np.ascontiguousarray(column), limits, hinge) for hinge, column in columns]
    )


def delay_controls(controls: Floats, offset: int) -> Floats:
    """Delay control points by a number of knots, negative to advance them."""
    if offset < 0:
        return controls[min(-offset, len(controls) - 3) :]
    return np.vstack([np.repeat(controls[:1], offset, axis=0), controls])


def extend_controls(controls: Floats, count: int) -> Floats:
    """Extend control points (m, n) to a length, repeating the last row."""
    missing = count - len(controls)
    return controls if missing <= 0 else np.vstack([controls, np.repeat(controls[-1:], missing, axis=0)])


def trim_final_rest(controls: Floats) -> Floats:
    """Remove the final rest from control points (m, n)."""
    moving = np.flatnonzero((np.abs(controls - controls[-1]) > SAME_ANGLE).any(axis=1))
    return controls[: max(int(moving[-1]) + 1 if len(moving) else 0, 1) + MIN_TRANSITION]


def _angles(column: Floats, places: Floats) -> Floats:
    """Return a spline's angles (m,) [rad] at given knot positions."""
    first, weights = spline_weights(places, len(column) - 3)
    return np.asarray((weights * column[first[:, None] + np.arange(4)]).sum(axis=1))


def _fade(difference: Floats, pieces: int) -> Floats:
    """Return an angle offset that fades to zero as a quintic.

    Of shape (pieces + 1,) [rad], from the angle, velocity and acceleration of three control points.
    """
    angle = (difference[0] + 4 * difference[1] + difference[2]) / 6
    speed, acceleration = (
        (difference[2] - difference[0]) / 2 * pieces,
        (difference[0] - 2 * difference[1] + difference[2]) * pieces**2,
    )
    u = np.linspace(0.0, 1.0, pieces + 1)
    v = (1.0 - u) ** 3
    return np.asarray(
        angle * v * (1 + 3 * u + 6 * u**2) + speed * v * (u + 3 * u**2) + acceleration * v * u**2 / 2,
    )
