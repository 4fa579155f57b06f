"""Couplings of an imported robot's hinges: mimic joints, equalities and gears."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree

import mujoco

from kinesic.body.arrays import sealed
from kinesic.sim.importer.model_tree import Follow, Joint

CURVE_TOLERANCE = 1e-9  # largest non-linear coefficient of a coupling that counts as linear
UNIT_RATIO_TOLERANCE = 1e-6  # difference from 1 of a gear ratio that counts as 1:1
MIN_GEAR_RATIO = 1e-3  # smallest |ratio| of a gear that can drive a limb


@dataclass(frozen=True)
class UrdfJoint:
    """Attributes of a URDF joint that MuJoCo drops."""

    speed: float | None  # [rad/s] velocity limit
    follows: Follow | None  # coupling of a mimic joint


def urdf_joints(root: ElementTree.Element) -> dict[str, UrdfJoint]:
    """Return a URDF's joints by name, empty for an MJCF.

    Raises:
        ValueError: a velocity is not a number.
    """
    if root.tag != "robot":
        return {}
    values = {}
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        speed = 0.0 if limit is None else float(limit.get("velocity", 0.0))
        values[joint.get("name", "")] = UrdfJoint(speed if speed > 0 else None, _mimic(joint.find("mimic")))
    return values


def _mimic(mimic: ElementTree.Element | None) -> Follow | None:
    if mimic is None:
        return None
    return Follow(mimic.get("joint", ""), float(mimic.get("multiplier", 1.0)), float(mimic.get("offset", 0.0)))


@dataclass(frozen=True)
class Equalities:
    """Couplings between hinges from the equality constraints of an MJCF file."""

    follows: dict[str, Follow]  # coupled hinge -> coupling, with angles relative to the file's pose
    left_out: tuple[str, ...]  # notes on omitted constraints


def read_equalities(spec: mujoco.MjSpec) -> Equalities:
    """Read joint couplings from a model's equality constraints.

    A polynomial coupling is approximated by its constant and linear terms.
    """
    follows: dict[str, Follow] = {}
    left_out = []
    for equality in spec.equalities:
        is_coupling = equality.type == mujoco.mjtEq.mjEQ_JOINT and bool(equality.name2)
        if not is_coupling:
            left_out.append(
                f"the equality {equality.name or equality.name1} is left out: only joint couplings are supported"
            )
            continue
        offset, ratio, *curve = (float(value) for value in equality.data[:5])
        follows[equality.name1] = Follow(equality.name2, ratio, offset)
        if any(abs(value) > CURVE_TOLERANCE for value in curve):
            left_out.append(f"{equality.name1} follows {equality.name2} linearly, but non-linearly in the file")
    if len(spec.tendons):
        left_out.append(f"{len(spec.tendons)} tendons are left out: hinges that they drive move independently")
    return Equalities(follows, tuple(left_out))


def to_absolute(follows: dict[str, Follow], model: mujoco.MjModel) -> dict[str, Follow]:
    """Convert couplings from angles relative to the file's pose to absolute angles."""

    def zero(name: str) -> float:
        return float(model.qpos0[model.jnt_qposadr[model.joint(name).id]])

    return {
        name: replace(follow, offset=zero(name) + follow.offset - follow.ratio * zero(follow.driver))
        for name, follow in follows.items()
    }


@dataclass(frozen=True)
class Gears:
    """Coupled joints that carry limbs, with their motors."""

    fixed: frozenset[str]  # joints that do not become hinges: motors of gears, and coupled joints without such a motor
    motors: Mapping[str, Follow]  # joint that carries a limb -> coupling to the joint of its motor
    notes: tuple[str, ...]


def find_gears(model: mujoco.MjModel, follows: Mapping[str, Follow]) -> Gears:
    """Find the coupled joints that carry independent joints, and their motors.

    A limb continues after such a joint. If the joint that drives it moves only a gear wheel, the coupled joint becomes
    a hinge with the motor of that joint. Otherwise it is fixed.
    """
    hinges = {model.joint(k).name: int(model.jnt_bodyid[k]) for k in range(model.njnt)}
    independent = [body for name, body in hinges.items() if name not in follows]
    above = {body: _list_parents(model, body) for body in set(hinges.values())}
    fixed, motors, notes = set[str](), dict[str, Follow](), list[str]()
    for name, body in hinges.items():
        if name not in follows or not any(body in above[other] for other in independent):
            continue
        follow = _resolve(name, follows)
        wheel = None if follow is None else hinges.get(follow.driver)
        is_gear = (
            follow is not None
            and wheel is not None
            and wheel not in (body, *above[body])
            and body not in above[wheel]
            and not _carries_others(model, wheel, follow.driver, independent, above)
            and follow.driver not in fixed
            and abs(follow.ratio) > MIN_GEAR_RATIO
        )
        if follow is not None and is_gear:
            fixed.add(follow.driver)
            motors[name] = follow
            notes.append(f"{name} is driven by {follow.driver} through a gear, with ratio {follow.ratio:g}")
        else:
            fixed.add(name)
            notes.append(f"{name} follows another joint and is held, because a limb continues after it")
    return Gears(frozenset(fixed), motors, tuple(notes))


def _carries_others(
    model: mujoco.MjModel, wheel: int, driver: str, independent: Sequence[int], above: Mapping[int, Sequence[int]]
) -> bool:
    """Return whether the body of a motor's joint moves other hinges, too."""
    first, count = int(model.body_jntadr[wheel]), int(model.body_jntnum[wheel])
    is_shared = any(model.joint(k).name != driver for k in range(first, first + count))
    return is_shared or any(wheel in above[other] for other in independent)


def _list_parents(model: mujoco.MjModel, body: int) -> tuple[int, ...]:
    parents = []
    while body := int(model.body_parentid[body]):
        parents.append(body)
    return tuple(parents)


def _resolve(name: str, follows: Mapping[str, Follow]) -> Follow | None:
    """Resolve a joint's coupling to its independent driver, None in a cycle."""
    follow, seen = follows[name], {name}
    while follow.driver in follows:
        if follow.driver in seen:
            return None
        seen.add(follow.driver)
        further = follows[follow.driver]
        follow = Follow(further.driver, follow.ratio * further.ratio, follow.offset + follow.ratio * further.offset)
    return follow


def join_gear(driven: Joint, motor: Joint, follow: Follow) -> Joint:
    """Return a limb's hinge with the motor of its gear.

    With a ratio of 1:1 the hinge has the name and angle of the motor's joint, otherwise those of the driven joint.
    """
    ratio, size = follow.ratio, abs(follow.ratio)
    ends = [None if end is None else ratio * end + follow.offset for end in (motor.lower, motor.upper)]
    lower, upper = ends if ratio > 0 else reversed(ends)
    joint = replace(
        driven,
        lower=_narrower(driven.lower, lower, max),
        upper=_narrower(driven.upper, upper, min),
        effort=None if motor.effort is None else motor.effort / size,
        speed=None if motor.speed is None else motor.speed * size,
        gain=None if motor.gain is None else motor.gain / size**2,
        armature=_sum(driven.armature, None if motor.armature is None else motor.armature / size**2),
        friction=_sum(driven.friction, None if motor.friction is None else motor.friction / size),
        damping=_sum(driven.damping, None if motor.damping is None else motor.damping / size**2),
        follows=None,
    )
    if abs(size - 1.0) > UNIT_RATIO_TOLERANCE:
        return joint
    sign = 1.0 if ratio > 0 else -1.0
    ends = [None if end is None else sign * (end - follow.offset) for end in (joint.lower, joint.upper)]
    lower, upper = ends if ratio > 0 else reversed(ends)
    axis = joint.axis if ratio > 0 else sealed(-joint.axis)
    return replace(
        joint, name=motor.name, axis=axis, zero=sign * (joint.zero - follow.offset), lower=lower, upper=upper
    )


def _narrower(first: float | None, second: float | None, choose: Callable[[float, float], float]) -> float | None:
    if first is None or second is None:
        return second if first is None else first
    return choose(first, second)


def _sum(first: float | None, second: float | None) -> float | None:
    return None if first is None and second is None else (first or 0.0) + (second or 0.0)
