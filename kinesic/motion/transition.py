"""Leads hinges from one motion into another, both on one grid, without a step and within all limits."""

from collections.abc import Iterable
from dataclasses import replace
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.segments import NOWHERE, SplineSegment
from kinesic.motion.spline_program import nearest_motion
from kinesic.motion.trajectory import EARLY, STEP, spline_weights

FEWEST_PIECES = 3  # pieces in which three control points give way to three others
LIMIT_ROOM = 1.0008  # on limits: where a motion is at one, there may be just one way on, and none is found
SAME_ANGLE = 1e-9  # [rad]
MARGINS = (15, 40, 10000)  # knots about what exceeds the limits, in which a motion may differ


def knot_at(time: float) -> int:
    """Finds the first knot not before a performance time [s], beyond the end of a motion as well."""
    return max(0, ceil(time / STEP - EARLY))


def roomy(limits: Limits) -> Limits:
    """Widens limits a little, within what the certificate allows."""
    return replace(
        limits,
        speed=sealed(LIMIT_ROOM * limits.speed),
        acceleration=sealed(LIMIT_ROOM * limits.acceleration),
        jerk=sealed(LIMIT_ROOM * limits.jerk),
        duty=sealed(LIMIT_ROOM * limits.duty),
    )


def cross_over(
    own: Floats, after: Floats, knots: tuple[int, int], limits: Limits, hinge: int, *, passing: Floats = NOWHERE
) -> Floats | None:
    """Leads a hinge out of one motion at a knot, and into another from a later knot on.

    What lies between the two at the beginning fades as calmly as can be.

    Args:
        own: (k + 3,) [rad] of the motion that is left.
        after: (k + 3,) [rad] of the other.
        knots: where it leaves the one, and from where on it is as the other.
        limits: of all hinges.
        hinge: whose motions they are.
        passing: (m,) places in between, in steps, where it is as the other already.

    Returns:
        (k + 3,) [rad] control points; None when the hinge cannot do so in this time.
    """
    leave, land = knots
    begin, end = own[leave : leave + 3], after[land : land + 3]
    if np.abs(begin - after[leave : leave + 3]).max() <= SAME_ANGLE:
        return np.concatenate([own[:leave], after[leave:]])
    pieces = land - leave
    if pieces < FEWEST_PIECES:
        return None
    way = SplineSegment.between(hinge, pieces, begin, end, places=passing - leave, angles=_angles(after, passing))
    desired = way.grid.at_knots @ after[leave : land + 3] + _fading(begin - after[leave : leave + 3], pieces)
    found = nearest_motion(way, desired, limits)
    return None if found is None else np.concatenate([own[: leave + 3], found[3:-3], after[land:]])


def join_columns(ways: Iterable[Floats | None]) -> Floats | None:
    """Joins the ways of several hinges as columns; None as soon as one has none, or where there are no hinges."""
    found: list[Floats] = []
    for way in ways:
        if way is None:
            return None
        found.append(way)
    return np.stack(found, axis=1) if found else None


def keep_limits(controls: Floats, first: int, last: int, limits: Limits, hinge: int) -> Floats | None:
    """Moves control points into the limits, as little as needed and only near where they exceed them.

    Args:
        controls: (k + 3,) [rad].
        first: knot from which they may differ.
        last: knot until which they may differ.
        limits: of all hinges.
        hinge: whose motion it is.

    Returns:
        None when the hinge cannot come from what is before to what is after.
    """
    begin, end = _beyond(controls, first, last, limits, hinge)
    if begin > end:
        return controls
    for margin in MARGINS:
        low, high = max(first, begin - margin), min(last, end + margin)
        found = _between(controls, low, high, limits, hinge)
        if found is not None or (low, high) == (first, last):
            return found
    return None


def _beyond(controls: Floats, first: int, last: int, limits: Limits, hinge: int) -> tuple[int, int]:
    shares = grid(last - first, STEP).shares(controls[first : last + FEWEST_PIECES], limits, hinge)
    places = np.concatenate([np.flatnonzero(np.abs(share) > 1.0) for share in shares])
    return first + int(places.min(initial=last - first)), first + int(places.max(initial=0))


def _between(controls: Floats, first: int, last: int, limits: Limits, hinge: int) -> Floats | None:
    """Control points within the limits, the same as given before a knot and after another."""
    part = controls[first : last + FEWEST_PIECES]
    way = SplineSegment.between(hinge, last - first, part[:FEWEST_PIECES], part[-FEWEST_PIECES:])
    found = nearest_motion(way, way.grid.at_knots @ part, limits)
    return (
        None
        if found is None
        else np.concatenate([controls[: first + FEWEST_PIECES], found[FEWEST_PIECES:-FEWEST_PIECES], controls[last:]])
    )


def largest_shares(controls: Floats, limits: Limits) -> Floats:
    """Computes (n,) the largest share of any limit that splines (k + 3, n) [rad] take."""
    whole = grid(len(controls) - 3, STEP)
    columns = enumerate(controls.T)
    return np.array([whole.largest(np.ascontiguousarray(column), limits, hinge) for hinge, column in columns])


def delay_controls(controls: Floats, offset: int) -> Floats:
    """Delays control points (k + 3, n) by so many knots; a negative number makes them earlier."""
    if offset < 0:
        return controls[min(-offset, len(controls) - 3) :]
    return np.vstack([np.repeat(controls[:1], offset, axis=0), controls])


def lengthen(controls: Floats, count: int) -> Floats:
    """Lengthens control points (m, n) to at least so many: they stay as they end."""
    more = count - len(controls)
    return controls if more <= 0 else np.vstack([controls, np.repeat(controls[-1:], more, axis=0)])


def shorten(controls: Floats) -> Floats:
    """Cuts control points (m, n) off where they only stay as they end."""
    moving = np.flatnonzero((np.abs(controls - controls[-1]) > SAME_ANGLE).any(axis=1))
    return controls[: max(int(moving[-1]) + 1 if len(moving) else 0, 1) + FEWEST_PIECES]


def _angles(column: Floats, places: Floats) -> Floats:
    """(m,) [rad] of a motion (k + 3,) at places in steps."""
    first, shares = spline_weights(places, len(column) - 3)
    return np.asarray((shares * column[first[:, None] + np.arange(4)]).sum(axis=1))


def _fading(away: Floats, pieces: int) -> Floats:
    """(pieces + 1,) [rad] quintic from the angle, speed and acceleration of three control points to rest at 0."""
    angle = (away[0] + 4 * away[1] + away[2]) / 6
    speed, acceleration = (away[2] - away[0]) / 2 * pieces, (away[0] - 2 * away[1] + away[2]) * pieces**2
    u = np.linspace(0.0, 1.0, pieces + 1)
    v = (1.0 - u) ** 3
    return np.asarray(
        angle * v * (1 + 3 * u + 6 * u**2) + speed * v * (u + 3 * u**2) + acceleration * v * u**2 / 2,
    )
