"""Zero pose of an imported humanoid: upright with hanging arms."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Side
from kinesic.sim.importer.arm import Centres, Split, centres, likeness, splits
from kinesic.sim.importer.hanging_pose import HangingPose, Posed, Ranges, pose_arm
from kinesic.sim.importer.hinge_row import HingeRow
from kinesic.sim.importer.mirror import Sides, sides
from kinesic.sim.importer.model_tree import BASE_INDEX, Tree

MIN_ARM_HINGES = 3  # smallest number of hinges of an arm
FINGER_MASS_RATIO = 0.15  # links lighter than this fraction of their parent count as fingers
MIRROR_SIGNS = sealed([1.0, -1.0, 1.0])  # signs that mirror a vector at the x-z plane
HANGING_ARM = HangingPose(upper=sealed([0, 0, -1]), fore=sealed([0, 0, -1]), hinge=sealed([0, -1, 0]))
RIVAL_LIKENESS_GAP = 0.8  # difference from the best `likeness` up to which other arm divisions are tried, too


@dataclass(frozen=True)
class Branches:
    """Hinge indices of trunk, neck and arms, from the base outwards."""

    trunk: tuple[int, ...]  # carries the arms
    neck: tuple[int, ...]  # moves the head; without the eyes
    left: tuple[int, ...]  # arm, up to where its fingers part
    right: tuple[int, ...]


def branches(tree: Tree, sides: Sides) -> Branches:
    """Find the hinges of arms, trunk and neck.

    The arms are the pair of limbs that begins highest. The trunk carries them.

    Raises:
        ConfigError: there is no pair of limbs with enough hinges.
    """
    limbs = [_find_limb(tree, sides, k) for k in sides.pairs if tree.joints[k].parent not in _both(sides)]
    arms = [limb for limb in limbs if len(limb) >= MIN_ARM_HINGES]
    if not arms:
        raise ConfigError(
            f"robot {tree.name}: no arms found: among {len(tree.joints)} hinges there are {len(sides.pairs)} mirror "
            f"pairs, but no pair of limbs with {MIN_ARM_HINGES} hinges each"
        )
    left = max(arms, key=lambda limb: tree.joints[limb[0]].anchor[2])
    trunk = tree.path_from_base(tree.joints[left[0]].parent)
    return Branches(trunk, _find_neck(tree, sides, trunk, left), left, tuple(sides.pairs[k] for k in left))


def _both(sides: Sides) -> set[int]:
    return set(sides.pairs) | set(sides.pairs.values())


def _find_limb(tree: Tree, sides: Sides, first: int) -> tuple[int, ...]:
    """Return the hinges of a limb up to its hand.

    The limb ends where it branches, where only a finger is left, or where the other side differs.
    """
    row = [first]
    while True:
        next_joints = [k for k in tree.children[row[-1]] if k in sides.pairs and tree.joints[k].follows is None]
        min_mass = FINGER_MASS_RATIO * tree.parts[row[-1]].mass
        if len(next_joints) != 1 or tree.merge_parts(tree.below(next_joints[0])).mass < min_mass:
            return tuple(row)
        row.append(next_joints[0])


def _find_neck(tree: Tree, sides: Sides, trunk: tuple[int, ...], arm: tuple[int, ...]) -> tuple[int, ...]:
    """Return the unpaired branch that ends highest above the shoulders.

    Empty if no branch ends above them.
    """
    paired, carriers = _both(sides), (trunk[-1] if trunk else BASE_INDEX,)
    paths = []
    for first in (k for carrier in carriers for k in tree.children[carrier] if k not in paired):
        path = [first]
        while next_joints := [k for k in tree.children[path[-1]] if k not in paired]:
            path.append(max(next_joints, key=lambda k: tree.joints[k].anchor[2]))
        paths.append(tuple(k for k in path if "eye" not in tree.joints[k].name.lower()))
    above = [path for path in paths if path and tree.joints[path[-1]].anchor[2] > tree.joints[arm[0]].anchor[2]]
    return max(above, key=lambda path: tree.joints[path[-1]].anchor[2], default=())


@dataclass(frozen=True, eq=False)
class HangingArm:
    """Hinges and joint centres of one hanging arm."""

    joints: tuple[int, ...]  # of the tree, fingers left out
    limb: HingeRow
    centres: Centres
    off: float  # [rad] larger angle of its two bones from the vertical


@dataclass(frozen=True, eq=False)
class HumanoidGeometry:
    """Branches, sides and arms of a humanoid in its zero pose.

    Axes are x forward, y left and z up, with the midline at y = 0 and hanging arms.
    """

    tree: Tree
    sides: Sides
    trunk: tuple[int, ...]
    neck: tuple[int, ...]
    split: Split
    likeness: float  # of the split
    arms: dict[Side, HangingArm]

    @property
    def arm_length(self) -> float:
        """Length [m] of the left arm from shoulder to wrist."""
        return sum(self.arms["l"].centres.lengths)

    @property
    def asymmetry(self) -> float:
        """Largest distance between mirrored joint centres of both arms, in arm lengths."""
        left, right = (np.array([a.centres.shoulder, a.centres.elbow, a.centres.wrist]) for a in self.arms.values())
        return float(np.linalg.norm(left - right * MIRROR_SIGNS, axis=1).max()) / self.arm_length


def analyse_geometry(tree: Tree) -> HumanoidGeometry:
    """Find trunk, neck and arms of a robot in its zero pose.

    Raises:
        ConfigError: the robot has no arms.
    """
    sides_found = sides(tree)
    upright = tree.moved(sides_found.upright, np.zeros(3))
    branch_rows = branches(upright, sides_found)
    split, left = _choose_split(upright, branch_rows)
    row, image = branch_rows.left[: split.hinges], branch_rows.right[: split.hinges]
    right = hang_arm(
        upright, image, split, HANGING_ARM, strict=False, first=mirror_angles(upright, row, image, left.angles)
    )
    turns = dict(zip((*row, *image), (*left.angles, *right.angles), strict=True))
    hanging = upright.turned(turns)
    limbs = {"l": HingeRow.of(hanging, row), "r": HingeRow.of(hanging, image)}
    middle = np.mean([centres(limb, split).shoulder[1] for limb in limbs.values()])
    standing = hanging.moved(np.eye(3), np.array([0.0, -float(middle), 0.0]))
    arms: dict[Side, HangingArm] = {"l": _arm(standing, row, split, left), "r": _arm(standing, image, split, right)}
    return HumanoidGeometry(
        standing, sides_found, branch_rows.trunk, branch_rows.neck, split, likeness(arms["l"].limb, split), arms
    )


def hang_arm(
    tree: Tree, row: tuple[int, ...], split: Split, target: HangingPose, *, strict: bool, first: Floats | None = None
) -> Posed:
    """Find the hinge angles that bring an arm nearest to a pose."""
    return pose_arm(
        HingeRow.of(tree, row), split, target, _find_ranges(tree, row, strict), [] if first is None else [first]
    )


def mirror_angles(tree: Tree, row: tuple[int, ...], image: tuple[int, ...], angles: Floats) -> Floats:
    """Mirror the angles (k,) [rad] of one arm to the other.

    Valid if the tree's pose is symmetric.
    """
    signs = [
        np.sign(tree.joints[a].axis * -MIRROR_SIGNS @ tree.joints[b].axis) or 1.0
        for a, b in zip(row, image, strict=True)
    ]
    return np.array(signs) * angles


def _choose_split(tree: Tree, branch_rows: Branches) -> tuple[Split, Posed]:
    """Return the hinge division most similar to a hanging human arm.

    Only the best candidates in the pose of the file are tried.
    """
    limb = HingeRow.of(tree, branch_rows.left)
    ranked = {split: likeness(limb, split) for split in splits(len(branch_rows.left))}
    candidates = []
    for split in (split for split, score in ranked.items() if score >= max(ranked.values()) - RIVAL_LIKENESS_GAP):
        row = branch_rows.left[: split.hinges]
        pose = hang_arm(tree, row, split, HANGING_ARM, strict=False)
        candidates.append((likeness(HingeRow.of(tree, row).turned(pose.angles), split), split, pose))
    _, split, pose = max(candidates, key=lambda candidate: candidate[0])
    return split, pose


def _arm(tree: Tree, row: tuple[int, ...], split: Split, pose: Posed) -> HangingArm:
    limb = HingeRow.of(tree, row)
    return HangingArm(row, limb, centres(limb, split), pose.off)


def _find_ranges(tree: Tree, row: tuple[int, ...], strict: bool) -> Ranges:
    """Return the hinge ranges [rad] relative to the tree's pose."""
    joints = [tree.joints[k] for k in row]
    lower = sealed([-np.inf if joint.lower is None else joint.lower - joint.zero for joint in joints])
    upper = sealed([np.inf if joint.upper is None else joint.upper - joint.zero for joint in joints])
    return Ranges(lower, upper, strict)
