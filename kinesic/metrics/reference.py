"""Planned motion sampled at the command times."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, seal_in_place
from kinesic.body.robot import SIDES, PartName
from kinesic.metrics.arrival import Arrival, compute_part_paths, find_arrivals
from kinesic.metrics.conditioning import ChangedBehaviour, find_changes
from kinesic.metrics.impact_figures import ImpactFigures, measure_impacts
from kinesic.metrics.smoothness import dimensionless_jerk, visible_jerk
from kinesic.motion.limit_check import Peaks, check_limits
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.sim.kinematics import compute_motion_frames

MOVING_FRACTION = 0.05  # fraction of the velocity limit above which a hinge counts as moving
MIN_HAND_TRAVEL = 0.05  # [m] extent of a hand path below which its smoothness is not measured
MAX_CACHED_COMMANDS = 4096  # [commands] longest motion with cached samples; longer ones are resampled at each access
COMMANDS_PER_WINDOW = 1024  # commands per batch of a long motion; the frames of one batch take 3 MB
HOLDING_RATE = 20  # [Hz] sampling rate of the static torque, which changes slowly


@dataclass(frozen=True, eq=False)
class Reference:
    """Planned motion at the command times, for comparison with twins.

    The samples of a long motion take much memory and are computed at every access.
    """

    plan: Plan
    times: Floats  # (m,) [s] of the commands
    duties: Floats  # (m, n) required duty cycles

    @property
    def angles(self) -> Floats:
        """Planned angles (m, n) [rad]."""
        return self._sample(0)

    @property
    def velocities(self) -> Floats:
        """Planned velocities (m, n) [rad/s]."""
        return self._sample(1)

    def velocities_of(self, hinges: Indices) -> Floats:
        """Sample the velocities (m, k) [rad/s] of some hinges (k,).

        For a long motion, other hinges are not evaluated.
        """
        if len(self.times) <= MAX_CACHED_COMMANDS:
            return self.velocities[:, hinges]
        trajectory = self.plan.trajectory
        return replace(trajectory, controls=trajectory.controls[:, hinges]).sample(self.times)[1]

    @property
    def accelerations(self) -> Floats:
        """Planned accelerations (m, n) [rad/s^2]."""
        return self._sample(2)

    def _sample(self, order: int) -> Floats:
        if len(self.times) <= MAX_CACHED_COMMANDS:
            return self._motion[order]
        samples = np.empty(self.duties.shape)
        for rows, motion in self.motions():
            samples[rows] = motion[order]
        return samples

    def motions(self) -> Iterator[tuple[slice, tuple[Floats, Floats, Floats]]]:
        """Yield batches of command indices with angles, velocities and accelerations.

        A short motion is one batch.
        """
        if len(self.times) <= MAX_CACHED_COMMANDS:
            yield slice(None), self._motion
            return
        for begin in range(0, len(self.times), COMMANDS_PER_WINDOW):
            rows = slice(begin, begin + COMMANDS_PER_WINDOW)
            yield rows, self.plan.trajectory.sample(self.times[rows])

    @cached_property
    def _motion(self) -> tuple[Floats, Floats, Floats]:
        return self.plan.trajectory.sample(self.times)

    @cached_property
    def peaks(self) -> Peaks:
        """Largest ratios of the motion to its limits, sampled at 1 kHz."""
        return check_limits(self.plan.trajectory, self.plan.setup.limits)

    @cached_property
    def hands(self) -> Mapping[str, Floats]:
        """Planned wrist paths in the world by side, (m, 3) [m]."""
        robot, hands = self.plan.setup.robot, np.empty((len(SIDES), len(self.times), 3))
        wrists = [robot.arm(side).wrist for side in SIDES]
        for rows, (angles, _, _) in self.motions():
            origins = compute_motion_frames(robot.skeleton, angles).origins
            hands[:, rows] = origins[wrists].transpose(0, 2, 1)
        return dict(zip(SIDES, (seal_in_place(path) for path in hands), strict=True))

    @cached_property
    def smoothness(self) -> Mapping[str, float | None]:
        """Dimensionless jerk of each hand's path, None if it hardly moves."""
        period = float(self.times[-1] - self.times[0]) / max(1, len(self.times) - 1)
        return {
            side: dimensionless_jerk(path, period=period) if np.ptp(path, axis=0).max() >= MIN_HAND_TRAVEL else None
            for side, path in self.hands.items()
        }

    @cached_property
    def visible_jerks(self) -> Mapping[str, float]:
        """Mean square jerk of each hand below 10 Hz [m^2/s^6]."""
        period = float(self.times[1] - self.times[0])
        return {side: visible_jerk(path, period=period) for side, path in self.hands.items()}

    @cached_property
    def paths(self) -> Mapping[PartName, Floats]:
        """Planned paths of hands [m], head and torso [rad], each (m, 3)."""
        robot = self.plan.setup.robot
        parts: tuple[PartName, ...] = ("head", "torso")
        windows = [compute_part_paths(angles, robot, self.hands) for _, (angles, _, _) in self.motions()]
        return {**windows[0], **{part: np.concatenate([paths[part] for paths in windows]) for part in parts}}

    @cached_property
    def arrivals(self) -> Mapping[SyncTime, tuple[Arrival, ...]]:
        """Body parts' target regions and planned arrivals at each sync point."""
        return find_arrivals(self.plan, self.times, self.paths)

    @cached_property
    def changes(self) -> tuple[ChangedBehaviour, ...]:
        """Behaviours that the motion limits shifted or weakened."""
        return find_changes(self.plan, self.times, self.paths)

    @cached_property
    def impacts(self) -> ImpactFigures | None:
        """Contacts of the planned motion with people, None without a model."""
        return measure_impacts(self.plan)

    @cached_property
    def moving(self) -> Flags:
        """Whether each hinge moves at each command, (m, n).

        A hinge moves if it is faster than `MOVING_FRACTION` of its velocity limit.
        """
        thresholds, moving = MOVING_FRACTION * self.plan.setup.limits.speed, np.empty(self.duties.shape, dtype=np.bool_)
        for rows, (_, speeds, _) in self.motions():
            moving[rows] = (speeds > thresholds) | (speeds < -thresholds)
        return moving

    @cached_property
    def holding_torques(self) -> tuple[Floats, Floats]:
        """Times (k,) [s] and absolute static load / stall torque (k, n)."""
        setup = self.plan.setup
        times = np.arange(0.0, self.plan.trajectory.duration + 1 / HOLDING_RATE, 1 / HOLDING_RATE)
        fractions = np.empty((len(times), len(setup.robot.drives)))
        for rows in (slice(begin, begin + COMMANDS_PER_WINDOW) for begin in range(0, len(times), COMMANDS_PER_WINDOW)):
            angles = self.plan.trajectory.angles(times[rows])
            still = np.zeros_like(angles)
            fractions[rows] = np.abs(setup.dynamics.torques(angles, still, still)) / setup.robot.drives.stall
        return times, fractions
