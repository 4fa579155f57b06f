"""Servo models, and drives of one or more servos at a hinge.

Figures of a model are those at its nominal voltage `volt`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi

from kinesic.body.arrays import Floats, sealed

TICKS_PER_TURN = 4096  # position units per revolution of the output shaft
FULL_DUTY_PWM = 885  # PWM register value at full duty
TICKS_PER_RADIAN = TICKS_PER_TURN / (2 * pi)  # [1/rad] position units of the output shaft
USABLE_VELOCITY_FRACTION = 0.8  # Maximum planned velocity / no-load velocity


@dataclass(frozen=True)
class ServoModel:
    """Data of one servo model, at the servo's own output shaft.

    One table of `configs/servos.toml` or of a robot file's `[servos]`.
    """

    name: str
    model: int  # model number in the servo's control table
    volt: float  # [V] nominal voltage
    stall_nm: float  # [Nm] stall torque
    stall_a: float  # [A] stall current
    no_load_rpm: float  # [1/min] no-load velocity
    gear: float  # gear ratio
    mass: float  # [kg]
    size: tuple[float, float, float]  # [m] width, height, depth
    p_gain: float  # factory position P gain
    d_gain: float  # factory position D gain
    kp_divisor: float  # register units of the P gain per unit of gain
    armature: float  # [kg m^2] rotor inertia at the output
    frictionloss: float  # [Nm] Coulomb friction
    damping: float  # [Nm s/rad] viscous friction
    idle_a: float = 0.0  # [A] current of the electronics alone
    thermal: tuple[float, float] | None = None  # [K/W] winding to surroundings, [J/K] of the winding; None: unknown
    price_usd: float | None = None  # [USD] price of one piece; None: unknown


@dataclass(frozen=True)
class Drive:
    """Drive of one hinge: servo model, number of servos and gear reduction.

    The servo is a PWM position controller: duty = clip(gain * error, -1, 1) and
    torque = stall * duty - (stall / no_load) * velocity.
    """

    servo: ServoModel
    count: int  # number of servos on the hinge's shaft
    reduction: float  # servo revolutions per hinge revolution
    velocity_fraction: float = USABLE_VELOCITY_FRACTION  # maximum planned velocity / no-load velocity

    @property
    def stall(self) -> float:
        """Stall torque of the drive at the hinge [Nm]."""
        return self.servo.stall_nm * self.count * self.reduction

    @property
    def no_load(self) -> float:
        """No-load velocity of the drive at the hinge [rad/s]."""
        return self.servo.no_load_rpm * 2 * pi / 60 / self.reduction

    @property
    def speed(self) -> float:
        """Maximum planned velocity of the drive's hinge [rad/s]."""
        return self.velocity_fraction * self.no_load

    @property
    def gain(self) -> float:
        """Duty per radian of hinge error [1/rad].

        gain = P / divisor * (4096 / 2 pi) / 885 * reduction.
        """
        return self.servo.p_gain / self.servo.kp_divisor * TICKS_PER_RADIAN / FULL_DUTY_PWM * self.reduction

    @property
    def rate_gain(self) -> float:
        """Torque of the D term per hinge velocity [Nm s/rad].

        It holds for a control loop at 1 kHz.
        """
        return self.stall * self.servo.d_gain / 16 * TICKS_PER_RADIAN / FULL_DUTY_PWM / 1000 * self.reduction

    @property
    def armature(self) -> float:
        """Rotor inertia reflected to the hinge [kg m^2]."""
        return self.servo.armature * self.count * self.reduction**2

    @property
    def frictionloss(self) -> float:
        """Coulomb friction of the drive at the hinge [Nm]."""
        return self.servo.frictionloss * self.count * self.reduction

    @property
    def damping(self) -> float:
        """Viscous friction of the drive at the hinge [Nm s/rad]."""
        return self.servo.damping * self.count * self.reduction**2

    @property
    def tick(self) -> float:
        """Resolution of the hinge's setpoint [rad]."""
        return 2 * pi / TICKS_PER_TURN / self.reduction


def _row(quantity: Callable[[Drive], float]) -> "cached_property[Floats]":
    """Return a cached property: one quantity of all drives, (n,)."""
    return cached_property(lambda drives: sealed([quantity(drive) for drive in drives]))


class Drives(tuple[Drive, ...]):
    """Drives of a robot in joint order.

    Each property of the drives is available as an array (n,).
    """

    stall = _row(lambda drive: drive.stall)  # [Nm]
    no_load = _row(lambda drive: drive.no_load)  # [rad/s]
    speed = _row(lambda drive: drive.speed)  # [rad/s] maximum planned velocity
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

    def demanded_duties(self, errors: Floats, velocities: Floats) -> Floats:
        """Compute the demanded duties (m, n), which may exceed 1.

        Args:
            errors: (m, n) [rad] setpoints minus angles.
            velocities: (m, n) [rad/s].
        """
        duties = self.gain * errors  # the following lines work in place, because this runs at 300 steps per second
        duties -= self.rate_gain / self.stall * velocities
        return duties

    def torque_ratios(self, duties: Floats, velocities: Floats, supply_ratios: Floats) -> Floats:
        """Compute the torques (m, n) of the servos, relative to stall torque.

        Args:
            duties: (m, n) applied duties within -1..1.
            velocities: (m, n) [rad/s].
            supply_ratios: (m,) or (1,) supply voltage relative to nominal.
        """
        torques: Floats = supply_ratios[:, None] * duties
        torques -= velocities / self.no_load
        return torques


def tracking_lags(drives: Drives) -> Floats:
    """Compute the tracking lags (n,) [s] of the servos at constant velocity.

    The feed-forward offset of a setpoint is lag times velocity.
    """
    return sealed((1.0 / drives.no_load + drives.rate_gain / drives.stall) / drives.gain)
