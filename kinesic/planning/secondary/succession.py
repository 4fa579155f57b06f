"""Succession in a motion: wrists come later than shoulders on the ways there and back, and one hand of two follows.

A hinge that is late is where the motion had it a moment before. How late it is changes while its arm stands still,
where nothing is seen of it, and else along a way, so that at the stroke every hinge of a hand is where it was; of two
hands that need not meet one does all of it a little later. A whole number of knots shifts a motion as it is: no limit
is nearer than before.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.secondary.arm_times import ArmCourse, ArmStroke, Gap
from kinesic.planning.secondary.swells import AHEAD, runs

LEAD = 0.5  # of what the wrist is later than the shoulder, that the shoulder is sooner than the elbow
CAUGHT_UP = 0.15  # of a way, that a hinge makes up for at most
REST = 0.35  # of the time that an arm stands still, in which it may become so much sooner or later
BEYOND = 30  # knots after its end, that a motion may go on where something is late
SEEN, SAME = 1e-3, 1e-9  # [rad] that is worth it, and that is nothing

Lateness = Sequence[tuple[float, float]]  # times [s], and how late a hinge is at them [s]; smooth in between


@dataclass(frozen=True, eq=False)
class Delay:
    """What some hinges do later than a motion has it; times [s] are those of the motion."""

    begin: float
    end: float
    hinges: tuple[int, ...]
    away: Floats  # (r, h) [rad] from where the motion has them, at each knot from the first on

    def added(self, times: Floats) -> Floats:
        """(m, h) [rad] what it adds to the angles of its hinges at (m,) times [s]."""
        rows = np.rint((times - self.begin) / STEP).astype(np.intp) + 1
        return np.asarray(self._padded[np.minimum(np.maximum(rows, 0), len(self.away) + 1)])

    @cached_property
    def _padded(self) -> Floats:
        """`away` between nothing and nothing."""
        nothing = np.zeros((1, self.away.shape[1]))
        return np.vstack([nothing, self.away, nothing])


def later_hinges(courses: Iterable[ArmCourse], motion: Trajectory, robot: Robot) -> Iterator[Delay]:
    """Finds what each arm does later than a motion has it, as the gestures of a block ask.

    Args:
        courses: of arms through the block.
        motion: through its keys.
        robot: whose arms they are.
    """
    for course in courses:
        arm = robot.arm(course.side)
        hand, forearm = (robot.skeleton.joints_of((name,)) for name in arm.segments[:-3:-1])
        upper = [joint for joint in arm.joints if joint not in (*forearm, *hand)]
        moving = _ArmMotion(motion, arm.moving)
        for stroke, (before, after) in zip(course.strokes, pairwise(course.gaps), strict=True):
            if stroke.behind:
                yield from moving.later(arm.moving, _behind(stroke, before, after), together=True)
            for joints, late in ((upper, -LEAD * stroke.loose), ((*hand, *arm.fingers), (1.0 - LEAD) * stroke.loose)):
                for lateness in (_coming(late, before, motion.start), _going(late, after)):
                    yield from moving.later(joints, lateness)


def _behind(stroke: ArmStroke, before: Gap, after: Gap) -> Lateness:
    """All of a stroke, and the ways there and back, later than the other hand."""
    enough = stroke.behind / REST
    come = next(((a, b) for a, b in reversed(before.rests) if b - a >= enough), None)
    gone = next(((a, b) for a, b in reversed(after.rests) if b - a >= enough), None)
    if (come is None and before.end - before.begin < stroke.behind / CAUGHT_UP) or (
        gone is None and after.end - after.begin < stroke.behind / CAUGHT_UP
    ):
        return ()
    begin, leave = (come[1] - enough, come[1]) if come else (before.begin, before.end)
    back, end = (gone[0], gone[0] + enough) if gone else (after.begin, after.end)
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
class _ArmMotion:
    """One arm in a motion, as smooth curves through its control points."""

    motion: Trajectory
    joints: tuple[int, ...]

    @cached_property
    def curves(self) -> "scipy.interpolate.CubicSpline":
        """(k, h) [rad] control points at places among them."""
        return scipy.interpolate.CubicSpline(np.arange(len(self.motion.controls)), self._controls)

    @cached_property
    def _controls(self) -> Floats:
        return self.motion.controls[:, list(self.joints)]

    def later(self, joints: Sequence[int], lateness: Lateness, *, together: bool = False) -> Iterator[Delay]:
        """Moves some of its joints later, each by itself or all together, wherever they are not on time."""
        if not lateness or not joints:
            return
        start, last = self.motion.start, len(self.motion.controls) - 1
        first, end = (
            int(min(max((time - start) / STEP, 0.0), last + BEYOND)) for time in (lateness[0][0], lateness[-1][0])
        )
        rows = np.arange(first, end + AHEAD + 2)
        times = np.asarray(start + (rows - AHEAD) * STEP, dtype=np.float64)
        columns = [self.joints.index(joint) for joint in joints]
        places = np.minimum(np.maximum(rows - _late_at(times, lateness) / STEP, 0.0), last)
        away = self.curves(places)[:, columns] - self._controls[np.minimum(rows, last)[:, None], columns]
        far = np.abs(away)
        seen = (far.max(axis=0) > SEEN).tolist()
        for group in [[*range(len(joints))]] if together else [[k] for k in range(len(joints))]:
            if not any(seen[k] for k in group):
                continue
            for one, other in runs(np.any(far[:, group] > SAME, axis=1)):
                found = away[one : other + 1, group]
                if far[one : other + 1, group].max() > SEEN:
                    hinges = tuple(joints[k] for k in group)
                    yield Delay(float(times[one]), float(times[other]) + 2 * STEP, hinges, sealed(found))


def _late_at(times: Floats, lateness: Lateness) -> Floats:
    """(m,) [s] how late a hinge is at (m,) times [s]."""
    found = np.zeros(len(times))
    for (begin, one), (end, other) in pairwise(lateness):
        inside = (times >= begin) & (times < end)
        along = minimum_jerk((times[inside] - begin) / (end - begin)) if one != other else 0.0
        found[inside] = one + along * (other - one)
    return found
