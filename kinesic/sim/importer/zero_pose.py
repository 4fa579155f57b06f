"""Zero pose of an imported humanoid: upright with hanging arms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES, Side
from kinesic.sim.importer.arm import Centres, Split, centres, likeness, splits
from kinesic.sim.importer.branches import Branches, branches
from kinesic.sim.importer.hanging_pose import HangingPose, Posed, Ranges, pose_arm
from kinesic.sim.importer.hinge_row import HingeRow
from kinesic.sim.importer.mirror import Sides, sides
from kinesic.sim.importer.model_tree import Tree
from kinesic.sim.importer.wishes import NO_WISHES, Wishes

MIRROR_SIGNS = sealed([1.0, -1.0, 1.0])  # signs that mirror a vector at the x-z plane
HANGING_ARM = HangingPose(upper=sealed([0, 0, -1]), fore=sealed([0, 0, -1]), hinge=sealed([0, -1, 0]))
RIVAL_LIKENESS_GAP = 0.8  # difference from the best `likeness` up to which other arm divisions are tried, too


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
    likeness: float  # score of the arm's hinge division by `likeness`
    arms: dict[Side, HangingArm]  # one or two
    legs: tuple[int, ...] = ()  # hinges of legs, which are not imported
    is_doubtful: bool = False  # whether the arms may be legs
    wishes: Wishes = NO_WISHES  # requested hinges, on both sides

    @property
    def arm_length(self) -> float:
        """Length [m] of the first arm from shoulder to wrist."""
        return sum(first_arm(self).centres.lengths)

    @property
    def asymmetry(self) -> float:
        """Largest distance between mirrored joint centres of both arms, in arm lengths.

        Zero for a single arm.
        """
        if len(self.arms) < len(SIDES):
            return 0.0
        left, right = (np.array([a.centres.shoulder, a.centres.elbow, a.centres.wrist]) for a in self.arms.values())
        return float(np.linalg.norm(left - right * MIRROR_SIGNS, axis=1).max()) / self.arm_length


def first_arm(figure: HumanoidGeometry) -> HangingArm:
    """Return the left arm, or the only arm."""
    return next(iter(figure.arms.values()))


def find_mid_shoulders(figure: HumanoidGeometry) -> Floats:
    """Return the midpoint (3,) [m] between the shoulders."""
    x, _, z = first_arm(figure).centres.shoulder
    return sealed([x, 0.0, z])


def analyse_geometry(tree: Tree, wishes: Wishes = NO_WISHES) -> HumanoidGeometry:
    """Find trunk, neck and arms of a robot in its zero pose.

    Raises:
        ConfigError: the robot has no arms.
    """
    sides_found = wishes.orient(sides(tree))
    wishes = wishes.on_both_sides(sides_found)
    upright = tree.moved(sides_found.upright, np.zeros(3))
    branch_rows = branches(upright, sides_found, wishes.arm_joints)
    first_side, first_limb = next(iter(branch_rows.arms.items()))
    split, posed = _choose_split(upright, first_limb, _list_splits(branch_rows, wishes))
    rows = {side: limb[: split.hinges] for side, limb in branch_rows.arms.items()}
    poses = {first_side: posed}
    for side, row in rows.items():
        if side != first_side:
            start = mirror_angles(upright, rows[first_side], row, posed.angles)
            poses[side] = hang_arm(upright, row, split, HANGING_ARM, strict=False, first=start)
    turns = {k: angle for side, row in rows.items() for k, angle in zip(row, poses[side].angles, strict=True)}
    hanging = upright.turned(turns)
    middle = _find_middle(hanging, rows, split, branch_rows)
    standing = hanging.moved(np.eye(3), np.array([0.0, -middle, 0.0]))
    arms = {side: _arm(standing, row, split, poses[side]) for side, row in rows.items()}
    return HumanoidGeometry(
        standing,
        sides_found,
        branch_rows.trunk,
        branch_rows.neck,
        split,
        likeness(arms[first_side].limb, split),
        arms,
        branch_rows.legs,
        branch_rows.is_doubtful,
        wishes,
    )


def _find_middle(tree: Tree, rows: Mapping[Side, tuple[int, ...]], split: Split, branch_rows: Branches) -> float:
    """Return the lateral coordinate [m] of the midline.

    It is between the shoulders. With a single arm it is that of neck, trunk or base.
    """
    if len(rows) == len(SIDES):
        return float(np.mean([centres(HingeRow.of(tree, row), split).shoulder[1] for row in rows.values()]))
    spine = branch_rows.neck or branch_rows.trunk
    return float(tree.joints[spine[0]].anchor[1] if spine else tree.base.centre[1])


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


def _list_splits(branch_rows: Branches, wishes: Wishes) -> list[Split]:
    """List the divisions of the arms' hinges that fit the requested mapping.

    Raises:
        ConfigError: there is none.
    """
    arms = list(branch_rows.arms.values())
    fitting = [split for split in splits(len(arms[0])) if all(wishes.allows(split, arm) for arm in arms)]
    if not fitting:
        raise ConfigError("--map: no division of the arm into shoulder, elbow and wrist has these hinges")
    return fitting


def _choose_split(tree: Tree, arm: tuple[int, ...], fitting: Sequence[Split]) -> tuple[Split, Posed]:
    """Return the hinge division most similar to a hanging human arm.

    Only the best candidates in the pose of the file are tried.
    """
    limb = HingeRow.of(tree, arm)
    ranked = {split: likeness(limb, split) for split in fitting}
    candidates = []
    for split in (split for split, score in ranked.items() if score >= max(ranked.values()) - RIVAL_LIKENESS_GAP):
        row = arm[: split.hinges]
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
