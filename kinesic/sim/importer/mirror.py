"""Which hinges are mirror images of one another, and which side is left."""

import re
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.importer.model_tree import BASE, Joint, Tree

GEOMETRIC_PAIRS = 6  # pairs found by geometry that need no names
NEAR = 0.02  # [m] between a point of an axis and the mirror image of its partner's
ALIKE = 0.98  # cosine between an axis and the mirror image of its partner
ASIDE = 0.01  # [m] from the plane at which a hinge is on a side
UP = np.array([0.0, 0.0, 1.0])

_WORDS = (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"))
_LETTERS = (("l", "r"), ("L", "R"))


@dataclass(frozen=True)
class Sides:
    """Pairs of hinges and the direction of left."""

    pairs: dict[int, int]  # left -> right
    left: tuple[float, float]  # unit direction to the left, x and y of the file's world
    certain: bool  # names or the sense of the feet and the head say which side is left
    by_names: bool  # the pose of the file is not symmetric, so names told the pairs

    @property
    def upright(self) -> Floats:
        """(3, 3) that turns the file's world to x forward, y left, z up."""
        y = np.array([*self.left, 0.0])
        return np.array([np.cross(y, UP), y, UP])


def sides(tree: Tree) -> Sides:
    """Finds the pairs by geometry (a plane about which axes mirror), by names where that finds too few."""
    found = max((_mirrored(tree, lateral, plane) for lateral, plane in _planes(tree)), key=len)
    named = _named(tree)
    by_names = len(found) < GEOMETRIC_PAIRS and len(named) > len(found)
    pairs = named if by_names else found
    vote = sum(_side_of(tree.joints[a].name, tree.joints[b].name) for a, b in pairs.items())
    across = sum(((tree.joints[a].anchor - tree.joints[b].anchor)[:2] for a, b in pairs.items()), np.zeros(2))
    left = _axis(across)
    if vote < 0 or (vote == 0 and _sense(tree, pairs, left) < 0.0):
        pairs = {b: a for a, b in pairs.items()}
        left = (-left[0], -left[1])
    return Sides(pairs, left, vote != 0 or _sense(tree, pairs, left) != 0.0, by_names)


def _planes(tree: Tree) -> list[tuple[int, float]]:
    """Candidates for the mirror plane: across which axis of the world (1: y, 0: x), and where [m]."""
    anchors = np.array([joint.anchor for joint in tree.joints])
    return [
        (lateral, float(plane))
        for lateral in (1, 0)
        for plane in (0.0, tree.base.centre[lateral], np.median(anchors[:, lateral]))
    ]


def _mirrored(tree: Tree, lateral: int, plane: float) -> dict[int, int]:
    """Pairs of hinges whose axes mirror about a plane, and whose parents do too."""
    flip = np.ones(3)
    flip[lateral] = -1.0
    pairs: dict[int, int] = {}
    partner: dict[int, int] = {BASE: BASE}
    for k, joint in enumerate(tree.joints):
        if k in partner or joint.parent not in partner:
            continue
        image = joint.anchor * flip + (1.0 - flip) * plane
        rivals = [
            (_off(other, image, joint.axis * flip), j)
            for j, other in enumerate(tree.joints)
            if j not in partner and other.parent == partner[joint.parent]
        ]
        miss, best = min(rivals)
        if best == k or miss > NEAR:
            if _off(joint, image, joint.axis * flip) <= NEAR:
                partner[k] = k
            continue
        partner[k], partner[best] = best, k
        side = joint.anchor[lateral] - tree.joints[best].anchor[lateral]
        pairs |= {k: best} if side >= 0 else {best: k}
    return pairs


def _off(joint: Joint, point: Floats, axis: Floats) -> float:
    """How far a hinge is from a line [m]; infinite where the directions differ."""
    if abs(joint.axis @ axis) < ALIKE:
        return np.inf
    return float(np.linalg.norm(joint.anchor - point)) * 0.1 + float(
        np.linalg.norm(np.cross(point - joint.anchor, axis))
    )


def _named(tree: Tree) -> dict[int, int]:
    """Pairs of hinges whose names differ in nothing but the side."""
    names = {joint.name: k for k, joint in enumerate(tree.joints)}
    pairs = {}
    for name, k in names.items():
        for image in _images(name):
            if image in names:
                pairs[k] = names[image]
                break
    return pairs


def _images(name: str) -> list[str]:
    words = [name.replace(left, right) for left, right in _WORDS if left in name]
    letters = [re.sub(rf"(^|_){left}(?=_|$|[A-Z])", rf"\g<1>{right}", name) for left, right in _LETTERS]
    return [image for image in (*words, *letters) if image != name]


def _side_of(a: str, b: str) -> int:
    """+1: the first name says left, -1: right, 0: neither."""
    return int(b in _images(a)) - int(a in _images(b))


def _axis(across: Floats) -> tuple[float, float]:
    lateral = int(np.argmax(np.abs(across)))
    sign = 1.0 if across[lateral] >= 0 else -1.0
    return (sign, 0.0) if lateral == 0 else (0.0, sign)


def _sense(tree: Tree, pairs: dict[int, int], left: tuple[float, float]) -> float:
    """How far toes and head reach forward [m], if left is left; zero when nothing does."""
    forward = np.cross([*left, 0.0], UP)
    ends = [k for k in range(len(tree.joints)) if not tree.children[k]]
    lowest = min(ends, key=lambda k: tree.joints[k].anchor[2], default=None)
    reach = 0.0
    for k in [] if lowest is None else [lowest, pairs.get(lowest, lowest)]:
        reach += float((tree.parts[k].centre - tree.joints[k].anchor) @ forward)
    for k in ends:
        if k not in pairs and k not in pairs.values():
            reach += float((tree.parts[k].centre - tree.joints[k].anchor) @ forward)
    return reach if abs(reach) > ASIDE else 0.0
