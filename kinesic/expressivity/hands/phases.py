"""Gesture phases: keys of each hand over a block, with transitions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from types import MappingProxyType

from kinesic.body.reach import Reach
from kinesic.body.robot import OTHER_SIDE, SIDES, Side
from kinesic.expressivity.hands.blending import interpolate_hands
from kinesic.expressivity.hands.busy_hands import BusyHand, Clashes
from kinesic.expressivity.hands.coarticulation import NO_CLASHES, allocate_hands
from kinesic.expressivity.hands.keys import HandKey
from kinesic.expressivity.hands.poses import REST_HAND, pose_distance, resting_hands
from kinesic.expressivity.hands.stroke_spacing import FixedSyncs
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, stroke_keys
from kinesic.expressivity.hands.time_ratios import available_time_ratios
from kinesic.expressivity.keyframes import Hand, Outcome, Touch
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import MIN_KEY_SPACING, arrival_time, departure_time
from kinesic.motion.keys import PLAIN_PASSAGE

NEIGHBOUR_INTERVAL = 0.5  # [s] longest gap between gestures in which the hand does not return to rest
ARM_PARTS: frozenset[Touch] = frozenset(("hand", "forearm", "upper_arm"))  # touchable parts of the other arm
LOWERING_FRACTION = 0.5  # fraction of the distance to rest by which a waiting hand is lowered
WAITING_OPENNESS = 0.2  # elbow openness (0 hanging .. 1 far out) of a waiting hand
MIN_PAUSE_TIME = 0.35  # [s] shortest stop of a lowered hand; a hand without that time sinks more slowly, without a stop
MAX_WAITING_TIME = 2.5  # [s] longest wait of a hand that retracts together with the other hand
ALL_FIXED: FixedSyncs = MappingProxyType({})  # default, empty: a behaviour without an entry has only fixed sync points


@dataclass(frozen=True, eq=False)
class HandArrangement:
    """Keys of both hands over a block, with the behaviours' outcomes."""

    hands: Mapping[Side, tuple[HandKey, ...]]
    outcomes: Mapping[str, Outcome]
    sides: Mapping[str, frozenset[Side]]  # behaviour id -> moved hands
    remarks: Mapping[str, tuple[str, ...]]  # changes for lack of time, by behaviour id
    times: Mapping[str, Mapping[str, float]]  # behaviour id -> moved sync points [s]
    works: tuple[HandStroke, ...]  # strokes of both hands, in time order


@dataclass(frozen=True)
class _Retraction:
    """Begin and end [s] of a retraction, and its final rest pose."""

    relax: float
    end: float
    pose: Hand


def arrange_hands(
    strokes: Sequence[Stroke],
    pace: Pace,
    fixed_syncs: FixedSyncs = ALL_FIXED,
    *,
    busy_hands: Sequence[BusyHand] = (),
    clashes: Clashes = NO_CLASHES,
) -> HandArrangement:
    """Assign hands to every stroke and connect the strokes of each hand.

    See `allocate_hands`.

    Args:
        strokes: in the order of the document.
        pace: of the robot, whose hands rest at `robot.skeleton.rest`.
        fixed_syncs: sync points fixed by the document; all of behaviours that are missing.
        busy_hands: hands that other blocks need.
        clashes: strokes that one hand cannot both perform, though they do not overlap.
    """
    allocation = allocate_hands(strokes, pace, fixed_syncs, busy_hands, clashes)
    sides: dict[str, frozenset[Side]] = {}
    for side in SIDES:
        for work in allocation.works[side]:
            sides[work.id] = sides.get(work.id, frozenset()) | {side}
    time_ratio = available_time_ratios(allocation.works, pace)
    hands = {
        side: _join_strokes(
            allocation.works[side], _single_handed(allocation.works, side), side, pace, clashes, time_ratio
        )
        for side in SIDES
    }
    works = {id(work): work for side in SIDES for work in allocation.works[side]}
    in_order = tuple(sorted(works.values(), key=lambda work: work.at("strokeStart")))
    remarks = {**allocation.remarks}
    for side in SIDES:
        remarks |= _deferral_remarks(allocation.works[side], clashes)
    return HandArrangement(hands, allocation.outcomes, sides, remarks, allocation.times, in_order)


def _single_handed(works: Mapping[Side, Sequence[HandStroke]], side: Side) -> list[HandStroke]:
    """Return the strokes that the opposite hand performs alone."""
    return [work for work in works[OTHER_SIDE[side]] if work not in works[side]]


def _join_strokes(
    row: Sequence[HandStroke],
    others: Sequence[HandStroke],
    side: Side,
    pace: Pace,
    clashes: Clashes,
    time_ratio: Mapping[int, float],
) -> tuple[HandKey, ...]:
    """Connect successive strokes of one hand by transitions or rest poses.

    The hand passes through the rest pose unless another stroke follows soon.
    """
    keys: list[HandKey] = []
    rest = resting_hands(pace.robot)[side]
    pose = REST_HAND  # rest pose of the hand
    holding: HandStroke | None = None  # last gesture, as long as the hand has not retracted
    for k, work in enumerate(row):
        hands = work.poses.hands[side]
        if work.stroke.rest and (_clashing_neighbours(row, k, clashes) or _must_defer(work, keys, row[k + 1 :])):
            pose = hands[-1]
            continue
        stroke_row = stroke_keys(work, side, pace, time_ratio[id(work)])
        if holding and work.at("start") >= (retraction := _retraction(holding, pose, others)).end + NEIGHBOUR_INTERVAL:
            keys_with_retraction = _add_retraction(keys, holding, retraction, rest, work.at("start"), pace)
            if (
                keys_with_retraction[-1].time + MIN_KEY_SPACING <= stroke_row[0].time
            ):  # otherwise there is no time to pass through rest
                keys, holding = keys_with_retraction, None
        if holding and pose is REST_HAND:
            keys = _lower_waiting_hand(keys, holding, work, stroke_row[0], rest, pace)
        keys = _add_preparation(keys, holding, work, stroke_row, rest, pace)
        holding = None if work.stroke.rest else work
        pose = hands[-1] if work.stroke.rest else pose
    if holding:
        keys = _add_retraction(keys, holding, _retraction(holding, pose, others), rest, inf, pace)
    return _stop_at_holds(keys)


def _stop_at_holds(keys: Sequence[HandKey]) -> tuple[HandKey, ...]:
    """Set full spline tension at hold keys, so that the hand stops.

    An arm hardly keeps its posture while the trunk turns below it, so that a loose key would swing.
    """
    hold_keys = {k for k, (one, other) in enumerate(pairwise(keys)) if one.hand is other.hand}
    return tuple(
        replace(key, passage=replace(key.passage, tension=1.0)) if {k - 1, k} & hold_keys else key
        for k, key in enumerate(keys)
    )


def _retraction(holding: HandStroke, pose: Hand, others: Sequence[HandStroke]) -> _Retraction:
    """Return begin and end of a hand's retraction to a rest pose.

    It waits for the other hand if their rest pose makes them touch and the other is soon free.
    """
    alone = together = _Retraction(holding.at("relax"), holding.at("end"), pose)
    for other in others if pose.touch in ARM_PARTS else ():
        if not other.stroke.rest and other.at("start") < together.end and other.at("relax") > together.relax:
            together = _Retraction(other.at("relax"), other.at("end"), pose)
    return together if together.relax <= alone.relax + MAX_WAITING_TIME else alone


def _clashing_neighbours(row: Sequence[HandStroke], k: int, clashes: Clashes) -> list[str]:
    """Return the ids of adjacent strokes that conflict with a stroke."""
    return [other.id for other in row[max(k - 1, 0) : k + 2] if frozenset((row[k].id, other.id)) in clashes]


def _deferral_remarks(row: Sequence[HandStroke], clashes: Clashes) -> dict[str, tuple[str, ...]]:
    """Return remarks about rest poses that clash with gestures, by id."""
    poses = [(work.id, _clashing_neighbours(row, k, clashes)) for k, work in enumerate(row) if work.stroke.rest]
    lacking = {pair: f"{clash.delay:.2f} s are missing between the two" for pair, clash in clashes.items()}
    return {
        id: tuple(f"is taken as the hands go back from {other}: {lacking[frozenset((id, other))]}" for other in others)
        for id, others in poses
        if others
    }


def _must_defer(work: HandStroke, keys: Sequence[HandKey], following: Sequence[HandStroke]) -> bool:
    """Return whether a rest pose must wait for the next retraction.

    The hand has no time to take it now.
    """
    late = bool(keys) and work.at("stroke") < keys[-1].time + MIN_KEY_SPACING
    return late or any(other.at("strokeStart") < work.at("strokeEnd") + MIN_KEY_SPACING for other in following[:1])


def _add_preparation(
    keys: list[HandKey],
    holding: HandStroke | None,
    work: HandStroke,
    stroke_row: Sequence[HandKey],
    rest: Reach,
    pace: Pace,
) -> list[HandKey]:
    """Add the departure towards a gesture and the gesture's keys.

    From rest the hand leaves at `start`. From the hold of an earlier gesture it leaves when this one relaxes or the
    later one starts, but early enough to arrive in time, and not before the earlier stroke has ended.
    """
    hand, free = (keys[-1].hand, keys[-1].time) if keys else (REST_HAND, -inf)
    effort, distance = work.effort(pace), pose_distance(hand, stroke_row[0].hand, rest)
    travel_time = effort.joining_time(distance) if holding else effort.preparation_time(distance)
    if len(stroke_row) > 1 and stroke_row[1].hand is stroke_row[0].hand and stroke_row[0].time < free + travel_time:
        stroke_row = stroke_row[1:]  # no time to wait at the beginning of the stroke
    if holding:
        leave = min(max(holding.at("relax"), work.at("start")), stroke_row[0].time - travel_time)
    else:
        leave = departure_time(work.at("start"), stroke_row[0].time, travel_time)
    leave = max(leave, free)
    passage = holding.effort(pace).passage("hold") if holding else PLAIN_PASSAGE
    hold = [HandKey(leave, hand, passage)] if leave - free >= MIN_KEY_SPACING else []
    return [*keys, *hold, *(key for key in stroke_row if key.time >= leave + MIN_KEY_SPACING)]


def _lower_waiting_hand(
    keys: list[HandKey], holding: HandStroke, work: HandStroke, first: HandKey, rest: Reach, pace: Pace
) -> list[HandKey]:
    """Lower a hand that waits for its next gesture, if time allows.

    People do not hold up an idle arm.
    """
    last = keys[-1]
    lowered = replace(interpolate_hands(last.hand, REST_HAND, LOWERING_FRACTION, rest), openness=WAITING_OPENNESS)
    lowering_time = holding.effort(pace).return_time(pose_distance(last.hand, lowered, rest))
    raising_time = work.effort(pace).joining_time(pose_distance(lowered, first.hand, rest))
    relax, leave = max(holding.at("relax"), last.time), min(work.at("start"), first.time - raising_time)
    if leave - relax < lowering_time:
        return keys
    hold = (
        [HandKey(relax, last.hand, holding.effort(pace).passage("hold"))]
        if relax - last.time >= MIN_KEY_SPACING
        else []
    )
    arrival = relax + lowering_time if leave - relax >= lowering_time + MIN_PAUSE_TIME else leave
    return [*keys, *hold, HandKey(arrival, lowered, holding.effort(pace).passage("retraction"))]


def _add_retraction(
    keys: list[HandKey], holding: HandStroke, retraction: _Retraction, rest: Reach, latest: float, pace: Pace
) -> list[HandKey]:
    """Add the retraction to the rest pose.

    It ends at the latest time [s] or before.
    """
    last = keys[-1]
    leave, pose = max(retraction.relax, last.time), retraction.pose
    effort = holding.effort(pace)
    hold = [HandKey(leave, last.hand, effort.passage("hold"))] if leave - last.time >= MIN_KEY_SPACING else []
    keys_with_retraction = arrival_time(leave, retraction.end, effort.return_time(pose_distance(last.hand, pose, rest)))
    return [*keys, *hold, HandKey(min(keys_with_retraction, latest), pose, effort.passage("retraction"))]
