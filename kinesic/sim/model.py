"""MuJoCo model of a robot, built from its description.

Inverse kinematics and limits read the same description. Each servo is a `dcmotor` whose on-board controller is the
servo's own position loop: with the data sheet's stall torque s, no-load speed w and voltage V the motor has K = V / w
and R = K V / s, and a torque gain of g s with the rate gain s / w (which undoes MuJoCo's compensation of the back-EMF)
gives

    torque = s clip(g error, -1, 1) - (s / w) velocity,

clamped exactly where the servo clamps its duty cycle. If gears have backlash, a second joint without a drive follows
each hinge, free between two stops: the motor turns the first joint, the links are attached to the second, and the
servo measures the sum of both.

Couplings have joints in pictures only. Physics leaves them out (`uncouple`), and fingers have no contacts.
"""

from copy import copy
from functools import lru_cache
from itertools import combinations
from math import pi

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.body.description import Mount
from kinesic.body.robot import SIDES, Robot
from kinesic.body.servo import Drive
from kinesic.body.skeleton import Capsule, Hinge, Segment
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.uncoupled import uncouple

POSITION_INPUT = 1  # value of MuJoCo's ctrlspec for a dcmotor controlled by position
MIN_AXIS_LENGTH = 1e-6  # [m] capsule axis length below which a ball replaces the capsule
MASS_BALL_RADIUS = 0.02  # [m] radius of the ball that carries the mass of a segment without capsules
MIN_BODY_MASS = 1e-4  # [kg] smallest mass of a moving body, as MuJoCo rejects massless ones
MIN_BODY_INERTIA = 1e-7  # [kg m^2] smallest inertia of a moving body, as MuJoCo rejects zero
PLAY_SUFFIX = "_play"  # suffix of the name of a hinge's backlash joint
STOP_SOLREF = (0.008, 1.0)  # time constant [s] and damping ratio of backlash stops, as stiff as 4 ms steps allow
STOP_SOLIMP = (0.99, 0.999, 0.001, 0.5, 2.0)  # MuJoCo impedance of backlash stops, which yield by about 0.01 deg


def build_model(robot: Robot, *, servos: Factors = NOMINAL_FACTORS) -> mujoco.MjModel:
    """Build the compiled MuJoCo model of a robot.

    Args:
        robot: Description.
        servos: Deviations of servos and masses from the description.

    Returns:
        A model whose bodies, joints and actuators are named after segments and hinges. The caller may change it.
    """
    return copy(_compile(robot, servos))


@lru_cache(maxsize=8)
def _compile(robot: Robot, servos: Factors) -> mujoco.MjModel:
    links = select_link_factors(servos)
    if servos != links:
        model = copy(_compile(robot, links))
        write_drives(model, robot, servos)
        return model
    spec = describe(uncouple(servos.applied(robot)), play=servos.play)
    spec.compiler.discardvisual = True  # of the servos' boxes only the mass remains
    return spec.compile()


def select_link_factors(servos: Factors) -> Factors:
    """Return the servo factors (mass, backlash) that require a new MuJoCo model.

    Drive parameters can be written into a compiled model.
    """
    return Factors(mass=servos.mass, play=servos.play)


def write_drives(model: mujoco.MjModel, robot: Robot, servos: Factors) -> None:
    """Write drive parameters into a model compiled with the servos' link factors.

    Equivalent to `_add_hinge`, in a tenth of the time of compilation.
    """
    drives, hinges, motors = (
        servos.applied(robot).drives,
        find_joint_indices(robot, model),
        find_actuator_indices(robot, model),
    )
    model.dof_frictionloss[hinges], model.dof_damping[hinges] = drives.frictionloss, drives.damping
    for motor, drive in zip(motors, drives, strict=True):
        motorconst, resistance, controller = _compute_motor(drive)
        model.actuator_gainprm[motor, :2] = resistance, motorconst
        model.actuator_gainprm[motor, 4:8] = controller[0], controller[1], controller[2], controller[5]
    if not np.array_equal(model.dof_armature[hinges], drives.armature):
        model.dof_armature[hinges] = drives.armature
        mujoco.mj_setConst(
            model, mujoco.MjData(model)
        )  # recomputes all constants that depend on inertia, except the mean inertia
        model.stat.meaninertia = sum(model.dof_M0.tolist()) / model.nv


def describe(robot: Robot, *, play: float = 0.0) -> mujoco.MjSpec:
    """Build the uncompiled MuJoCo model of a robot.

    Args:
        robot: Description.
        play: [rad] backlash of all gears.
    """
    spec = mujoco.MjSpec()
    spec.modelname = robot.name
    spec.compiler.degree = False  # MjSpec reads degrees by default, which would scale every range by 1/57
    spec.compiler.boundmass = MIN_BODY_MASS
    spec.compiler.boundinertia = MIN_BODY_INERTIA
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # the sparse solver of 4.0.0 gives wrong accelerations
    spec.option.disableflags = int(
        mujoco.mjtDisableBit.mjDSBL_ISLAND
    )  # a single kinematic tree has no constraint islands
    for segment in robot.skeleton.segments:
        _add_body(spec, segment)
    for geom in (geom for name in _fingers(robot) for geom in spec.body(name).geoms):
        _make_ghost(geom)
    for coupling in robot.skeleton.couplings:
        spec.body(coupling.segment).add_joint(name=coupling.name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=coupling.axis)
    for hinge, mount in zip(robot.skeleton.hinges, robot.mounts, strict=True):
        _add_hinge(spec, hinge, mount.drive)
        if play:
            _add_play(spec, hinge, play)
        _add_servo(spec, hinge, mount)
    for name, site in robot.sites.items():
        spec.body(site.segment).add_site(name=name, pos=site.position, size=[0.005] * 3, group=4)
    _add_exclusions(spec, robot)
    return spec


def find_turn_indices(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Return `qpos` indices of hinges and couplings in a drawing model.

    Hinges come first, then couplings; the shape is (n + c,).
    """
    names = (*robot.skeleton.names, *(coupling.name for coupling in robot.skeleton.couplings))
    return np.array([model.joint(name).qposadr[0] for name in names], dtype=np.intp)


def find_joint_indices(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Return the indices (n,) of the hinges in MuJoCo's `qpos` and `qvel`."""
    return np.array([model.joint(name).qposadr[0] for name in robot.skeleton.names], dtype=np.intp)


def find_play_indices(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Return the indices (n,) of the backlash joints in `qpos` and `qvel`.

    Empty (0,) if gears have no backlash.
    """
    names = [f"{name}{PLAY_SUFFIX}" for name in robot.skeleton.names] if model.njnt > len(robot.skeleton.names) else []
    return np.array([model.joint(name).qposadr[0] for name in names], dtype=np.intp)


def sum_hinge_values(values: Floats, motors: Indices | slice, play: Indices) -> Floats:
    """Compute hinge angles or velocities from those of MuJoCo's joints.

    The value of a hinge is that of its motor plus that of its backlash joint.

    Args:
        values: (..., q) angles or velocities of all joints.
        motors: (n,) indices of the motor joints.
        play: (n,) indices of the backlash joints; (0,) if gears have no backlash.

    Returns:
        (..., n).
    """
    turned: Floats = values[..., motors]
    return turned + values[..., play] if len(play) else turned


def find_actuator_indices(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Return the indices (n,) of the hinges in MuJoCo's `ctrl`."""
    return np.array([model.actuator(name).id for name in robot.skeleton.names], dtype=np.intp)


def capsule_name(segment: str, index: int) -> str:
    """Return the geom name of a segment's capsule."""
    return f"{segment}_{index}"


def _add_body(spec: mujoco.MjSpec, segment: Segment) -> None:
    parent = spec.worldbody if segment.parent is None else spec.body(segment.parent)
    body = parent.add_body(name=segment.name, pos=segment.origin_in_parent)
    volumes = np.array([_compute_volume(capsule) for capsule in segment.capsules])
    for k, capsule in enumerate(segment.capsules):
        _add_capsule(body, capsule, capsule_name(segment.name, k), segment.mass * volumes[k] / volumes.sum())
    if not segment.capsules and segment.mass:
        ball = body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[MASS_BALL_RADIUS, 0, 0], mass=segment.mass)
        _make_ghost(ball)


def _fingers(robot: Robot) -> frozenset[str]:
    return frozenset(name for side in SIDES for name in robot.fingers(side))


def _add_capsule(body: mujoco.MjsBody, capsule: Capsule, name: str, mass: float) -> None:
    size = [capsule.radius, 0, 0]
    if np.linalg.norm(capsule.end - capsule.start) < MIN_AXIS_LENGTH:
        body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, pos=capsule.start, size=size, mass=mass)
        return
    ends: Floats = np.concatenate([capsule.start, capsule.end])
    body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=ends, size=size, mass=mass)


def _compute_volume(capsule: Capsule) -> float:
    length = float(np.linalg.norm(capsule.end - capsule.start))
    return pi * capsule.radius**2 * (length + 4 / 3 * capsule.radius)


def _add_hinge(spec: mujoco.MjSpec, hinge: Hinge, drive: Drive) -> None:
    spec.body(hinge.segment).add_joint(
        name=hinge.name,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=hinge.axis,
        pos=hinge.at,
        range=[hinge.lower, hinge.upper],
        armature=drive.armature,
        frictionloss=drive.frictionloss,
        damping=[drive.damping, 0, 0],
    )
    motorconst, resistance, controller = _compute_motor(drive)
    spec.add_actuator(
        name=hinge.name,
        target=hinge.name,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
    ).set_to_dcmotor(
        motorconst=[motorconst, motorconst],
        resistance=resistance,
        controller=controller,
        ctrlspec=POSITION_INPUT,
    )


def _compute_motor(drive: Drive) -> tuple[float, float, list[float]]:
    """Return motor constant, resistance and controller parameters of a drive's `dcmotor`."""
    volt = drive.servo.volt
    constant = volt / drive.no_load
    controller = [drive.gain * drive.stall, 0, drive.stall / drive.no_load + drive.rate_gain, 0, 0, volt]
    return constant, constant * volt / drive.stall, controller


def _add_play(spec: mujoco.MjSpec, hinge: Hinge, play: float) -> None:
    spec.body(hinge.segment).add_joint(
        name=f"{hinge.name}{PLAY_SUFFIX}",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=hinge.axis,
        pos=hinge.at,
        range=[-play / 2, play / 2],
        solref_limit=STOP_SOLREF,
        solimp_limit=STOP_SOLIMP,
    )


def _add_servo(spec: mujoco.MjSpec, hinge: Hinge, mount: Mount) -> None:
    """Add the servos of a hinge as one box.

    The servos of a tandem stand side by side.
    """
    drive = mount.drive
    width, length, height = drive.servo.size
    box = spec.body(mount.segment).add_geom(
        name=f"{hinge.name}_servo",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=mount.position,
        size=[drive.count * width / 2, length / 2, height / 2],
        mass=drive.count * drive.servo.mass,
    )
    _make_ghost(box)


def _make_ghost(geom: mujoco.MjsGeom) -> None:
    """Disable the contacts of a geom but keep its mass."""
    geom.contype = 0
    geom.conaffinity = 0


def _add_exclusions(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Exclude contacts of segment pairs that the collision check ignores.

    MuJoCo's own filter misses the first moving link of a fixed base.
    """
    counted, fingers = {frozenset(pair) for pair in robot.counted_pairs}, _fingers(robot)
    for a, b in combinations([s for s in robot.skeleton.segments if s.name not in fingers], 2):
        if frozenset((a.name, b.name)) not in counted:
            spec.add_exclude(bodyname1=a.name, bodyname2=b.name)
