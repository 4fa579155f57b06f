"""Generation of goal positions for the servos, within the host's limits."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.axes import fold_turns
from kinesic.hardware.supervisor.goal_limits import MAX_LEAD_RATIO, GoalBounds, GoalCourse, limit_goals
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.player import Player
from kinesic.hardware.supervisor.settings import SupervisorSettings


class GoalSteering:
    """Generator of servo goals that approach their targets within the limits."""

    def __init__(self, manifest: Manifest, settings: SupervisorSettings) -> None:
        self.player = Player(settings)
        self._manifest = manifest
        self._bounds = GoalBounds(*manifest.spans, manifest.velocities, MAX_LEAD_RATIO * manifest.full)
        self._period = settings.period
        self.set_profile_velocities(manifest.velocities)
        self._course: GoalCourse | None = None
        self._target: Floats = np.zeros(len(manifest.members))  # (m,) [ticks] positions that the goals approach
        self._given_up: Flags = np.zeros(
            len(manifest.members), dtype=np.bool_
        )  # (m,) servos that are not driven any more
        self._limp: Flags = self._given_up  # (m,) servos without torque

    @property
    def goals(self) -> Floats | None:
        """Current limited goals (m,) [ticks], before lag compensation.

        None while unknown.
        """
        return self._course.goals if self._course is not None else None

    @property
    def angles(self) -> Floats:
        """Joint angles (n,) [rad] of the goals.

        NaN while unknown.
        """
        if self._course is None:
            return np.full(len(self._manifest.rest), np.nan)
        return self._manifest.angles(self._course.goals, whole=True)

    @property
    def arrived(self) -> bool:
        """Whether all goals are within one tick of their targets.

        Servos without torque do not count, because nothing moves them.
        """
        if self._course is None:
            return False
        distance = np.abs(self._course.goals - self._target)
        return float(np.where(self._limp, 0.0, distance).max()) < 1.0

    def set_profile_velocities(self, velocities: Floats) -> None:
        """Set the profile velocities (m,) [ticks/s] of the servos.

        `ticks` compensates their lag.
        """
        self._lag = self._period / (2 * velocities)  # (m,) [s^2/tick] profile lag per squared velocity

    def hold(self) -> None:
        """Stop at the present goals until the next move begins."""
        self.player.hold()
        if self._course is not None:
            self._target = self._course.goals.copy()

    def approach(self) -> None:
        """Begin a move to the posture at which the performance continues."""
        self.player.approach(self.angles)

    def fold(self, holding: frozenset[int]) -> None:
        """Begin a move to the rest posture, except for holding joints."""
        present = self.angles
        is_held = np.isin(np.arange(len(present)), list(holding))
        self.player.fold(present, np.where(is_held, present, self._manifest.rest))

    def move(self, seconds: float, present: Floats, *, target: float, slow: float) -> Flags:
        """Advance the goals by one step, and flag the limited ones.

        Args:
            seconds: [s] duration of the step.
            present: (m,) [ticks] positions of the servos; NaN: unknown.
            target: time scale.
            slow: [s] in which time decelerates to a stop.

        Returns:
            (m,) whether the limits changed a requested goal.
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
        """Stop driving stuck servos, which hold their position from now on.

        Args:
            stuck: (m,) stuck servos; the others on the same hinge hold, too.
            present: (m,) [ticks]; NaN: unknown.
        """
        joints = self._manifest.joints
        newly_stuck = np.isin(joints, joints[stuck]) & ~self._given_up & np.isfinite(present)
        if newly_stuck.any():
            self.put(newly_stuck, present[newly_stuck])
            self._given_up = self._given_up | newly_stuck

    def take_back(self, places: Sequence[int]) -> None:
        """Resume driving servos that were given up as stuck."""
        self._given_up = self._given_up.copy()
        self._given_up[list(places)] = False

    def put(self, places: Flags | Sequence[int], goals: Floats) -> None:
        """Set the goals of motionless servos at once, bypassing all limits.

        These members do not move by it: they have no torque, or are being taken over.
        """
        if self._course is None:
            self._course = GoalCourse.still(self._target)
        course_goals, velocities, target = (
            self._course.goals.copy(),
            self._course.velocities.copy(),
            self._target.copy(),
        )
        course_goals[places], velocities[places], target[places] = goals, 0.0, goals
        self._course, self._target = GoalCourse(course_goals, velocities), target

    def ticks(self) -> Ticks | None:
        """Return goals (m,) [ticks] that compensate the lag of the servo profiles.

        A servo's set point approaches a goal at its profile velocity v instead of at once. While goals move at velocity
        s, that takes s / v of each period T, and leaves the set point s^2 T / 2v behind on average.
        """
        course, bounds = self._course, self._bounds
        if course is None:
            return None
        ahead = course.velocities * np.abs(course.velocities) * self._lag
        return np.rint(np.minimum(np.maximum(course.goals + ahead, bounds.lower), bounds.upper)).astype(np.int64)

    def follow_without_torque(self, limp: Flags, present: Floats) -> None:
        """Set the goals of torque-free servos to their positions.

        Hence they do not jump when torque is switched on.

        Args:
            limp: (m,) servos without torque.
            present: (m,) [ticks]; NaN: unknown.
        """
        self._limp = limp
        if not limp.any():
            return
        has_position = limp & np.isfinite(present)
        if self._course is not None and has_position.any():
            self.put(has_position, fold_turns(present[has_position]))
