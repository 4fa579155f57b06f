"""Tables of a hand with fingers: its segments, couplings, rest, and what does not count as a collision."""

from collections.abc import Mapping, Sequence
from math import degrees

import msgspec
import numpy as np

from kinesic.body.robot import Side
from kinesic.body.robot_schema import (
    BodyTable,
    CapsuleTable,
    CouplingTable,
    ExclusionTable,
    HingeTable,
    MountTable,
    RobotFile,
    SiteTable,
)
from kinesic.sim.importer.hand import MappedFinger, MappedHand
from kinesic.sim.importer.hinges import MappedHinge
from kinesic.sim.importer.model_tree import Tree
from kinesic.sim.importer.segments import SegmentLayout, own_capsules, rounded_triple

Hands = Mapping[Side, MappedHand]
BENT, OPPOSED = 0.3, 0.35  # shares of the ranges at rest: of flexion, of the thumb before the palm
SHORTEST_PART = 0.003  # [m] a shorter part has no shape of its own
SLACK = 1e-3  # [deg] that rounding may add to what a coupling is led to
ROUGH = 0.5  # times the way from the wrist to the knuckles: where the palm is


def with_hands(file: RobotFile, hands: Hands, tree: Tree, where: SegmentLayout) -> RobotFile:
    """Adds the fingers of hands to a robot's tables.

    Args:
        file: of the robot, without them; its hands' segments carry their weight.
        hands: by side.
        tree: the robot, arms hanging.
        where: its segments.
    """
    body, hinge, coupling = [*file.body], [*file.hinge], [*file.coupling]
    chains, sites, rest = dict(file.chains), dict(file.sites), dict(file.rest)
    exclude = [*file.collision.exclude]
    for side, hand in hands.items():
        wrist = f"{side}_wrist"
        turns = [turn for finger in hand.fingers for turn in finger.turns]
        parts = [part for finger in hand.fingers for part in _bodies(finger, tree, where, wrist)]
        body = [_lighter(each, sum(part.mass for part in parts)) if each.name == wrist else each for each in body]
        body += parts
        hinge += [_hinge(turn, where, wrist) for finger in hand.fingers for turn in finger.hinges]
        coupling += [row for finger in hand.fingers for row in _couplings(finger, turns)]
        chains[f"{side}_fingers"] = [turn.segment for turn in turns]
        sites[f"{side}_palm"] = _palm(hand, where, wrist)
        rest |= {turn.name: round(_resting(turn), 2) for finger in hand.fingers for turn in finger.hinges}
        exclude += [
            ExclusionTable((part, f"{side}_fingers"), "fingers close over their palm")
            for part in (wrist, f"{side}_elbow")
        ]
    return msgspec.structs.replace(
        file,
        body=body,
        hinge=hinge,
        coupling=coupling,
        chains=chains,
        sites=sites,
        rest=rest,
        collision=msgspec.structs.replace(file.collision, exclude=exclude),
    )


def _lighter(body: BodyTable, mass: float) -> BodyTable:
    return msgspec.structs.replace(body, mass=round(max(body.mass - mass, 0.0), 4))


def _bodies(finger: MappedFinger, tree: Tree, where: SegmentLayout, wrist: str) -> list[BodyTable]:
    found, parent, origin = [], wrist, where.origins[wrist]
    ends = [*(turn.anchor for turn in finger.turns[1:]), finger.tip]
    for turn, end in zip(finger.turns, ends, strict=True):
        part = tree.parts[turn.joint]
        capsules = own_capsules(part.shapes, turn.anchor)
        if not capsules and np.linalg.norm(end - turn.anchor) > SHORTEST_PART:
            bone = rounded_triple(end - turn.anchor)
            capsules = [CapsuleTable((0.0, 0.0, 0.0), bone, round(finger.radius, 6))]
        found.append(
            BodyTable(turn.segment, parent, rounded_triple(turn.anchor - origin), round(part.mass, 4), capsules)
        )
        parent, origin = turn.segment, turn.anchor
    return found


def _hinge(turn: MappedHinge, where: SegmentLayout, wrist: str) -> HingeTable:
    """Writes the table of a finger's hinge, whose motor sits in the hand."""
    return HingeTable(
        name=turn.name,
        body=turn.segment,
        axis=_axis(turn),
        range_deg=(round(degrees(turn.lower), 3), round(degrees(turn.upper), 3)),
        servo=turn.name[2:],
        mount=MountTable(wrist, (0.0, 0.0, 0.0)),
    )


def _couplings(finger: MappedFinger, turns: Sequence[MappedHinge]) -> list[CouplingTable]:
    ranges = {turn.name: (round(degrees(turn.lower), 3), round(degrees(turn.upper), 3)) for turn in turns}
    rows = []
    for turn in finger.turns:
        if turn.name in finger.follows:
            driver, ratio, offset = finger.follows[turn.name]
            ratio, away = round(ratio, 6), round(degrees(offset), 4)
            ends = sorted(away + ratio * end for end in ranges[driver])
            span = (round(ends[0] - SLACK, 3), round(ends[1] + SLACK, 3))
            rows.append(CouplingTable(turn.name, turn.segment, _axis(turn), span, driver, ratio, away))
    return rows


def _axis(turn: MappedHinge) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 9) + 0.0 for value in turn.axis)
    return x, y, z


def _palm(hand: MappedHand, where: SegmentLayout, wrist: str) -> SiteTable:
    along = ROUGH * (hand.knuckles - where.origins[wrist])
    direction = along / np.linalg.norm(along)
    facing = hand.facing - direction * (direction @ hand.facing)
    return SiteTable(wrist, rounded_triple(along), rounded_triple(facing / np.linalg.norm(facing)))


def _resting(turn: MappedHinge) -> float:
    """[deg] a little bent, the thumb a little before the palm, and nothing else turned."""
    lower, upper = round(degrees(turn.lower), 3), round(degrees(turn.upper), 3)
    finger, turned = turn.name.split("_")[1:3]
    share = BENT * max(upper, 0.0) if turned.startswith("flexion") else 0.0
    if (finger, turned) == ("thumb", "abduct"):
        share = lower + OPPOSED * (upper - lower)
    return min(max(share, lower), upper)
