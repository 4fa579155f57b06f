"""Turns the shafts of virtual servos: a protocol for physics, and motors of the first order that follow it."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, exp, inf, pi
from typing import Literal, NamedTuple, Protocol

from kinesic.body.servo import DUTY_FULL, TICKS_PER_RADIAN, ServoModel

LONGEST = 0.01  # [s] step of motors whose law is integrated exactly: only the way of a profile is sampled

DemandKind = Literal["limp", "angle", "speed", "current", "duty"]


class Demand(NamedTuple):
    """What a servo's electronics ask of its motor until the next step."""

    kind: DemandKind
    value: float = 0.0  # [rad], [rad/s], share of the stall current -1..1, or duty -1..1
    cap: float = 1.0  # largest duty 0..1


class Shaft(NamedTuple):
    """What a servo's sensors feel."""

    angle: float  # [rad] of the output shaft, over all turns
    speed: float = 0.0  # [rad/s]
    duty: float = 0.0  # -1..1 of the bridge
    load: float = 0.0  # motor current over stall current, signed


LIMP = Demand("limp")


class Physics(Protocol):
    """The shafts of several servos, always in the same order."""

    longest: float  # [s] step that keeps it accurate

    def shafts(self) -> Sequence[Shaft]:
        """Returns the shafts as they are now."""

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Moves time on by at most `longest` under constant demands."""


@dataclass(frozen=True)
class Motor:
    """A motor without inertia: speed = no_load (duty - load), duty = gain error clipped to the cap."""

    no_load: float = 8.0  # [rad/s]
    gain: float = 4.6  # duty per error [1/rad]

    @classmethod
    def of(cls, model: ServoModel) -> "Motor":
        """Makes the motor of a servo's data sheet, with its factory position gain."""
        gain = model.p_gain / model.kp_divisor * TICKS_PER_RADIAN / DUTY_FULL
        return cls(no_load=model.no_load_rpm * 2 * pi / 60, gain=gain)

    def towards(self, error: float, seconds: float, *, cap: float, load: float) -> float:
        """Returns the position error [rad] that is left after a time, exactly.

        Args:
            error: goal minus angle [rad].
            seconds: how long.
            cap: largest duty, 0..1.
            load: that the shaft carries, as a share of the stall torque; positive pulls the angle down.
        """
        edge = cap / self.gain  # [rad] of error at which the duty saturates
        if abs(error) > edge:
            speed = self.no_load * (copysign(cap, error) - load)
            reaches = (error - copysign(edge, error)) / speed if speed * error > 0.0 else inf
            if reaches >= seconds:
                return error - speed * seconds
            error, seconds = copysign(edge, error), seconds - reaches
        settled = load / self.gain
        return settled + (error - settled) * exp(-seconds * self.gain * self.no_load)


class FirstOrder:
    """Independent motors of the first order. Loads and jams are attributes: they may change between two steps."""

    longest = LONGEST

    def __init__(self, motors: Sequence[Motor], angles: Sequence[float]) -> None:
        """Stands still.

        Args:
            motors: one per servo.
            angles: [rad] of their shafts.

        Raises:
            ValueError: there are not as many angles as motors.
        """
        if len(motors) != len(angles):
            raise ValueError(f"{len(angles)} angles for {len(motors)} motors, must be as many")
        self._motors = tuple(motors)
        self._shafts = [Shaft(angle) for angle in angles]
        self.loads = [0.0] * len(motors)  # share of the stall torque that each shaft carries
        self.jammed = [False] * len(motors)  # shafts that something blocks

    def shafts(self) -> Sequence[Shaft]:
        """Returns the shafts as they are now."""
        return self._shafts

    def turn(self, index: int, angle: float) -> None:
        """Sets a shaft [rad], as a hand would that turns it."""
        self._shafts[index] = Shaft(angle)

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Moves time on under constant demands."""
        if seconds <= 0.0:
            return
        moved = zip(self._motors, self._shafts, demands, self.loads, self.jammed, strict=True)
        self._shafts = [_moved(motor, shaft, demand, seconds, load, jam) for motor, shaft, demand, load, jam in moved]


def _moved(motor: Motor, shaft: Shaft, demand: Demand, seconds: float, load: float, jammed: bool) -> Shaft:
    if demand.kind == "limp":
        return Shaft(shaft.angle)  # gears hold a limp servo still
    if jammed:
        duty = _duty(motor, shaft, demand, load)
        return Shaft(shaft.angle, 0.0, duty, duty)
    if demand.kind == "angle":
        error = motor.towards(demand.value - shaft.angle, seconds, cap=demand.cap, load=load)
        angle = demand.value - error
        duty = _clipped(motor.gain * error, demand.cap)
        return Shaft(angle, (angle - shaft.angle) / seconds, duty, load)
    duty = _duty(motor, shaft, demand, load)
    speed = motor.no_load * (duty - load)
    return Shaft(shaft.angle + speed * seconds, speed, duty, load)


def _duty(motor: Motor, shaft: Shaft, demand: Demand, load: float) -> float:
    """The duty that answers a demand; the current's loop sees the load as friction."""
    if demand.kind == "angle":
        wanted = motor.gain * (demand.value - shaft.angle)
    elif demand.kind == "speed":
        wanted = demand.value / motor.no_load + load
    elif demand.kind == "current":
        wanted = demand.value + shaft.speed / motor.no_load
    else:
        wanted = demand.value
    return _clipped(wanted, demand.cap)


def _clipped(value: float, cap: float) -> float:
    return max(-cap, min(cap, value))
