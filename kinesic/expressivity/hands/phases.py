"""Phases of gestures: the keys of each hand through a whole block, neighbours running into one another."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from types import MappingProxyType

from kinesic.body.reach import Reach
from kinesic.body.robot import OTHER_SIDE, SIDES, Side
from kinesic.expressivity.hands.blending import between
from kinesic.expressivity.hands.coarticulation import NO_CLASHES, allot_hands
from kinesic.expressivity.hands.engaged import Clashes, Engaged
from kinesic.expressivity.hands.keys import HandKey
from kinesic.expressivity.hands.leisure import find_leisure
from kinesic.expressivity.hands.making_room import Tied
from kinesic.expressivity.hands.poses import REST, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke, Stroke, stroke_keys
from kinesic.expressivity.keyframes import Hand, Outcome, Touch
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import MERGE, arrival, departure_time
from kinesic.motion.keys import PLAIN_PASSAGE

NEIGHBOUR = 0.5  # [s] gestures nearer than this do not pass through rest
MEETING: frozenset[Touch] = frozenset(("hand", "forearm", "upper_arm"))  # what an arm rests on of the other one
SUNK = 0.5  # of the way to rest, that a hand sinks which waits for its next gesture
ASIDE = 0.2  # openness of its elbow, which would else be against the body
WAITING = 2.5  # [s] that a hand stays where it is, to come to rest together with the other one
ALL_TIED: Tied = MappingProxyType({})  # every sync point stays where it is


@dataclass(frozen=True, eq=False)
class Arranged:
    """The keys of both hands through a whole block, and what came of each behaviour."""

    hands: Mapping[Side, tuple[HandKey, ...]]
    outcomes: Mapping[str, Outcome]
    sides: Mapping[str, frozenset[Side]]  # behaviour id -> hands that it moves
    remarks: Mapping[str, tuple[str, ...]]  # what time did not allow
    times: Mapping[str, Mapping[str, float]]  # behaviour id -> points that moved [s]
    works: tuple[HandStroke, ...]  # what both hands do, in time order


@dataclass(frozen=True)
class _WayHome:
    """The times at which a hand leaves for its rest pose, and is there [s]."""

    relax: float
    end: float


def arrange_hands(
    strokes: Sequence[Stroke],
    pace: Pace,
    tied: Tied = ALL_TIED,
    *,
    engaged: Sequence[Engaged] = (),
    clashes: Clashes = NO_CLASHES,
) -> Arranged:
    """Gives every stroke its hands (see `allot_hands`) and joins the strokes of each hand.

    Args:
        strokes: in the order of the document.
        pace: of the robot, whose hands rest at `robot.skeleton.rest`.
        tied: sync points that the document places; all of behaviours that are missing.
        engaged: hands that other blocks need.
        clashes: strokes that one hand cannot both do, though they do not overlap.
    """
    rest = resting_hands(pace.robot)
    given = allot_hands(strokes, pace, tied, engaged, clashes)
    sides: dict[str, frozenset[Side]] = {}
    for side in SIDES:
        for work in given.works[side]:
            sides[work.id] = sides.get(work.id, frozenset()) | {side}
    leisure = find_leisure(given.works, pace)
    hands = {
        side: _join_strokes(given.works[side], _alone(given.works, side), side, rest[side], pace, clashes, leisure)
        for side in SIDES
    }
    works = {id(work): work for side in SIDES for work in given.works[side]}
    in_order = tuple(sorted(works.values(), key=lambda work: work.at("strokeStart")))
    remarks = {**given.remarks}
    for side in SIDES:
        remarks |= _deferred_poses(given.works[side], clashes)
    return Arranged(hands, given.outcomes, sides, remarks, given.times, in_order)


def _alone(works: Mapping[Side, Sequence[HandStroke]], side: Side) -> list[HandStroke]:
    """Lists the strokes that the other hand does without this one."""
    return [work for work in works[OTHER_SIDE[side]] if work not in works[side]]


def _join_strokes(
    row: Sequence[HandStroke],
    others: Sequence[HandStroke],
    side: Side,
    rest: Reach,
    pace: Pace,
    clashes: Clashes,
    leisure: Mapping[int, float],
) -> tuple[HandKey, ...]:
    """Each gesture goes back to the rest pose, unless a neighbour follows."""
    keys: list[HandKey] = []
    pose = REST  # what the hand rests in
    holding: HandStroke | None = None  # the gesture that has not gone back yet
    for k, work in enumerate(row):
        hands = work.poses.hands[side]
        if work.stroke.rest and (_clashing(row, k, clashes) or _lacks_time(work, keys, row[k + 1 :])):
            pose = hands[-1]
            continue
        own = stroke_keys(work, side, pace, leisure[id(work)])
        if holding and work.at("start") >= (home := _homeward(holding, pose, others)).end + NEIGHBOUR:
            back = _go_back(keys, holding, home, pose, rest, work.at("start"), pace)
            if back[-1].time + MERGE <= own[0].time:  # else there is no time to pass through rest
                keys, holding = back, None
        if holding and pose is REST:
            keys = _sink(keys, holding, work, own[0], rest, pace)
        keys = _approach(keys, holding, work, own, rest, pace)
        holding = None if work.stroke.rest else work
        pose = hands[-1] if work.stroke.rest else pose
    if holding:
        keys = _go_back(keys, holding, _homeward(holding, pose, others), pose, rest, inf, pace)
    return _stop_at_holds(keys)


def _stop_at_holds(keys: Sequence[HandKey]) -> tuple[HandKey, ...]:
    """Stops where a hand waits, however loose it is: while the trunk turns beneath, its arm hardly stays as it was."""
    waiting = {k for k, (one, other) in enumerate(pairwise(keys)) if one.hand is other.hand}
    return tuple(
        replace(key, passage=replace(key.passage, tension=1.0)) if {k - 1, k} & waiting else key
        for k, key in enumerate(keys)
    )


def _homeward(holding: HandStroke, pose: Hand, others: Sequence[HandStroke]) -> _WayHome:
    """Finds when a hand goes back to rest: with the other one where they rest in one another and it is soon free."""
    alone = together = _WayHome(holding.at("relax"), holding.at("end"))
    for other in others if pose.touch in MEETING else ():
        if not other.stroke.rest and other.at("start") < together.end and other.at("relax") > together.relax:
            together = _WayHome(other.at("relax"), other.at("end"))
    return together if together.relax <= alone.relax + WAITING else alone


def _clashing(row: Sequence[HandStroke], k: int, clashes: Clashes) -> list[str]:
    """Names the neighbours of a stroke in its row between which and it there is not the time that a hand needs."""
    return [other.id for other in row[max(k - 1, 0) : k + 2] if frozenset((row[k].id, other.id)) in clashes]


def _deferred_poses(row: Sequence[HandStroke], clashes: Clashes) -> dict[str, tuple[str, ...]]:
    """Says of rest poses that clash with a gesture what becomes of them."""
    poses = [(work.id, _clashing(row, k, clashes)) for k, work in enumerate(row) if work.stroke.rest]
    lacking = {pair: f"{clash.late:.2f} s lack between both" for pair, clash in clashes.items()}
    return {
        id: tuple(f"is taken as the hands go back from {other}: {lacking[frozenset((id, other))]}" for other in others)
        for id, others in poses
        if others
    }


def _lacks_time(work: HandStroke, keys: Sequence[HandKey], following: Sequence[HandStroke]) -> bool:
    """Whether the hand has no time for a rest pose, and takes it when it goes back from its gesture."""
    late = bool(keys) and work.at("stroke") < keys[-1].time + MERGE
    return late or any(other.at("strokeStart") < work.at("strokeEnd") + MERGE for other in following[:1])


def _approach(
    keys: list[HandKey], holding: HandStroke | None, work: HandStroke, own: Sequence[HandKey], rest: Reach, pace: Pace
) -> list[HandKey]:
    """Adds the departure towards a gesture, and the gesture's own keys.

    From rest the hand leaves at `start`. From the hold of an earlier gesture it leaves when this one relaxes or
    the later one starts, but early enough for the way, and not before the earlier stroke has ended.
    """
    hand, free = (keys[-1].hand, keys[-1].time) if keys else (REST, -inf)
    effort, distance = work.effort(pace), pose_distance(hand, own[0].hand, rest)
    way = effort.joining_time(distance) if holding else effort.preparation_time(distance)
    if len(own) > 1 and own[1].hand is own[0].hand and own[0].time < free + way:
        own = own[1:]  # no time to wait at the beginning of the stroke
    if holding:
        leave = min(max(holding.at("relax"), work.at("start")), own[0].time - way)
    else:
        leave = departure_time(work.at("start"), own[0].time, way)
    leave = max(leave, free)
    passage = holding.effort(pace).passage("hold") if holding else PLAIN_PASSAGE
    hold = [HandKey(leave, hand, passage)] if leave - free >= MERGE else []
    return [*keys, *hold, *(key for key in own if key.time >= leave + MERGE)]


def _sink(
    keys: list[HandKey], holding: HandStroke, work: HandStroke, first: HandKey, rest: Reach, pace: Pace
) -> list[HandKey]:
    """Lets a hand that waits for its next gesture sink, if there is time for it: nobody holds an arm up for nothing."""
    last = keys[-1]
    low = replace(between(last.hand, REST, SUNK, rest), openness=ASIDE)
    sinking = holding.effort(pace).return_time(pose_distance(last.hand, low, rest))
    rising = work.effort(pace).joining_time(pose_distance(low, first.hand, rest))
    relax, leave = max(holding.at("relax"), last.time), min(work.at("start"), first.time - rising)
    if leave - relax < sinking:
        return keys
    hold = [HandKey(relax, last.hand, holding.effort(pace).passage("hold"))] if relax - last.time >= MERGE else []
    return [*keys, *hold, HandKey(relax + sinking, low, holding.effort(pace).passage("retraction"))]


def _go_back(
    keys: list[HandKey], holding: HandStroke, home: _WayHome, pose: Hand, rest: Reach, latest: float, pace: Pace
) -> list[HandKey]:
    """Adds the way back to the rest pose, which ends before the latest time [s]."""
    last = keys[-1]
    leave = max(home.relax, last.time)
    effort = holding.effort(pace)
    hold = [HandKey(leave, last.hand, effort.passage("hold"))] if leave - last.time >= MERGE else []
    back = arrival(leave, home.end, effort.return_time(pose_distance(last.hand, pose, rest)))
    return [*keys, *hold, HandKey(min(back, latest), pose, effort.passage("retraction"))]
