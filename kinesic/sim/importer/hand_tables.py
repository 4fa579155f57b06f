"""Robot tables of fingers: segments, couplings, rest angles and collision exclusions."""

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
from kinesic.sim.importer.segments import SegmentLayout, convert_capsules, round_triple

Hands = Mapping[Side, MappedHand]
REST_FLEXION_FRACTION = 0.3  # flexion of a resting finger / upper limit of its range
REST_ABDUCTION_FRACTION = 0.35  # abduction of a resting thumb, as a fraction of its range from the lower limit
MIN_PART_LENGTH = 0.003  # [m] shortest finger segment without shapes of its own that gets a capsule
RANGE_SLACK = 1e-3  # [deg] margin added to a coupled joint's range for rounding errors
PALM_FRACTION = 0.5  # position of the palm between wrist (0) and knuckles (1)


def with_hands(file: RobotFile, hands: Hands, tree: Tree, layout: SegmentLayout) -> RobotFile:
    """Return a robot's tables extended by the fingers of its hands.

    Args:
        file: Tables of the robot without fingers, whose mass is part of the hands' segments.
        hands: Hands by side.
        tree: Robot with hanging arms.
        layout: Segments of the robot.
    """
    body, hinge, coupling = [*file.body], [*file.hinge], [*file.coupling]
    chains, sites, rest = dict(file.chains), dict(file.sites), dict(file.rest)
    exclude = [*file.collision.exclude]
    for side, hand in hands.items():
        wrist = f"{side}_wrist"
        turns = [turn for finger in hand.fingers for turn in finger.turns]
        parts = [part for finger in hand.fingers for part in _bodies(finger, tree, layout, wrist)]
        body = [_reduce_mass(row, sum(part.mass for part in parts)) if row.name == wrist else row for row in body]
        body += parts
        hinge += [_hinge(turn, layout, wrist) for finger in hand.fingers for turn in finger.hinges]
        coupling += [row for finger in hand.fingers for row in _couplings(finger, turns)]
        chains[f"{side}_fingers"] = [turn.segment for turn in turns]
        sites[f"{side}_palm"] = _palm(hand, layout, wrist)
        rest |= {turn.name: round(_find_rest_angle(turn), 2) for finger in hand.fingers for turn in finger.hinges}
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


def _reduce_mass(body: BodyTable, mass: float) -> BodyTable:
    return msgspec.structs.replace(body, mass=round(max(body.mass - mass, 0.0), 4))


def _bodies(finger: MappedFinger, tree: Tree, layout: SegmentLayout, wrist: str) -> list[BodyTable]:
    bodies, parent, origin = [], wrist, layout.origins[wrist]
    ends = [*(turn.anchor for turn in finger.turns[1:]), finger.tip]
    for turn, end in zip(finger.turns, ends, strict=True):
        part = tree.parts[turn.joint]
        capsules = convert_capsules(part.shapes, turn.anchor)
        if not capsules and np.linalg.norm(end - turn.anchor) > MIN_PART_LENGTH:
            bone = round_triple(end - turn.anchor)
            capsules = [CapsuleTable((0.0, 0.0, 0.0), bone, round(finger.radius, 6))]
        bodies.append(
            BodyTable(turn.segment, parent, round_triple(turn.anchor - origin), round(part.mass, 4), capsules)
        )
        parent, origin = turn.segment, turn.anchor
    return bodies


def _hinge(turn: MappedHinge, layout: SegmentLayout, wrist: str) -> HingeTable:
    """Return the TOML table of a finger's hinge.

    Its motor is mounted in the hand.
    """
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
            ratio, offset_deg = round(ratio, 6), round(degrees(offset), 4)
            ends = sorted(offset_deg + ratio * end for end in ranges[driver])
            span = (round(ends[0] - RANGE_SLACK, 3), round(ends[1] + RANGE_SLACK, 3))
            rows.append(CouplingTable(turn.name, turn.segment, _axis(turn), span, driver, ratio, offset_deg))
    return rows


def _axis(turn: MappedHinge) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 9) + 0.0 for value in turn.axis)
    return x, y, z


def _palm(hand: MappedHand, layout: SegmentLayout, wrist: str) -> SiteTable:
    along = PALM_FRACTION * (hand.knuckles - layout.origins[wrist])
    direction = along / np.linalg.norm(along)
    facing = hand.facing - direction * (direction @ hand.facing)
    return SiteTable(wrist, round_triple(along), round_triple(facing / np.linalg.norm(facing)))


def _find_rest_angle(turn: MappedHinge) -> float:
    """Return the rest angle [deg] of a finger's hinge.

    Fingers are slightly bent, the thumb is slightly in front of the palm, and other hinges are at 0.
    """
    lower, upper = round(degrees(turn.lower), 3), round(degrees(turn.upper), 3)
    finger, turn_name = turn.name.split("_")[1:3]
    angle = REST_FLEXION_FRACTION * max(upper, 0.0) if turn_name.startswith("flexion") else 0.0
    if (finger, turn_name) == ("thumb", "abduct"):
        angle = lower + REST_ABDUCTION_FRACTION * (upper - lower)
    return min(max(angle, lower), upper)
