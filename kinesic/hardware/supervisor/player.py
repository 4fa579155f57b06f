"""Playback of setpoints in performance time.

It plays the performance, a move to its start, or a move to the rest posture.
"""

from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.supervisor.goal_buffer import GoalBuffer
from kinesic.hardware.supervisor.settings import SupervisorSettings

PEAK_VELOCITY_RATIO = 15 / 8  # Peak / mean velocity of the minimum-jerk curve
PEAK_ACCELERATION_FACTOR = 10 / sqrt(3)  # Peak acceleration of the minimum-jerk curve * duration^2 / travel
MAX_MOVE_ACCELERATION = 7.0  # [rad/s^2] largest joint acceleration of moves to rest or to the performance
NEW_PERFORMANCE_GAP = 0.5  # [s] longest gap between commands of one performance
END_TOLERANCE = 1e-6  # [s] rounding tolerance for the end of a motion

Source = Literal["performance", "move"]


@dataclass(frozen=True)
class TimeScale:
    """Time [s] of a performance or move, with its rate."""

    time: float = 0.0  # [s] from the start of the performance or move
    scale: float = 0.0  # rate relative to real time

    @property
    def still(self) -> bool:
        """Whether the rate is zero, so that the motion is stopped."""
        return self.scale <= 0.0


def advance_time(time_scale: TimeScale, seconds: float, *, target: float, end: float, slow: float) -> TimeScale:
    """Advance the time of a performance or move by one step.

    Its scale changes linearly, and it stops at the latest time.

    Args:
        time_scale: current time and scale.
        seconds: [s] duration of the step.
        target: desired scale, 0..1.
        end: [s] latest time.
        slow: [s] from full rate to a stop, and back.
    """
    left = max(0.0, end - time_scale.time)
    # highest scale after this step from which time can still stop: a linear stop takes scale^2 * slow / 2
    after = max(0.0, left - time_scale.scale * seconds / 2)
    allowed = min(target, 1.0, (sqrt(seconds**2 / 4 + 2 * slow * after) - seconds / 2) / slow)
    change = seconds / slow
    scale = max(0.0, time_scale.scale - change, min(allowed, time_scale.scale + change))
    path = (time_scale.scale + scale) / 2 * seconds
    return TimeScale(time_scale.time + left, 0.0) if path >= left else TimeScale(time_scale.time + path, scale)


@dataclass(frozen=True, eq=False)
class TimedMove:
    """Minimum-jerk move of all joints between two postures.

    It begins and ends at rest (Flash and Hogan, 1985), and needs no planner.
    """

    start: Floats  # (n,) [rad] posture at the start
    goal: Floats  # (n,) [rad] posture at the end
    duration: float  # [s] from start to end of the move

    @classmethod
    def between(cls, start: Floats, goal: Floats, *, pace: float) -> "TimedMove":
        """Make a move with limited velocity and acceleration.

        A move between equal postures has zero duration.

        Args:
            start: (n,) [rad].
            goal: (n,) [rad].
            pace: [rad/s] largest joint velocity.
        """
        longest = float(np.abs(goal - start).max(initial=0.0))
        duration = max(
            PEAK_VELOCITY_RATIO * longest / pace, sqrt(PEAK_ACCELERATION_FACTOR * longest / MAX_MOVE_ACCELERATION)
        )
        return cls(sealed(start), sealed(goal), duration)

    def at(self, time: float) -> Floats:
        """Return the angles (n,) [rad] at a time [s] from the start."""
        if time >= self.duration:
            return self.goal
        u = max(0.0, time / self.duration)
        progress = u**3 * (10 - 15 * u + 6 * u**2)
        angles: Floats = self.start + progress * (self.goal - self.start)
        return angles


class Player:
    """Playback of setpoints with its own performance time."""

    def __init__(self, settings: SupervisorSettings) -> None:
        self._settings = settings
        self._buffer = GoalBuffer()
        self._move: TimedMove | None = None
        self._source: Source | None = None
        self.performances = 0  # number of performances that have begun
        self.time_scale = TimeScale()  # time of the performance
        self._move_time = TimeScale()  # time of the move

    @property
    def begun(self) -> bool:
        """Whether any command was received."""
        return len(self._buffer) > 0

    @property
    def left(self) -> float:
        """Duration [s] of buffered commands that are not performed yet."""
        return max(0.0, self._buffer.end - self.time_scale.time)  # an empty buffer ends at minus infinity

    @property
    def still(self) -> bool:
        """Whether the played motion is stopped."""
        return self._source is None or (self._move_time if self._source == "move" else self.time_scale).still

    @property
    def reached(self) -> bool:
        """Whether the current move has ended."""
        return self._move is not None and self._move_time.time >= self._move.duration - END_TOLERANCE

    def take(self, time: float, goals: Floats, leads: Floats | None = None) -> bool:
        """Accept a command, unless it is late or not finite.

        Returns whether it was accepted.

        Args:
            time: [s] performance time.
            goals: (n,) [rad] setpoints.
            leads: (n,) [rad] feed-forward of the planned velocity in them; None: zero.
        """
        if not np.isfinite(goals).all() or not (leads is None or np.isfinite(leads).all()):
            return False
        over = self.left <= END_TOLERANCE
        if not self.begun or (over and (time > self._buffer.end + NEW_PERFORMANCE_GAP or time <= self.time_scale.time)):
            self._buffer, self.time_scale = GoalBuffer(), TimeScale(time)
            self.performances += 1
        elif time <= self.time_scale.time:
            return False
        self._buffer.add(time, goals, leads)
        return True

    def hold(self) -> None:
        """Stop the performance and any move at the present setpoints."""
        self._source, self._move = None, None
        self.time_scale = TimeScale(self.time_scale.time, 0.0)

    def approach(self, start: Floats) -> None:
        """Begin a move from angles (n,) [rad] to the performance's current point."""
        self._go(start, self._buffer.at_scale(self.time_scale.time, 0.0))

    def fold(self, start: Floats, goal: Floats) -> None:
        """Begin a move from angles (n,) [rad] to goal angles (n,) [rad]."""
        self._go(start, goal)

    def _go(self, start: Floats, goal: Floats) -> None:
        self.hold()
        self._move = TimedMove.between(start, goal, pace=self._settings.pace)
        self._source, self._move_time = "move", TimeScale(0.0, 1.0)

    def follow(self) -> None:
        """Start or resume the playback of the buffered setpoints.

        It starts at full rate at the first command, where the robot rests, and gradually when it resumes.
        """
        fresh = self.time_scale.time <= self._buffer.begin
        self._source, self._move = "performance", None
        self.time_scale = TimeScale(self.time_scale.time, 1.0 if fresh else 0.0)

    def advance(self, seconds: float, *, target: float, slow: float) -> Floats | None:
        """Advance time by one step, and return the new setpoints.

        Args:
            seconds: [s] duration of the step.
            target: time scale, 0..1.
            slow: [s] in which time decelerates to a stop.

        Returns:
            (n,) [rad]; None: unchanged.
        """
        if self._source == "move" and self._move is not None:
            self._move_time = advance_time(self._move_time, seconds, target=target, end=self._move.duration, slow=slow)
            return self._move.at(self._move_time.time)
        if self._source == "performance":
            self.time_scale = advance_time(self.time_scale, seconds, target=target, end=self._buffer.end, slow=slow)
            self._buffer.forget(self.time_scale.time)
            return self._buffer.at_scale(self.time_scale.time, self.time_scale.scale)
        return None
