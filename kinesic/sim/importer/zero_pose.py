"""The figure that a foreign robot makes when it stands upright and its arms hang: kinesic's zero pose."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Side
from kinesic.sim.importer.arm import Centres, Split, centres, likeness, splits
from kinesic.sim.importer.hanging_pose import HangingPose, Posed, Ranges, pose_arm
from kinesic.sim.importer.hinge_row import HingeRow
from kinesic.sim.importer.mirror import Sides, sides
from kinesic.sim.importer.model_tree import BASE, Tree

FEWEST_HINGES = 3  # hinges of an arm
FINGER = 0.15  # of the mass of what carries it: a hinge that moves less moves a finger
ACROSS = sealed([1.0, -1.0, 1.0])
HANGING = HangingPose(upper=sealed([0, 0, -1]), fore=sealed([0, 0, -1]), hinge=sealed([0, -1, 0]))
RIVAL = 0.8  # likeness behind the best at which a split is still hung up and looked at again


@dataclass(frozen=True)
class Branches:
    """Indices of the hinges of trunk, neck and arms, from the base outward."""

    trunk: tuple[int, ...]  # carries the arms
    neck: tuple[int, ...]  # moves the head; without the eyes
    left: tuple[int, ...]  # arm, up to where its fingers part
    right: tuple[int, ...]


def branches(tree: Tree, sides: Sides) -> Branches:
    """Finds arms, trunk and head: arms are the pair of limbs that begins highest, the trunk carries them.

    Raises:
        ConfigError: there is no pair of limbs with enough hinges.
    """
    limbs = [_limb(tree, sides, k) for k in sides.pairs if tree.joints[k].parent not in _both(sides)]
    arms = [limb for limb in limbs if len(limb) >= FEWEST_HINGES]
    if not arms:
        raise ConfigError(
            f"robot {tree.name}: no arms found: among {len(tree.joints)} hinges there are {len(sides.pairs)} mirror "
            f"pairs, but no pair of limbs with {FEWEST_HINGES} hinges each"
        )
    left = max(arms, key=lambda limb: tree.joints[limb[0]].anchor[2])
    trunk = tree.way(tree.joints[left[0]].parent)
    return Branches(trunk, _neck(tree, sides, trunk, left), left, tuple(sides.pairs[k] for k in left))


def _both(sides: Sides) -> set[int]:
    return set(sides.pairs) | set(sides.pairs.values())


def _limb(tree: Tree, sides: Sides, first: int) -> tuple[int, ...]:
    """From its first hinge to where it parts or only a finger is left, as long as both sides go along."""
    row = [first]
    while True:
        onward = [k for k in tree.children[row[-1]] if k in sides.pairs and tree.joints[k].follows is None]
        least = FINGER * tree.parts[row[-1]].mass
        if len(onward) != 1 or tree.lump(tree.below(onward[0])).mass < least:
            return tuple(row)
        row.append(onward[0])


def _neck(tree: Tree, sides: Sides, trunk: tuple[int, ...], arm: tuple[int, ...]) -> tuple[int, ...]:
    """The unpaired branch that ends highest above the shoulders."""
    paired, carriers = _both(sides), (trunk[-1] if trunk else BASE,)
    ways = []
    for first in (k for carrier in carriers for k in tree.children[carrier] if k not in paired):
        way = [first]
        while onward := [k for k in tree.children[way[-1]] if k not in paired]:
            way.append(max(onward, key=lambda k: tree.joints[k].anchor[2]))
        ways.append(tuple(k for k in way if "eye" not in tree.joints[k].name.lower()))
    above = [way for way in ways if way and tree.joints[way[-1]].anchor[2] > tree.joints[arm[0]].anchor[2]]
    return max(above, key=lambda way: tree.joints[way[-1]].anchor[2], default=())


@dataclass(frozen=True, eq=False)
class HangingArm:
    """One arm, hanging."""

    joints: tuple[int, ...]  # of the tree, fingers left out
    limb: HingeRow
    centres: Centres
    off: float  # [rad] of its worse bone from the vertical


@dataclass(frozen=True, eq=False)
class HumanoidGeometry:
    """Everything that geometry tells, in x forward, y left, z up, the midline at y = 0, arms hanging."""

    tree: Tree
    sides: Sides
    trunk: tuple[int, ...]
    neck: tuple[int, ...]
    split: Split
    likeness: float  # of the split
    arms: dict[Side, HangingArm]

    @property
    def arm_length(self) -> float:
        """Shoulder to wrist of the left arm [m]."""
        return sum(self.arms["l"].centres.lengths)

    @property
    def asymmetry(self) -> float:
        """How far the right arm's centres are from the left's mirror images, in arm lengths."""
        left, right = (np.array([a.centres.shoulder, a.centres.elbow, a.centres.wrist]) for a in self.arms.values())
        return float(np.linalg.norm(left - right * ACROSS, axis=1).max()) / self.arm_length


def geometry_of(tree: Tree) -> HumanoidGeometry:
    """Finds trunk, neck and arms of a robot, and lets the arms hang.

    Raises:
        ConfigError: it has no arms.
    """
    found = sides(tree)
    upright = tree.moved(found.upright, np.zeros(3))
    rows = branches(upright, found)
    split, left = _best(upright, rows)
    row, image = rows.left[: split.hinges], rows.right[: split.hinges]
    right = hang_arm(
        upright, image, split, HANGING, strict=False, first=mirror_angles(upright, row, image, left.angles)
    )
    turns = dict(zip((*row, *image), (*left.angles, *right.angles), strict=True))
    hanging = upright.turned(turns)
    limbs = {"l": HingeRow.of(hanging, row), "r": HingeRow.of(hanging, image)}
    middle = np.mean([centres(limb, split).shoulder[1] for limb in limbs.values()])
    standing = hanging.moved(np.eye(3), np.array([0.0, -float(middle), 0.0]))
    arms: dict[Side, HangingArm] = {"l": _arm(standing, row, split, left), "r": _arm(standing, image, split, right)}
    return HumanoidGeometry(standing, found, rows.trunk, rows.neck, split, likeness(arms["l"].limb, split), arms)


def hang_arm(
    tree: Tree, row: tuple[int, ...], split: Split, wish: HangingPose, *, strict: bool, first: Floats | None = None
) -> Posed:
    """Finds the angles that bring an arm of a tree nearest to a wish."""
    return pose_arm(HingeRow.of(tree, row), split, wish, _ranges(tree, row, strict), [] if first is None else [first])


def mirror_angles(tree: Tree, row: tuple[int, ...], image: tuple[int, ...], angles: Floats) -> Floats:
    """Mirrors an arm's angles (k,) [rad] to the other one, if the tree's pose is symmetric."""
    signs = [
        np.sign(tree.joints[a].axis * -ACROSS @ tree.joints[b].axis) or 1.0 for a, b in zip(row, image, strict=True)
    ]
    return np.array(signs) * angles


def _best(tree: Tree, rows: Branches) -> tuple[Split, Posed]:
    """The split that looks most like an arm when it hangs; those that look best in the file's pose are tried."""
    limb = HingeRow.of(tree, rows.left)
    ranked = {split: likeness(limb, split) for split in splits(len(rows.left))}
    tried = []
    for split in (split for split, like in ranked.items() if like >= max(ranked.values()) - RIVAL):
        row = rows.left[: split.hinges]
        pose = hang_arm(tree, row, split, HANGING, strict=False)
        tried.append((likeness(HingeRow.of(tree, row).turned(pose.angles), split), split, pose))
    _, split, pose = max(tried, key=lambda one: one[0])
    return split, pose


def _arm(tree: Tree, row: tuple[int, ...], split: Split, pose: Posed) -> HangingArm:
    limb = HingeRow.of(tree, row)
    return HangingArm(row, limb, centres(limb, split), pose.off)


def _ranges(tree: Tree, row: tuple[int, ...], strict: bool) -> Ranges:
    """Ranges [rad] as angles from the tree's pose."""
    joints = [tree.joints[k] for k in row]
    lower = sealed([-np.inf if joint.lower is None else joint.lower - joint.zero for joint in joints])
    upper = sealed([np.inf if joint.upper is None else joint.upper - joint.zero for joint in joints])
    return Ranges(lower, upper, strict)
