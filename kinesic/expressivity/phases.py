"""Phases of gestures: from poses and sync points to keys of each hand, neighbours running into one another."""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf

from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Side
from kinesic.expressivity.hands import REST, Poses, between, distance, resting
from kinesic.expressivity.keyframes import Hand, Outcome
from kinesic.expressivity.pace import FLOOR, Pace
from kinesic.expressivity.turns import MERGE, arrival, departure

NEIGHBOUR = 0.5  # [s] gestures nearer than this do not pass through rest
_NAMES: Mapping[Side, str] = {"l": "left", "r": "right"}


@dataclass(frozen=True, eq=False)
class HandKey:
    """One hand at one time."""

    time: float  # [s] block time
    hand: Hand


@dataclass(frozen=True, eq=False)
class Stroke:
    """What a behaviour asks of the hands, and when."""

    id: str
    times: Mapping[str, float]  # the seven sync points of a gesture [s]
    options: tuple[Poses, ...]  # the first that the hands are free for is performed
    rest: bool = False  # it stays, and becomes the rest pose


@dataclass(frozen=True, eq=False)
class Arranged:
    """Both hands through a whole block."""

    hands: Mapping[Side, tuple[HandKey, ...]]
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    sides: Mapping[str, frozenset[Side]] = field(default_factory=dict)  # behaviour id -> hands that it moves


@dataclass(frozen=True, eq=False)
class _Work:
    """A stroke and the poses that were chosen for it."""

    stroke: Stroke
    poses: Poses
    moments: tuple[float, ...]  # [s] of its keys

    def at(self, sync: str) -> float:
        return self.stroke.times[sync]


def arranged(strokes: Sequence[Stroke], pace: Pace) -> Arranged:
    """Gives every stroke its hands and joins the strokes of each hand.

    A gesture whose stroke would begin before the earlier one of the same hand has ended is dropped, unless one of
    its options finds its hands free (co-articulation). A rest pose never stands in the way: it is
    taken when the hand is free.

    Args:
        strokes: in the order of the document.
        pace: of the robot, whose hands rest at `robot.skeleton.rest`.
    """
    rest = resting(pace.robot)
    taken: dict[Side, list[_Work]] = {side: [] for side in SIDES}
    outcomes: dict[str, Outcome] = {}
    sides: dict[str, frozenset[Side]] = {}
    for stroke in sorted(strokes, key=lambda stroke: stroke.times["strokeStart"]):
        blocks = [_block(stroke, option, taken) for option in stroke.options]
        if all(blocks):
            outcomes[stroke.id] = Outcome("dropped", blocks[0])
            continue
        choice = blocks.index("")
        poses = stroke.options[choice]
        if choice:
            hand = " and ".join(_NAMES[side] for side in sorted(poses.hands))
            outcomes[stroke.id] = Outcome("substituted", f"moved to the {hand} hand: {blocks[0]}")
        sides[stroke.id] = sides.get(stroke.id, frozenset()) | frozenset(poses.hands)
        work = _Work(stroke, poses, moments(poses, stroke.times, rest))
        for side in poses.hands:
            taken[side].append(work)
    return Arranged({side: _joined(taken[side], side, rest[side], pace) for side in SIDES}, outcomes, sides)


def moments(poses: Poses, times: Mapping[str, float], rest: Mapping[Side, Reach]) -> tuple[float, ...]:
    """Times of stroke keys: the stroke's own key at `stroke`, the others spread by their ways around it [s].

    Args:
        poses: of the behaviour.
        times: sync points; `strokeStart`, `stroke` and `strokeEnd` are used.
        rest: where the hands hang.
    """
    start, stroke, end = (times[sync] for sync in ("strokeStart", "stroke", "strokeEnd"))
    last = poses.count - 1
    middle = poses.stroke if end - stroke >= MERGE * (last - poses.stroke) else last
    ways = paths(poses, rest)
    return (*_spread(start, stroke, ways[:middle]), *_spread(stroke, end, ways[middle:])[1:])


def paths(poses: Poses, rest: Mapping[Side, Reach]) -> tuple[float, ...]:
    """Ways between neighbouring keys, of the hand that goes farther [m]."""
    return tuple(
        max(distance(row[k], row[k + 1], rest[side]) for side, row in poses.hands.items())
        for k in range(poses.count - 1)
    )


def hand_at(keys: Sequence[HandKey], time: float, rest: Reach) -> Hand:
    """The hand at a time, straight between its keys, constant outside them."""
    k = bisect_right(keys, time, key=lambda key: key.time)
    if k == 0 or k == len(keys):
        return keys[min(k, len(keys) - 1)].hand if keys else REST
    a, b = keys[k - 1], keys[k]
    return between(a.hand, b.hand, (time - a.time) / (b.time - a.time), rest)


def _spread(start: float, end: float, ways: Sequence[float]) -> tuple[float, ...]:
    """One time more than ways, from start to end in proportion to the ways [s]."""
    whole = sum(ways)
    shares = [way / whole if whole > 0 else 1 / len(ways) for way in ways]
    times = [start + sum(shares[:k]) * (end - start) for k in range(len(ways))]
    return (*times, end)


def _block(stroke: Stroke, option: Poses, taken: Mapping[Side, Sequence[_Work]]) -> str:
    """Why the hands are not free; empty when they are."""
    if stroke.rest:
        return ""
    for side in sorted(option.hands):
        for work in taken[side]:
            ends = work.at("strokeEnd")
            begins, beats = stroke.times["strokeStart"], stroke.times["stroke"]
            if not work.stroke.rest and (begins < ends - 1e-9 or beats < ends + MERGE):
                return (
                    f"its stroke begins at {begins:.2f} s, the {_NAMES[side]} hand is busy with the stroke of "
                    f"{work.stroke.id} until {ends:.2f} s"
                )
    return ""


def _joined(row: Sequence[_Work], side: Side, rest: Reach, pace: Pace) -> tuple[HandKey, ...]:
    """Keys of one hand: each gesture goes back to the rest pose, unless a neighbour follows."""
    keys: list[HandKey] = []
    pose = REST  # what the hand rests in
    held: _Work | None = None  # the gesture that has not gone back yet
    for k, work in enumerate(row):
        hands = work.poses.hands[side]
        if work.stroke.rest and _crowded(work, keys, row[k + 1 :]):
            pose = hands[-1]
            continue
        if held and work.at("start") >= held.at("end") + NEIGHBOUR:
            keys = _released(keys, held, pose, rest, work.at("start"), pace)
            held = None
        keys = _approached(keys, held, work, _own(work, hands), rest, pace)
        held = None if work.stroke.rest else work
        pose = hands[-1] if work.stroke.rest else pose
    return tuple(_released(keys, held, pose, rest, inf, pace) if held else keys)


def _crowded(work: _Work, keys: Sequence[HandKey], following: Sequence[_Work]) -> bool:
    """Whether the hand has no time to take a rest pose: it does so when it goes back from its gesture."""
    late = bool(keys) and work.at("stroke") < keys[-1].time + MERGE
    return late or any(other.at("strokeStart") < work.at("strokeEnd") + MERGE for other in following[:1])


def _approached(
    keys: list[HandKey], held: _Work | None, work: _Work, own: Sequence[HandKey], rest: Reach, pace: Pace
) -> list[HandKey]:
    """The keys so far, the departure towards a gesture, and the gesture's own keys.

    From rest the hand leaves at `start`. From the hold of an earlier gesture it leaves when this one relaxes or
    the later one starts, but early enough for the way, and not before the earlier stroke has ended.
    """
    hand, free = (keys[-1].hand, keys[-1].time) if keys else (REST, -inf)
    way = _way(hand, own[0].hand, rest, pace)
    if held:
        leave = min(max(held.at("relax"), work.at("start")), own[0].time - way)
    else:
        leave = departure(work.at("start"), own[0].time, way)
    leave = max(leave, free)
    hold = [HandKey(leave, hand)] if leave - free >= MERGE else []
    return [*keys, *hold, *(key for key in own if key.time >= leave + MERGE)]


def _released(keys: list[HandKey], held: _Work, pose: Hand, rest: Reach, latest: float, pace: Pace) -> list[HandKey]:
    """The keys so far and the way back to the rest pose, which ends before the latest time [s]."""
    last = keys[-1]
    leave = max(held.at("relax"), last.time)
    hold = [HandKey(leave, last.hand)] if leave - last.time >= MERGE else []
    back = arrival(leave, held.at("end"), _way(last.hand, pose, rest, pace))
    return [*keys, *hold, HandKey(min(back, latest), pose)]


def _way(a: Hand, b: Hand, rest: Reach, pace: Pace) -> float:
    """Natural time from one hand to another [s]."""
    return max(FLOOR, pace.hand_time(distance(a, b, rest)))


def _own(work: _Work, hands: Sequence[Hand]) -> list[HandKey]:
    """Ready, the stroke keys (of two that are too near the later, but always the stroke) and the end of the stroke."""
    moments = work.moments
    stroke = max(k for k, time in enumerate(moments) if time == work.at("stroke"))
    kept: list[int] = []
    for k, time in enumerate(moments):
        if not kept or time - moments[kept[-1]] >= MERGE:
            kept.append(k)
        elif kept[-1] != stroke:
            kept[-1] = k
    keys = [HandKey(moments[k], hands[k]) for k in kept]
    if keys[0].time - work.at("ready") >= MERGE:
        keys.insert(0, HandKey(work.at("ready"), hands[0]))
    if work.at("strokeEnd") - keys[-1].time >= MERGE:
        keys.append(HandKey(work.at("strokeEnd"), hands[-1]))
    return keys
