"""Recognition of legs among the limbs of an imported robot."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.joint_words import count_leg_words
from kinesic.sim.importer.model_tree import ModelPart, Tree

GROUND_TOLERANCE = 0.06  # height above the robot's lowest point up to which a limb reaches the ground, in limb lengths
MIN_LOAD_HEIGHT = 0.05  # height of the carried mass above the first joint that suggests a leg, in limb lengths
MIN_SOLE_RATIO = 1.4  # horizontal / vertical extent of a last part above which it may be a foot
MIN_LATERAL_COSINE = 0.7  # |cosine| between an axis and the lateral direction above which a joint is a knee or an elbow
MIN_ONE_SIDED_RATIO = 0.6  # |mid-range| / half range above which a joint bends to one side only


@dataclass(frozen=True)
class Feet:
    """Verdict on a limb."""

    is_leg: bool
    is_doubtful: bool  # whether geometry is ambiguous and names give no hint


def rate_limb(tree: Tree, limb: Sequence[int], others: Sequence[Sequence[int]]) -> Feet:
    """Judge whether a limb is a leg or an arm.

    Joint names decide if they mention parts of legs or arms. Otherwise a leg reaches the ground, carries the mass of
    the trunk above its first joint, and ends in a flat sole or has a knee, which bends backward. Two pairs of limbs
    that begin at the same height and reach the ground are legs, too.

    Args:
        tree: Robot with x forward, y left and z up.
        limb: Hinges of the limb, from the trunk outwards.
        others: Limbs of the other pairs.
    """
    votes = count_leg_words(tree.joints[k].name for k in limb)
    if votes:
        return Feet(votes > 0, is_doubtful=False)
    length = _measure_length(tree, limb)
    if not _reaches_ground(tree, limb, length):
        return Feet(is_leg=False, is_doubtful=False)
    start = float(tree.joints[limb[0]].anchor[2])
    for other in others:
        same_height = abs(float(tree.joints[other[0]].anchor[2]) - start) < GROUND_TOLERANCE * length
        if same_height and _reaches_ground(tree, other, length):
            return Feet(is_leg=True, is_doubtful=False)
    limb_parts = {k for row in (limb, *others) for k in tree.below(row[0])}
    carried = tree.merge_parts([k for k in range(-1, len(tree.joints)) if k not in limb_parts])
    is_above = float(carried.centre[2]) - start > MIN_LOAD_HEIGHT * length
    marks = int(_has_sole(tree.merge_parts(tree.below(limb[-1])))) + _count_knees(tree, limb)
    return Feet(is_above and marks > 0, is_doubtful=is_above != (marks > 0))


def _measure_length(tree: Tree, limb: Sequence[int]) -> float:
    points = [*(tree.joints[k].anchor for k in limb), tree.merge_parts(tree.below(limb[-1])).centre]
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _reaches_ground(tree: Tree, limb: Sequence[int], length: float) -> bool:
    """Return whether a limb ends near the robot's lowest point."""
    every = [find_bottom(part) for part in (tree.base, *tree.parts)]
    lowest = min(every)
    end = min(find_bottom(tree.parts[k]) for k in tree.below(limb[-1]))
    return end - lowest <= GROUND_TOLERANCE * length


def find_bottom(part: ModelPart) -> float:
    """Return the height [m] of a part's lowest point."""
    ends = [float(end[2]) - shape.radius for shape in part.shapes for end in (shape.start, shape.end)]
    visible = [float(surface.mesh.vertices[:, 2].min()) for surface in part.surfaces]
    return min((*ends, *visible), default=float(part.centre[2]))


def _has_sole(part: ModelPart) -> bool:
    points = _list_corners(part)
    if not len(points):
        return False
    forward, lateral, height = np.ptp(points, axis=0)
    return bool(max(forward, lateral) > MIN_SOLE_RATIO * height)


def _list_corners(part: ModelPart) -> Floats:
    """Return points (n, 3) [m] that bound the shapes of a part."""
    corners = [_bound_capsule(shape) for shape in part.shapes]
    return np.concatenate([np.zeros((0, 3)), *corners, *(surface.mesh.vertices for surface in part.surfaces)])


def _bound_capsule(shape: Capsule) -> Floats:
    ends = np.array([shape.start, shape.end])
    return np.concatenate([ends - shape.radius, ends + shape.radius])


def _count_knees(tree: Tree, limb: Sequence[int]) -> int:
    """Count hinges of knees, minus those of elbows.

    A knee bends backward only, an elbow forward only.
    """
    count = 0
    for k in limb[1:-1]:
        joint = tree.joints[k]
        if abs(float(joint.axis[1])) < MIN_LATERAL_COSINE or joint.lower is None or joint.upper is None:
            continue
        middle, half = (joint.lower + joint.upper) / 2 - joint.zero, (joint.upper - joint.lower) / 2
        if half > 0 and abs(middle) > MIN_ONE_SIDED_RATIO * half:
            count += 1 if middle * float(joint.axis[1]) > 0 else -1  # positive rotation about +y moves a shin back
    return count
