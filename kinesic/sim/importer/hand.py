"""Fingers of a foreign robot by geometry: which is the thumb, where the palm is, and what each hinge does.

The thumb is the finger that stands apart from the others: its name says so, or its base lies behind theirs and it
points another way. The palm is where fingers bend to.
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

FINGERS = ("thumb", "index", "middle", "ring", "pinky")
FEWEST_FINGERS = 3  # fingers of a hand; less is a gripper
ALONG = 0.8  # cosine between an axis and a direction that it counts as
FLEXION, SPREAD = (0.0, radians(80)), (radians(-10), radians(15))  # where the file tells no range
WHOLE_TURN = radians(350)  # a wider range is none
GIRTH = 0.09  # radius of a finger, as a share of its length
THIN, THICK = 0.004, 0.011  # [m]
MOST_FOLLOWERS = 10  # of hinges that follow one another


@dataclass(frozen=True, eq=False)
class MappedFinger:
    """A finger of the foreign robot as kinesic's: a segment for each of its hinges."""

    name: str
    turns: tuple[MappedHinge, ...]  # from the palm outward, those that follow others included
    follows: dict[str, tuple[str, float, float]]  # hinge -> hinge that leads it, ratio, offset [rad]
    tip: Floats  # (3,) [m] in the world, hanging
    radius: float  # [m]

    @property
    def hinges(self) -> tuple[MappedHinge, ...]:
        """The hinges that have a motor of their own."""
        return tuple(turn for turn in self.turns if turn.name not in self.follows)


@dataclass(frozen=True, eq=False)
class MappedHand:
    """A hand with fingers."""

    fingers: tuple[MappedFinger, ...]  # the thumb first
    knuckles: Floats  # (3,) [m] the middle of where the fingers begin, in the world, hanging
    facing: Floats  # (3,) unit: where the palm looks


@dataclass(frozen=True, eq=False)
class _Row:
    """The hinges of a finger in the tree."""

    joints: tuple[int, ...]
    base: Floats  # (3,) [m]
    tip: Floats  # (3,) [m]

    @property
    def along(self) -> Floats:
        return np.asarray((self.tip - self.base) / max(float(np.linalg.norm(self.tip - self.base)), 1e-9))


@dataclass(frozen=True, eq=False)
class _Axes:
    """The hand's own directions, (3,) each."""

    along: Floats  # from the wrist to the finger tips
    across: Floats  # towards the thumb
    palm: Floats  # out of the palm


def find_hand(figure: HumanoidGeometry, side: Side) -> MappedHand | None:
    """Finds the fingers of a hand; None where there are too few, or they point nowhere."""
    tree = figure.tree
    rows = [_row(tree, row) for row in _chains(tree, figure.arms[side].joints[-1])]
    rows = [row for row in rows if np.linalg.norm(row.tip - row.base) > THIN]
    if len(rows) < FEWEST_FINGERS:
        return None
    thumb = _thumb(tree, rows)
    others = [row for row in rows if row is not thumb]
    axes = _axes(tree, thumb, others)
    others.sort(key=lambda row: float(-row.base @ axes.across))
    named = [("thumb", thumb), *zip(FINGERS[1:], others, strict=False)]
    names = {
        k: name for finger, row in named for k, name in zip(row.joints, _names(tree, finger, row, axes), strict=True)
    }
    turns = {
        k: _turn(tree.joints[k], k, side, f"{finger}{place}", names[k], _sense(tree.joints[k], names[k], row, axes))
        for finger, row in named
        for place, k in enumerate(row.joints, 1)
    }
    fingers = tuple(_finger(tree, finger, row, turns) for finger, row in named)
    return MappedHand(fingers, sealed(np.mean([row.base for row in others], axis=0)), sealed(axes.palm))


def _chains(tree: Tree, joint: int) -> Iterator[tuple[int, ...]]:
    """Yields the hinges of each finger; what several fingers share is held as it is."""
    for child in tree.children[joint]:
        row = [child]
        while len(tree.children[row[-1]]) == 1:
            row.append(tree.children[row[-1]][0])
        if tree.children[row[-1]]:
            yield from _chains(tree, row[-1])
        else:
            yield tuple(row)


def _row(tree: Tree, row: tuple[int, ...]) -> _Row:
    """The tip is the end of the last shape, or as far beyond the last part's centre as that is from its hinge."""
    anchor, part = tree.joints[row[-1]].anchor, tree.parts[row[-1]]
    ends = [end for shape in part.shapes for end in (shape.start, shape.end)]
    far = max(ends, key=lambda end: float(np.linalg.norm(end - anchor)), default=2 * part.centre - anchor)
    return _Row(row, tree.joints[row[0]].anchor, far)


def _thumb(tree: Tree, rows: Sequence[_Row]) -> _Row:
    named = [row for row in rows if any("thumb" in tree.joints[k].name.lower() for k in row.joints)]
    return named[0] if len(named) == 1 else max(rows, key=lambda row: _apartness(row, rows))


def _apartness(row: _Row, rows: Sequence[_Row]) -> float:
    """How far a finger's direction and base are from those of the others."""
    others = [other for other in rows if other is not row]
    along = np.mean([other.along for other in others], axis=0)
    along /= max(float(np.linalg.norm(along)), 1e-9)
    length = float(np.mean([np.linalg.norm(other.tip - other.base) for other in others]))
    behind = float((np.mean([other.base for other in others], axis=0) - row.base) @ along) / length
    return float(np.arccos(np.clip(row.along @ along, -1.0, 1.0))) + behind


def _axes(tree: Tree, thumb: _Row, others: Sequence[_Row]) -> _Axes:
    along = _unit(np.mean([row.along for row in others], axis=0))
    bases = np.array([row.base for row in others])
    middle = bases.mean(axis=0)
    across = np.linalg.svd(bases - middle)[2][0]
    across = _unit(across - (across @ along) * along)
    across = across * (np.sign(across @ (thumb.base + thumb.tip - 2 * middle)) or 1.0)
    palm = np.cross(along, across)
    bends = sum(
        _larger_end(tree.joints[k]) * float(_moved(tree.joints[k], row.tip) @ palm)
        for row in others
        for k in row.joints
    )
    return _Axes(along, across, palm if bends >= 0.0 else -palm)


def _larger_end(joint: Joint) -> float:
    """The sense in which most of its range lies."""
    if joint.lower is None or joint.upper is None:
        return 0.0
    return float(np.sign(joint.upper + joint.lower - 2 * joint.zero))


def _moved(joint: Joint, tip: Floats) -> Floats:
    """(3,) where a tip goes when a hinge turns."""
    return np.asarray(np.cross(joint.axis, tip - joint.anchor))


def _names(tree: Tree, finger: str, row: _Row, axes: _Axes) -> Iterator[str]:
    """Yields what each hinge of a finger is called: flexions are numbered, of others there is one, the rest rests."""
    joints = [tree.joints[k] for k in row.joints]
    if finger == "thumb":
        shares = [float(abs(_unit(_moved(joint, row.tip)) @ axes.palm)) for joint in joints]
        aside = int(np.argmax(shares[:-1])) if len(joints) > 1 else -1
        if abs(float(joints[aside].axis @ joints[-1].axis)) > ALONG:  # it only bends
            aside = -1
    else:
        spreads = [k for k, joint in enumerate(joints) if abs(float(joint.axis @ axes.palm)) > ALONG]
        aside = spreads[0] if spreads else -1
    count = 0
    for k, joint in enumerate(joints):
        turned = abs(float(joint.axis @ row.along)) > ALONG and finger != "thumb"
        if k == aside:
            yield f"{finger}_abduct" if finger != "middle" else f"{finger}_pivot"
        elif turned or (finger != "thumb" and abs(float(joint.axis @ axes.palm)) > ALONG):
            yield f"{finger}_turn{k + 1}"
        else:
            count += 1
            yield f"{finger}_flexion{count}"


def _sense(joint: Joint, name: str, row: _Row, axes: _Axes) -> float:
    """+1 when the hinge already turns as kinesic's does: flexion towards the palm, fingers away from the middle one."""
    finger, turn = name.split("_")
    moved = _moved(joint, row.tip)
    if finger == "thumb":
        wanted = axes.palm if turn == "abduct" else axes.palm / 2 - axes.across
    elif turn.startswith("flexion"):
        wanted = axes.palm
    else:
        wanted = axes.across if finger == "index" else -axes.across
    return float(np.sign(moved @ wanted)) or 1.0


def _turn(joint: Joint, k: int, side: Side, segment: str, name: str, sign: float) -> MappedHinge:
    lower, upper = SPREAD if name.endswith(("abduct", "pivot")) else FLEXION
    assumed = joint.lower is None or joint.upper is None or joint.upper - joint.lower > WHOLE_TURN
    if joint.lower is not None and joint.upper is not None and not assumed:
        ends = sorted((sign * (joint.lower - joint.zero), sign * (joint.upper - joint.zero)))
        lower, upper = max(ends[0], -pi), min(ends[1], pi)
    axis = sealed(sign * joint.axis)
    return MappedHinge(
        f"{side}_{name}", f"{side}_{segment}", k, sign, joint.zero, joint.anchor, axis, lower, upper, assumed
    )


def _finger(tree: Tree, name: str, row: _Row, turns: dict[int, MappedHinge]) -> MappedFinger:
    own = tuple(turns[k] for k in row.joints)
    length = float(np.linalg.norm(row.tip - row.base))
    follows = {turn.name: led for turn in own if (led := _led(tree, turn, turns)) is not None}
    return MappedFinger(name, own, follows, sealed(row.tip), min(max(GIRTH * length, THIN), THICK))


def _led(tree: Tree, turn: MappedHinge, turns: dict[int, MappedHinge]) -> tuple[str, float, float] | None:
    """Which motorised hinge of the hand leads another one, by which ratio and offset [rad]; None: none does."""
    named = {tree.joints[k].name: k for k in turns}
    ratio, offset, joint = 1.0, 0.0, turn.joint
    for _ in range(MOST_FOLLOWERS):
        follow = tree.joints[joint].follows
        if follow is None:
            break
        if follow.driver not in named:
            return None
        ratio, offset, joint = ratio * follow.ratio, offset + ratio * follow.offset, named[follow.driver]
    if joint == turn.joint or tree.joints[joint].follows is not None:
        return None
    lead = turns[joint]
    return (
        lead.name,
        turn.sign * ratio * lead.sign,
        turn.sign * (offset + ratio * lead.zero - turn.zero),
    )


def _unit(vector: Floats) -> Floats:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-9))
