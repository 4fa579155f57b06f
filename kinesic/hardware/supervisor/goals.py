"""Steers the goals on the wire to what is to be performed, within the host's own limits."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.axes import fold_turns
from kinesic.hardware.supervisor.goal_limits import LEAD, GoalBounds, GoalCourse, limit_goals
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.player import Player
from kinesic.hardware.supervisor.settings import SupervisorSettings


class GoalSteering:
    """The goals of all members on the wire, and the targets that they steer for."""

    def __init__(self, manifest: Manifest, settings: SupervisorSettings) -> None:
        self.player = Player(settings)
        self._manifest = manifest
        self._bounds = GoalBounds(*manifest.spans, manifest.speeds, LEAD * manifest.full)
        self._lag = settings.period / (2 * manifest.speeds)  # (m,) [s^2/tick] see `ticks`
        self._course: GoalCourse | None = None
        self._target: Floats = np.zeros(len(manifest.members))  # (m,) [ticks]
        self._given_up: Flags = np.zeros(len(manifest.members), dtype=np.bool_)  # (m,) who move no more
        self._limp: Flags = self._given_up  # (m,) who have no torque

    @property
    def goals(self) -> Floats | None:
        """(m,) [ticks] on the wire; None while they are not known."""
        return self._course.goals if self._course is not None else None

    @property
    def angles(self) -> Floats:
        """(n,) [rad] of the goals; NaN while they are not known."""
        if self._course is None:
            return np.full(len(self._manifest.rest), np.nan)
        return self._manifest.angles(self._course.goals, whole=True)

    @property
    def arrived(self) -> bool:
        """Whether the goals are where they are to go; those of limp servos, which nothing moves, do not count."""
        if self._course is None:
            return False
        away = np.abs(self._course.goals - self._target)
        return float(np.where(self._limp, 0.0, away).max()) < 1.0

    def hold(self) -> None:
        """Lets the goals stand from now on."""
        self.player.hold()
        if self._course is not None:
            self._target = self._course.goals.copy()

    def approach(self) -> None:
        """Moves to where the performance goes on."""
        self.player.approach(self.angles)

    def fold(self, holding: frozenset[int]) -> None:
        """Moves to rest, but for joints that must not move."""
        here = self.angles
        still = np.isin(np.arange(len(here)), list(holding))
        self.player.fold(here, np.where(still, here, self._manifest.rest))

    def move(self, seconds: float, present: Floats, *, target: float, slow: float) -> Flags:
        """Brings the goals on by a moment.

        Args:
            seconds: that pass.
            present: (m,) [ticks] where the servos are; NaN where nobody knows.
            target: scale of time.
            slow: [s] in which time comes to a stop.

        Returns:
            (m,) whose goals were not where they were requested.
        """
        angles = self.player.advance(seconds, target=target, slow=slow)
        if self._course is None:
            return np.zeros(len(self._target), dtype=np.bool_)
        desired = self._target
        if angles is not None:
            desired = self._manifest.scale.nearest(angles.take(self._manifest.joints))
            if self._given_up.any():
                desired = np.where(self._given_up, self._target, desired)
        self._target = np.maximum(np.minimum(desired, self._bounds.upper), self._bounds.lower)
        self._course, refused = limit_goals(self._course, self._target, present, seconds, self._bounds)
        refused |= self._target != desired
        return refused

    def give_up(self, stuck: Flags, present: Floats) -> None:
        """Stops driving servos that are stuck: from now on they hold where they are.

        Args:
            stuck: (m,) who they are; those on the same hinge hold with them.
            present: (m,) [ticks]; NaN where nobody knows.
        """
        joints = self._manifest.joints
        news = np.isin(joints, joints[stuck]) & ~self._given_up & np.isfinite(present)
        if news.any():
            self.put(news, present[news])
            self._given_up = self._given_up | news

    def take_back(self, places: Sequence[int]) -> None:
        """Drives servos again that were given up, as their torque comes anew."""
        self._given_up = self._given_up.copy()
        self._given_up[list(places)] = False

    def put(self, places: Flags | Sequence[int], goals: Floats) -> None:
        """Sets the goals of some members, who do not move by them: they are limp, or just being taken over."""
        if self._course is None:
            self._course = GoalCourse.still(self._target)
        now, speeds, target = self._course.goals.copy(), self._course.speeds.copy(), self._target.copy()
        now[places], speeds[places], target[places] = goals, 0.0, goals
        self._course, self._target = GoalCourse(now, speeds), target

    def ticks(self) -> Ticks | None:
        """Returns (m,) what goes out: the goals, ahead by what the servos' own profiles cost.

        A servo's set point comes to a goal at the speed v of its profile, not at once. While goals move at a speed s,
        that takes s / v of each period T, and leaves the set point s^2 T / 2v behind on the mean.
        """
        course, bounds = self._course, self._bounds
        if course is None:
            return None
        ahead = course.speeds * np.abs(course.speeds) * self._lag
        return np.rint(np.minimum(np.maximum(course.goals + ahead, bounds.lower), bounds.upper)).astype(np.int64)

    def follow_limp(self, limp: Flags, present: Floats) -> None:
        """Sets the goals of limp servos to where they are, so that none of them jumps when torque comes.

        Args:
            limp: (m,) who they are.
            present: (m,) [ticks]; NaN where nobody knows.
        """
        self._limp = limp
        if not limp.any():
            return
        known = limp & np.isfinite(present)
        if self._course is not None and known.any():
            self.put(known, fold_turns(present[known]))
