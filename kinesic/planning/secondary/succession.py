"""Succession in a motion: wrists come later than shoulders on the ways there and back, and one hand of two follows.

A hinge that is late is where the motion had it a moment before. How late it is changes while its arm stands still,
where nothing is seen of it, and else along a way, so that at the stroke every hinge of a hand is where it was; of two
hands that need not meet one does all of it a little later. A whole number of knots shifts a motion as it is: no limit
is nearer than before.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.secondary.arm_times import ArmCourse, ArmStroke, Gap
from kinesic.planning.secondary.swells import CONTROL_LEAD

LEAD = 0.5  # of what the wrist is later than the shoulder, that the shoulder is sooner than the elbow
CAUGHT_UP = 0.15  # of a way, that a hinge makes up for at most
REST = 0.35  # of the time that an arm stands still, in which it may become so much sooner or later
BEYOND = 30  # knots after its end, that a motion may go on where something is late
SEEN, SAME = 1e-3, 1e-9  # [rad] that is worth it, and that is nothing

ON_TIME = (0.0, 1.0, 0.0, 0.0)  # a part of `_late_at`

Lateness = Sequence[tuple[float, float]]  # times [s], and how late a hinge is at them [s]; smooth in between


@dataclass(frozen=True, eq=False)
class Delay:
    """A change that has some hinges come later than in the motion; times [s] are those of the motion."""

    begin: float
    end: float
    hinges: tuple[int, ...]
    away: Floats  # (r, h) [rad] from where the motion has them, at each knot from the first on

    def added(self, times: Floats) -> Floats:
        """(m, h) [rad] what it adds to the angles of its hinges at (m,) times [s], which are one knot apart."""
        first = round((self.begin - float(times[0])) / STEP)
        found, own = np.zeros((len(times), len(self.hinges))), self.away[max(0, -first) :]
        end = max(0, first) + len(own)
        found[max(0, first) : end] = own[: max(0, len(times) - max(0, first))]
        return found


def later_hinges(courses: Iterable[ArmCourse], motion: Trajectory, robot: Robot) -> Iterator[Delay]:
    """Finds what each arm does later than a motion has it, as the gestures of a block ask.

    Args:
        courses: of arms through the block.
        motion: through its keys.
        robot: whose arms they are.
    """
    wanted = [shift for course in courses for shift in _shifts(course, motion.start, robot)]
    if wanted:
        joints = tuple(sorted({joint for shift in wanted for joint in shift.joints}))
        yield from _Curves(motion, joints).later(wanted)


@dataclass(frozen=True, eq=False)
class _Shift:
    """The lateness that some joints are to have, judged for each joint alone or for all together."""

    joints: Sequence[int]
    lateness: Lateness
    together: bool = False


def _shifts(course: ArmCourse, start: float, robot: Robot) -> Iterator[_Shift]:
    """Yields the shifts of one arm in a motion that begins at a start [s]."""
    arm = robot.arm(course.side)
    hand, forearm = (robot.skeleton.joints_of((name,)) for name in arm.segments[:-3:-1])
    upper = [joint for joint in arm.joints if joint not in (*forearm, *hand)]
    for stroke, (before, after) in zip(course.strokes, pairwise(course.gaps), strict=True):
        every = [_Shift(arm.moving, _behind(stroke, before, after), together=True)] if stroke.behind else []
        for joints, late in ((upper, -LEAD * stroke.loose), ((*hand, *arm.fingers), (1.0 - LEAD) * stroke.loose)):
            every += [_Shift(joints, _coming(late, before, start)), _Shift(joints, _going(late, after))]
        yield from (shift for shift in every if shift.joints and shift.lateness)


def _behind(stroke: ArmStroke, before: Gap, after: Gap) -> Lateness:
    """Delays a stroke, with the ways there and back, against the other hand; empty where it could not catch up."""
    rest_needed = stroke.behind / REST
    come = next(((a, b) for a, b in reversed(before.rests) if b - a >= rest_needed), None)
    gone = next(((a, b) for a, b in reversed(after.rests) if b - a >= rest_needed), None)
    if (come is None and before.end - before.begin < stroke.behind / CAUGHT_UP) or (
        gone is None and after.end - after.begin < stroke.behind / CAUGHT_UP
    ):
        return ()
    begin, leave = (come[1] - rest_needed, come[1]) if come else (before.begin, before.end)
    back, end = (gone[0], gone[0] + rest_needed) if gone else (after.begin, after.end)
    return (begin, 0.0), (leave, stroke.behind), (back, stroke.behind), (end, 0.0)


def _coming(late: float, gap: Gap, start: float) -> Lateness:
    """Sooner or later on the way to a stroke, and there in time."""
    if not gap.rests:
        return ()
    one, leave = gap.rests[-1]
    room = leave - (max(one, start) if late < 0.0 else one)
    late = np.sign(late) * min(abs(late), REST * room, CAUGHT_UP * (gap.end - leave))
    return ((max(one, leave - abs(late) / REST), 0.0), (leave, late), (gap.end, 0.0)) if late else ()


def _going(late: float, gap: Gap) -> Lateness:
    """Sooner or later on the way back to rest."""
    if gap.way_home is None:
        return ()
    leave, there = gap.way_home
    begin, until = (gap.rests[0][0] if len(gap.rests) > 1 else gap.begin), gap.rests[-1][1]
    leave = leave if leave > begin else there
    late = np.sign(late) * min(abs(late), REST * (leave - begin), REST * (until - there))
    return ((begin, 0.0), (leave, late), (there, late), (min(until, there + abs(late) / REST), 0.0)) if late else ()


@dataclass(frozen=True, eq=False)
class _Curves:
    """Some joints of a motion, as smooth curves through its control points."""

    motion: Trajectory
    joints: tuple[int, ...]

    def later(self, shifts: Sequence[_Shift]) -> Iterator[Delay]:
        """Moves joints later, wherever they are not on time."""
        start, last = self.motion.start, len(self.motion.controls) - 1
        spans = [
            [int(min(max((shift.lateness[k][0] - start) / STEP, 0.0), last + BEYOND)) for k in (0, -1)]
            for shift in shifts
        ]
        rows = np.concatenate([np.arange(first, end + CONTROL_LEAD + 2) for first, end in spans])
        times = np.asarray(start + (rows - CONTROL_LEAD) * STEP, dtype=np.float64)
        edges = np.cumsum([0, *(end + CONTROL_LEAD + 2 - first for first, end in spans)]).tolist()
        late = _late_at([times[one:other] for one, other in pairwise(edges)], [shift.lateness for shift in shifts])
        places = np.minimum(np.maximum(rows - late / STEP, 0.0), last)
        own = self.motion.controls[:, list(self.joints)]
        away = _spline(own)(places) - own.take(np.minimum(rows, last), axis=0)
        columns = {joint: k for k, joint in enumerate(self.joints)}
        blocks = [
            sealed(away[one:other].take([columns[joint] for joint in shift.joints], axis=1))
            for shift, (one, other) in zip(shifts, pairwise(edges), strict=True)
        ]
        moments: list[float] = times.tolist()
        for shift, hinge, first, end in _seen_runs(shifts, blocks):
            which = slice(None) if shifts[shift].together else slice(hinge, hinge + 1)
            begin, until = moments[edges[shift] + first], moments[edges[shift] + end] + 2 * STEP
            yield Delay(begin, until, tuple(shifts[shift].joints[which]), blocks[shift][first : end + 1, which])


def _spline(points: Floats) -> "scipy.interpolate.PPoly":
    """The cubic spline through (k, h) points that are 1 apart; its third derivative goes on at the first and last."""
    steps = np.diff(points, axis=0)
    ends = np.array([5.0, 1.0]) / 2.0
    pull = np.vstack([ends @ steps[:2], 3.0 * (steps[:-1] + steps[1:]), ends @ steps[:-3:-1]])
    beside, middle = np.ones(len(steps)), np.full(len(points), 4.0)
    before, after = beside.copy(), beside
    middle[[0, -1]], after[0], before[-1] = 1.0, 2.0, 2.0
    slopes = scipy.linalg.lapack.dgtsv(before, middle, after, pull)[3]
    bend = slopes[:-1] + slopes[1:] - 2.0 * steps
    coefficients = np.stack([bend, steps - slopes[:-1] - bend, slopes[:-1], points[:-1]])
    return scipy.interpolate.PPoly.construct_fast(coefficients, np.arange(float(len(points))))


def _seen_runs(shifts: Sequence[_Shift], blocks: Sequence[Floats]) -> Iterator[tuple[int, int, int, int]]:
    """Finds runs of rows in which joints are away, at least once far enough to be seen: shift, joint, first, last.

    Each joint counts by itself, or all of a shift together as its first.

    Args:
        shifts: of the joints.
        blocks: (r, h) [rad] by which the joints of each are away.
    """
    far = [np.abs(block).T for block in blocks]
    far = [own.max(axis=0, keepdims=True) if shift.together else own for shift, own in zip(shifts, far, strict=True)]
    owners = [(k, hinge) for k, own in enumerate(far) for hinge in range(len(own))]
    starts = np.cumsum([0, *(own.shape[1] for own in far for _ in own)])
    flat = np.concatenate([own.ravel() for own in far])
    away, edge = flat > SAME, np.zeros(len(flat) + 1, dtype=np.bool_)
    edge[starts] = True
    firsts = np.flatnonzero(away & (edge[:-1] | ~np.append(False, away[:-1])))
    lasts = np.flatnonzero(away & (edge[1:] | ~np.append(away[1:], False)))
    if not firsts.size:
        return
    seen = np.maximum.reduceat(flat, firsts) > SEEN
    columns = np.searchsorted(starts, firsts[seen], side="right") - 1
    rows = np.stack([firsts[seen], lasts[seen]]) - starts[columns]
    for column, first, last in zip(columns.tolist(), *rows.tolist(), strict=True):
        yield *owners[column], first, last


def _late_at(times: Sequence[Floats], latenesses: Sequence[Lateness]) -> Floats:
    """Computes how late hinges are [s], each at its own times (m,) [s]; their results are joined."""
    parts: list[tuple[float, float, float, float]] = []  # begin [s], how long [s], lateness and how it grows [s]
    counts: list[int] = []
    for own, lateness in zip(times, latenesses, strict=True):
        edges = np.searchsorted(own, [time for time, _ in lateness]).tolist()
        parts += [
            ON_TIME,
            *((begin, end - begin, one, other - one) for (begin, one), (end, other) in pairwise(lateness)),
            ON_TIME,
        ]
        counts += [other - one for one, other in pairwise((0, *edges, len(own)))]
    begin, lasts, late, growth = np.repeat(np.array(parts).T, counts, axis=1)
    return np.asarray(late + minimum_jerk((np.concatenate(times) - begin) / lasts) * growth)
