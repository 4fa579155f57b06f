"""Recognition of thumb, fingers and palm by geometry.

The thumb is the finger that differs from the others: its name says so, or its base is behind theirs and it points in
another direction. The palm is on the side to which fingers bend.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi, radians

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Side
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.model_tree import Joint, Tree
from kinesic.sim.importer.zero_pose import HumanoidGeometry

FINGER_NAMES = ("thumb", "index", "middle", "ring", "pinky")  # finger names in robot files, thumb first
MIN_FINGERS = 3  # smallest number of fingers of a hand, with the thumb; fewer make a gripper
MIN_ALIGNED_COSINE = 0.8  # cosine above which two directions count as aligned
FLEXION_RANGE = (0.0, radians(80))  # [rad] range of flexion if the file gives none
SPREAD_RANGE = (radians(-10), radians(15))  # [rad] range of spreading if the file gives none
MAX_USEFUL_RANGE = radians(350)  # [rad] widest joint range that is used; a default replaces wider ranges
FINGER_RADIUS_RATIO = 0.09  # radius of a finger / its length
MIN_FINGER_RADIUS = 0.004  # [m] lower limit of a finger's radius
MAX_FINGER_RADIUS = 0.011  # [m] upper limit of a finger's radius
MAX_COUPLING_DEPTH = 10  # largest number of successive couplings between a finger joint and its motor


@dataclass(frozen=True, eq=False)
class MappedFinger:
    """Finger of the imported robot, with one segment for each hinge."""

    name: str
    turns: tuple[MappedHinge, ...]  # from the palm outwards, including coupled hinges
    follows: dict[str, tuple[str, float, float]]  # coupled hinge -> driver, ratio, offset [rad]
    tip: Floats  # (3,) [m] in the world, with hanging arms
    radius: float  # [m] of the finger's capsules

    @property
    def hinges(self) -> tuple[MappedHinge, ...]:
        """Hinges driven directly by a motor."""
        return tuple(turn for turn in self.turns if turn.name not in self.follows)


@dataclass(frozen=True, eq=False)
class MappedHand:
    """Hand of the imported robot with its fingers."""

    fingers: tuple[MappedFinger, ...]  # thumb first
    knuckles: Floats  # (3,) [m] mean base of the fingers in the world, with hanging arms
    facing: Floats  # (3,) unit normal of the palm


@dataclass(frozen=True, eq=False)
class _Row:
    """Hinges of one finger, with base and tip positions."""

    joints: tuple[int, ...]
    base: Floats  # (3,) [m]
    tip: Floats  # (3,) [m]

    @property
    def along(self) -> Floats:
        return np.asarray((self.tip - self.base) / max(float(np.linalg.norm(self.tip - self.base)), 1e-9))


@dataclass(frozen=True, eq=False)
class _Axes:
    """Unit vectors (3,) along the axes of a hand's frame."""

    along: Floats  # from the wrist to the finger tips
    across: Floats  # towards the thumb
    palm: Floats  # out of the palm


def find_hand(figure: HumanoidGeometry, side: Side) -> MappedHand | None:
    """Find the fingers and the palm of a hand, or return None.

    Returns:
        None if there are too few fingers of sufficient length.
    """
    tree = figure.tree
    rows = [_make_row(tree, row) for row in _list_chains(tree, figure.arms[side].joints[-1])]
    rows = [row for row in rows if np.linalg.norm(row.tip - row.base) > MIN_FINGER_RADIUS]
    if len(rows) < MIN_FINGERS:
        return None
    thumb = _find_thumb(tree, rows)
    others = [row for row in rows if row is not thumb]
    axes = _find_axes(tree, thumb, others)
    others.sort(key=lambda row: float(-row.base @ axes.across))
    named = [("thumb", thumb), *zip(FINGER_NAMES[1:], others, strict=False)]
    names = {
        k: name
        for finger, row in named
        for k, name in zip(row.joints, _name_hinges(tree, finger, row, axes), strict=True)
    }
    turns = {
        k: _map_turn(
            tree.joints[k], k, side, f"{finger}{place}", names[k], _find_sense(tree.joints[k], names[k], row, axes)
        )
        for finger, row in named
        for place, k in enumerate(row.joints, 1)
    }
    fingers = tuple(_map_finger(tree, finger, row, turns) for finger, row in named)
    return MappedHand(fingers, sealed(np.mean([row.base for row in others], axis=0)), sealed(axes.palm))


def _list_chains(tree: Tree, joint: int) -> Iterator[tuple[int, ...]]:
    """Yield the hinge indices of each finger, from the palm outwards.

    Hinges before a branch, which several fingers have in common, are kept fixed.
    """
    for child in tree.children[joint]:
        row = [child]
        while len(tree.children[row[-1]]) == 1:
            row.append(tree.children[row[-1]][0])
        if tree.children[row[-1]]:
            yield from _list_chains(tree, row[-1])
        else:
            yield tuple(row)


def _make_row(tree: Tree, row: tuple[int, ...]) -> _Row:
    """Return a finger's hinges with its base and tip positions [m].

    The tip is the far end of the last part's shapes. Without shapes it is the mirror image of the last hinge at the
    part's centre of mass.
    """
    anchor, part = tree.joints[row[-1]].anchor, tree.parts[row[-1]]
    ends = [end for shape in part.shapes for end in (shape.start, shape.end)]
    tip = max(ends, key=lambda end: float(np.linalg.norm(end - anchor)), default=2 * part.centre - anchor)
    return _Row(row, tree.joints[row[0]].anchor, tip)


def _find_thumb(tree: Tree, rows: Sequence[_Row]) -> _Row:
    named = [row for row in rows if any("thumb" in tree.joints[k].name.lower() for k in row.joints)]
    return named[0] if len(named) == 1 else max(rows, key=lambda row: _score_apartness(row, rows))


def _score_apartness(row: _Row, rows: Sequence[_Row]) -> float:
    """Score a finger's separation from the others, largest for a thumb.

    The score is the angle [rad] to the others' mean direction plus the distance of its base behind theirs, in finger
    lengths.
    """
    others = [other for other in rows if other is not row]
    along = np.mean([other.along for other in others], axis=0)
    along /= max(float(np.linalg.norm(along)), 1e-9)
    length = float(np.mean([np.linalg.norm(other.tip - other.base) for other in others]))
    behind = float((np.mean([other.base for other in others], axis=0) - row.base) @ along) / length
    return float(np.arccos(np.clip(row.along @ along, -1.0, 1.0))) + behind


def _find_axes(tree: Tree, thumb: _Row, others: Sequence[_Row]) -> _Axes:
    along = _normalise(np.mean([row.along for row in others], axis=0))
    bases = np.array([row.base for row in others])
    middle = bases.mean(axis=0)
    across = np.linalg.svd(bases - middle)[2][0]
    across = _normalise(across - (across @ along) * along)
    across = across * (np.sign(across @ (thumb.base + thumb.tip - 2 * middle)) or 1.0)
    palm = np.cross(along, across)
    bends = sum(
        _find_range_sign(tree.joints[k]) * float(_find_tip_direction(tree.joints[k], row.tip) @ palm)
        for row in others
        for k in row.joints
    )
    return _Axes(along, across, palm if bends >= 0.0 else -palm)


def _find_range_sign(joint: Joint) -> float:
    """Return the sign of a joint's mid-range relative to its current angle.

    0 for a symmetric or unknown range.
    """
    if joint.lower is None or joint.upper is None:
        return 0.0
    return float(np.sign(joint.upper + joint.lower - 2 * joint.zero))


def _find_tip_direction(joint: Joint, tip: Floats) -> Floats:
    """Return a fingertip's velocity (3,) [m/s] per rad/s of a hinge."""
    return np.asarray(np.cross(joint.axis, tip - joint.anchor))


def _name_hinges(tree: Tree, finger: str, row: _Row, axes: _Axes) -> Iterator[str]:
    """Yield a name for each hinge of a finger.

    Flexions are numbered. At most one hinge spreads the finger. Other hinges are named `turn` and stay at rest.
    """
    joints = [tree.joints[k] for k in row.joints]
    if finger == "thumb":
        alignments = [float(abs(_normalise(_find_tip_direction(joint, row.tip)) @ axes.palm)) for joint in joints]
        spread_index = int(np.argmax(alignments[:-1])) if len(joints) > 1 else -1
        if (
            abs(float(joints[spread_index].axis @ joints[-1].axis)) > MIN_ALIGNED_COSINE
        ):  # the thumb has parallel axes and only bends
            spread_index = -1
    else:
        spreads = [k for k, joint in enumerate(joints) if abs(float(joint.axis @ axes.palm)) > MIN_ALIGNED_COSINE]
        spread_index = spreads[0] if spreads else -1
    count = 0
    for k, joint in enumerate(joints):
        is_twist = abs(float(joint.axis @ row.along)) > MIN_ALIGNED_COSINE and finger != "thumb"
        if k == spread_index:
            yield f"{finger}_abduct" if finger != "middle" else f"{finger}_pivot"
        elif is_twist or (finger != "thumb" and abs(float(joint.axis @ axes.palm)) > MIN_ALIGNED_COSINE):
            yield f"{finger}_turn{k + 1}"
        else:
            count += 1
            yield f"{finger}_flexion{count}"


def _find_sense(joint: Joint, name: str, row: _Row, axes: _Axes) -> float:
    """Return +1 if a finger hinge rotates in kinesic's direction, otherwise -1.

    Positive flexion moves towards the palm, positive abduction away from the middle finger.
    """
    finger, turn = name.split("_")
    moved = _find_tip_direction(joint, row.tip)
    if finger == "thumb":
        positive_direction = axes.palm if turn == "abduct" else axes.palm / 2 - axes.across
    elif turn.startswith("flexion"):
        positive_direction = axes.palm
    else:
        positive_direction = axes.across if finger == "index" else -axes.across
    return float(np.sign(moved @ positive_direction)) or 1.0


def _map_turn(joint: Joint, k: int, side: Side, segment: str, name: str, sign: float) -> MappedHinge:
    lower, upper = SPREAD_RANGE if name.endswith(("abduct", "pivot")) else FLEXION_RANGE
    assumed = joint.lower is None or joint.upper is None or joint.upper - joint.lower > MAX_USEFUL_RANGE
    if joint.lower is not None and joint.upper is not None and not assumed:
        ends = sorted((sign * (joint.lower - joint.zero), sign * (joint.upper - joint.zero)))
        lower, upper = max(ends[0], -pi), min(ends[1], pi)
    axis = sealed(sign * joint.axis)
    return MappedHinge(
        f"{side}_{name}", f"{side}_{segment}", k, sign, joint.zero, joint.anchor, axis, lower, upper, assumed
    )


def _map_finger(tree: Tree, name: str, row: _Row, turns: dict[int, MappedHinge]) -> MappedFinger:
    finger_turns = tuple(turns[k] for k in row.joints)
    length = float(np.linalg.norm(row.tip - row.base))
    follows = {
        turn.name: coupling for turn in finger_turns if (coupling := _find_driver(tree, turn, turns)) is not None
    }
    return MappedFinger(
        name,
        finger_turns,
        follows,
        sealed(row.tip),
        min(max(FINGER_RADIUS_RATIO * length, MIN_FINGER_RADIUS), MAX_FINGER_RADIUS),
    )


def _find_driver(tree: Tree, turn: MappedHinge, turns: dict[int, MappedHinge]) -> tuple[str, float, float] | None:
    """Return driver, ratio and offset of a coupled hinge, or None.

    Returns:
        Name of the driver, ratio and offset [rad]; None if no hinge of the hand drives it.
    """
    named = {tree.joints[k].name: k for k in turns}
    ratio, offset, joint = 1.0, 0.0, turn.joint
    for _ in range(MAX_COUPLING_DEPTH):
        follow = tree.joints[joint].follows
        if follow is None:
            break
        if follow.driver not in named:
            return None
        ratio, offset, joint = ratio * follow.ratio, offset + ratio * follow.offset, named[follow.driver]
    if joint == turn.joint or tree.joints[joint].follows is not None:
        return None
    driver = turns[joint]
    return (
        driver.name,
        turn.sign * ratio * driver.sign,
        turn.sign * (offset + ratio * driver.zero - turn.zero),
    )


def _normalise(vector: Floats) -> Floats:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-9))
