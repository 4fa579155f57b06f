"""How a servo's set point travels to a new goal: the four profiles of the X series."""

from dataclasses import dataclass
from math import copysign, inf, sqrt
from typing import Literal

Form = Literal["step", "rectangle", "triangle", "trapezoid"]


@dataclass(frozen=True)
class Profile:
    """Three stretches of constant acceleration from where the set point was to the goal, where it rests."""

    start: float  # [rad]
    goal: float  # [rad]
    speed: float  # [rad/s] at the start
    cruise: float  # [rad/s] signed, of the middle stretch
    spans: tuple[float, float, float]  # [s] of speeding up, cruising, braking
    form: Form

    @property
    def duration(self) -> float:
        """[s]."""
        return sum(self.spans)

    def at(self, time: float) -> tuple[float, float]:
        """Set point [rad] and its speed [rad/s] at a time [s] from the start."""
        if time >= self.duration:
            return self.goal, 0.0
        rise, flat, fall = self.spans
        if time < rise:
            return self._eased(self.start, self.speed, self.cruise, rise, time)
        place = self.start + (self.speed + self.cruise) / 2 * rise
        if time < rise + flat:
            return place + self.cruise * (time - rise), self.cruise
        return self._eased(place + self.cruise * flat, self.cruise, 0.0, fall, time - rise - flat)

    @staticmethod
    def _eased(place: float, before: float, after: float, span: float, time: float) -> tuple[float, float]:
        """While the speed changes evenly from one value to another."""
        speed = before + (after - before) * time / span
        return place + (before + speed) / 2 * time, speed


def still_profile(place: float) -> Profile:
    """No motion at all."""
    return Profile(place, place, 0.0, 0.0, (0.0, 0.0, 0.0), "step")


def by_speed(start: float, speed: float, goal: float, *, limit: float, acceleration: float) -> Profile:
    """The velocity-based profile.

    Args:
        start: set point [rad].
        speed: of the set point [rad/s].
        goal: [rad].
        limit: largest speed [rad/s]; infinite: a step.
        acceleration: largest [rad/s^2]; infinite: a rectangle.
    """
    if limit == inf or (start == goal and speed == 0.0):
        return Profile(start, goal, 0.0, 0.0, (0.0, 0.0, 0.0), "step")
    if acceleration == inf:
        cruise = copysign(limit, goal - start)
        return Profile(start, goal, cruise, cruise, (0.0, abs(goal - start) / limit, 0.0), "rectangle")
    stops = start + speed * abs(speed) / (2 * acceleration)  # where braking at once would end
    way = copysign(1.0, goal - stops)
    along = speed * way
    peak = sqrt(max(acceleration * (goal - start) * way + along**2 / 2, 0.0))
    cruise = min(limit, peak)
    rise, fall = abs(cruise - along) / acceleration, cruise / acceleration
    left = (goal - start) * way - (along + cruise) / 2 * rise - cruise / 2 * fall
    flat = max(left, 0.0) / cruise if cruise > 0.0 else 0.0
    form: Form = "trapezoid" if peak >= limit else "triangle"
    return Profile(start, goal, speed, way * cruise, (rise, flat, fall), form)


def by_time(start: float, goal: float, *, duration: float, rise: float) -> Profile:
    """The time-based profile: how long it takes, and how long it speeds up, at most half of that.

    Args:
        start: set point [rad].
        goal: [rad].
        duration: [s]; zero: a step.
        rise: [s]; zero: a rectangle.
    """
    if duration <= 0.0:
        return Profile(start, goal, 0.0, 0.0, (0.0, 0.0, 0.0), "step")
    rise = min(rise, duration / 2)
    cruise = (goal - start) / (duration - rise)
    if rise <= 0.0:
        return Profile(start, goal, cruise, cruise, (0.0, duration, 0.0), "rectangle")
    form: Form = "triangle" if rise >= duration / 2 else "trapezoid"
    return Profile(start, goal, 0.0, cruise, (rise, duration - 2 * rise, rise), form)
