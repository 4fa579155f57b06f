"""Shafts with inertia, friction, motor and gravity load."""

from dataclasses import dataclass
from math import pi, sin

from .table import Model

TICKS_PER_RADIAN = 4096 / (2 * pi)  # [1/rad]
MID_TICKS = 2048  # [ticks] encoder position at shaft angle 0
FRICTION_RATIO = 0.004  # friction torque / stall torque
UNPOWERED_BRAKING = 0.1  # braking torque without power / braking torque with power, at equal velocity


@dataclass
class Shaft:
    """Output shaft of a servo with its load."""

    model: Model
    angle: float = 0.0  # [rad]
    speed: float = 0.0  # [rad/s]
    pull: float = 0.0  # [Nm] external torque
    jammed: bool = False
    share: float = 0.0  # motor torque / stall torque, with sign

    @property
    def ticks(self) -> float:
        """Return the encoder position [ticks] with turns counted."""
        return self.angle * TICKS_PER_RADIAN + MID_TICKS

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
        torque = model.stall * (self.share if duty is not None else -UNPOWERED_BRAKING * spin) + self.pull
        rub = FRICTION_RATIO * model.stall
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
    hang: float  # [rad] shaft angle at which the link hangs straight down
    turns: float  # signed turns of the shaft per turn of the joint
    pull: float  # [Nm] gravity torque of the horizontal link


@dataclass
class Arm:
    """Serial links in one vertical plane."""

    links: tuple[Link, ...]

    def pull(self) -> None:
        """Apply the weight of the links as torques on their shafts."""
        lean, weights = 0.0, []
        for link in self.links:
            lean += (link.shaft.angle - link.hang) / link.turns
            weights.append(link.pull * sin(lean))
        carried = 0.0
        for link, weight in zip(reversed(self.links), reversed(weights), strict=True):
            carried += weight
            link.shaft.pull = -carried / link.turns
