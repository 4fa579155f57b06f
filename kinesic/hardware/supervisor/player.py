"""Plays goals in performance time: the performance, a move to where it begins, or a move to rest."""

from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.supervisor.goal_buffer import GoalBuffer
from kinesic.hardware.supervisor.settings import SupervisorSettings

PEAK = 15 / 8  # peak over mean speed of the minimum-jerk curve
THRUST = 10 / sqrt(3)  # its peak acceleration over way / duration^2
GENTLE = 7.0  # [rad/s^2] that no move which nobody has planned exceeds
GAP = 0.5  # [s] between commands beyond which the later ones are a performance of their own
DONE = 1e-6  # [s] before the end that is the end

Source = Literal["performance", "move"]


@dataclass(frozen=True)
class TimeScale:
    """Where performance time is, and how fast it runs."""

    time: float = 0.0  # [s]
    scale: float = 0.0  # seconds of it per second

    @property
    def still(self) -> bool:
        """Whether it stands."""
        return self.scale <= 0.0


def advance_time(time_scale: TimeScale, seconds: float, *, target: float, end: float, slow: float) -> TimeScale:
    """Advances time by a moment: its scale changes evenly, and it comes to a stop at the end of what is known.

    Args:
        time_scale: now.
        seconds: that pass.
        target: scale, 0..1.
        end: [s] beyond which time cannot run.
        slow: [s] from full speed to a stop, and back.
    """
    left = max(0.0, end - time_scale.time)
    # the scale from which, after this moment, it can still stop evenly: scale^2 * slow / 2 is the way that this takes
    after = max(0.0, left - time_scale.scale * seconds / 2)
    allowed = min(target, 1.0, (sqrt(seconds**2 / 4 + 2 * slow * after) - seconds / 2) / slow)
    change = seconds / slow
    scale = max(0.0, time_scale.scale - change, min(allowed, time_scale.scale + change))
    path = (time_scale.scale + scale) / 2 * seconds
    return TimeScale(time_scale.time + left, 0.0) if path >= left else TimeScale(time_scale.time + path, scale)


@dataclass(frozen=True, eq=False)
class TimedMove:
    """A minimum-jerk move of all joints from rest to rest, made without a planner (Flash and Hogan, 1985)."""

    start: Floats  # (n,) [rad]
    goal: Floats  # (n,) [rad]
    duration: float  # [s]

    @classmethod
    def between(cls, start: Floats, goal: Floats, *, pace: float) -> "TimedMove":
        """Makes a gentle move in which no joint is faster than a pace [rad/s]; equal postures take no time."""
        longest = float(np.abs(goal - start).max(initial=0.0))
        duration = max(PEAK * longest / pace, sqrt(THRUST * longest / GENTLE))
        return cls(sealed(start), sealed(goal), duration)

    def at(self, time: float) -> Floats:
        """Returns (n,) [rad] at a time [s] from its start."""
        if time >= self.duration:
            return self.goal
        u = max(0.0, time / self.duration)
        share = u**3 * (10 - 15 * u + 6 * u**2)
        there: Floats = self.start + share * (self.goal - self.start)
        return there


class Player:
    """Plays goals as a function of performance time, which it owns."""

    def __init__(self, settings: SupervisorSettings) -> None:
        self._settings = settings
        self._buffer = GoalBuffer()
        self._move: TimedMove | None = None
        self._source: Source | None = None
        self.performances = 0  # that have begun
        self.time_scale = TimeScale()  # of the performance
        self._move_time = TimeScale()  # of the way

    @property
    def begun(self) -> bool:
        """Whether there is, or was, something to perform."""
        return len(self._buffer) > 0

    @property
    def left(self) -> float:
        """[s] of performance that are known and not performed."""
        return max(0.0, self._buffer.end - self.time_scale.time)  # it ends at minus infinity while there is none

    @property
    def still(self) -> bool:
        """Whether nothing moves."""
        return self._source is None or (self._move_time if self._source == "move" else self.time_scale).still

    @property
    def reached(self) -> bool:
        """Whether the present move has ended."""
        return self._move is not None and self._move_time.time >= self._move.duration - DONE

    def take(self, time: float, goals: Floats, leads: Floats | None = None) -> bool:
        """Takes a command, and returns whether it came in time and makes sense.

        Args:
            time: [s] of the performance.
            goals: (n,) [rad].
            leads: (n,) [rad] part of them that carries the planned speed; None: nothing.
        """
        if not np.isfinite(goals).all() or not (leads is None or np.isfinite(leads).all()):
            return False
        over = self.left <= DONE
        if not self.begun or (over and (time > self._buffer.end + GAP or time <= self.time_scale.time)):
            self._buffer, self.time_scale = GoalBuffer(), TimeScale(time)
            self.performances += 1
        elif time <= self.time_scale.time:
            return False
        self._buffer.add(time, goals, leads)
        return True

    def hold(self) -> None:
        """Stands still from now on."""
        self._source, self._move = None, None
        self.time_scale = TimeScale(self.time_scale.time, 0.0)

    def approach(self, start: Floats) -> None:
        """Moves from (n,) [rad] to where the performance begins, or goes on."""
        self._go(start, self._buffer.slowed(self.time_scale.time, 0.0))

    def fold(self, start: Floats, goal: Floats) -> None:
        """Moves from (n,) [rad] to (n,) [rad]."""
        self._go(start, goal)

    def _go(self, start: Floats, goal: Floats) -> None:
        self.hold()
        self._move = TimedMove.between(start, goal, pace=self._settings.pace)
        self._source, self._move_time = "move", TimeScale(0.0, 1.0)

    def follow(self) -> None:
        """Starts performance time: at full rate from the first command, which is at rest; gradually on resuming."""
        fresh = self.time_scale.time <= self._buffer.begin
        self._source, self._move = "performance", None
        self.time_scale = TimeScale(self.time_scale.time, 1.0 if fresh else 0.0)

    def advance(self, seconds: float, *, target: float, slow: float) -> Floats | None:
        """Lets time pass.

        Args:
            seconds: that pass.
            target: scale of time, 0..1.
            slow: [s] in which it comes to a stop.

        Returns:
            (n,) [rad] to go to now; None: where it is.
        """
        if self._source == "move" and self._move is not None:
            self._move_time = advance_time(self._move_time, seconds, target=target, end=self._move.duration, slow=slow)
            return self._move.at(self._move_time.time)
        if self._source == "performance":
            self.time_scale = advance_time(self.time_scale, seconds, target=target, end=self._buffer.end, slow=slow)
            self._buffer.forget(self.time_scale.time)
            return self._buffer.slowed(self.time_scale.time, self.time_scale.scale)
        return None
