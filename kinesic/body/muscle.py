"""The drive of a hinge that has limits instead of a servo, as a virtual human's have: a position drive made of them."""

from math import pi

from kinesic.body.servo import DUTY_FULL, TICKS_PER_RADIAN, Drive, ServoModel

NAME = "muscle"
VOLT = 12.0  # of a drive that draws no current
GAIN = 5.0  # [1/rad] duty per radian of error, about that of a servo
SPEED_SHARE = 0.5  # of the speed at which a muscle has no force left: at its limit it still has half of it


def muscle(*, speed: float, acceleration: float, torque: float) -> Drive:
    """Makes a drive that keeps the limits of a hinge.

    Its rotor is so heavy that the whole torque gives the hinge by itself the acceleration, and no more: what the drive
    can follow keeps the limit, whatever hangs on the hinge.

    Args:
        speed: [rad/s] that a plan may use.
        acceleration: [rad/s^2] of the hinge with nothing on it.
        torque: [Nm] at rest.
    """
    model = ServoModel(
        name=NAME,
        model=0,
        volt=VOLT,
        stall_nm=torque,
        stall_a=0.0,
        no_load_rpm=speed / SPEED_SHARE * 60 / (2 * pi),
        gear=1.0,
        mass=0.0,
        size=(0.001, 0.001, 0.001),
        p_gain=GAIN,
        d_gain=0.0,
        kp_divisor=TICKS_PER_RADIAN / DUTY_FULL,
        armature=torque / acceleration,
        frictionloss=0.0,
        damping=0.0,
    )
    return Drive(model, 1, 1.0, SPEED_SHARE)
