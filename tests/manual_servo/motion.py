"""Set point profiles of the X series, and position control."""

from dataclasses import dataclass
from math import copysign, inf, sqrt

VELOCITY_UNIT = 0.229 * 4096 / 60  # [ticks/s] velocity per register count
ACCELERATION_UNIT = 214.577 * 4096 / 3600  # [ticks/s^2] acceleration per register count


@dataclass
class Profile:
    """Set point and its profile towards a goal."""

    place: float = 0.0  # [ticks] position
    speed: float = 0.0  # [ticks/s] velocity
    goal: float = 0.0
    fastest: float = inf
    acceleration: float = inf

    def stand(self, place: float) -> None:
        """Stop at a position [ticks]."""
        self.place = self.goal = place
        self.speed = 0.0

    def head(self, goal: float, speed: int, acceleration: int, timed: bool) -> None:
        """Start a profile to a goal with values of the profile registers.

        With `timed`, the registers are times [ms].
        """
        self.goal = goal
        if not timed:
            self.fastest = speed * VELOCITY_UNIT or inf
            self.acceleration = acceleration * ACCELERATION_UNIT or inf
            return
        seconds, rising = speed / 1000, min(acceleration, speed / 2) / 1000
        self.fastest = abs(goal - self.place) / (seconds - rising) if seconds else inf
        self.acceleration = self.fastest / rising if rising else inf

    def step(self, seconds: float) -> float:
        """Advance the set point by one time step and return it."""
        away = self.goal - self.place
        if not away and not self.speed:
            return self.place
        fastest = self.fastest
        if self.acceleration < inf:
            fastest = min(fastest, sqrt(2 * self.acceleration * abs(away)))
        wish = copysign(min(fastest, abs(away) / seconds), away)
        change = self.acceleration * seconds
        self.speed = max(self.speed - change, min(self.speed + change, wish))
        self.place += self.speed * seconds
        if abs(self.goal - self.place) < 1e-6:
            self.place, self.speed = self.goal, 0.0
        return self.place


@dataclass
class Pid:
    """Position control at 1 kHz on the error in ticks.

    P / 128, I / 65536 and D / 16; the result is a PWM count.
    """

    total: float = 0.0
    before: float = 0.0

    def step(self, error: float, gains: tuple[int, int, int], limit: float) -> float:
        """Return the PWM for an error."""
        p, i, d = gains
        self.total += error if i else 0.0
        slope, self.before = error - self.before, error
        wish = p / 128 * error + i / 65536 * self.total + d / 16 * slope
        return max(-limit, min(limit, wish))

    def rest(self) -> None:
        """Reset integral and last error."""
        self.total = self.before = 0.0
