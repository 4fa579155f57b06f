"""Shafts with inertia, friction, motor and gravity load."""

from dataclasses import dataclass
from math import pi, sin

from .table import Model

TICKS = 4096 / (2 * pi)  # [1/rad]
MIDDLE = 2048  # [ticks] where a shaft's angle is 0
FRICTION = 0.004  # of the stall torque
GEARS = 0.1  # of the motor's braking that is left without power


@dataclass
class Shaft:
    """Output shaft of a servo with its load."""

    model: Model
    angle: float = 0.0  # [rad]
    speed: float = 0.0  # [rad/s]
    pull: float = 0.0  # [Nm] from outside
    jammed: bool = False
    share: float = 0.0  # of the motor's stall torque, with sign

    @property
    def ticks(self) -> float:
        """Return the encoder position [ticks] with turns counted."""
        return self.angle * TICKS + MIDDLE

    def step(self, seconds: float, duty: float | None, volts: float) -> None:
        """Advance the shaft by one time step.

        The motor duty is in -1..1; None means no power.
        """
        model = self.model
        if self.jammed:
            self.speed, self.share = 0.0, duty or 0.0
            return
        spin = self.speed / model.no_load
        self.share = 0.0 if duty is None else duty * volts / model.rated - spin
        torque = model.stall * (self.share if duty is not None else -GEARS * spin) + self.pull
        rub = FRICTION * model.stall
        if self.speed == 0.0 and abs(torque) <= rub:
            return
        way = self.speed or torque
        speed = self.speed + (torque - (rub if way > 0 else -rub)) / model.inertia * seconds
        self.speed = 0.0 if speed * way < 0 else speed
        self.angle += self.speed * seconds


@dataclass(frozen=True)
class Link:
    """Link of an arm, turned by one shaft."""

    shaft: Shaft
    hang: float  # [rad] of the shaft where it hangs straight down
    turns: float  # signed turns of the shaft per turn of the joint
    pull: float  # [Nm] of its weight where it is level


@dataclass
class Arm:
    """Serial links in one vertical plane."""

    links: tuple[Link, ...]

    def pull(self) -> None:
        """Apply the links' weight as torque on their shafts."""
        lean, weights = 0.0, []
        for link in self.links:
            lean += (link.shaft.angle - link.hang) / link.turns
            weights.append(link.pull * sin(lean))
        carried = 0.0
        for link, weight in zip(reversed(self.links), reversed(weights), strict=True):
            carried += weight
            link.shaft.pull = -carried / link.turns
