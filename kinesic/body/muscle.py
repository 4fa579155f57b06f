"""Drives of virtual humans, derived from limits instead of a servo."""

from math import pi

from kinesic.body.servo import FULL_DUTY_PWM, TICKS_PER_RADIAN, Drive, ServoModel

MUSCLE_NAME = "muscle"  # name of the servo model of drives without a servo
MUSCLE_VOLTAGE = 12.0  # [V] nominal supply voltage of muscles, which draw no current
MUSCLE_GAIN = 5.0  # [1/rad] duty per radian of position error, about that of real servos
MUSCLE_VELOCITY_FRACTION = 0.2  # Velocity limit / no-load velocity; leaves 80 % of stall torque at the limit


def make_muscle(*, speed: float, acceleration: float, torque: float) -> Drive:
    """Make a virtual drive from a hinge's velocity, acceleration and torque limits.

    Its rotor inertia is so large that the full torque gives the unloaded hinge just the acceleration limit. Hence any
    motion that the drive can follow keeps the limit, with every load.

    Args:
        speed: [rad/s] maximum velocity of a plan.
        acceleration: [rad/s^2] limit of the unloaded hinge.
        torque: [Nm] stall torque.
    """
    model = ServoModel(
        name=MUSCLE_NAME,
        model=0,
        volt=MUSCLE_VOLTAGE,
        stall_nm=torque,
        stall_a=0.0,
        no_load_rpm=speed / MUSCLE_VELOCITY_FRACTION * 60 / (2 * pi),
        gear=1.0,
        mass=0.0,
        size=(0.001, 0.001, 0.001),
        p_gain=MUSCLE_GAIN,
        d_gain=0.0,
        kp_divisor=TICKS_PER_RADIAN / FULL_DUTY_PWM,
        armature=torque / acceleration,
        frictionloss=0.0,
        damping=0.0,
    )
    return Drive(model, 1, 1.0, MUSCLE_VELOCITY_FRACTION)
