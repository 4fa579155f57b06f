"""Loads an MJCF or URDF file: kinematics, weights, primitive shapes, what its motors can do, and how it looks."""

import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.looks import Looks, load_looks
from kinesic.sim.importer.model_tree import BASE, Follow, Joint, ModelPart, Tree
from kinesic.sim.importer.reading.robot_files import RobotFiles, read_robot_files

MESHES = (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_HFIELD, mujoco.mjtGeom.mjGEOM_SDF)
NOT_NEEDED = ("keys", "sensors", "tendons", "equalities", "pairs", "excludes", "skins", "flexes", "meshes", "hfields")
LOOKS = ("materials", "textures", "cameras", "lights", "numerics", "texts", "tuples")
MAX_BODIES = 2000
MAX_GEOMS = 20_000
GHOST_MASS = 1e-3  # [kg] of a body of which nothing is known
GHOST_INERTIA = 1e-6  # [kg m^2]
FLAT = 1e-9  # of a coupling, coefficients of its curve that are none
LEAST_SHAPE = 0.005  # [m] radius of a shape that counts


@dataclass(frozen=True)
class UrdfJoint:
    """The attributes of a URDF joint that MuJoCo drops when it reads the file."""

    speed: float | None  # [rad/s]
    follows: Follow | None


def urdf_joints(root: ElementTree.Element) -> dict[str, UrdfJoint]:
    """Return a URDF's joints by name, or none for an MJCF.

    Raises:
        ValueError: a velocity is not a number.
    """
    if root.tag != "robot":
        return {}
    found = {}
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        speed = 0.0 if limit is None else float(limit.get("velocity", 0.0))
        found[joint.get("name", "")] = UrdfJoint(speed if speed > 0 else None, _mimic(joint.find("mimic")))
    return found


def _mimic(mimic: ElementTree.Element | None) -> Follow | None:
    if mimic is None:
        return None
    return Follow(mimic.get("joint", ""), float(mimic.get("multiplier", 1.0)), float(mimic.get("offset", 0.0)))


def load_model(path: Path) -> Tree:
    """Reads a robot.

    Args:
        path: of an MJCF or URDF file; its meshes need not exist.

    Returns:
        Its hinges in the pose of the file. Slides, balls and the free joint of the root are held where they are, and
        so are joints of a URDF that mimic others and carry some that do not.

    Raises:
        ConfigError: the file is missing, MuJoCo cannot read it, or it reads or makes more than a robot may.
    """
    try:
        files = read_robot_files(path)
        urdf = urdf_joints(files.root)
        mujoco.set_mju_user_warning(_unheard)  # by default they go to a file in the present folder
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of bodies without weight: they get some
            spec = _read_spec(files.root, files)
            equal = _equalities(spec)
            model = _without_meshes(spec, path)
            looks = load_looks(files, _read_spec, lambda spec: _without_meshes(spec, path))
    except ConfigError:
        raise
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except (ValueError, OSError, ExpatError) as error:
        raise ConfigError(f"{path}: neither MJCF nor URDF that can be read: {' '.join(str(error).split())}") from None
    except mujoco.FatalError as error:
        raise ConfigError(f"{path}: MuJoCo makes no model of it: {' '.join(str(error).split())}") from None
    finally:
        mujoco.set_mju_user_warning(None)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    follows = {name: told.follows for name, told in urdf.items() if told.follows} or _from_zero(equal.follows, model)
    tree = _tree(path.stem, model, data, urdf, follows, looks)
    return replace(tree, left_out=(*tree.left_out, *equal.left_out))


def _unheard(_: str) -> None:
    """Drops a warning of MuJoCo about a URDF: the importer checks the same itself."""


def _read_spec(root: ElementTree.Element, files: RobotFiles) -> mujoco.MjSpec:
    """Describe a robot to MuJoCo by text and bytes alone."""
    return mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"), include=dict(files.models))


@dataclass(frozen=True)
class Equalities:
    """The hinges of an MJCF that equality constraints tie to others."""

    follows: dict[str, Follow]  # by the name of the hinge that is led; both as turns away from the file's pose
    left_out: tuple[str, ...]


def _equalities(spec: mujoco.MjSpec) -> Equalities:
    """Reads couplings of joints; curves count as the straight line at their beginning."""
    follows: dict[str, Follow] = {}
    left_out = []
    for tie in spec.equalities:
        is_coupling = tie.type == mujoco.mjtEq.mjEQ_JOINT and bool(tie.name2)
        if not is_coupling:
            left_out.append(f"the equality {tie.name or tie.name1} is left out: only couplings of two joints are known")
            continue
        offset, ratio, *curve = (float(value) for value in tie.data[:5])
        follows[tie.name1] = Follow(tie.name2, ratio, offset)
        if any(abs(value) > FLAT for value in curve):
            left_out.append(f"{tie.name1} follows {tie.name2} in a straight line, in its file in a curve")
    if len(spec.tendons):
        left_out.append(f"{len(spec.tendons)} tendons are left out: hinges that they lead move by themselves")
    return Equalities(follows, tuple(left_out))


def _from_zero(follows: dict[str, Follow], model: mujoco.MjModel) -> dict[str, Follow]:
    """The same between angles as they are."""

    def zero(name: str) -> float:
        return float(model.qpos0[model.jnt_qposadr[model.joint(name).id]])

    return {
        name: replace(follow, offset=zero(name) + follow.offset - follow.ratio * zero(follow.driver))
        for name, follow in follows.items()
    }


def _without_meshes(spec: mujoco.MjSpec, path: Path) -> mujoco.MjModel:
    if len(spec.bodies) > MAX_BODIES or len(spec.geoms) > MAX_GEOMS:
        raise ConfigError(
            f"{path}: {len(spec.bodies)} bodies and {len(spec.geoms)} shapes; at most {MAX_BODIES} and {MAX_GEOMS}"
        )
    spec.memory, spec.nuserdata, spec.nkey = -1, 0, 0  # nothing is simulated
    for geom in list(spec.geoms):
        if geom.type in MESHES:
            spec.delete(geom)
        else:
            geom.material = ""
    for kind in (*NOT_NEEDED, *LOOKS):
        for element in list(getattr(spec, kind)):
            spec.delete(element)
    for body in spec.bodies[1:]:
        if not body.explicitinertial and not len(body.geoms):
            body.mass, body.inertia, body.explicitinertial = GHOST_MASS, [GHOST_INERTIA] * 3, True
    spec.compiler.LRopt.mode = mujoco.mjtLRMode.mjLRMODE_NONE  # muscles are not simulated either
    spec.compiler.boundmass = GHOST_MASS
    spec.compiler.boundinertia = GHOST_INERTIA
    spec.compiler.balanceinertia = True
    return spec.compile()


def _tree(
    name: str,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    urdf: dict[str, UrdfJoint],
    follows: dict[str, Follow],
    looks: Looks,
) -> Tree:
    held = _held(model, {name for name, told in urdf.items() if told.follows})
    joints: list[Joint] = []
    owner: dict[int, int] = {0: BASE}  # body -> the hinge that moves it
    for body in range(1, model.nbody):
        last = owner[int(model.body_parentid[body])]
        first = int(model.body_jntadr[body])
        for k in range(first, first + int(model.body_jntnum[body])):
            called = model.joint(k).name
            if model.jnt_type[k] == mujoco.mjtJoint.mjJNT_HINGE and called not in held:
                joint = _joint(model, data, k, last, urdf.get(called))
                joints.append(replace(joint, follows=follows.get(called)))
                last = len(joints) - 1
        owner[body] = last
    rows: dict[int, list[int]] = {k: [] for k in range(BASE, len(joints))}
    for body, k in owner.items():
        rows[k].append(body)
    parts = {k: _part(model, data, bodies, joints[k].anchor if k != BASE else None) for k, bodies in rows.items()}
    for k, bodies in rows.items():
        seen = tuple(surface for body in bodies for surface in looks.surfaces.get(body, ()))
        parts[k] = replace(parts[k], surfaces=seen)
    return Tree(name, tuple(joints), tuple(parts[k] for k in range(len(joints))), parts[BASE], looks.left_out)


def _held(model: mujoco.MjModel, mimics: set[str]) -> set[str]:
    """Joints of a URDF that mimic others and carry some that do not: a limb goes on behind them."""
    held: set[str] = set()
    for k in range(model.njnt):
        if model.joint(k).name not in mimics:
            body = int(model.jnt_bodyid[k])
            while body := int(model.body_parentid[body]):
                first = int(model.body_jntadr[body])
                held |= {model.joint(j).name for j in range(first, first + int(model.body_jntnum[body]))} & mimics
    return held


def _joint(model: mujoco.MjModel, data: mujoco.MjData, k: int, parent: int, told: UrdfJoint | None) -> Joint:
    dof = int(model.jnt_dofadr[k])
    limited = bool(model.jnt_limited[k])
    return Joint(
        name=model.joint(k).name,
        parent=parent,
        anchor=sealed(data.xanchor[k]),
        axis=sealed(data.xaxis[k]),
        zero=float(model.qpos0[model.jnt_qposadr[k]]),
        lower=float(model.jnt_range[k, 0]) if limited else None,
        upper=float(model.jnt_range[k, 1]) if limited else None,
        effort=_effort(model, k),
        speed=told.speed if told else None,
        gain=_gain(model, k),
        armature=_positive(model.dof_armature[dof]),
        friction=_positive(model.dof_frictionloss[dof]),
        damping=_positive(model.dof_damping[dof]),
    )


def _effort(model: mujoco.MjModel, joint: int) -> float | None:
    """The torque that the joint or its actuator is limited to [Nm]."""
    found = [float(model.jnt_actfrcrange[joint, 1])] if model.jnt_actfrclimited[joint] else []
    for a in _actuators(model, joint):
        gear = abs(float(model.actuator_gear[a, 0]))
        if model.actuator_forcelimited[a]:
            found.append(gear * float(model.actuator_forcerange[a, 1]))
        elif model.actuator_ctrllimited[a] and model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_NONE:
            found.append(gear * abs(float(model.actuator_gainprm[a, 0] * model.actuator_ctrlrange[a, 1])))
    return _positive(min(found, default=0.0))


def _gain(model: mujoco.MjModel, joint: int) -> float | None:
    """Of a position actuator, whose bias undoes its gain [Nm/rad]."""
    for a in _actuators(model, joint):
        gain = float(model.actuator_gainprm[a, 0])
        if model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_AFFINE and model.actuator_biasprm[a, 1] == -gain:
            return _positive(gain)
    return None


def _actuators(model: mujoco.MjModel, joint: int) -> list[int]:
    at_joint = model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT
    return [int(a) for a in np.flatnonzero(at_joint & (model.actuator_trnid[:, 0] == joint))]


def _positive(value: float) -> float | None:
    return float(value) if value > 0 else None


def _part(model: mujoco.MjModel, data: mujoco.MjData, bodies: list[int], anchor: Floats | None) -> ModelPart:
    masses, centres = model.body_mass[bodies], data.xipos[bodies]
    mass = float(masses.sum())
    fallback = np.zeros(3) if anchor is None else anchor
    centre = masses @ centres / mass if mass > 0 else fallback
    shapes = [_capsule(model, data, g) for g in range(model.ngeom) if int(model.geom_bodyid[g]) in bodies]
    return ModelPart(mass, sealed(centre), tuple(shape for shape in shapes if shape is not None))


def _capsule(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Capsule | None:
    """A primitive shape as the capsule that holds nearly all of it."""
    kind, size = model.geom_type[geom], model.geom_size[geom]
    centre, frame = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        half, radius = np.zeros(3), float(size[0])
    elif kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        half, radius = frame[:, 2] * size[1], float(size[0])
    elif kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
        sizes = np.array([size[0], size[0], size[1]]) if kind == mujoco.mjtGeom.mjGEOM_CYLINDER else size
        longest = int(np.argmax(sizes))
        radius = float(np.delete(sizes, longest).mean())
        half = frame[:, longest] * max(float(sizes[longest]) - radius, 0.0)
    else:
        return None
    return Capsule(sealed(centre - half), sealed(centre + half), radius) if radius >= LEAST_SHAPE else None
