"""Reader of kinematics, masses, shapes, motors and meshes of MJCF or URDF."""

import warnings
from dataclasses import replace
from math import ceil
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers.expat import ExpatError

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.skeleton import Capsule
from kinesic.files.unicode_text import escape_surrogates
from kinesic.sim.importer.couplings import UrdfJoint, find_gears, join_gear, read_equalities, to_absolute, urdf_joints
from kinesic.sim.importer.looks import Looks, load_looks
from kinesic.sim.importer.model_tree import BASE_INDEX, Follow, Joint, ModelPart, Tree
from kinesic.sim.importer.reading.robot_files import RobotFiles, read_robot_files
from kinesic.sim.importer.repairs import repair

MESH_GEOM_TYPES = (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_HFIELD, mujoco.mjtGeom.mjGEOM_SDF)
UNUSED_ELEMENTS = (
    "keys",
    "sensors",
    "tendons",
    "equalities",
    "pairs",
    "excludes",
    "skins",
    "flexes",
    "meshes",
    "hfields",
)
APPEARANCE_ELEMENTS = ("materials", "textures", "cameras", "lights", "numerics", "texts", "tuples")
SIZE_COUNTS = {  # type of a shape -> number of its size values
    mujoco.mjtGeom.mjGEOM_SPHERE: 1,
    mujoco.mjtGeom.mjGEOM_CAPSULE: 2,
    mujoco.mjtGeom.mjGEOM_CYLINDER: 2,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: 3,
    mujoco.mjtGeom.mjGEOM_BOX: 3,
}
MAX_BODIES = 2000  # largest number of bodies in a robot file
MAX_GEOMS = 20_000  # largest number of geoms in a robot file
DEFAULT_BODY_MASS = 1e-3  # [kg] mass of a body without inertial data or geoms, and minimum of all
DEFAULT_BODY_INERTIA = 1e-6  # [kg m^2] inertia of a body without inertial data or geoms, and minimum of all
MIN_SHAPE_RADIUS = 0.005  # [m] radius below which a shape is ignored
MAX_SINGLE_WIDTH_RATIO = 1.25  # largest width / thickness of a box that one capsule approximates
MAX_BOX_CAPSULES = 3  # largest number of parallel capsules that approximate a box


def load_robot_tree(path: Path) -> Tree:
    """Load a robot as a tree of hinges.

    Args:
        path: MJCF or URDF file; its meshes need not exist.

    Returns:
        Hinges in the pose of the file. Slide and ball joints and the free joint of the root are fixed in place, and so
        are URDF joints that mimic others and carry independent joints.

    Raises:
        ConfigError: the file is missing, MuJoCo cannot read it, or it is larger than a robot may be.
    """
    try:
        files = read_robot_files(path)
        repairs = repair(files.root)
        urdf = urdf_joints(files.root)
        mujoco.set_mju_user_warning(_ignore_warning)  # by default MuJoCo writes them to a file in the current folder
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # massless bodies get a default mass below
            spec = _read_spec(files.root, files)
            equalities = read_equalities(spec)
            shapes = _leave_out_shapes(spec)
            model = _without_meshes(spec, path)
            looks = load_looks(files, _read_spec, lambda spec: _without_meshes(spec, path))
    except ConfigError:
        raise
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except (ValueError, OSError, ExpatError) as error:
        raise ConfigError(f"{path}: not a readable MJCF or URDF file: {' '.join(str(error).split())}") from None
    except mujoco.FatalError as error:
        raise ConfigError(f"{path}: MuJoCo cannot build a model from it: {' '.join(str(error).split())}") from None
    finally:
        mujoco.set_mju_user_warning(None)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    _check_places(model, data, path)
    follows = {name: urdf_joint.follows for name, urdf_joint in urdf.items() if urdf_joint.follows} or to_absolute(
        equalities.follows, model
    )
    tree = _tree(escape_surrogates(path.stem), model, data, urdf, follows, looks)
    return replace(tree, left_out=(*repairs, *shapes, *tree.left_out, *equalities.left_out))


def _check_places(model: mujoco.MjModel, data: mujoco.MjData, path: Path) -> None:
    """Check that bodies and shapes have finite positions and rotations."""
    places = ((data.xpos, data.xmat, range(model.nbody)), (data.geom_xpos, data.geom_xmat, model.geom_bodyid))
    for positions, rotations, bodies in places:
        valid = np.isfinite(positions).all(axis=1) & np.isfinite(rotations).all(axis=1)
        if not valid.all():
            name = model.body(int(bodies[int(np.argmin(valid))])).name
            raise ConfigError(f"{path}: the position or rotation of {name or 'the world'} is not finite")


def _ignore_warning(_: str) -> None:
    """Ignore a MuJoCo warning about a URDF.

    The importer does the same checks itself.
    """


def _read_spec(root: ElementTree.Element, files: RobotFiles) -> mujoco.MjSpec:
    """Create a MuJoCo specification from XML text and attached models."""
    return mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"), include=dict(files.models))


def _without_meshes(spec: mujoco.MjSpec, path: Path) -> mujoco.MjModel:
    if len(spec.bodies) > MAX_BODIES or len(spec.geoms) > MAX_GEOMS:
        raise ConfigError(
            f"{path}: {len(spec.bodies)} bodies and {len(spec.geoms)} shapes; at most {MAX_BODIES} and {MAX_GEOMS}"
        )
    spec.memory, spec.nuserdata, spec.nkey = -1, 0, 0  # the model is not simulated
    for geom in list(spec.geoms):
        if geom.type in MESH_GEOM_TYPES:
            spec.delete(geom)
        else:
            geom.material = ""
    for kind in (*UNUSED_ELEMENTS, *APPEARANCE_ELEMENTS):
        for element in list(getattr(spec, kind)):
            spec.delete(element)
    for body in spec.bodies[1:]:
        if not body.explicitinertial and not len(body.geoms):
            body.mass, body.inertia, body.explicitinertial = DEFAULT_BODY_MASS, [DEFAULT_BODY_INERTIA] * 3, True
    spec.compiler.LRopt.mode = mujoco.mjtLRMode.mjLRMODE_NONE  # muscles need no length range without simulation
    spec.compiler.boundmass = DEFAULT_BODY_MASS
    spec.compiler.boundinertia = DEFAULT_BODY_INERTIA
    spec.compiler.balanceinertia = True
    return spec.compile()


def _leave_out_shapes(spec: mujoco.MjSpec) -> tuple[str, ...]:
    """Remove the shapes of a specification without a positive size."""
    notes = []
    for geom in list(spec.geoms):
        needed = SIZE_COUNTS.get(geom.type, 0)
        has_ends = needed == SIZE_COUNTS[mujoco.mjtGeom.mjGEOM_CAPSULE] and not np.isnan(geom.fromto[0])
        sizes = np.array(geom.size[: 1 if has_ends else needed])
        if not (np.isfinite(sizes) & (sizes > 0.0)).all() and not geom.meshname:
            notes.append(f"a shape of {geom.parent.name or 'the world'} is left out: its size is not positive")
            spec.delete(geom)
    return tuple(notes)


def _tree(
    name: str,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    urdf: dict[str, UrdfJoint],
    follows: dict[str, Follow],
    looks: Looks,
) -> Tree:
    mimics = {name: urdf_joint.follows for name, urdf_joint in urdf.items() if urdf_joint.follows}
    gears = find_gears(model, mimics | follows)
    joints: list[Joint] = []
    owner: dict[int, int] = {0: BASE_INDEX}  # body -> index of the hinge that moves it
    for body in range(1, model.nbody):
        last = owner[int(model.body_parentid[body])]
        first = int(model.body_jntadr[body])
        for k in range(first, first + int(model.body_jntnum[body])):
            joint_name = model.joint(k).name
            if model.jnt_type[k] == mujoco.mjtJoint.mjJNT_HINGE and joint_name not in gears.fixed:
                joint = _joint(model, data, k, last, urdf.get(joint_name))
                gear = gears.motors.get(joint_name)
                if gear is not None:
                    wheel = _joint(model, data, model.joint(gear.driver).id, last, urdf.get(gear.driver))
                    joints.append(join_gear(joint, wheel, gear))
                else:
                    joints.append(replace(joint, follows=follows.get(joint_name)))
                last = len(joints) - 1
        owner[body] = last
    rows: dict[int, list[int]] = {k: [] for k in range(BASE_INDEX, len(joints))}
    for body, k in owner.items():
        rows[k].append(body)
    parts = {k: _part(model, data, bodies, joints[k].anchor if k != BASE_INDEX else None) for k, bodies in rows.items()}
    for k, bodies in rows.items():
        visible = tuple(surface for body in bodies for surface in looks.surfaces.get(body, ()))
        parts[k] = replace(parts[k], surfaces=visible)
    notes = (*gears.notes, *looks.left_out)
    return Tree(name, tuple(joints), tuple(parts[k] for k in range(len(joints))), parts[BASE_INDEX], notes)


def _joint(model: mujoco.MjModel, data: mujoco.MjData, k: int, parent: int, urdf_joint: UrdfJoint | None) -> Joint:
    dof = int(model.jnt_dofadr[k])
    limited = bool(model.jnt_limited[k]) and bool(np.isfinite(model.jnt_range[k]).all())
    return Joint(
        name=model.joint(k).name,
        parent=parent,
        anchor=sealed(data.xanchor[k]),
        axis=sealed(data.xaxis[k]),
        zero=float(model.qpos0[model.jnt_qposadr[k]]),
        lower=float(model.jnt_range[k, 0]) if limited else None,
        upper=float(model.jnt_range[k, 1]) if limited else None,
        effort=_find_effort(model, k),
        speed=urdf_joint.speed if urdf_joint else None,
        gain=_find_gain(model, k),
        armature=_positive(model.dof_armature[dof]),
        friction=_positive(model.dof_frictionloss[dof]),
        damping=_positive(model.dof_damping[dof]),
    )


def _find_effort(model: mujoco.MjModel, joint: int) -> float | None:
    """Return the smallest torque limit [Nm] of a joint and its actuators.

    None if the file gives no positive limit.
    """
    values = [float(model.jnt_actfrcrange[joint, 1])] if model.jnt_actfrclimited[joint] else []
    for a in _actuators(model, joint):
        gear = abs(float(model.actuator_gear[a, 0]))
        if model.actuator_forcelimited[a]:
            values.append(gear * float(model.actuator_forcerange[a, 1]))
        elif model.actuator_ctrllimited[a] and model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_NONE:
            values.append(gear * abs(float(model.actuator_gainprm[a, 0] * model.actuator_ctrlrange[a, 1])))
    return _positive(min(values, default=0.0))


def _find_gain(model: mujoco.MjModel, joint: int) -> float | None:
    """Return the gain [Nm/rad] of a joint's position actuator, or None."""
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
    geoms = [geom for geom in range(model.ngeom) if int(model.geom_bodyid[geom]) in bodies]
    shapes = [shape for geom in geoms for shape in _approximate_by_capsules(model, data, geom)]
    return ModelPart(mass, sealed(centre), tuple(shapes))


def _approximate_by_capsules(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> tuple[Capsule, ...]:
    """Approximate a primitive shape by capsules, a wide box by several.

    Other shapes and very small ones give none.
    """
    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    centre, frame = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    offsets = np.zeros((1, 3))
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        half, radius = np.zeros(3), float(size[0])
    elif kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        half, radius = frame[:, 2] * size[1], float(size[0])
    elif kind in (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_ELLIPSOID):
        sizes = np.array([size[0], size[0], size[1]]) if kind == mujoco.mjtGeom.mjGEOM_CYLINDER else size
        long = int(np.argmax(sizes))
        thin, wide = sorted({0, 1, 2} - {long}, key=lambda axis: float(sizes[axis]))
        radius = float(sizes[[thin, wide]].mean())
        if kind == mujoco.mjtGeom.mjGEOM_BOX and sizes[wide] > MAX_SINGLE_WIDTH_RATIO * sizes[thin]:
            count = min(ceil(sizes[wide] / sizes[thin]), MAX_BOX_CAPSULES)
            radius = float(max(sizes[thin], sizes[wide] / count))
            offsets = np.outer(np.linspace(-1.0, 1.0, count) * (sizes[wide] - radius), frame[:, wide])
        half = frame[:, long] * max(float(sizes[long]) - radius, 0.0)
    else:
        return ()
    if radius < MIN_SHAPE_RADIUS:
        return ()
    return tuple(Capsule(sealed(centre + row - half), sealed(centre + row + half), radius) for row in offsets)
