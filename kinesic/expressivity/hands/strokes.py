"""The stroke of one gesture: its keys, when they fall, and what lies between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from kinesic.body.reach import Reach
from kinesic.body.robot import Side
from kinesic.expressivity.hands.keys import HandKey, along
from kinesic.expressivity.hands.poses import Poses, pose_distance, resting_hands
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import HandPath, PathKind
from kinesic.expressivity.style.effort import Effort, Nature
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL, Expressivity
from kinesic.expressivity.turns import MERGE

BENT = 1.5  # a swing of a path is worth a straight way of so many lengths: not all hinges turn at once
SPARE_TIME = 1.4  # and takes so many times the shortest time, for it cannot choose where its hinges turn

_SAME = 1e-9  # [s]
_LEAST_TURNS: Mapping[PathKind, float] = {"wave": 0.5, "arc": 0.5}  # what is left to see of it; one turn of others


@dataclass(frozen=True)
class _Way:
    """A way of a hand, by what decides how much time it takes."""

    swings: int
    length: float  # [m] of straight way, each swing
    spare: float  # factor on the shortest time of a straight way

    def least(self, pace: Pace) -> float:
        """The shortest time of a swing that servos need [s]."""
        return self.spare * pace.least_hand_time(self.length)


@dataclass(frozen=True, eq=False)
class Stroke:
    """What a behaviour asks of the hands, and when."""

    id: str
    times: Mapping[str, float]  # the sync points of a gesture, `stroke:2` and so on where it is repeated [s]
    options: tuple[Poses, ...]  # the first that the hands are free for is performed
    rest: bool = False  # it stays, and becomes the rest pose
    manner: Expressivity = NEUTRAL
    halves: bool = False  # whether one of its two hands may do it alone where another block needs the other
    importance: int = 1  # 0 a beat, 1 any other, 2 required: where hands do not suffice, what counts for less gives way
    series: str = ""  # strokes of one series, as of counting, stay with the hand that began it
    spoken: bool = False  # whether the document ties it to a word


@dataclass(frozen=True, eq=False)
class HandStroke:
    """A stroke, the poses that were chosen for it, and when they fall."""

    stroke: Stroke
    poses: Poses
    moments: tuple[float, ...]  # [s] of its keys
    remarks: tuple[str, ...] = ()  # what time did not allow

    def effort(self, pace: Pace) -> Effort:
        """Its times and passages on a robot."""
        return Effort(pace, self.poses.nature, self.stroke.manner, self.stroke.spoken)

    @property
    def id(self) -> str:
        """Of the behaviour."""
        return self.stroke.id

    def is_stroke(self, key: int) -> bool:
        """Whether one of its keys is a stroke."""
        return key in (self.poses.stroke, *self.poses.again)

    def at(self, sync: str) -> float:
        """Time of one of its sync points [s]."""
        return self.stroke.times[sync]


def overlaps(work: HandStroke, stroke: Stroke) -> bool:
    """Whether a work is still in its stroke when the hand is needed for another."""
    ends = work.at("strokeEnd")
    return not work.stroke.rest and (
        stroke.times["strokeStart"] < ends - _SAME or stroke.times["stroke"] < ends + MERGE - _SAME
    )


def do_stroke(stroke: Stroke, option: Poses, pace: Pace) -> HandStroke:
    """Does a stroke by one of its options, as often and with as many turns as there is time for."""
    chosen = _drop_repetitions(option, stroke.times, pace)
    remarks = []
    if chosen.times < option.times:
        room = stroke.times["strokeEnd"] - stroke.times["stroke"]
        remarks.append(f"its stroke is done {_count(chosen.times)}, not {option.times}: {room:.2f} s follow the first")
    moments = stroke_key_times(chosen, stroke.times, pace)
    slowed, slower = _slow_paths(chosen, moments, pace)
    return HandStroke(stroke, slowed, moments, (*remarks, *slower))


def shortened(stroke: Stroke) -> Stroke:
    """Reduces a stroke to its one key at `stroke`, for which there is nearly always time."""
    at = stroke.times["stroke"]
    times = {**stroke.times, "strokeStart": at, "strokeEnd": at}
    return replace(stroke, times=times, options=tuple(_at_stroke(option) for option in stroke.options))


def is_brief(stroke: Stroke) -> bool:
    """Whether a stroke is over when it has begun: it is one key alone."""
    return stroke.times["strokeStart"] == stroke.times["strokeEnd"]


def show_once(work: HandStroke, pace: Pace) -> HandStroke:
    """Reduces what hands do for a stroke to its one key."""
    return do_stroke(shortened(work.stroke), _at_stroke(work.poses), pace)


def _at_stroke(poses: Poses) -> Poses:
    hands = {side: (row[poses.stroke],) for side, row in poses.hands.items()}
    return replace(poses, hands=hands, stroke=0, paths={}, again=())


def natural_times(poses: Poses, effort: Effort) -> tuple[float, ...]:
    """Finds the natural time of each way between neighbouring keys, of the hand that takes longest [s].

    A path takes the time of its swings, each a way of its own: a hand turns round as if it came to rest.

    Args:
        poses: the stroke keys.
        effort: of the gesture.
    """
    return _natural_times(_ways(poses, effort.pace), effort.pace, effort.nature, effort.manner)


@lru_cache(maxsize=1024)
def _natural_times(
    ways: tuple[tuple[_Way, ...], ...], pace: Pace, nature: Nature, manner: Expressivity
) -> tuple[float, ...]:
    effort = Effort(pace, nature, manner)
    return tuple(max(way.swings * max(effort.stroke_time(way.length), way.least(pace)) for way in row) for row in ways)


def stroke_key_times(poses: Poses, times: Mapping[str, float], pace: Pace) -> tuple[float, ...]:
    """Times stroke keys [s]: strokes at their sync points, the others by their natural times.

    Args:
        poses: of the behaviour.
        times: sync points; `strokeStart`, `stroke`, `strokeEnd` are used, and `stroke:2` and so on if there are.
        pace: of the robot that moves.
    """
    start, stroke, end = (times[sync] for sync in ("strokeStart", "stroke", "strokeEnd"))
    last = poses.count - 1
    if last == 0:
        return (stroke,)
    if end - stroke < MERGE * (last - poses.stroke):
        pins = {0: start, last: stroke}
    else:
        numbered = {key: times[f"stroke:{k}"] for k, key in enumerate(poses.again, 2) if f"stroke:{k}" in times}
        pins = {last: end} | {0: start, poses.stroke: stroke} | numbered
    natural, found = natural_times(poses, Effort(pace, poses.nature)), [pins[0]]
    for (a, early), (b, late) in pairwise(sorted(pins.items())):
        found += _spread(early, late, natural[a:b])
    return tuple(found)


def stroke_keys(work: HandStroke, side: Side, pace: Pace, leisure: float = 1.0) -> list[HandKey]:
    """Lists the keys of one hand: ready, the stroke keys with what lies on their paths, and the stroke's end.

    Of two keys that are too near the later stays, but always the stroke.

    Args:
        work: what the hands do.
        side: of the hand.
        pace: of the robot.
        leisure: share of its natural time that the gesture has.
    """
    hands, moments, effort = work.poses.hands[side], work.moments, work.effort(pace)
    kept = _keys_apart(moments, max(k for k, time in enumerate(moments) if time == work.at("stroke")))
    paths = [work.poses.path(side, b) if b == a + 1 else None for a, b in pairwise(kept)]
    strokes = [work.is_stroke(k) for k in kept]
    poses = [
        HandKey(moments[k], hands[k], effort.passage(phase, led=any(beside), leisure=leisure, stroke=stroke))
        for k, stroke, *beside in zip(kept, strokes, (None, *paths), (*paths, None), strict=True)
        for phase in ("stroke" if k else "preparation",)
    ]
    keys = poses[:1]
    for k, path in enumerate(paths, 1):
        late = work.stroke.spoken and strokes[k]
        keys += along(poses, k, path, unit=pace.robot.arm_length, power=work.stroke.manner.power, late=late)
        keys.append(poses[k])
    if keys[0].time - work.at("ready") >= MERGE:
        keys.insert(0, HandKey(work.at("ready"), hands[0], effort.passage("preparation", leisure=0.0)))
    if work.at("strokeEnd") - keys[-1].time >= MERGE:
        keys.append(HandKey(work.at("strokeEnd"), hands[-1], effort.passage("hold")))
    return keys


def _ways(poses: Poses, pace: Pace) -> tuple[tuple[_Way, ...], ...]:
    """The ways between neighbouring keys, one of each hand."""
    rows = tuple((side, row, poses.paths.get(side, (None,) * poses.count)) for side, row in poses.hands.items())
    return _ways_of(rows, poses.count - 1, pace)


@lru_cache(maxsize=1024)  # each stroke is tried beside each of its neighbours, and a gesture is done more than once
def _ways_of(
    rows: tuple[tuple[Side, tuple[Hand, ...], tuple[HandPath | None, ...]], ...], count: int, pace: Pace
) -> tuple[tuple[_Way, ...], ...]:
    rest = resting_hands(pace.robot)
    return tuple(
        tuple(_way(hands[k], hands[k + 1], paths[k + 1], rest[side]) for side, hands, paths in rows)
        for k in range(count)
    )


def _way(a: Hand, b: Hand, path: HandPath | None, rest: Reach) -> _Way:
    if path is None:
        return _Way(1, pose_distance(a, b, rest), 1.0)
    start, end = (a.reach or rest).position, (b.reach or rest).position
    swings = path.swings(start, end)
    return _Way(swings, BENT * path.length(start, end) / swings, SPARE_TIME)


def least_stroke_times(poses: Poses, pace: Pace) -> tuple[float, ...]:
    """Finds the shortest time of each way between neighbouring keys that servos need [s]."""
    return tuple(max(way.swings * way.least(pace) for way in ways) for ways in _ways(poses, pace))


def _drop_repetitions(poses: Poses, times: Mapping[str, float], pace: Pace) -> Poses:
    """Leaves out repetitions for which there is no time between `stroke` and `strokeEnd`."""
    room = times["strokeEnd"] - times["stroke"]
    while poses.again and sum(least_stroke_times(poses, pace)[poses.stroke :]) > room + 1e-9:
        poses = poses.fewer()
    return poses


def _slow_paths(poses: Poses, moments: Sequence[float], pace: Pace) -> tuple[Poses, tuple[str, ...]]:
    """Lets paths turn no oftener than servos can in the time of their way, and says what that changes."""
    paths, remarks = dict(poses.paths), []
    for side, row in poses.paths.items():
        slower = list(row)
        for k, path in enumerate(row):
            if path is None or path.turns <= 1.0 or moments[k] <= moments[k - 1]:
                continue
            before, after = poses.hands[side][k - 1], poses.hands[side][k]
            least = _way(before, after, path, resting_hands(pace.robot)[side]).least(pace)
            whole = moments[k] - moments[k - 1]
            turns = max(_LEAST_TURNS.get(path.kind, 1.0), np.floor(whole / least + 1e-9) / 2)
            if turns < path.turns:
                slower[k] = path.slowed(turns)
                remarks.append(
                    f"its {path.kind} makes {turns:g} of its {path.turns:g} turns: in {whole:.2f} s servos do no more"
                )
        paths[side] = tuple(slower)
    return (replace(poses, paths=paths) if remarks else poses), tuple(dict.fromkeys(remarks))


def _spread(start: float, end: float, natural: Sequence[float]) -> tuple[float, ...]:
    """Spreads as many times as ways, the last at the end, in proportion to their natural times [s]."""
    shares = np.cumsum(natural) / sum(natural)
    return (*(start + float(share) * (end - start) for share in shares[:-1]), end)


def _keys_apart(moments: Sequence[float], stroke: int) -> list[int]:
    """Indices of keys that are far enough apart in time; the stroke always stays."""
    kept: list[int] = []
    for k, time in enumerate(moments):
        if not kept or time - moments[kept[-1]] >= MERGE:
            kept.append(k)
        elif kept[-1] != stroke:
            kept[-1] = k
    return kept


def _count(times: int) -> str:
    return "once" if times == 1 else f"{times} times"
