"""Builds the robot's MuJoCo model from the description that inverse kinematics and limits also read.

Each servo is a `dcmotor` whose on-board controller is the servo's own position loop: with the data sheet's stall
torque s, no-load speed w and volt V the motor has K = V / w and R = K V / s, and a torque gain of g s with the rate
gain s / w (which undoes MuJoCo's compensation of the back-EMF) gives

    torque = s clip(g error, -1, 1) - (s / w) speed,

clamped exactly where the servo clamps its duty. Where gears have play, a second joint without drive follows each hinge,
free between two stops: the motor turns the first, the links hang on the second, and the servo measures both together.

Couplings have joints in pictures alone: physics leaves them out (`uncouple`), and lets fingers touch nothing.
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
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.uncoupled import uncouple

POSITION_INPUT = 1  # ctrlspec of a dcmotor that is told a position
SHORTEST_AXIS = 1e-6  # [m] a capsule whose ends are nearer is a ball
BALL_RADIUS = 0.02  # [m] of the mass of a segment without capsules
LEAST_MASS = 1e-4  # [kg] MuJoCo refuses moving bodies without mass
LEAST_INERTIA = 1e-7  # [kg m^2]
PLAY = "_play"  # after the name of a hinge
STOP = (0.008, 1.0)  # [s], damping ratio of the stops of play: as stiff as steps of 4 ms can bear
HARDNESS = (0.99, 0.999, 0.001, 0.5, 2.0)  # their impedance: they yield by about 0.01 deg


def build_model(robot: Robot, *, servos: Factors = NOMINAL) -> mujoco.MjModel:
    """Builds the compiled model of a robot.

    Args:
        robot: the description.
        servos: how far servos and masses are from it.

    Returns:
        A model whose bodies, joints and actuators are named after segments and hinges; the caller's own.
    """
    return copy(_compiled(robot, servos))


@lru_cache(maxsize=8)
def _compiled(robot: Robot, servos: Factors) -> mujoco.MjModel:
    links = figures_of_links(servos)
    if servos != links:
        model = copy(_compiled(robot, links))
        fit_drives(model, robot, servos)
        return model
    spec = describe(uncouple(servos.applied(robot)), play=servos.play)
    spec.compiler.discardvisual = True  # the servos' boxes leave only their weight
    return spec.compile()


def figures_of_links(servos: Factors) -> Factors:
    """Picks what compiling looks at beside figures of drives."""
    return Factors(mass=servos.mass, play=servos.play)


def fit_drives(model: mujoco.MjModel, robot: Robot, servos: Factors) -> None:
    """Writes what `_add_hinge` says of drives into a model with the same figures of links: a tenth of compiling."""
    drives, hinges, motors = servos.applied(robot).drives, joint_order(robot, model), actuator_order(robot, model)
    model.dof_frictionloss[hinges], model.dof_damping[hinges] = drives.frictionloss, drives.damping
    for motor, drive in zip(motors, drives, strict=True):
        motorconst, resistance, controller = _motor(drive)
        model.actuator_gainprm[motor, :2] = resistance, motorconst
        model.actuator_gainprm[motor, 4:8] = controller[0], controller[1], controller[2], controller[5]
    if not np.array_equal(model.dof_armature[hinges], drives.armature):
        model.dof_armature[hinges] = drives.armature
        mujoco.mj_setConst(model, mujoco.MjData(model))  # what follows from inertia, but for its mean
        model.stat.meaninertia = sum(model.dof_M0.tolist()) / model.nv


def describe(robot: Robot, *, play: float = 0.0) -> mujoco.MjSpec:
    """Describes the same model before it is compiled, for whoever adds scenery; play [rad] is that of all gears."""
    spec = mujoco.MjSpec()
    spec.modelname = robot.name
    spec.compiler.degree = False  # MjSpec reads degrees by default, and would shrink every range 57 times
    spec.compiler.boundmass = LEAST_MASS
    spec.compiler.boundinertia = LEAST_INERTIA
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # the sparse solver of 4.0.0 gives wrong accelerations
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_ISLAND)  # one tree has no islands to find
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


def turn_order(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Finds the positions (n + c,) of the skeleton's turns, hinges and then couplings, in the `qpos` of a picture."""
    names = (*robot.skeleton.names, *(coupling.name for coupling in robot.skeleton.couplings))
    return np.array([model.joint(name).qposadr[0] for name in names], dtype=np.intp)


def joint_order(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Finds the positions (n,) of the skeleton's hinges in MuJoCo's `qpos` and `qvel`, by name."""
    return np.array([model.joint(name).qposadr[0] for name in robot.skeleton.names], dtype=np.intp)


def play_order(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Finds where the play (n,) of each hinge is in `qpos` and `qvel`; empty (0,) where gears have none."""
    names = [f"{name}{PLAY}" for name in robot.skeleton.names] if model.njnt > len(robot.skeleton.names) else []
    return np.array([model.joint(name).qposadr[0] for name in names], dtype=np.intp)


def of_hinges(values: Floats, motors: Indices | slice, play: Indices) -> Floats:
    """Computes (..., n) of the hinges from those of all joints: where the motors are, and what play adds."""
    turned: Floats = values[..., motors]
    return turned + values[..., play] if len(play) else turned


def actuator_order(robot: Robot, model: mujoco.MjModel) -> Indices:
    """Finds the positions (n,) of the skeleton's hinges in MuJoCo's `ctrl`, by name."""
    return np.array([model.actuator(name).id for name in robot.skeleton.names], dtype=np.intp)


def capsule_name(segment: str, index: int) -> str:
    """Names the geom of a segment's capsule."""
    return f"{segment}_{index}"


def _add_body(spec: mujoco.MjSpec, segment: Segment) -> None:
    parent = spec.worldbody if segment.parent is None else spec.body(segment.parent)
    body = parent.add_body(name=segment.name, pos=segment.origin_in_parent)
    volumes = np.array([_volume(capsule) for capsule in segment.capsules])
    for k, capsule in enumerate(segment.capsules):
        _add_capsule(body, capsule, capsule_name(segment.name, k), segment.mass * volumes[k] / volumes.sum())
    if not segment.capsules and segment.mass:
        ball = body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[BALL_RADIUS, 0, 0], mass=segment.mass)
        _make_ghost(ball)


def _fingers(robot: Robot) -> frozenset[str]:
    return frozenset(name for side in SIDES for name in robot.fingers(side))


def _add_capsule(body: mujoco.MjsBody, capsule: Capsule, name: str, mass: float) -> None:
    size = [capsule.radius, 0, 0]
    if np.linalg.norm(capsule.end - capsule.start) < SHORTEST_AXIS:
        body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, pos=capsule.start, size=size, mass=mass)
        return
    ends: Floats = np.concatenate([capsule.start, capsule.end])
    body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=ends, size=size, mass=mass)


def _volume(capsule: Capsule) -> float:
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
    motorconst, resistance, controller = _motor(drive)
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


def _motor(drive: Drive) -> tuple[float, float, list[float]]:
    """Constant, resistance and controller of the motor that is a drive."""
    volt = drive.servo.volt
    constant = volt / drive.no_load
    controller = [drive.gain * drive.stall, 0, drive.stall / drive.no_load + drive.rate_gain, 0, 0, volt]
    return constant, constant * volt / drive.stall, controller


def _add_play(spec: mujoco.MjSpec, hinge: Hinge, play: float) -> None:
    spec.body(hinge.segment).add_joint(
        name=f"{hinge.name}{PLAY}",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=hinge.axis,
        pos=hinge.at,
        range=[-play / 2, play / 2],
        solref_limit=STOP,
        solimp_limit=HARDNESS,
    )


def _add_servo(spec: mujoco.MjSpec, hinge: Hinge, mount: Mount) -> None:
    """The servos of a hinge as one box: those of a tandem stand side by side."""
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
    """It has weight but touches nothing."""
    geom.contype = 0
    geom.conaffinity = 0


def _add_exclusions(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Only counted pairs collide; MuJoCo's own filter misses the first moving link of a fixed base."""
    counted, fingers = {frozenset(pair) for pair in robot.counted_pairs}, _fingers(robot)
    for a, b in combinations([s for s in robot.skeleton.segments if s.name not in fingers], 2):
        if frozenset((a.name, b.name)) not in counted:
            spec.add_exclude(bodyname1=a.name, bodyname2=b.name)
