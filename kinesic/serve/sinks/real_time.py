"""Real-time outputs (sinks), which receive commands at or ahead of their time."""

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from math import ceil, floor
from typing import Protocol, runtime_checkable

import numpy as np
from msgspec.structs import replace

from kinesic.body.arrays import Floats
from kinesic.body.command import COMMAND_RATE, Command, Sink
from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import Identification
from kinesic.controller.play import commands
from kinesic.controller.servo_caps import compute_caps
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.setup import Setup
from kinesic.serve.messages import ServoHealth, ServoPlace, ServoState
from kinesic.serve.sinks.adaptive_feedforward import AdaptiveFeedForward
from kinesic.serve.sinks.learner import ServoLearner
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.twin import Twin

MAX_POSITION_STEP = 1e-6  # [rad] position step below which two motions join smoothly
MAX_VELOCITY_STEP = 1e-4  # [rad/s] velocity step below which two motions join smoothly
MAX_ACCELERATION_STEP = 1e-1  # [rad/s^2] acceleration step below which two motions join smoothly
TICK_TOLERANCE = 1e-6  # [ticks] rounding tolerance of command times
SERVO_LOOKAHEAD = 0.7  # [s] time by which commands are sent ahead; the supervisor starts once it has 0.5 s of commands
Face = Callable[[float], Mapping[str, float]]  # action units at a clock time [s]

CAPPED_TICKS = 1000  # number of further commands for which caps are computed at once
LOG_CAPACITY = 1000  # largest number of stored control cycles; a twin clears its record after as many commands


@runtime_checkable
class TimedSink(Protocol):
    """Output (sink) that provides the performance time."""

    def time(self, clock: float, /) -> float | None:
        """Return the performance time at a monotonic clock time [s], or None.

        None while it is undefined.
        """


@runtime_checkable
class MeasuringSink(Protocol):
    """Output (sink) that measures joint angles."""

    def measurement(self) -> tuple[float, Floats] | None:
        """Return clock time [s] and angles (n,) [rad] of the last measurement.

        None if there is no measurement.
        """


@runtime_checkable
class ResumableSink(Protocol):
    """Output (sink) that may hold still until a client resumes the motion."""

    def needs_resume(self) -> bool:
        """Return whether the robot holds still until `resume`."""

    def resume(self) -> None:
        """Resume the motion."""


@runtime_checkable
class TelemetrySink(Protocol):
    """Output (sink) that records the servo status of each control cycle."""

    def take_cycles(self) -> Iterable[Status]:
        """Return the servo status of every cycle since the last call."""


@runtime_checkable
class ServoSink(Protocol):
    """Output (sink) to servos whose torque can be enabled and disabled."""

    @property
    def armed(self) -> bool:
        """Whether the servos follow commands and provide the performance time."""

    @property
    def state(self) -> ServoState:
        """Operating state of the servos."""

    @property
    def members(self) -> tuple[ServoPlace, ...]:
        """Identity of each servo."""

    def health(self) -> ServoHealth:
        """Return the latest telemetry of the servos."""

    def arm(self) -> None:
        """Enable the torque by forwarding commands from now on."""

    def disarm(self) -> None:
        """Fold and disable the torque, which takes seconds."""

    def revive(self) -> None:
        """Reopen the servos if their supervisor has ended.

        May take a second.
        """


@runtime_checkable
class CappedSink(Protocol):
    """Output (sink) whose servos accept caps of velocity and power."""

    @property
    def pace(self) -> float:
        """Largest joint velocity [rad/s] of moves without commands."""

    def limit(self, caps: ServoCaps, /) -> None:
        """Cap velocity and power from now on."""


class RealTwin:
    """Simulated robot for a server, with bounded memory for any run time."""

    def __init__(self, robot: Robot, *, factors: Factors = NOMINAL_FACTORS) -> None:
        """Create a twin at rest with the given servo deviations."""
        self._twin, self._count, self._time = Twin(robot, factors=factors), 0, 0.0
        self._cycles: deque[Status] = deque(maxlen=LOG_CAPACITY)

    def write(self, command: Command, /) -> None:
        """Execute one command."""
        self._twin.write(command)
        self._count, self._time = self._count + 1, command.time
        if self._count % LOG_CAPACITY == 0:
            self._twin.forget()
        angles, time = self._twin.positions(), command.time
        taken = np.full_like(angles, time)
        self._cycles.append(
            Status(Stage.ACTIVE, time, time, 1.0, angles=angles, setpoints=command.setpoints, taken=taken)
        )

    def take_cycles(self) -> tuple[Status, ...]:
        """Return the servo status after each command since the last call.

        At most the last `LOG_CAPACITY`.
        """
        cycles = tuple(self._cycles)
        self._cycles.clear()
        return cycles

    def measurement(self) -> tuple[float, Floats]:
        """Return time [s] of the last command and simulated joint angles [rad]."""
        return self._time, self._twin.positions()

    def close(self) -> None:
        """Close the twin."""
        self._twin.close()


class RealTimeSink:
    """Sender of commands to one output (sink) at the required times."""

    def __init__(
        self,
        sink: Sink,
        *,
        ahead: float = 0.0,
        delay: float = 0.0,
        estimate: Factors = NOMINAL_FACTORS,
        learner: ServoLearner | None = None,
    ) -> None:
        """Create a sender that starts at clock time zero.

        Args:
            sink: sink to drive; it is closed together with this object.
            ahead: time [s] by which commands are sent in advance.
            delay: time [s] from a command until its setpoints arrive.
            estimate: initial estimate of the servo parameters for the feed-forward.
            learner: identifies the servo parameters from the first motion; None keeps the initial estimate.
        """
        self.sink, self.ahead = sink, ahead
        self.lesson: Identification | None = None  # latest identification result
        self._feedforward, self._learner = AdaptiveFeedForward(estimate, delay=delay), learner
        self._next = 0  # tick of the next command
        self._capped_motion: Trajectory | None = None  # motion of the present caps
        self._capped_until = 0  # tick until which the present caps hold

    def follow(self, motion: Trajectory, now: float, setup: Setup, face: Face) -> None:
        """Send all commands due until a clock time [s] plus `ahead`."""
        last = floor((now + self.ahead) * COMMAND_RATE + TICK_TOLERANCE)
        if last < self._next:
            return
        self._learn()
        times = np.arange(self._next, last + 1) / COMMAND_RATE
        setpoints = self._feedforward.feedforward(setup, times).compute_setpoints(motion, times)
        for command in commands(motion, times, setpoints):
            self.sink.write(replace(command, face=face(command.time)))
        self._next = last + 1
        self._limit(motion, now, setup, last)  # after the commands, which an emergency stop must not delay

    def _limit(self, motion: Trajectory, now: float, setup: Setup, last: int) -> None:
        """Send velocity and power caps of the next motion near people."""
        if setup.policy is None or not isinstance(self.sink, CappedSink):
            return
        if motion is self._capped_motion and last <= self._capped_until:
            return
        first = floor(now * COMMAND_RATE)  # commands from now on may still be in the supervisor
        self._capped_motion, self._capped_until = motion, last + CAPPED_TICKS
        times = np.arange(first, self._capped_until + 1) / COMMAND_RATE
        setpoints = self._feedforward.feedforward(setup, times).compute_setpoints(motion, times)
        self.sink.limit(compute_caps(setpoints, setup, pace=self.sink.pace))

    def close(self) -> None:
        """Close the sink and its learner."""
        if self._learner is not None:
            self._learner.close()
        self.sink.close()

    def _learn(self) -> None:
        """Pass new cycles to the learner and apply its result."""
        if self._learner is None or not isinstance(self.sink, TelemetrySink):
            return
        self._learner.see(self.sink.take_cycles())
        lesson = self._learner.lesson()
        if lesson is not None:
            self.lesson = lesson
            if not lesson.why:
                self._feedforward.change(lesson.estimate, self._next / COMMAND_RATE)

    def repeat_from(self, cut: float) -> None:
        """Let the next `follow` resend the commands after a time [s]."""
        self._next = min(self._next, ceil(cut * COMMAND_RATE - TICK_TOLERANCE))


def is_steady(old: Trajectory, new: Trajectory, time: float) -> bool:
    """Return whether one motion continues another smoothly at a clock time [s].

    Position, velocity and acceleration must agree.
    """
    times = np.array([time])
    before, after = old.sample(times), new.sample(times)
    tolerances = MAX_POSITION_STEP, MAX_VELOCITY_STEP, MAX_ACCELERATION_STEP
    return all(np.allclose(a, b, rtol=0.0, atol=step) for a, b, step in zip(before, after, tolerances, strict=True))
