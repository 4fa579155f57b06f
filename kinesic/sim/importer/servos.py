"""A servo model for each foreign hinge: from what the file says of its motor, else from documented defaults."""

from math import pi

from kinesic.body.robot_schema import ServoTable
from kinesic.body.servo import DUTY_FULL, SPEED_SHARE, TICKS_PER_RADIAN
from kinesic.sim.importer.model_tree import Joint

VOLT = 48.0
STATIC_SHARE = 0.35  # of the stall torque that holds the worst posture, where no effort is told
MOST_STATIC = 0.38  # of the stall torque: a told effort that bears more is no stall torque, and is raised
ENDLESS = 1000.0  # [Nm] a told effort above says nothing
QUICK = 25.0  # [rad/s^2] that a servo of unknown strength can give, with ...
QUICK_SHARE = 0.35  # ... this share of its stall torque
SPEED = 8.0  # [rad/s] no-load, where none is told
SPEEDS = (0.4, 12.0)  # [rad/s] no-load speeds that are believed or needed
MEANINGLESS = 50.0  # [rad/s] a told limit above says nothing
P_GAIN, DIVISOR = 800.0, 128.0  # Dynamixel's, where no gain is told
GAINS = (2.0, 30.0)  # [1/rad] duty per error that is believed
ARMATURE, FRICTION, DAMPING = 0.002, 0.02, 0.02  # of the stall torque [s^2], [1]; of stall over no-load speed
MOST_FRICTION, MOST_DAMPING = 0.1, 0.2  # of the same


def servo(joint: Joint, *, gravity: float, inertia: float) -> tuple[ServoTable, str]:
    """Chooses the servo that turns a hinge.

    Args:
        joint: what the file says.
        gravity: [Nm] that the hinge needs in its worst posture.
        inertia: [kg m^2] that it moves at most.

    Returns:
        The model, and where its figures come from.
    """
    stall, strength = _stall(joint.effort, gravity, inertia + (joint.armature or 0.0))
    no_load, speed = _no_load(joint, stall)
    p_gain, gain = _p_gain(joint.gain, stall)
    brake = stall / no_load
    armature, friction = joint.armature, joint.friction
    table = ServoTable(
        model=0,
        volt=VOLT,
        stall_nm=_rounded(stall),
        stall_a=_rounded(stall * no_load / VOLT),
        no_load_rpm=_rounded(no_load * 60 / (2 * pi)),
        gear=1.0,
        mass=0.0,
        size=(0.01, 0.01, 0.01),
        p_gain=_rounded(p_gain),
        d_gain=0.0,
        kp_divisor=DIVISOR,
        armature=_rounded(ARMATURE * stall if armature is None else armature),
        frictionloss=_rounded(FRICTION * stall if friction is None else min(friction, MOST_FRICTION * stall)),
        damping=_rounded(min(DAMPING * brake if joint.damping is None else joint.damping, MOST_DAMPING * brake)),
    )
    rest = [name for name in ("armature", "friction", "damping") if getattr(joint, name) is not None]
    losses = f"{', '.join(rest)}: the file's" if rest else "inertia and friction assumed"
    return table, f"{strength}; {speed}; {gain}; {losses}"


def _stall(effort: float | None, gravity: float, inertia: float) -> tuple[float, str]:
    needed = max(gravity / STATIC_SHARE, inertia * QUICK / QUICK_SHARE)
    if effort is None:
        return needed, "stall assumed: holds the worst posture with a third"
    if effort > ENDLESS:
        return needed, f"stall assumed: the file's {effort:g} Nm is no limit"
    if gravity > MOST_STATIC * effort:
        return gravity / MOST_STATIC, f"stall raised: the file's {effort:g} Nm cannot hold the worst posture at ease"
    return effort, "stall: the file's effort"


def _no_load(joint: Joint, stall: float) -> tuple[float, str]:
    """[rad/s] A position actuator's damping in an MJCF is mostly its motor's back-EMF, which is stall over no-load."""
    if joint.gain is not None and joint.damping is not None and SPEEDS[0] < stall / joint.damping < SPEEDS[1]:
        return stall / joint.damping, "speed: from the file's damping, taken as back-EMF"
    if joint.speed is None or joint.speed > MEANINGLESS:
        return SPEED, "speed assumed"
    no_load = joint.speed / SPEED_SHARE
    return min(max(no_load, SPEEDS[0]), SPEEDS[1]), "speed: the file's limit" + (
        ", capped" if no_load > SPEEDS[1] else ""
    )


def _p_gain(gain: float | None, stall: float) -> tuple[float, str]:
    if gain is not None and GAINS[0] <= gain / stall <= GAINS[1]:
        return gain / stall * DIVISOR * DUTY_FULL / TICKS_PER_RADIAN, "gain: the file's"
    return P_GAIN, "gain assumed"


def _rounded(value: float) -> float:
    """Five significant digits."""
    return float(f"{value:.5g}")
