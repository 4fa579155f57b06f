"""Physics protocol for the shafts of virtual servos, with first-order motors."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, exp, inf, pi
from typing import Literal, NamedTuple, Protocol

from kinesic.body.servo import FULL_DUTY_PWM, TICKS_PER_RADIAN, ServoModel

MAX_STEP = 0.01  # [s] longest time step, since set points are held during a step

DemandKind = Literal["limp", "angle", "speed", "current", "duty"]


class Demand(NamedTuple):
    """Motor command of a servo's electronics until the next time step."""

    kind: DemandKind
    value: float = 0.0  # by kind: [rad], [rad/s], current / stall current -1..1, or duty -1..1
    cap: float = 1.0  # duty limit 0..1


class Shaft(NamedTuple):
    """State of an output shaft, as the servo's sensors measure it."""

    angle: float  # [rad] angle of the output shaft, multi-turn
    speed: float = 0.0  # [rad/s] velocity of the output shaft
    duty: float = 0.0  # PWM duty -1..1
    load: float = 0.0  # motor current / stall current, signed


NO_TORQUE = Demand("limp")  # Motor command of a servo with torque off


class Physics(Protocol):
    """Interface of a simulation of shafts, always in the same order."""

    max_step: float  # [s] largest accurate time step

    def shafts(self) -> Sequence[Shaft]:
        """Return the present state of the shafts."""

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Advance time by at most `max_step` under constant motor commands."""


@dataclass(frozen=True)
class Motor:
    """Motor model without inertia, with proportional position control.

    velocity = no_load (duty - load); duty = gain * error, clipped to the cap.
    """

    no_load: float = 8.0  # [rad/s] no-load velocity
    gain: float = 4.6  # [1/rad] duty per position error

    @classmethod
    def of(cls, model: ServoModel) -> "Motor":
        """Make the motor of a data sheet, with its factory position gain."""
        gain = model.p_gain / model.kp_divisor * TICKS_PER_RADIAN / FULL_DUTY_PWM
        return cls(no_load=model.no_load_rpm * 2 * pi / 60, gain=gain)

    def advance_error(self, error: float, seconds: float, *, cap: float, load: float) -> float:
        """Return the exact position error [rad] after some time.

        Args:
            error: [rad] goal minus angle.
            seconds: [s] elapsed time.
            cap: largest duty, 0..1.
            load: load torque / stall torque; positive pulls the angle down.
        """
        edge = cap / self.gain  # [rad] error at which the duty saturates
        if abs(error) > edge:
            speed = self.no_load * (copysign(cap, error) - load)
            reaches = (error - copysign(edge, error)) / speed if speed * error > 0.0 else inf
            if reaches >= seconds:
                return error - speed * seconds
            error, seconds = copysign(edge, error), seconds - reaches
        settled = load / self.gain
        return settled + (error - settled) * exp(-seconds * self.gain * self.no_load)


class FirstOrder:
    """Physics of independent first-order motors, one per shaft.

    Loads and jams are attributes, which may change between two steps.
    """

    max_step = MAX_STEP

    def __init__(self, motors: Sequence[Motor], angles: Sequence[float]) -> None:
        """Start all motors at rest, at the given shaft angles.

        Args:
            motors: one per servo.
            angles: [rad] of their shafts.

        Raises:
            ValueError: the numbers of angles and motors differ.
        """
        if len(motors) != len(angles):
            raise ValueError(f"{len(angles)} angles for {len(motors)} motors; the numbers must be equal")
        self._motors = tuple(motors)
        self._shafts = [Shaft(angle) for angle in angles]
        self.loads = [0.0] * len(motors)  # load torque / stall torque of each shaft
        self.jammed = [False] * len(motors)  # blocked shafts

    def shafts(self) -> Sequence[Shaft]:
        """Return the present state of the shafts."""
        return self._shafts

    def turn(self, index: int, angle: float) -> None:
        """Set the angle [rad] of a shaft.

        It simulates a hand that turns the shaft.
        """
        self._shafts[index] = Shaft(angle)

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Advance time under constant motor commands."""
        if seconds <= 0.0:
            return
        moved = zip(self._motors, self._shafts, demands, self.loads, self.jammed, strict=True)
        self._shafts = [_moved(motor, shaft, demand, seconds, load, jam) for motor, shaft, demand, load, jam in moved]


def _moved(motor: Motor, shaft: Shaft, demand: Demand, seconds: float, load: float, jammed: bool) -> Shaft:
    if demand.kind == "limp":
        return Shaft(shaft.angle)  # gear friction holds a servo without torque
    if jammed:
        duty = _duty(motor, shaft, demand, load)
        return Shaft(shaft.angle, 0.0, duty, duty)
    if demand.kind == "angle":
        error = motor.advance_error(demand.value - shaft.angle, seconds, cap=demand.cap, load=load)
        angle = demand.value - error
        duty = _clipped(motor.gain * error, demand.cap)
        return Shaft(angle, (angle - shaft.angle) / seconds, duty, load)
    duty = _duty(motor, shaft, demand, load)
    speed = motor.no_load * (duty - load)
    return Shaft(shaft.angle + speed * seconds, speed, duty, load)


def _duty(motor: Motor, shaft: Shaft, demand: Demand, load: float) -> float:
    """Compute the motor's duty cycle from a servo's motor command.

    The current loop treats the load as friction.
    """
    if demand.kind == "angle":
        duty = motor.gain * (demand.value - shaft.angle)
    elif demand.kind == "speed":
        duty = demand.value / motor.no_load + load
    elif demand.kind == "current":
        duty = demand.value + shaft.speed / motor.no_load
    else:
        duty = demand.value
    return _clipped(duty, demand.cap)


def _clipped(value: float, cap: float) -> float:
    return max(-cap, min(cap, value))
