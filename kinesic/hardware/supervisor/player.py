"""Plays goals in performance time: the performance, a move to where it begins, or a move to rest."""

from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.supervisor.goal_buffer import GoalBuffer, are_numbers
from kinesic.hardware.supervisor.settings import SupervisorSettings

PEAK = 15 / 8  # peak over mean speed of the minimum-jerk curve
LEAST = 0.3  # [s]
GAP = 0.5  # [s] between commands beyond which the later ones are a performance of their own
DONE = 1e-6  # [s] before the end that is the end

Source = Literal["score", "way"]


@dataclass(frozen=True)
class TimeScale:
    """Where time is, and how fast it runs."""

    time: float = 0.0  # [s]
    scale: float = 0.0  # seconds of it per second

    @property
    def still(self) -> bool:
        """Whether it stands."""
        return self.scale <= 0.0


def advance_time(tempo: TimeScale, seconds: float, *, wanted: float, end: float, slow: float) -> TimeScale:
    """Time a moment later: its scale changes evenly, and it comes to a stop at the end of what is known.

    Args:
        tempo: now.
        seconds: that pass.
        wanted: scale, 0..1.
        end: [s] beyond which time cannot run.
        slow: [s] from full speed to a stop, and back.
    """
    left = max(0.0, end - tempo.time)
    # the scale from which, after this moment, it can still stop evenly: scale^2 * slow / 2 is the way that this takes
    after = max(0.0, left - tempo.scale * seconds / 2)
    allowed = min(wanted, 1.0, (sqrt(seconds**2 / 4 + 2 * slow * after) - seconds / 2) / slow)
    change = seconds / slow
    scale = max(0.0, tempo.scale - change, min(allowed, tempo.scale + change))
    way = (tempo.scale + scale) / 2 * seconds
    return TimeScale(tempo.time + left, 0.0) if way >= left else TimeScale(tempo.time + way, scale)


@dataclass(frozen=True, eq=False)
class TimedMove:
    """Minimum jerk from rest to rest (Flash and Hogan, 1985)."""

    start: Floats  # (n,) [rad]
    goal: Floats  # (n,) [rad]
    duration: float  # [s]

    @classmethod
    def between(cls, start: Floats, goal: Floats, *, pace: float) -> "TimedMove":
        """A way on which no joint is faster than a pace [rad/s]; of no duration between equal postures."""
        longest = float(np.abs(goal - start).max(initial=0.0))
        duration = 0.0 if longest < 1e-9 else max(LEAST, PEAK * longest / pace)
        return cls(sealed(start), sealed(goal), duration)

    def at(self, time: float) -> Floats:
        """(n,) [rad] at a time [s] from its start."""
        if time >= self.duration:
            return self.goal
        u = max(0.0, time / self.duration)
        share = u**3 * (10 - 15 * u + 6 * u**2)
        there: Floats = self.start + share * (self.goal - self.start)
        return there


class Player:
    """Goals as a function of performance time, which it owns."""

    def __init__(self, settings: SupervisorSettings) -> None:
        """Nothing to play yet."""
        self._settings = settings
        self._score = GoalBuffer()
        self._way: TimedMove | None = None
        self._source: Source | None = None
        self.tempo = TimeScale()  # of the performance
        self._walk = TimeScale()  # of the way

    @property
    def begun(self) -> bool:
        """Whether there is, or was, something to perform."""
        return len(self._score) > 0

    @property
    def left(self) -> float:
        """[s] of performance that are known and not performed."""
        return max(0.0, self._score.end - self.tempo.time)  # it ends at minus infinity while there is none

    @property
    def still(self) -> bool:
        """Whether nothing moves."""
        return self._source is None or (self._walk if self._source == "way" else self.tempo).still

    @property
    def reached(self) -> bool:
        """Whether the present move has ended."""
        return self._way is not None and self._walk.time >= self._way.duration - DONE

    def take(self, time: float, goals: Floats) -> bool:
        """One more command; whether it came in time and makes sense.

        Args:
            time: [s] of the performance.
            goals: (n,) [rad].
        """
        if not are_numbers(goals):
            return False
        over = self.left <= DONE
        if not self.begun or (over and (time > self._score.end + GAP or time <= self.tempo.time)):
            self._score, self.tempo = GoalBuffer(), TimeScale(time)
        elif time <= self.tempo.time:
            return False
        self._score.add(time, goals)
        return True

    def hold(self) -> None:
        """Stands still from now on."""
        self._source, self._way = None, None
        self.tempo = TimeScale(self.tempo.time, 0.0)

    def approach(self, start: Floats) -> None:
        """To where the performance begins, or goes on, from (n,) [rad]."""
        self._go(start, self._score.at(self.tempo.time))

    def fold(self, start: Floats, goal: Floats) -> None:
        """From (n,) [rad] to (n,) [rad]."""
        self._go(start, goal)

    def _go(self, start: Floats, goal: Floats) -> None:
        self.hold()
        self._way = TimedMove.between(start, goal, pace=self._settings.pace)
        self._source, self._walk = "way", TimeScale(0.0, 1.0)

    def follow(self) -> None:
        """Performance time runs: at once from the first command, which is at rest; softly when it goes on."""
        fresh = self.tempo.time <= self._score.begin
        self._source, self._way = "score", None
        self.tempo = TimeScale(self.tempo.time, 1.0 if fresh else 0.0)

    def advance(self, seconds: float, *, wanted: float, slow: float) -> Floats | None:
        """Lets time pass.

        Args:
            seconds: that pass.
            wanted: scale of time, 0..1.
            slow: [s] in which it comes to a stop.

        Returns:
            (n,) [rad] to go to now; None: where it is.
        """
        if self._source == "way" and self._way is not None:
            self._walk = advance_time(self._walk, seconds, wanted=wanted, end=self._way.duration, slow=slow)
            return self._way.at(self._walk.time)
        if self._source == "score":
            self.tempo = advance_time(self.tempo, seconds, wanted=wanted, end=self._score.end, slow=slow)
            self._score.forget(self.tempo.time)
            return self._score.at(self.tempo.time)
        return None
