"""Trunk, neck and arms in the tree of an imported robot."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.robot import Side
from kinesic.sim.importer.feet import rate_limb
from kinesic.sim.importer.joint_words import list_parts
from kinesic.sim.importer.mirror import Sides, find_named_side
from kinesic.sim.importer.model_tree import BASE_INDEX, Joint, Tree

MIN_ARM_HINGES = 3  # smallest number of hinges of an arm
FINGER_MASS_RATIO = 0.15  # links lighter than this fraction of their parent count as fingers
SENSOR_MASS_RATIO = 0.05  # largest mass moved by a sensor of the head / mass of the part that carries the sensor
SPINDLE_MASS_RATIO = 0.5  # largest mass moved by a hinge without limits at the neck's end / mass of the hinge's carrier
MAX_SAME_AXIS = 4  # largest number of hinges of trunk or neck about the same axis
MIN_VERTICAL_COSINE = 0.9  # |cosine| between an axis and the vertical above which the hinge turns the trunk
MIN_ARM_OFFSET = 0.05  # [m] distance of a single arm's centre from the midline


@dataclass(frozen=True)
class Branches:
    """Hinge indices of trunk, neck and arms, from the base outwards."""

    trunk: tuple[int, ...]  # carries the arms
    neck: tuple[int, ...]  # moves the head; without the eyes
    arms: Mapping[Side, tuple[int, ...]]  # up to where the fingers part; one or two
    legs: tuple[int, ...] = ()  # hinges of legs
    is_doubtful: bool = False  # whether the arms may be legs

    @property
    def left(self) -> tuple[int, ...]:
        """Hinges of the left arm, empty if there is none."""
        return self.arms.get("l", ())

    @property
    def right(self) -> tuple[int, ...]:
        """Hinges of the right arm, empty if there is none."""
        return self.arms.get("r", ())


def branches(tree: Tree, sides: Sides, arm_joints: Collection[int] = ()) -> Branches:
    """Find the hinges of arms, trunk and neck.

    The arms are the pair of limbs that begins highest and does not end in feet, or a single limb. The trunk carries
    them.

    Args:
        tree: Robot with x forward, y left and z up.
        sides: Left-right pairs of its hinges.
        arm_joints: Hinges that certainly belong to arms.

    Raises:
        ConfigError: there is no limb with enough hinges, or all limbs are legs.
    """
    if not tree.joints:
        raise ConfigError(f"robot {tree.name}: no movable joint: all joints of the file are fixed or slide")
    limbs = [_find_limb(tree, sides, k) for k in sides.pairs if tree.joints[k].parent not in _both(sides)]
    verdicts = {limb: rate_limb(tree, limb, [other for other in limbs if other != limb]) for limb in limbs}
    requested = [limb for limb in limbs if {*limb, *(sides.pairs[k] for k in limb)} & set(arm_joints)]
    legs = [limb for limb in limbs if verdicts[limb].is_leg and limb not in requested]
    leg_hinges = tuple(k for limb in legs for first in (limb[0], sides.pairs[limb[0]]) for k in tree.below(first))
    pairs = [limb for limb in limbs if len(limb) >= MIN_ARM_HINGES and limb not in legs]
    arms: dict[Side, tuple[int, ...]] = {}
    if pairs:
        candidates = [limb for limb in pairs if limb in requested] or pairs
        left = max(candidates, key=lambda limb: tree.joints[limb[0]].anchor[2])
        arms = {"l": left, "r": tuple(sides.pairs[k] for k in left)}
    else:
        arms = _find_single_arm(tree, sides)
    if not arms:
        raise ConfigError(f"robot {tree.name}: {_explain_absence(tree, sides, legs)}")
    first = next(iter(arms.values()))
    trunk = tree.path_from_base(tree.joints[first[0]].parent)
    others = _both(sides) | {k for arm in arms.values() for k in tree.below(arm[0])}
    neck = _find_neck(tree, others, trunk, first)
    is_doubtful = bool(pairs) and verdicts[arms["l"]].is_doubtful and arms["l"] not in requested
    return Branches(_limit_same_axis(tree, trunk), _limit_same_axis(tree, neck), arms, leg_hinges, is_doubtful)


def _explain_absence(tree: Tree, sides: Sides, legs: Sequence[tuple[int, ...]]) -> str:
    if legs:
        names = ", ".join(tree.joints[limb[0]].name for limb in legs)
        return f"no movable arms; the mirrored limbs end in feet (they begin at {names})"
    return (
        f"no arms found: among {len(tree.joints)} hinges there are {len(sides.pairs)} mirror pairs, but no pair of "
        f"limbs, and no single arm, with {MIN_ARM_HINGES} hinges each"
    )


def _both(sides: Sides) -> set[int]:
    return set(sides.pairs) | set(sides.pairs.values())


def _find_limb(tree: Tree, sides: Sides, first: int) -> tuple[int, ...]:
    """Return the hinges of a paired limb up to its hand.

    The limb ends where it branches, where only a finger is left, or where the other side differs.
    """
    return _follow_limb(tree, first, lambda k: k in sides.pairs)


def _follow_limb(tree: Tree, first: int, belongs: Callable[[int], bool]) -> tuple[int, ...]:
    row = [first]
    while True:
        next_joints = [k for k in tree.children[row[-1]] if belongs(k) and tree.joints[k].follows is None]
        min_mass = FINGER_MASS_RATIO * tree.parts[row[-1]].mass
        if len(next_joints) != 1 or tree.merge_parts(tree.below(next_joints[0])).mass < min_mass:
            return tuple(row)
        row.append(next_joints[0])


def _find_single_arm(tree: Tree, sides: Sides) -> dict[Side, tuple[int, ...]]:
    """Find the only arm of a robot, by its side.

    It is the longest limb beside the midline that has no partner on the other side and is no leg.
    """
    middle, paired = _find_midline(tree, sides), _both(sides)
    limbs: dict[tuple[int, ...], Side] = {}
    for k, joint in enumerate(tree.joints):
        offset = float(tree.merge_parts(tree.below(k)).centre[1]) - middle
        if (
            k in paired
            or _is_trunk(joint, middle)
            or (joint.parent != BASE_INDEX and joint.parent in {j for row in limbs for j in row})
        ):
            continue
        if abs(offset) < MIN_ARM_OFFSET:
            continue
        limb = _follow_limb(tree, k, lambda j: j not in paired)
        if len(limb) >= MIN_ARM_HINGES and not rate_limb(tree, limb, []).is_leg:
            named = sum(find_named_side(tree.joints[j].name) for j in limb)
            is_left = named > 0 if named else offset > 0
            limbs[limb] = "l" if is_left else "r"
    if not limbs:
        return {}
    arm = max(limbs, key=len)
    return {limbs[arm]: arm}


def _is_trunk(joint: Joint, middle: float) -> bool:
    """Return whether a hinge on the midline turns the trunk.

    The shoulder of a single arm in front of the trunk may have the same axis, but is named after the arm.
    """
    if abs(float(joint.anchor[1]) - middle) >= MIN_ARM_OFFSET:
        return False
    part = list_parts(joint.name)[-1:]
    return part == ["trunk"] or (part != ["arm"] and abs(float(joint.axis[2])) > MIN_VERTICAL_COSINE)


def _find_midline(tree: Tree, sides: Sides) -> float:
    """Return the lateral coordinate [m] of the midline.

    It is that of mirror pairs, or else of the base's centre.
    """
    if sides.pairs:
        return float(
            np.mean([(tree.joints[a].anchor[1] + tree.joints[b].anchor[1]) / 2 for a, b in sides.pairs.items()])
        )
    return float(tree.base.centre[1])


def _find_neck(tree: Tree, others: set[int], trunk: tuple[int, ...], arm: tuple[int, ...]) -> tuple[int, ...]:
    """Return the highest branch above the shoulders, without arms, eyes and sensors.

    Empty if no branch ends above them.
    """
    carriers = (trunk[-1] if trunk else BASE_INDEX,)
    paths = []
    for first in (k for carrier in carriers for k in tree.children[carrier] if k not in others):
        path = [first]
        while next_joints := [k for k in tree.children[path[-1]] if k not in others]:
            path.append(max(next_joints, key=lambda k: tree.joints[k].anchor[2]))
        paths.append(_without_sensors(tree, path))
    above = [path for path in paths if path and tree.joints[path[-1]].anchor[2] > tree.joints[arm[0]].anchor[2]]
    return max(above, key=lambda path: tree.joints[path[-1]].anchor[2], default=())


def _without_sensors(tree: Tree, path: Sequence[int]) -> tuple[int, ...]:
    """Remove eyes from a branch, and sensors from its end."""
    kept = [k for k in path if "eye" not in tree.joints[k].name.lower()]
    while kept and _is_sensor(tree, kept[-1], is_first=len(kept) == 1):
        kept.pop()
    return tuple(kept)


def _is_sensor(tree: Tree, k: int, *, is_first: bool) -> bool:
    """Return whether a hinge at a branch's end moves a sensor.

    Otherwise it belongs to the neck.
    """
    joint = tree.joints[k]
    if list_parts(joint.name)[-1:] == ["sensor"]:
        return True
    carrier = tree.base if joint.parent == BASE_INDEX else tree.parts[joint.parent]
    ratio = tree.merge_parts(tree.below(k)).mass / max(carrier.mass, 1e-9)
    if joint.lower is None or joint.upper is None:
        return ratio < (SENSOR_MASS_RATIO if is_first else SPINDLE_MASS_RATIO)
    return ratio < SENSOR_MASS_RATIO and not is_first


def _limit_same_axis(tree: Tree, joints: Iterable[int]) -> tuple[int, ...]:
    """Keep up to four hinges about the same axis, nearest the base."""
    kept: list[int] = []
    for k in joints:
        axes = [int(np.argmax(np.abs(tree.joints[j].axis))) for j in (*kept, k)]
        if axes.count(axes[-1]) <= MAX_SAME_AXIS:
            kept.append(k)
    return tuple(kept)
