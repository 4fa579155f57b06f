"""Servos as data: a model's figures at 12 V, a drive, the servo as its hinge feels it, and all drives of a robot."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi

from kinesic.body.arrays import Floats, sealed

TICKS_PER_TURN = 4096
DUTY_FULL = 885  # PWM register value of full duty
TICKS_PER_RADIAN = TICKS_PER_TURN / (2 * pi)
SPEED_SHARE = 0.8  # of the no-load speed that a plan may use


@dataclass(frozen=True)
class ServoModel:
    """One row of `configs/servos.toml`, at the servo's own output shaft."""

    name: str
    model: int  # model number on the wire
    volt: float
    stall_nm: float
    stall_a: float
    no_load_rpm: float
    gear: float
    mass: float  # [kg]
    size: tuple[float, float, float]  # [m]
    p_gain: float  # factory position P gain
    d_gain: float
    kp_divisor: float
    armature: float  # [kg m^2]
    frictionloss: float  # [Nm]
    damping: float  # [Nm s/rad]
    idle_a: float = 0.0  # [A] of the electronics alone
    thermal: tuple[float, float] | None = None  # [K/W] winding to surroundings, [J/K] of the winding; None: not known
    price_usd: float | None = None  # of one piece; None: not known


@dataclass(frozen=True)
class Drive:
    """Servo, tandem count and reduction together, at the hinge.

    The servo is a PWM position controller: duty = clip(gain * error, -1, 1) and
    torque = stall * duty - (stall / no_load) * speed.
    """

    servo: ServoModel
    count: int
    reduction: float  # servo turns per hinge turn
    speed_share: float = SPEED_SHARE  # of the no-load speed that a plan may use

    @property
    def stall(self) -> float:
        """Stall torque [Nm]."""
        return self.servo.stall_nm * self.count * self.reduction

    @property
    def no_load(self) -> float:
        """No-load speed [rad/s]."""
        return self.servo.no_load_rpm * 2 * pi / 60 / self.reduction

    @property
    def speed(self) -> float:
        """Speed that a plan may use [rad/s]."""
        return self.speed_share * self.no_load

    @property
    def gain(self) -> float:
        """Duty per radian of hinge error, g = P / divisor * (4096 / 2 pi) / 885 [1/rad]."""
        return self.servo.p_gain / self.servo.kp_divisor * TICKS_PER_RADIAN / DUTY_FULL * self.reduction

    @property
    def rate_gain(self) -> float:
        """Torque of the D term per hinge speed, at a 1 kHz loop [Nm s/rad]."""
        return self.stall * self.servo.d_gain / 16 * TICKS_PER_RADIAN / DUTY_FULL / 1000 * self.reduction

    @property
    def armature(self) -> float:
        """Reflected rotor inertia [kg m^2]."""
        return self.servo.armature * self.count * self.reduction**2

    @property
    def frictionloss(self) -> float:
        """Coulomb friction [Nm]."""
        return self.servo.frictionloss * self.count * self.reduction

    @property
    def damping(self) -> float:
        """Viscous friction [Nm s/rad]."""
        return self.servo.damping * self.count * self.reduction**2

    @property
    def tick(self) -> float:
        """Smallest step of the hinge's goal [rad]."""
        return 2 * pi / TICKS_PER_TURN / self.reduction


def _row(figure: Callable[[Drive], float]) -> "cached_property[Floats]":
    """A read-only array (n,) of one figure, made when it is first asked for."""
    return cached_property(lambda drives: sealed([figure(drive) for drive in drives]))


class Drives(tuple[Drive, ...]):
    """The drives of a robot in joint order, and each of their figures as a read-only array (n,)."""

    stall = _row(lambda drive: drive.stall)  # [Nm]
    no_load = _row(lambda drive: drive.no_load)  # [rad/s]
    speed = _row(lambda drive: drive.speed)  # [rad/s] that a plan may use
    gain = _row(lambda drive: drive.gain)  # [1/rad]
    rate_gain = _row(lambda drive: drive.rate_gain)  # [Nm s/rad]
    armature = _row(lambda drive: drive.armature)  # [kg m^2]
    frictionloss = _row(lambda drive: drive.frictionloss)  # [Nm]
    damping = _row(lambda drive: drive.damping)  # [Nm s/rad]
    tick = _row(lambda drive: drive.tick)  # [rad]
    volt = _row(lambda drive: drive.servo.volt)  # [V]
    servo_current = _row(lambda drive: drive.servo.stall_a)  # [A] at stall, of one servo
    stall_current = _row(lambda drive: drive.servo.stall_a * drive.count)  # [A] of all servos of the drive
    idle_current = _row(lambda drive: drive.count * drive.servo.idle_a)  # [A] of all servos of the drive

    def demanded(self, errors: Floats, speeds: Floats) -> Floats:
        """Computes the duties (m, n) that servos demand, which may exceed 1.

        Args:
            errors: (m, n) [rad] goals minus angles.
            speeds: (m, n) [rad/s].
        """
        duties = self.gain * errors  # in place from here on: there are 300 steps a second
        duties -= self.rate_gain / self.stall * speeds
        return duties

    def loads(self, applied: Floats, speeds: Floats, supplied: Floats) -> Floats:
        """Computes the shares (m, n) of their stall torque that servos give.

        Args:
            applied: (m, n) duties within -1..1.
            speeds: (m, n) [rad/s].
            supplied: (m,) or (1,) share of its voltage that the supply has.
        """
        loads: Floats = supplied[:, None] * applied
        loads -= speeds / self.no_load
        return loads


def follow_lags(drives: Drives) -> Floats:
    """Computes (n,) [s] by which servos follow their goals late, and by which goals of a plan so lead its speed."""
    return sealed((1.0 / drives.no_load + drives.rate_gain / drives.stall) / drives.gain)
