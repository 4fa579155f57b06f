"""Drives sinks in real time: each gets its commands when it wants them."""

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from math import ceil, floor
from typing import Protocol, runtime_checkable

import numpy as np
from msgspec.structs import replace

from kinesic.body.arrays import Floats
from kinesic.body.command import RATE, Command, Sink
from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import Lesson
from kinesic.controller.play import commands
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.setup import Setup
from kinesic.serve.messages import ServoHealth, ServoPlace, ServoState
from kinesic.serve.sinks.leading import Leading
from kinesic.serve.sinks.learner import ServoLearner
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.twin import Twin

SAME = 1e-6  # ticks
AHEAD = 0.7  # [s] servos' supervisor lets time run when it has 0.5 s of commands
Face = Callable[[float], Mapping[str, float]]  # action units at a time [s] of the clock

KEPT = 1000  # commands after which a twin forgets what it measured


@runtime_checkable
class TimedSink(Protocol):
    """A sink that owns the time."""

    def time(self, clock: float, /) -> float | None:
        """[s] the performance's own time at one of the machine's monotonic clock [s]; None while it stands still."""


@runtime_checkable
class MeasuringSink(Protocol):
    """A sink that knows where its joints are."""

    def seen(self) -> tuple[float, Floats] | None:
        """A time [s] of the clock and the angles (n,) [rad] then; None when there is nothing yet."""


@runtime_checkable
class ConsentingSink(Protocol):
    """A sink that may stop, and goes on only when a client consents."""

    def waits(self) -> bool:
        """Whether it has stopped."""

    def resume(self) -> None:
        """Lets it go on."""


@runtime_checkable
class TeachingSink(Protocol):
    """A sink whose cycles tell how its servos are."""

    def cycles(self) -> Iterable[Status]:
        """Goals and angles of the cycles since the last call."""


@runtime_checkable
class ServoSink(Protocol):
    """A sink of servos, whose torque somebody may give and take."""

    @property
    def armed(self) -> bool:
        """Whether they follow, and own the time."""

    @property
    def state(self) -> ServoState:
        """What they do."""

    @property
    def members(self) -> tuple[ServoPlace, ...]:
        """What each of them is."""

    def health(self) -> ServoHealth:
        """How they are."""

    def arm(self) -> None:
        """Lets them follow from now on."""

    def disarm(self) -> None:
        """Folds and takes their torque, which takes seconds."""

    def revive(self) -> None:
        """Opens them anew if nobody drives them, which may take a second."""


class RealTwin:
    """A twin for a server: it forgets what it measured, and so lives without end."""

    def __init__(self, robot: Robot, *, factors: Factors = NOMINAL) -> None:
        """Begins at rest; the twin's servos are so far from the robot's description."""
        self._twin, self._count, self._time = Twin(robot, factors=factors), 0, 0.0
        self._cycles: deque[Status] = deque(maxlen=KEPT)

    def write(self, command: Command, /) -> None:
        """Follows one command."""
        self._twin.write(command)
        self._count, self._time = self._count + 1, command.time
        if self._count % KEPT == 0:
            self._twin.forget()
        angles, time = self._twin.positions(), command.time
        taken = np.full_like(angles, time)
        self._cycles.append(Status(Stage.ACTIVE, time, time, 1.0, angles=angles, goals=command.goals, taken=taken))

    def cycles(self) -> tuple[Status, ...]:
        """Goals and angles of the commands since the last call."""
        found = tuple(self._cycles)
        self._cycles.clear()
        return found

    def seen(self) -> tuple[float, Floats]:
        """The time of the last command, and where the joints were then."""
        return self._time, self._twin.positions()

    def close(self) -> None:
        """Nothing to give back."""
        self._twin.close()


class RealTimeSink:
    """Hands commands to a sink in time, and knows which is next."""

    def __init__(
        self,
        sink: Sink,
        *,
        ahead: float = 0.0,
        delay: float = 0.0,
        believed: Factors = NOMINAL,
        learner: ServoLearner | None = None,
    ) -> None:
        """Begins at the clock's zero.

        Args:
            sink: closed with this.
            ahead: [s] by which it wants commands before their time.
            delay: [s] from a command's time until its goals arrive.
            believed: how its servos are believed to be, by which goals lead.
            learner: finds how they are from their first motion, which later goals lead by; None: nobody does.
        """
        self.sink, self.ahead = sink, ahead
        self.lesson: Lesson | None = None  # the last one
        self._leading, self._learner = Leading(believed, delay=delay), learner
        self._next = 0  # tick

    def follow(self, motion: Trajectory, now: float, setup: Setup, face: Face) -> None:
        """Hands on all commands that it wants at a time [s]."""
        last = floor((now + self.ahead) * RATE + SAME)
        if last < self._next:
            return
        self._learn()
        times = np.arange(self._next, last + 1) / RATE
        setpoints = self._leading.feedforward(setup, times).lead(motion, times)
        for command in commands(motion, times, setpoints):
            self.sink.write(replace(command, face=face(command.time)))
        self._next = last + 1

    def close(self) -> None:
        """Closes the sink, and learns no more."""
        if self._learner is not None:
            self._learner.close()
        self.sink.close()

    def _learn(self) -> None:
        """Looks at what the servos did, and leads what comes by what that has told."""
        if self._learner is None or not isinstance(self.sink, TeachingSink):
            return
        self._learner.see(self.sink.cycles())
        lesson = self._learner.lesson()
        if lesson is not None:
            self.lesson = lesson
            if not lesson.why:
                self._leading.change(lesson.believed, self._next / RATE)

    def repeat_from(self, cut: float) -> None:
        """Resends commands from a time [s] on when the motion has changed; they replace those already sent."""
        self._next = min(self._next, ceil(cut * RATE - SAME))


def is_steady(old: Trajectory, new: Trajectory, time: float) -> bool:
    """Whether a motion goes over into another at a time [s] of the clock without a step."""
    at = np.array([time])
    before, after = old.sample(at), new.sample(at)
    return all(np.allclose(a, b, rtol=0.0, atol=most) for a, b, most in zip(before, after, STEPS, strict=True))


STEPS = (1e-6, 1e-4, 1e-1)  # [rad], [rad/s], [rad/s^2] that nobody can see
