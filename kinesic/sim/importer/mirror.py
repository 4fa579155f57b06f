"""Left-right pairs of hinges, found by mirror symmetry or by name."""

import re
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.importer.model_tree import BASE_INDEX, Joint, Tree

MIN_GEOMETRIC_PAIRS = 6  # number of pairs found by symmetry below which pairs by joint name are tried
MAX_MIRROR_OFFSET = 0.02  # [m] largest weighted offset of an axis from the mirror image of its partner's
EQUAL_OFFSET = 0.002  # [m] difference of offsets below which two candidates count as equally near
MIN_MIRROR_COSINE = 0.98  # smallest cosine between an axis and the mirror image of its partner's axis
MIN_FORWARD_EXTENT = 0.01  # [m] forward extent of toes and head below which the forward direction is undecided
UP_AXIS = np.array([0.0, 0.0, 1.0])  # unit vector upward in the world

_SIDE_WORDS = (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"))  # left and right words in joint names
_SIDE_LETTERS = (("l", "r"), ("L", "R"))  # left and right letters in joint names


@dataclass(frozen=True)
class Sides:
    """Left-right pairs of hinges and the direction to the left."""

    pairs: dict[int, int]  # index of the left hinge -> index of the right hinge
    left: tuple[float, float]  # unit direction to the left, x and y of the file's world
    certain: bool  # whether names, or the direction of feet and head, determine the left side
    by_names: bool  # whether pairs were found by name, as the file's pose is not symmetric

    @property
    def upright(self) -> Floats:
        """Rotation (3, 3) from the file's world to x forward, y left."""
        y = np.array([*self.left, 0.0])
        return np.array([np.cross(y, UP_AXIS), y, UP_AXIS])


def sides(tree: Tree) -> Sides:
    """Find left-right pairs of hinges and the direction to the left.

    Pairs are found by mirror symmetry of the axes, or by name if symmetry finds too few.
    """
    geometric_pairs = max((_pair_by_symmetry(tree, lateral, plane) for lateral, plane in _list_planes(tree)), key=len)
    name_pairs = _pair_by_name(tree)
    by_names = len(geometric_pairs) < MIN_GEOMETRIC_PAIRS and len(name_pairs) > len(geometric_pairs)
    pairs = name_pairs if by_names else geometric_pairs
    vote = sum(_find_side(tree.joints[a].name, tree.joints[b].name) for a, b in pairs.items())
    left_sum = sum(((tree.joints[a].anchor - tree.joints[b].anchor)[:2] for a, b in pairs.items()), np.zeros(2))
    if not pairs:
        return _find_left_without_pairs(tree)
    left = _axis(left_sum)
    if vote < 0 or (vote == 0 and _measure_forward_extent(tree, pairs, left) < 0.0):
        pairs = {b: a for a, b in pairs.items()}
        left = (-left[0], -left[1])
    return Sides(pairs, left, vote != 0 or _measure_forward_extent(tree, pairs, left) != 0.0, by_names)


def _find_left_without_pairs(tree: Tree) -> Sides:
    """Find the left direction of a robot without limb pairs.

    Joint names decide; otherwise it is y, as in most robot files.
    """
    offsets = [find_named_side(joint.name) * (joint.anchor - tree.base.centre)[:2] for joint in tree.joints]
    offset = np.sum([np.zeros(2), *offsets], axis=0)
    certain = float(np.abs(offset).max()) > MAX_MIRROR_OFFSET
    return Sides({}, _axis(offset) if certain else (0.0, 1.0), certain, by_names=False)


def find_named_side(name: str) -> int:
    """Find the side in a joint name.

    1: left, -1: right, 0: neither.
    """
    words = [("l", "r"), *((left, right) for left, right in _SIDE_WORDS)]
    sides = {1: any(_mentions(name, left) for left, _ in words), -1: any(_mentions(name, right) for _, right in words)}
    return sides[1] - sides[-1]


def _mentions(name: str, side: str) -> bool:
    if len(side) > 1:
        return side in name
    return (
        re.search(rf"(^|_){side}(?=_|$|[A-Z])", name) is not None
        or re.match(rf"{side.upper()}[A-Z_]", name) is not None
    )


def _list_planes(tree: Tree) -> list[tuple[int, float]]:
    """Return candidates for the mirror plane.

    Returns:
        Index of the normal axis in the world (1: y, 0: x) and position [m] of each plane.
    """
    anchors = np.array([joint.anchor for joint in tree.joints]).reshape(-1, 3)
    return [
        (lateral, float(plane))
        for lateral in (1, 0)
        for plane in (0.0, tree.base.centre[lateral], np.median(anchors[:, lateral]) if tree.joints else 0.0)
    ]


def _pair_by_symmetry(tree: Tree, lateral: int, plane: float) -> dict[int, int]:
    """Return pairs of hinges with mirrored axes and mirrored parents.

    The first hinge of each pair has the larger coordinate along the normal of the plane.
    """
    flip = np.ones(3)
    flip[lateral] = -1.0
    centres = [tree.merge_parts(tree.below(k)).centre for k in range(len(tree.joints))]
    pairs: dict[int, int] = {}
    partners: dict[int, int] = {BASE_INDEX: BASE_INDEX}
    for k, joint in enumerate(tree.joints):
        if k in partners or joint.parent not in partners:
            continue  # paired before, or below an unpaired hinge
        image = joint.anchor * flip + (1.0 - flip) * plane
        mirrored_centre = centres[k] * flip + (1.0 - flip) * plane
        candidates = [
            (offset, float(np.linalg.norm(centres[j] - mirrored_centre)), j)
            for j, other in enumerate(tree.joints)
            if j not in partners and other.parent == partners[joint.parent]
            if (offset := _measure_mirror_offset(other, image, joint.axis * flip)) <= MAX_MIRROR_OFFSET
        ]
        nearest = _choose_partner(candidates)
        if nearest is None:
            continue
        partners[k], partners[nearest] = nearest, k
        if nearest != k:
            is_first = _is_on_positive_side(tree, k, nearest, pairs, centres, lateral)
            pairs |= {k: nearest} if is_first else {nearest: k}
    return pairs


def _choose_partner(candidates: list[tuple[float, float, int]]) -> int | None:
    """Return the best mirror partner of a hinge, or None without candidates.

    Hinges of both sides may share an axis on the midline. Among nearly equal axes, the moved masses decide.

    Args:
        candidates: Offset of the axis [m], offset of the centre of the moved mass [m] and index of each candidate.
    """
    least = min((offset for offset, _, _ in candidates), default=0.0)
    equal = [row for row in candidates if row[0] <= least + EQUAL_OFFSET]
    return min(equal, key=lambda row: row[1:], default=(0.0, 0.0, None))[2]


def _is_on_positive_side(
    tree: Tree, k: int, partner: int, pairs: dict[int, int], centres: list[Floats], lateral: int
) -> bool:
    """Return whether a pair's first hinge is on the positive side.

    True for the larger lateral coordinate.

    Below a pair, the sides of the parents decide. On the midline, the moved masses decide.
    """
    parent = tree.joints[k].parent
    if parent in pairs or parent in pairs.values():
        return parent in pairs
    offset = float(tree.joints[k].anchor[lateral] - tree.joints[partner].anchor[lateral])
    if abs(offset) < EQUAL_OFFSET:
        offset = float(centres[k][lateral] - centres[partner][lateral])
    return offset >= 0.0


def _measure_mirror_offset(joint: Joint, point: Floats, axis: Floats) -> float:
    """Return a hinge's weighted offset [m] from a mirrored hinge axis.

    The distance of the lines plus a tenth of the distance of their points; infinite if their directions differ.
    """
    if abs(joint.axis @ axis) < MIN_MIRROR_COSINE:
        return np.inf
    return float(np.linalg.norm(joint.anchor - point)) * 0.1 + float(
        np.linalg.norm(np.cross(point - joint.anchor, axis))
    )


def _pair_by_name(tree: Tree) -> dict[int, int]:
    """Return pairs of hinges whose names differ only in the side."""
    names = {joint.name: k for k, joint in enumerate(tree.joints)}
    pairs = {}
    for name, k in names.items():
        for image in _list_images(name):
            if image in names:
                pairs[k] = names[image]
                break
    return pairs


def _list_images(name: str) -> list[str]:
    words = [name.replace(left, right) for left, right in _SIDE_WORDS if left in name]
    letters = [re.sub(rf"(^|_){left}(?=_|$|[A-Z])", rf"\g<1>{right}", name) for left, right in _SIDE_LETTERS]
    return [image for image in (*words, *letters) if image != name]


def _find_side(a: str, b: str) -> int:
    """Return the side that the first of two joint names mentions.

    +1: left, -1: right, 0: neither.
    """
    return int(b in _list_images(a)) - int(a in _list_images(b))


def _axis(left_sum: Floats) -> tuple[float, float]:
    lateral = int(np.argmax(np.abs(left_sum)))
    sign = 1.0 if left_sum[lateral] >= 0 else -1.0
    return (sign, 0.0) if lateral == 0 else (0.0, sign)


def _measure_forward_extent(tree: Tree, pairs: dict[int, int], left: tuple[float, float]) -> float:
    """Return the summed forward extent [m] of toes and head.

    It is positive if the assumed left side is correct, and zero if it is too small to decide.
    """
    forward = np.cross([*left, 0.0], UP_AXIS)
    ends = [k for k in range(len(tree.joints)) if not tree.children[k]]
    lowest = min(ends, key=lambda k: tree.joints[k].anchor[2], default=None)
    extent = 0.0
    for k in [] if lowest is None else [lowest, pairs.get(lowest, lowest)]:
        extent += float((tree.parts[k].centre - tree.joints[k].anchor) @ forward)
    for k in ends:
        if k not in pairs and k not in pairs.values():
            extent += float((tree.parts[k].centre - tree.joints[k].anchor) @ forward)
    return extent if abs(extent) > MIN_FORWARD_EXTENT else 0.0
