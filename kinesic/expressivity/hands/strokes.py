"""Timing of gesture strokes: keys, repetitions and paths between keys."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from math import ceil

import numpy as np

from kinesic.body.reach import Reach
from kinesic.body.robot import Side
from kinesic.expressivity.hands.keys import HandKey, PathVelocity, path_keys_between
from kinesic.expressivity.hands.poses import Poses, pose_distance, resting_hands
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import HandPath, PathKind
from kinesic.expressivity.style.effort import Effort, GestureTraits
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Expressivity
from kinesic.expressivity.turns import MIN_KEY_SPACING

PATH_LENGTH_FACTOR = 1.5  # factor on the length of half a path period in the estimate of the minimum time
PATH_TIME_FACTOR = 1.4  # minimum time of half a path period / minimum time of a straight movement

_TIME_TOLERANCE = 1e-9  # [s] times that differ by less count as equal
_MIN_PERIODS: Mapping[PathKind, float] = {"wave": 0.5, "arc": 0.5}  # fewest periods by path kind; other kinds: 1


@dataclass(frozen=True)
class _HandMove:
    """Movement of a hand between two successive keys."""

    swings: int  # number of swings, one for each reversal of the path
    length: float  # [m] equivalent straight distance of each swing
    time_factor: float  # minimum time / minimum time of a straight movement
    duration: float = 0.0  # [s] duration of all swings in a capture; 0: not captured

    def minimum_time(self, pace: Pace) -> float:
        """Return the minimum duration of one movement between path reversals [s]."""
        return self.time_factor * pace.least_hand_time(self.length)


@dataclass(frozen=True, eq=False)
class Stroke:
    """Requested hand motion of a behaviour, with its sync points."""

    id: str
    times: Mapping[str, float]  # [s] sync points, with `stroke:2` and so on for repetitions
    options: tuple[Poses, ...]  # alternatives; the first with free hands is performed
    rest: bool = False  # whether the stroke's last pose is held and becomes the rest pose
    manner: Expressivity = NEUTRAL_EXPRESSIVITY
    may_split: bool = False  # whether one hand may perform the stroke alone if another block needs the other hand
    importance: int = 1  # 0 beat, 1 other gesture, 2 required behaviour; the least important is dropped first
    series: str = ""  # strokes of one series, such as counting, use the same hand
    spoken: bool = False  # whether the document synchronises the stroke with a word


@dataclass(frozen=True, eq=False)
class HandStroke:
    """Stroke with the chosen poses and their times."""

    stroke: Stroke
    poses: Poses
    moments: tuple[float, ...]  # [s] times of the keys
    remarks: tuple[str, ...] = ()  # changes for lack of time

    def effort(self, pace: Pace) -> Effort:
        """Return the calculator of the stroke's durations and spline parameters."""
        return Effort(pace, self.poses.traits, self.stroke.manner, self.stroke.spoken)

    @property
    def id(self) -> str:
        """Id of the behaviour that requests the stroke."""
        return self.stroke.id

    def is_stroke(self, key: int) -> bool:
        """Return whether a key is the stroke or one of its repetitions."""
        return key in (self.poses.stroke, *self.poses.again)

    def at(self, sync: str) -> float:
        """Return the time of one of the stroke's sync points [s]."""
        return self.stroke.times[sync]


def overlaps(work: HandStroke, stroke: Stroke) -> bool:
    """Return whether a hand's stroke ends too late for another stroke."""
    ends = work.at("strokeEnd")
    return not work.stroke.rest and (
        stroke.times["strokeStart"] < ends - _TIME_TOLERANCE
        or stroke.times["stroke"] < ends + MIN_KEY_SPACING - _TIME_TOLERANCE
    )


def time_stroke(stroke: Stroke, option: Poses, pace: Pace) -> HandStroke:
    """Assign key times to a stroke, with only the repetitions that fit.

    Paths that are too fast lose periods. The remarks name both changes.
    """
    feasible = _drop_repetitions(option, stroke.times, pace)
    remarks = []
    if feasible.stroke_count < option.stroke_count:
        available = stroke.times["strokeEnd"] - stroke.times["stroke"]
        needed = ceil(100 * sum(least_stroke_times(option, pace)[option.stroke :])) / 100
        remarks.append(
            f"its stroke is done {_count_words(feasible.stroke_count)}, not {_count_words(option.stroke_count)}: "
            f"only {available:.2f} s remain after the first one, of {needed:.2f} s for all"
        )
    moments = stroke_key_times(feasible, stroke.times, pace)
    slowed, slowed_row = _reduce_path_periods(feasible, moments, pace)
    return HandStroke(stroke, slowed, moments, (*remarks, *slowed_row))


def shortened(stroke: Stroke) -> Stroke:
    """Return a requested stroke reduced to its pose at sync point `stroke`.

    This key nearly always fits.
    """
    at = stroke.times["stroke"]
    times = {**stroke.times, "strokeStart": at, "strokeEnd": at}
    return replace(stroke, times=times, options=tuple(_at_stroke(option) for option in stroke.options))


def is_brief(stroke: Stroke) -> bool:
    """Return whether a stroke has zero duration, as after `shortened`."""
    return stroke.times["strokeStart"] == stroke.times["strokeEnd"]


def show_once(work: HandStroke, pace: Pace) -> HandStroke:
    """Return a performed stroke reduced to its pose at sync point `stroke`."""
    return time_stroke(shortened(work.stroke), _at_stroke(work.poses), pace)


def _at_stroke(poses: Poses) -> Poses:
    hands = {side: (row[poses.stroke],) for side, row in poses.hands.items()}
    return replace(poses, hands=hands, stroke=0, paths={}, again=())


def natural_times(poses: Poses, effort: Effort) -> tuple[float, ...]:
    """Return the natural durations between successive stroke keys [s].

    A path takes the time of its swings, since a hand reverses as if it came to rest. A captured path keeps its duration
    in neutral expressivity.
    """
    return _natural_times(_hand_moves(poses, effort.pace), effort.pace, effort.traits, effort.manner)


@lru_cache(maxsize=128)
def _natural_times(
    moves: tuple[tuple[_HandMove, ...], ...], pace: Pace, traits: GestureTraits, manner: Expressivity
) -> tuple[float, ...]:
    effort = Effort(pace, traits, manner)
    return tuple(max(_natural_time(move, effort) for move in row) for row in moves)


def _natural_time(move: _HandMove, effort: Effort) -> float:
    """Return the natural duration of a hand's movement between two keys [s]."""
    if not move.duration:
        return move.swings * max(effort.stroke_time(move.length), move.minimum_time(effort.pace))
    ratio = effort.stroke_time(move.length) / effort.plain.stroke_time(move.length)
    return max(move.duration * ratio, effort.pace.least_hand_time(move.length))


def stroke_key_times(poses: Poses, times: Mapping[str, float], pace: Pace) -> tuple[float, ...]:
    """Return the times of the stroke keys [s].

    Strokes are at their sync points, the other keys at their natural times.

    Args:
        poses: of the behaviour.
        times: sync points; `strokeStart`, `stroke`, `strokeEnd` are used, and `stroke:2` and so on if present.
        pace: of the robot.
    """
    start, stroke, end = (times[sync] for sync in ("strokeStart", "stroke", "strokeEnd"))
    last = poses.count - 1
    if last == 0:
        return (stroke,)
    if end - stroke < MIN_KEY_SPACING * (last - poses.stroke):
        pins = {0: start, last: stroke}
    else:
        numbered = {key: times[f"stroke:{k}"] for k, key in enumerate(poses.again, 2) if f"stroke:{k}" in times}
        pins = {last: end} | {0: start, poses.stroke: stroke} | numbered
    natural, times_of_keys = natural_times(poses, Effort(pace, poses.traits)), [pins[0]]
    for (a, early), (b, late) in pairwise(sorted(pins.items())):
        times_of_keys += _spread(early, late, natural[a:b])
    return tuple(times_of_keys)


def stroke_keys(work: HandStroke, side: Side, pace: Pace, time_ratio: float = 1.0) -> list[HandKey]:
    """Return the keys of one hand in a stroke.

    They are the ready pose, the stroke keys with keys on their paths, and the stroke end.

    Of two keys that are too close the later one is kept, but the stroke always is.

    Args:
        work: stroke of the hands.
        side: of the hand.
        pace: of the robot.
        time_ratio: available / natural time of the gesture.
    """
    hands, moments, effort = work.poses.hands[side], work.moments, work.effort(pace)
    kept_keys = _keys_apart(moments, max(k for k, time in enumerate(moments) if time == work.at("stroke")))
    paths = [work.poses.path(side, b) if b == a + 1 else None for a, b in pairwise(kept_keys)]
    strokes = [work.is_stroke(k) for k in kept_keys]
    poses = [
        HandKey(
            moments[k], hands[k], effort.passage(phase, led=any(adjacent_paths), time_ratio=time_ratio, stroke=stroke)
        )
        for k, stroke, *adjacent_paths in zip(kept_keys, strokes, (None, *paths), (*paths, None), strict=True)
        for phase in ("stroke" if k else "preparation",)
    ]
    keys, waits = poses[:1], poses[0].time - work.at("ready") >= MIN_KEY_SPACING
    for k, path in enumerate(paths, 1):
        path_keys = path_keys_between(
            poses,
            k,
            path,
            unit=pace.robot.arm_length,
            velocity=PathVelocity(
                work.stroke.manner.power,
                has_late_peak=work.stroke.spoken and strokes[k],
                start=0.0 if waits or k > 1 else effort.path_start_velocity(poses[0].passage),
            ),
        )
        keys += [*path_keys, poses[k]]
    if waits:
        keys.insert(0, HandKey(work.at("ready"), hands[0], effort.passage("preparation", time_ratio=0.0)))
    if work.at("strokeEnd") - keys[-1].time >= MIN_KEY_SPACING:
        keys.append(HandKey(work.at("strokeEnd"), hands[-1], effort.passage("hold")))
    return keys


def _hand_moves(poses: Poses, pace: Pace) -> tuple[tuple[_HandMove, ...], ...]:
    """Return the movements between successive keys, one per hand."""
    rows = tuple((side, row, poses.paths.get(side, (None,) * poses.count)) for side, row in poses.hands.items())
    return _cached_hand_moves(rows, poses.count - 1, pace)


@lru_cache(maxsize=64)  # reused within one document only: every document has new hands
def _cached_hand_moves(
    rows: tuple[tuple[Side, tuple[Hand, ...], tuple[HandPath | None, ...]], ...], count: int, pace: Pace
) -> tuple[tuple[_HandMove, ...], ...]:
    rest = resting_hands(pace.robot)
    return tuple(
        tuple(_hand_move(hands[k], hands[k + 1], paths[k + 1], rest[side]) for side, hands, paths in rows)
        for k in range(count)
    )


def _hand_move(a: Hand, b: Hand, path: HandPath | None, rest: Reach) -> _HandMove:
    if path is None:
        return _HandMove(1, pose_distance(a, b, rest), 1.0)
    start, end = (a.reach or rest).position, (b.reach or rest).position
    if path.course is not None:
        return _HandMove(1, float(np.linalg.norm(end - start)), 1.0, path.course.duration)
    swings = path.swings(start, end)
    return _HandMove(swings, PATH_LENGTH_FACTOR * path.length(start, end) / swings, PATH_TIME_FACTOR)


def least_stroke_times(poses: Poses, pace: Pace) -> tuple[float, ...]:
    """Return the minimum durations between successive stroke keys [s]."""
    return tuple(max(move.swings * move.minimum_time(pace) for move in moves) for moves in _hand_moves(poses, pace))


def _drop_repetitions(poses: Poses, times: Mapping[str, float], pace: Pace) -> Poses:
    """Drop repetitions that do not fit between `stroke` and `strokeEnd`."""
    available = times["strokeEnd"] - times["stroke"]
    while poses.again and sum(least_stroke_times(poses, pace)[poses.stroke :]) > available + 1e-9:
        poses = poses.fewer()
    return poses


def _reduce_path_periods(poses: Poses, moments: Sequence[float], pace: Pace) -> tuple[Poses, tuple[str, ...]]:
    """Reduce the number of periods of hand paths that are too fast.

    The remarks name the reduced paths.
    """
    paths, remarks = dict(poses.paths), []
    for side, row in poses.paths.items():
        slowed_row = list(row)
        for k, path in enumerate(row):
            if path is None or path.turns <= 1.0 or moments[k] <= moments[k - 1]:
                continue
            before, after = poses.hands[side][k - 1], poses.hands[side][k]
            minimum_time = _hand_move(before, after, path, resting_hands(pace.robot)[side]).minimum_time(pace)
            whole = moments[k] - moments[k - 1]
            turns = max(_MIN_PERIODS.get(path.kind, 1.0), np.floor(whole / minimum_time + 1e-9) / 2)
            if turns < path.turns:
                slowed_row[k] = path.slowed(turns)
                made = f"its {path.kind} makes {turns:g} of its {path.turns:g} turns"
                remarks.append(f"{made}: in {whole:.2f} s the servos can do no more")
        paths[side] = tuple(slowed_row)
    return (replace(poses, paths=paths) if remarks else poses), tuple(dict.fromkeys(remarks))


def _spread(start: float, end: float, natural: Sequence[float]) -> tuple[float, ...]:
    """Divide a time span in proportion to natural durations [s].

    There are as many times as intervals, the last at the end.
    """
    shares = np.cumsum(natural) / sum(natural)
    return (*(start + float(share) * (end - start) for share in shares[:-1]), end)


def _keys_apart(moments: Sequence[float], stroke: int) -> list[int]:
    """Return indices of sufficiently spaced keys, the stroke included."""
    kept_keys: list[int] = []
    for k, time in enumerate(moments):
        if not kept_keys or time - moments[kept_keys[-1]] >= MIN_KEY_SPACING:
            kept_keys.append(k)
        elif kept_keys[-1] != stroke:
            kept_keys[-1] = k
    return kept_keys


def _count_words(times: int) -> str:
    return "once" if times == 1 else "twice" if times == 2 else f"{times} times"
