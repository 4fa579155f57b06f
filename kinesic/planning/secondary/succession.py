"""Follow-through: wrists lag behind shoulders, one hand behind the other.

A delayed hinge is where the motion had it before. The delay changes during rests, unnoticed, or along a path, so that
at the stroke every hinge of a hand is in place. Of two hands that need not meet, one may do everything later. A delay
of a whole number of knots shifts the motion exactly, which keeps the distance to all limits.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.piecewise import PiecewisePolynomial
from kinesic.motion.recursion import sum_decaying
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.arm_times import ArmCourse, ArmStroke, Gap
from kinesic.planning.secondary.offset_bumps import CONTROL_LEAD

SHOULDER_LEAD_FRACTION = 0.5  # shoulder lead / delay from shoulder to wrist; the wrist lags by the rest
MAX_CATCH_UP = 0.15  # largest delay that a joint reduces to zero during a motion / duration of the motion
MAX_DELAY_RATE = 0.35  # largest delay that a joint builds up during a rest / duration of the rest
MAX_TRAILING_KNOTS = 30  # knots by which delays may prolong the motion
MIN_VISIBLE_OFFSET = 1e-3  # [rad] angle offset below which a joint's delay is not applied
OFFSET_TOLERANCE = 1e-9  # [rad] smaller angle offsets count as zero
SPLINE_POLE = 3.0**0.5 - 2.0  # factor by which slopes of a cubic spline decay per point, the root of z + 1 / z = -4
NOT_A_KNOT = sealed([2.5, 0.5])  # weights of the first two steps in the sum of the first slope and twice the second

NO_DELAY = (0.0, 1.0, 0.0, 0.0)  # [s] start, any duration, delay and change of delay of an interval without delay

Lateness = Sequence[tuple[float, float]]  # (time [s], delay [s]) pairs, smoothly interpolated


@dataclass(frozen=True, eq=False)
class Delay:
    """Delay of some hinges, expressed as angle offsets over time."""

    begin: float
    end: float
    hinges: tuple[int, ...]
    away: Floats  # (r, h) [rad] offset of each hinge at successive knots

    def added(self, times: Floats) -> Floats:
        """Return the angle offsets (m, h) [rad] at successive knots."""
        first = round((self.begin - float(times[0])) / KNOT_INTERVAL)
        offsets, values = np.zeros((len(times), len(self.hinges))), self.away[max(0, -first) :]
        end = max(0, first) + len(values)
        offsets[max(0, first) : end] = values[: max(0, len(times) - max(0, first))]
        return offsets


def delay_hinges(courses: Iterable[ArmCourse], motion: Trajectory, robot: Robot) -> Iterator[Delay]:
    """Yield the follow-through delays of a block's gestures.

    Args:
        courses: of arms through the block.
        motion: through its keys.
        robot: with the arms.
    """
    requested = [shift for course in courses for shift in _shifts(course, motion.start, robot)]
    if requested:
        joints = tuple(sorted({joint for shift in requested for joint in shift.joints}))
        yield from _Curves(motion, joints).later(requested)


@dataclass(frozen=True, eq=False)
class _Shift:
    """Requested time delay of some joints relative to the gesture."""

    joints: Sequence[int]
    lateness: Lateness
    together: bool = False


def _shifts(course: ArmCourse, start: float, robot: Robot) -> Iterator[_Shift]:
    """Yield the requested follow-through delays of one arm.

    Args:
        course: of the arm.
        start: [s] of the motion.
        robot: with the arm.
    """
    arm = robot.arm(course.side)
    hand, forearm = (robot.skeleton.joints_of((name,)) for name in arm.segments[:-3:-1])
    upper = [joint for joint in arm.joints if joint not in (*forearm, *hand)]
    for stroke, (before, after) in zip(course.strokes, pairwise(course.gaps), strict=True):
        shifts = [_Shift(arm.all_joints, _delay_hand(stroke, before, after), together=True)] if stroke.behind else []
        for joints, delay in (
            (upper, -SHOULDER_LEAD_FRACTION * stroke.loose),
            ((*hand, *arm.fingers), (1.0 - SHOULDER_LEAD_FRACTION) * stroke.loose),
        ):
            shifts += [
                _Shift(joints, _delay_on_approach(delay, before, start)),
                _Shift(joints, _delay_on_return(delay, after)),
            ]
        yield from (shift for shift in shifts if shift.joints and shift.lateness)


def _delay_hand(stroke: ArmStroke, before: Gap, after: Gap) -> Lateness:
    """Return one hand's delay relative to the other hand over time.

    It is empty if the arm could not catch up.
    """
    rest_needed = stroke.behind / MAX_DELAY_RATE
    come = next(((a, b) for a, b in reversed(before.rests) if b - a >= rest_needed), None)
    gone = next(((a, b) for a, b in reversed(after.rests) if b - a >= rest_needed), None)
    if (come is None and before.end - before.begin < stroke.behind / MAX_CATCH_UP) or (
        gone is None and after.end - after.begin < stroke.behind / MAX_CATCH_UP
    ):
        return ()
    begin, leave = (come[1] - rest_needed, come[1]) if come else (before.begin, before.end)
    back, end = (gone[0], gone[0] + rest_needed) if gone else (after.begin, after.end)
    return (begin, 0.0), (leave, stroke.behind), (back, stroke.behind), (end, 0.0)


def _delay_on_approach(delay: float, gap: Gap, start: float) -> Lateness:
    """Return a joint's delay over time during the approach to a stroke.

    It is zero at the stroke.
    """
    if not gap.rests:
        return ()
    one, leave = gap.rests[-1]
    available = leave - (max(one, start) if delay < 0.0 else one)
    delay = np.sign(delay) * min(abs(delay), MAX_DELAY_RATE * available, MAX_CATCH_UP * (gap.end - leave))
    return ((max(one, leave - abs(delay) / MAX_DELAY_RATE), 0.0), (leave, delay), (gap.end, 0.0)) if delay else ()


def _delay_on_return(delay: float, gap: Gap) -> Lateness:
    """Return a joint's delay over time during the return to rest.

    It is empty if the arm does not return to rest.
    """
    if gap.return_span is None:
        return ()
    leave, there = gap.return_span
    begin, until = (gap.rests[0][0] if len(gap.rests) > 1 else gap.begin), gap.rests[-1][1]
    leave = leave if leave > begin else there
    delay = np.sign(delay) * min(abs(delay), MAX_DELAY_RATE * (leave - begin), MAX_DELAY_RATE * (until - there))
    return (
        ((begin, 0.0), (leave, delay), (there, delay), (min(until, there + abs(delay) / MAX_DELAY_RATE), 0.0))
        if delay
        else ()
    )


@dataclass(frozen=True, eq=False)
class _Curves:
    """Joint angles of a motion as cubic splines, for delayed sampling."""

    motion: Trajectory
    joints: tuple[int, ...]

    def later(self, shifts: Sequence[_Shift]) -> Iterator[Delay]:
        """Yield joint delays as angle offsets, omitting invisible ones."""
        start, last = self.motion.start, len(self.motion.controls) - 1
        spans = [
            [
                int(min(max((shift.lateness[k][0] - start) / KNOT_INTERVAL, 0.0), last + MAX_TRAILING_KNOTS))
                for k in (0, -1)
            ]
            for shift in shifts
        ]
        rows = np.concatenate([np.arange(first, end + CONTROL_LEAD + 2) for first, end in spans])
        times = np.asarray(start + (rows - CONTROL_LEAD) * KNOT_INTERVAL, dtype=np.float64)
        edges = np.cumsum([0, *(end + CONTROL_LEAD + 2 - first for first, end in spans)]).tolist()
        delays = _evaluate_delays(
            [times[one:other] for one, other in pairwise(edges)], [shift.lateness for shift in shifts]
        )
        places = np.minimum(np.maximum(rows - delays / KNOT_INTERVAL, 0.0), last)
        values = self.motion.controls[:, list(self.joints)]
        away = _spline(values).at(places) - values.take(np.minimum(rows, last), axis=0)
        columns = {joint: k for k, joint in enumerate(self.joints)}
        blocks = [
            sealed(away[one:other].take([columns[joint] for joint in shift.joints], axis=1))
            for shift, (one, other) in zip(shifts, pairwise(edges), strict=True)
        ]
        times_of_rows: list[float] = times.tolist()
        for shift, hinge, first, end in _find_visible_ranges(shifts, blocks):
            which = slice(None) if shifts[shift].together else slice(hinge, hinge + 1)
            begin, until = times_of_rows[edges[shift] + first], times_of_rows[edges[shift] + end] + 2 * KNOT_INTERVAL
            yield Delay(begin, until, tuple(shifts[shift].joints[which]), blocks[shift][first : end + 1, which])


def _spline(points: Floats) -> PiecewisePolynomial:
    """Return the cubic spline through equidistant points (k, h).

    The third derivative is continuous at the second and the last but one point (not-a-knot). Two recursions give slopes
    of a continuous second derivative; slopes that decay from both ends are added, so that the ends fit, too.
    """
    steps = points[1:] - points[:-1]
    pulls = np.zeros_like(points)
    pulls[1:-1] = 3.0 * (steps[:-1] + steps[1:])
    slopes = -SPLINE_POLE * sum_decaying(sum_decaying(pulls, SPLINE_POLE)[::-1], SPLINE_POLE)[::-1]
    ends = [NOT_A_KNOT @ steps[:2] - (slopes[0] + 2.0 * slopes[1])]
    ends.append(NOT_A_KNOT @ steps[:-3:-1] - (slopes[-1] + 2.0 * slopes[-2]))
    decay = SPLINE_POLE ** np.arange(len(points))
    near, far = decay[:2] @ [1.0, 2.0], decay[:-3:-1] @ [1.0, 2.0]
    begin, end = np.linalg.solve([[near, far], [far, near]], ends)
    slopes += np.outer(decay, begin) + np.outer(decay[::-1], end)
    bend = slopes[:-1] + slopes[1:] - 2.0 * steps
    coefficients = np.stack([bend, steps - slopes[:-1] - bend, slopes[:-1], points[:-1]])
    return PiecewisePolynomial(np.arange(float(len(points))), coefficients)


def _find_visible_ranges(shifts: Sequence[_Shift], blocks: Sequence[Floats]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the sample ranges in which a delay visibly changes an angle.

    Each joint counts alone, or all joints of a shift together as its first.

    Args:
        shifts: of the joints.
        blocks: (r, h) [rad] offsets of the joints of each shift.
    """
    far = [np.abs(block).T for block in blocks]
    far = [
        values.max(axis=0, keepdims=True) if shift.together else values
        for shift, values in zip(shifts, far, strict=True)
    ]
    owners = [(k, hinge) for k, values in enumerate(far) for hinge in range(len(values))]
    starts = np.cumsum([0, *(values.shape[1] for values in far for _ in values)])
    flat = np.concatenate([values.ravel() for values in far])
    away, edge = flat > OFFSET_TOLERANCE, np.zeros(len(flat) + 1, dtype=np.bool_)
    edge[starts] = True
    firsts = np.flatnonzero(away & (edge[:-1] | ~np.append(False, away[:-1])))
    lasts = np.flatnonzero(away & (edge[1:] | ~np.append(away[1:], False)))
    if not firsts.size:
        return
    seen = np.maximum.reduceat(flat, firsts) > MIN_VISIBLE_OFFSET
    columns = np.searchsorted(starts, firsts[seen], side="right") - 1
    rows = np.stack([firsts[seen], lasts[seen]]) - starts[columns]
    for column, first, last in zip(columns.tolist(), *rows.tolist(), strict=True):
        yield *owners[column], first, last


def _evaluate_delays(times: Sequence[Floats], latenesses: Sequence[Lateness]) -> Floats:
    """Evaluate time-varying delays [s], each at its own times [s]."""
    parts: list[tuple[float, float, float, float]] = []  # start, duration, delay and its growth [s]
    counts: list[int] = []
    for values, lateness in zip(times, latenesses, strict=True):
        edges = np.searchsorted(values, [time for time, _ in lateness]).tolist()
        parts += [
            NO_DELAY,
            *((begin, end - begin, one, other - one) for (begin, one), (end, other) in pairwise(lateness)),
            NO_DELAY,
        ]
        counts += [other - one for one, other in pairwise((0, *edges, len(values)))]
    begin, durations, delays, growth = np.repeat(np.array(parts).T, counts, axis=1)
    return np.asarray(delays + minimum_jerk((np.concatenate(times) - begin) / durations) * growth)
