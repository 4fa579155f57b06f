"""What was planned and what was performed, side by side.

The reference is what a plan says at the times of its commands, whoever follows them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, seal_own
from kinesic.body.command import RATE, Measurements
from kinesic.body.robot import SIDES, PartName, Robot
from kinesic.controller.arrival import Arrival, arrivals, lags, part_paths
from kinesic.controller.play import command_times
from kinesic.controller.smoothness import dimensionless_jerk, visible_jerk
from kinesic.controller.synchrony import StrokeLag, measure_lags
from kinesic.controller.tracking_delay import tracking_delay
from kinesic.controller.tracking_errors import TrackingErrors, measure_errors
from kinesic.controller.watch.clearance import LOOK, foresee
from kinesic.motion.limit_check import Peaks, check_limits
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.sim.kinematics import motion_frames
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors

MOVING = 0.05  # share of its speed limit above which a hinge counts as moving
LEAST_WAY = 0.05  # [m] below which a hand only sways with the body
COMMANDS_PER_LOOK = round(2 * LOOK * RATE)  # from one look back at the clearance to the next
MOST_KEPT = 4096  # commands of a motion that is kept once it is sampled; a longer one is sampled anew, by windows
COMMANDS_PER_WINDOW = 1024  # of a longer one, which are sampled together: frames of as many take 3 MB
HOLDING_RATE = 20  # [Hz] at which the torque of standing still is judged: gravity changes slowly


@dataclass(frozen=True, eq=False)
class Reference:
    """The planned motion at the times of its commands, which every twin that performs the plan is compared with."""

    plan: Plan
    times: Floats  # (m,) [s] of the commands
    duties: Floats  # (m, n) that the motion needs

    @property
    def angles(self) -> Floats:
        """(m, n) [rad]; a long motion is sampled anew each time that somebody asks, as it takes much room."""
        return self._sample(0)

    @property
    def speeds(self) -> Floats:
        """(m, n) [rad/s]; likewise."""
        return self._sample(1)

    def speeds_of(self, hinges: Indices) -> Floats:
        """Samples the speeds (m, k) [rad/s] of (k,) hinges; those of others are not computed for a long motion."""
        if len(self.times) <= MOST_KEPT:
            return self.speeds[:, hinges]
        trajectory = self.plan.trajectory
        return replace(trajectory, controls=trajectory.controls[:, hinges]).sample(self.times)[1]

    @property
    def accelerations(self) -> Floats:
        """(m, n) [rad/s^2]; likewise."""
        return self._sample(2)

    def _sample(self, order: int) -> Floats:
        if len(self.times) <= MOST_KEPT:
            return self._motion[order]
        found = np.empty(self.duties.shape)
        for rows, motion in self.motions():
            found[rows] = motion[order]
        return found

    def motions(self) -> Iterator[tuple[slice, tuple[Floats, Floats, Floats]]]:
        """Yields windows of commands with their angles, speeds and accelerations; a short motion is one window."""
        if len(self.times) <= MOST_KEPT:
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
        """The plan against its limits, at 1 kHz."""
        return check_limits(self.plan.trajectory, self.plan.setup.limits)

    @cached_property
    def hands(self) -> Mapping[str, Floats]:
        """Side -> (m, 3) [m] the wrist's centre in the world."""
        robot, hands = self.plan.setup.robot, np.empty((len(SIDES), len(self.times), 3))
        wrists = [robot.arm(side).wrist for side in SIDES]
        for rows, (angles, _, _) in self.motions():
            origins = motion_frames(robot.skeleton, angles).origins
            hands[:, rows] = origins[wrists].transpose(0, 2, 1)
        return dict(zip(SIDES, (seal_own(each) for each in hands), strict=True))

    @cached_property
    def smoothness(self) -> Mapping[str, float | None]:
        """Side -> dimensionless jerk of the hand's path; None for a hand that only sways with the body."""
        period = float(self.times[-1] - self.times[0]) / max(1, len(self.times) - 1)
        return {
            side: dimensionless_jerk(path, period=period) if np.ptp(path, axis=0).max() >= LEAST_WAY else None
            for side, path in self.hands.items()
        }

    @cached_property
    def visible_jerks(self) -> Mapping[str, float]:
        """Side -> mean square of the jerk [m^2/s^6] of the hand that is seen."""
        period = float(self.times[1] - self.times[0])
        return {side: visible_jerk(path, period=period) for side, path in self.hands.items()}

    @cached_property
    def paths(self) -> Mapping[PartName, Floats]:
        """Where hands (m, 3) [m], head and torso (m, 3) [rad] are."""
        robot = self.plan.setup.robot
        parts: tuple[PartName, ...] = ("head", "torso")
        seen = [part_paths(angles, robot, self.hands) for _, (angles, _, _) in self.motions()]
        return {**seen[0], **{part: np.concatenate([paths[part] for paths in seen]) for part in parts}}

    @cached_property
    def arrivals(self) -> Mapping[SyncTime, tuple[Arrival, ...]]:
        """By sync point, where it wants the parts that its behaviour moves, and when the plan is near enough."""
        return arrivals(self.plan, self.times, self.paths)

    @cached_property
    def moving(self) -> Flags:
        """(m, n) where a hinge's speed is more than a small share of its limit."""
        least, moving = MOVING * self.plan.setup.limits.speed, np.empty(self.duties.shape, dtype=np.bool_)
        for rows, (_, speeds, _) in self.motions():
            moving[rows] = (speeds > least) | (speeds < -least)
        return moving

    @cached_property
    def holding(self) -> tuple[Floats, Floats]:
        """Times (k,) [s] and share (k, n) of the stall torque that would hold the posture there."""
        known = self.plan.setup
        times = np.arange(0.0, self.plan.trajectory.duration + 1 / HOLDING_RATE, 1 / HOLDING_RATE)
        shares = np.empty((len(times), len(known.robot.drives)))
        for rows in (slice(begin, begin + COMMANDS_PER_WINDOW) for begin in range(0, len(times), COMMANDS_PER_WINDOW)):
            angles = self.plan.trajectory.angles(times[rows])
            still = np.zeros_like(angles)
            shares[rows] = np.abs(known.dynamics.torques(angles, still, still)) / known.robot.drives.stall
        return times, shares


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """What was measured, as a function of performance time."""

    times: Floats  # (m,) [s] increasing
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.times[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (k, n), at (k,) times; between measurements on straight lines."""
        rows = (self.angles, self.speeds, np.gradient(self.speeds, self.times, axis=0))
        angles, speeds, accelerations = (
            np.stack([np.interp(times, self.times, column) for column in row.T], axis=1) for row in rows
        )
        return angles, speeds, accelerations


@dataclass(frozen=True, eq=False)
class Performance:
    """One block, planned and performed in the twin."""

    reference: Reference  # of the plan, at the times of the commands
    twin: Factors  # how far the twin's servos and masses are from the robot's description
    measured: Measurements
    parse_seconds: float
    dry_run_seconds: float  # of feed-forward and of all twins that performed together
    least_pace: float = 1.0  # seconds of the performance per second, where it was slowed down most
    believed: Factors = NOMINAL  # how servos are believed to be, by which goals lead
    restoring: float = 1.0  # the part of its strength with which the correction restores: what stiff, late servos bear

    @cached_property
    def rooms(self) -> Floats:
        """(k,) [m] clearance that the twin's errors of the last moments would have left, every 100 ms."""
        planned = self.plan.trajectory.angles(self.reference.times[::COMMANDS_PER_LOOK])
        return foresee(planned, self.measured.angles[::COMMANDS_PER_LOOK], self.plan.setup.distances, every=1)

    @property
    def performed(self) -> float:
        """Share of the plan that was performed before somebody stopped it."""
        end = float(command_times(self.plan.duration)[-1])
        return float(self.reference.times[-1]) / end

    @property
    def plan(self) -> Plan:
        """What was performed."""
        return self.reference.plan

    @property
    def twin_name(self) -> str:
        """How reports call the twin."""
        return {NOMINAL: "nominal", PESSIMISTIC: "pessimistic"}.get(self.twin, "own")

    @cached_property
    def robot(self) -> Robot:
        """The robot as the twin has it."""
        return self.twin.applied(self.plan.setup.robot)

    @cached_property
    def period(self) -> float:
        """[s] between samples."""
        times = self.measured.times
        return float(times[-1] - times[0]) / max(1, len(times) - 1)

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """How much later than planned each sync point was met in the twin [s]; None: never."""
        performed = part_paths(self.measured.angles, self.plan.setup.robot, self.measured.hands)
        return lags(self.reference.arrivals, self.measured.times, performed)

    @cached_property
    def stroke_lags(self) -> tuple[StrokeLag, ...]:
        """When the twin's wrists are fastest in the strokes that are tied to words."""
        return measure_lags(self.plan, self.measured.times, self.measured.hands)

    @property
    def errors(self) -> Floats:
        """(m, n) [rad] measured minus planned, NaN where the hinge is not moving; computed anew each time."""
        return np.where(self.reference.moving, self.measured.angles - self.reference.angles, np.nan)

    @cached_property
    def tracking(self) -> TrackingErrors:
        """How far the twin's moving hinges are from the plan."""
        measured, moving = self.measured.angles, self.reference.moving
        errors, done = np.empty(np.count_nonzero(moving)), 0
        for rows, (angles, _, _) in self.reference.motions():
            found = (measured[rows] - angles)[moving[rows]]
            errors[done : done + len(found)] = found
            done += len(found)
        return measure_errors(errors, moving)

    @cached_property
    def lateness(self) -> Floats:
        """(n,) [s] by which the twin's hinges follow late, by cross-correlation; NaN for those that do not move."""
        moving: Flags = np.any(self.reference.moving, axis=0)
        return tracking_delay(self.reference.speeds_of, self.measured.speeds, moving, period=self.period)
