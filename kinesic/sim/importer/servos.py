"""Servo models of imported hinges from motor data or defaults."""

from math import pi

from kinesic.body.robot_schema import ServoTable
from kinesic.body.servo import FULL_DUTY_PWM, TICKS_PER_RADIAN, USABLE_VELOCITY_FRACTION
from kinesic.sim.importer.model_tree import Joint

SUPPLY_VOLTAGE = 48.0  # [V] supply voltage of imported servos
DEFAULT_STATIC_RATIO = 0.35  # torque in the worst static posture / stall torque, if the file gives no effort
MAX_STATIC_RATIO = 0.38  # highest plausible static load / stall torque; lower stall torques are raised
MAX_MEANINGFUL_EFFORT = 1000.0  # [Nm] largest joint effort in the file that is used
DEFAULT_ACCELERATION = 25.0  # [rad/s^2] acceleration required of a servo whose torque limit is unknown
ACCELERATION_TORQUE_RATIO = 0.35  # torque that gives `DEFAULT_ACCELERATION` / stall torque
DEFAULT_NO_LOAD_VELOCITY = 8.0  # [rad/s] no-load velocity if the file gives none
NO_LOAD_VELOCITY_RANGE = (0.4, 12.0)  # [rad/s] plausible no-load velocities
MAX_MEANINGFUL_VELOCITY = 50.0  # [rad/s] largest velocity limit in the file that is used
DEFAULT_P_GAIN = 800.0  # default value of the Dynamixel P gain register
P_GAIN_DIVISOR = 128.0  # divisor of the Dynamixel P gain register
PLAUSIBLE_GAIN_RANGE = (2.0, 30.0)  # [1/rad] plausible range of position gain / stall torque
DEFAULT_ARMATURE = 0.002  # [s^2] default armature / stall torque
DEFAULT_FRICTION = 0.02  # default Coulomb friction / stall torque
DEFAULT_DAMPING = 0.02  # default damping / (stall torque / no-load velocity)
MAX_FRICTION = 0.1  # largest accepted Coulomb friction / stall torque
MAX_DAMPING = 0.2  # largest accepted damping / (stall torque / no-load velocity)


def servo(joint: Joint, *, gravity: float, inertia: float) -> tuple[ServoTable, str]:
    """Return a hinge's servo model and the sources of its values.

    Args:
        joint: Hinge with the motor data of the file.
        gravity: [Nm] torque in the hinge's worst static posture.
        inertia: [kg m^2] largest inertia moved by the hinge.

    Returns:
        The model and the sources of its values.
    """
    stall, strength = _choose_stall(joint.effort, gravity, inertia + (joint.armature or 0.0))
    no_load, speed = _choose_no_load(joint, stall)
    p_gain, gain = _choose_p_gain(joint.gain, stall)
    back_emf_damping = stall / no_load
    armature, friction = joint.armature, joint.friction
    table = ServoTable(
        model=0,
        volt=SUPPLY_VOLTAGE,
        stall_nm=_round(stall),
        stall_a=_round(stall * no_load / SUPPLY_VOLTAGE),
        no_load_rpm=_round(no_load * 60 / (2 * pi)),
        gear=1.0,
        mass=0.0,
        size=(0.01, 0.01, 0.01),
        p_gain=_round(p_gain),
        d_gain=0.0,
        kp_divisor=P_GAIN_DIVISOR,
        armature=_round(DEFAULT_ARMATURE * stall if armature is None else armature),
        frictionloss=_round(DEFAULT_FRICTION * stall if friction is None else min(friction, MAX_FRICTION * stall)),
        damping=_round(
            min(
                DEFAULT_DAMPING * back_emf_damping if joint.damping is None else joint.damping,
                MAX_DAMPING * back_emf_damping,
            )
        ),
    )
    given_losses = [name for name in ("armature", "friction", "damping") if getattr(joint, name) is not None]
    losses = f"{', '.join(given_losses)}: the file's" if given_losses else "inertia and friction assumed"
    return table, f"{strength}; {speed}; {gain}; {losses}"


def _choose_stall(effort: float | None, gravity: float, inertia: float) -> tuple[float, str]:
    required_stall = max(gravity / DEFAULT_STATIC_RATIO, inertia * DEFAULT_ACCELERATION / ACCELERATION_TORQUE_RATIO)
    if effort is None:
        return required_stall, "stall assumed: holds the worst posture with a third"
    if effort > MAX_MEANINGFUL_EFFORT:
        return required_stall, f"stall assumed: the file's {effort:g} Nm is no limit"
    if gravity > MAX_STATIC_RATIO * effort:
        return (
            gravity / MAX_STATIC_RATIO,
            f"stall raised: the file's {effort:g} Nm cannot hold the worst posture at ease",
        )
    return effort, "stall: the file's effort"


def _choose_no_load(joint: Joint, stall: float) -> tuple[float, str]:
    """Return the no-load velocity [rad/s] and its source.

    The damping of a position actuator in an MJCF is mostly its motor's back-EMF, stall torque / no-load velocity.
    """
    if (
        joint.gain is not None
        and joint.damping is not None
        and NO_LOAD_VELOCITY_RANGE[0] < stall / joint.damping < NO_LOAD_VELOCITY_RANGE[1]
    ):
        return stall / joint.damping, "speed: from the file's damping, taken as back-EMF"
    if joint.speed is None or joint.speed > MAX_MEANINGFUL_VELOCITY:
        return DEFAULT_NO_LOAD_VELOCITY, "speed assumed"
    no_load = joint.speed / USABLE_VELOCITY_FRACTION
    return min(max(no_load, NO_LOAD_VELOCITY_RANGE[0]), NO_LOAD_VELOCITY_RANGE[1]), "speed: the file's limit" + (
        ", capped" if no_load > NO_LOAD_VELOCITY_RANGE[1] else ""
    )


def _choose_p_gain(gain: float | None, stall: float) -> tuple[float, str]:
    if gain is not None and PLAUSIBLE_GAIN_RANGE[0] <= gain / stall <= PLAUSIBLE_GAIN_RANGE[1]:
        return gain / stall * P_GAIN_DIVISOR * FULL_DUTY_PWM / TICKS_PER_RADIAN, "gain: the file's"
    return DEFAULT_P_GAIN, "gain assumed"


def _round(value: float) -> float:
    """Round a value to five significant digits."""
    return float(f"{value:.5g}")
