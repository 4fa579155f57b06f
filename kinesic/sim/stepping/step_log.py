"""Compact log of all physics steps, in MuJoCo's joint order.

Logging a step must be cheap: there are 300 steps per second.
"""

from array import array
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from kinesic.body.arrays import Floats, Indices

Rows: TypeAlias = "array[float]"  # rows of equal length, concatenated


@dataclass(frozen=True, eq=False)
class StepRecord:
    """Commands and physics steps of a compiled loop.

    They cover the time since the last record, or all of it.
    """

    times: Floats  # (m,) [s] of the commands
    sent: Floats  # (m, n) [rad] setpoints of each command
    counts: Indices  # (m,) number of steps of this record before each command
    aims: Floats  # (g, n) [rad] setpoints that came into force
    aimed: Indices  # (g,) number of steps of this record before each of these setpoints
    angles: Floats  # (s, q) [rad] qpos after each step
    velocities: Floats  # (s, q) [rad/s] qvel after each step
    spans: Floats  # (s,) [s] duration of each step


@dataclass(frozen=True, eq=False)
class LoggedSteps:
    """Arrays of the s steps and m commands of a log."""

    angles: Floats  # (s, q) [rad] qpos after each step
    velocities: Floats  # (s, q) [rad/s] qvel after each step
    spans: Floats  # (s,) [s] duration of each step
    supplied: Floats  # (s,) voltage / open-circuit voltage during each step; (1,) if constant
    aims: Floats  # (g, n) [rad] successive setpoints in force
    begins: Indices  # (g,) first step of each of these setpoints
    ends: Indices  # (m,) number of steps before each command


class StepLog:
    """Log of postures, velocities and setpoints at all steps and commands."""

    def __init__(self, angles: Floats, velocities: Floats, goals: Floats) -> None:
        """Start the log with the initial posture.

        Args:
            angles: (q,) [rad] live array of the physics, copied at each step.
            velocities: (q,) [rad/s] live array of the physics, copied at each step.
            goals: (n,) [rad] setpoints in force, in joint order.
        """
        self._live = angles, velocities
        self._redirect_log(array("d", angles), array("d", velocities), array("d", [0.0]), array("d", [1.0]))
        self._begins, self._aims = [0], [goals[None]]  # first step and rows of the setpoints in force
        self.times: list[float] = []  # [s] of the commands
        self.counts: list[int] = []  # number of steps before each command
        self._sent: list[Floats] = []  # arrays (k, n) [rad] with the setpoints of k commands

    def _redirect_log(self, angles: Rows, velocities: Rows, spans: Rows, supplied: Rows) -> None:
        """Redirect the log of later physics steps to the given arrays.

        The arrays contain at least one step.
        """
        live_angles, live_velocities = self._live
        self._angles, self._velocities = angles, velocities
        self.log_angles = partial(angles.frombytes, live_angles.data.cast("B"))  # call after each physics step
        self.log_velocities = partial(
            velocities.frombytes, live_velocities.data.cast("B")
        )  # call after each physics step
        self._steps = spans  # [s] duration of each step
        self._supplied = supplied  # voltage / open-circuit voltage; one element if constant
        self.log_voltage = supplied.append  # call before each physics step

    def aim(self, goals: Floats) -> None:
        """Set the setpoints (n,) [rad] that apply from the next step."""
        self._begins.append(len(self._steps))
        self._aims.append(goals[None])

    def stepped(self, count: int, span: float) -> None:
        """Record new steps, given their count and the duration [s] of each."""
        self._steps.extend([span] * count)

    def mark(self, time: float, goals: Floats) -> None:
        """Record a command with its time [s] and setpoints (n,) [rad]."""
        self.times.append(time)
        self.counts.append(len(self._steps))
        self._sent.append(goals[None])

    def take(self, record: StepRecord) -> None:
        """Append a compiled loop's steps and commands to the log."""
        step_count = len(self._steps)
        for steps, new_rows in (
            (self._angles, record.angles),
            (self._velocities, record.velocities),
            (self._steps, record.spans),
        ):
            steps.frombytes(np.ascontiguousarray(new_rows).reshape(-1).view(np.uint8).data)
        self.times += record.times.tolist()
        self.counts += (record.counts + step_count).tolist()
        self._sent.append(record.sent)
        if len(record.aims):
            self._begins += (record.aimed + step_count).tolist()
            self._aims.append(record.aims)

    @property
    def posture(self) -> Floats:
        """Current angles (q,) [rad] of all MuJoCo joints."""
        angles, velocities = self._live
        # MuJoCo's semi-implicit angles are half a step ahead of constant setpoints, its velocities are not
        angles_now: Floats = angles - self._steps[-1] / 2 * velocities
        return angles_now

    def steps(self) -> LoggedSteps:
        """Return all logged steps without a copy.

        The returned arrays must be released before further steps are logged.
        """
        spans = np.frombuffer(self._steps)
        angles, velocities = (
            np.frombuffer(steps).reshape(len(spans), -1) for steps in (self._angles, self._velocities)
        )
        aims, begins = np.concatenate(self._aims), np.array(self._begins, dtype=np.intp)
        ends, supplied = np.array(self.counts, dtype=np.intp), np.frombuffer(self._supplied)
        return LoggedSteps(angles, velocities, spans, supplied, aims, begins, ends)

    def sent(self) -> Floats:
        """Return the setpoints (m, n) [rad] of all commands."""
        return np.concatenate(self._sent)

    def forget(self) -> None:
        """Discard all commands, and all steps except the last one.

        Arrays from `steps` stay valid, since thread profilers may still refer to them.
        """
        count = len(self._live[0])
        self._redirect_log(self._angles[-count:], self._velocities[-count:], self._steps[-1:], self._supplied[-1:])
        self._begins, self._aims = [0], [self._aims[-1][-1:]]
        self.times, self.counts, self._sent = [], [], []
