"""Merging of all body parts' key sequences into key frames (thesis 8.5).

Keys and sync points that are nearly simultaneous become one key frame. A part without a key in a frame is filled by
linear interpolation between its neighbours, or left out, and then keeps its last key. The complex approach fills every
part. The lazy one fills a part only where it is at least as important as the moving parts, so that less is solved and
less important parts follow more important ones.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import get_args

import numpy as np

from kinesic.body.choices import KeyFrameFilling
from kinesic.body.robot import SIDES, PartName, Robot, Side
from kinesic.expressivity.hands.keys import HandKey, hand_at
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.keyframes import KeyFrame, Turn
from kinesic.expressivity.turns import Layer, TurnKey, add_turns, clip_turn, rotation_range, scale_turn, sum_layers
from kinesic.motion.keys import KeyPassage

Priorities = Mapping[PartName, float]

SAME_FRAME = 0.01  # [s] times within this interval share a key frame; smaller shifts are not reported
BODY_PARTS: tuple[PartName, ...] = get_args(PartName)
HAND_PARTS: Mapping[Side, PartName] = {"l": "l_hand", "r": "r_hand"}  # body part of the hand of each side
PART_PRIORITIES: Mapping[KeyFrameFilling, Priorities] = {
    "complex": dict.fromkeys(BODY_PARTS, 1.0),
    "lazy": {"l_hand": 1.0, "r_hand": 1.0, "torso": 0.5, "head": 0.25},
}


@dataclass(frozen=True)
class SyncPoint:
    """Sync point of a behaviour that moves a body part."""

    time: float  # [s] block time
    behaviour: str
    sync: str


@dataclass(frozen=True)
class FrameMoment:
    """Time of a key frame with the sync points merged into it."""

    time: float  # [s] time of the key frame
    first: float  # [s] earliest time merged into the frame
    last: float  # [s] latest time merged into the frame
    syncs: tuple[tuple[str, str], ...]

    def among(self, times: Sequence[float]) -> float | None:
        """Return the time [s] from `first` to `last` nearest to the frame.

        Args:
            times: sorted [s].

        Returns:
            None if no time lies between `first` and `last`.
        """
        inside = times[bisect_left(times, self.first) : bisect_right(times, self.last)]
        return _nearest(inside, self.time) if inside else None


def gather_times(times: Mapping[PartName, Sequence[float]], syncs: Sequence[SyncPoint]) -> list[FrameMoment]:
    """Group times closer than `SAME_FRAME` into key frames, strokes first.

    Args:
        times: of the keys of each part, sorted [s].
        syncs: points that must fall on a frame.
    """
    strokes = _spaced_times(sorted(point.time for point in syncs if point.sync.partition(":")[0] == "stroke"))
    all_times = sorted({point.time for point in syncs}.union(*times.values()))
    others = _spaced_times([time for time in all_times if _near_anchor(strokes, time) is None])
    anchors = sorted([*strokes, *others])
    members: dict[float, list[float]] = {anchor: [] for anchor in anchors}
    for time in all_times:
        members[_anchor(time, strokes, others)].append(time)
    names: dict[float, list[tuple[str, str]]] = {anchor: [] for anchor in anchors}
    for point in sorted(syncs, key=lambda point: point.time):
        names[_anchor(point.time, strokes, others)].append((point.behaviour, point.sync))
    return [FrameMoment(a, members[a][0], members[a][-1], tuple(names[a])) for a in anchors]


def _spaced_times(times: Sequence[float]) -> list[float]:
    """Drop sorted times [s] less than `SAME_FRAME` after a kept time."""
    kept_times: list[float] = []
    for time in times:
        if not kept_times or time - kept_times[-1] >= SAME_FRAME:
            kept_times.append(time)
    return kept_times


def _near_anchor(anchors: Sequence[float], time: float) -> float | None:
    """Return the nearest key frame time [s] within `SAME_FRAME`, or None."""
    k = bisect_left(anchors, time)
    key_times = [anchor for anchor in anchors[max(0, k - 1) : k + 1] if abs(anchor - time) < SAME_FRAME]
    return _nearest(key_times, time) if key_times else None


def _nearest(times: Sequence[float], time: float) -> float:
    """Return the listed time [s] nearest to another time, earlier if tied."""
    return min(times, key=lambda other: abs(other - time))


def _anchor(time: float, strokes: Sequence[float], others: Sequence[float]) -> float:
    """Return the time [s] of the key frame that absorbs a time.

    It is that of a near stroke, otherwise that of the earliest neighbour.
    """
    stroke = _near_anchor(strokes, time)
    return stroke if stroke is not None else others[bisect_left(others, time + 1e-12) - 1]


@dataclass(frozen=True, eq=False)
class Sequences:
    """Key sequences of each body part, before merging into key frames."""

    torso: tuple[Layer, ...] = ()
    head: tuple[Layer, ...] = ()
    hands: Mapping[Side, tuple[HandKey, ...]] = field(default_factory=dict)

    def keys(self) -> Mapping[PartName, list[TurnKey | HandKey]]:
        """Return the keys of each body part, sorted by time."""
        keys: dict[PartName, list[TurnKey | HandKey]] = {
            "torso": [key for layer in self.torso for key in layer],
            "head": [key for layer in self.head for key in layer],
        }
        keys.update({HAND_PARTS[side]: list(part_times) for side, part_times in self.hands.items()})
        return {part: sorted(part_times, key=lambda key: key.time) for part, part_times in keys.items() if part_times}


def gather_frames(
    sequences: Sequences, syncs: Sequence[SyncPoint], robot: Robot, priorities: Priorities = PART_PRIORITIES["complex"]
) -> tuple[KeyFrame, ...]:
    """Merge the key sequences of all parts into ordered key frames.

    A part without a key is filled if no part with a key has a higher priority. Keys and sync points less than
    `SAME_FRAME` from a stroke, or after the first of a frame, are in that frame. Where all priorities are equal every
    part is filled: the complex approach.

    Args:
        sequences: of the parts.
        syncs: points that must fall on a frame.
        robot: whose hands hang at rest, and whose ranges limit torso and neck.
        priorities: of all parts.
    """
    keys = sequences.keys()
    times = {part: [key.time for key in part_times] for part, part_times in keys.items()}
    moments = gather_times(times, syncs)
    keyed_parts = [frozenset(part for part in times if moment.among(times[part]) is not None) for moment in moments]
    fillings = {parts: _parts_to_fill(parts, priorities) for parts in {*keyed_parts}}
    filled = [fillings[parts] for parts in keyed_parts]
    read_times = {part: _read_times(part, moments, times.get(part, []), filled) for part in BODY_PARTS}
    trunk, neck, rest = rotation_range(robot, "torso"), rotation_range(robot, "neck"), resting_hands(robot)
    torso = [clip_turn(turn, trunk) for turn in _turns(sequences.torso, read_times["torso"])]
    head_turns = _turns(sequences.head, read_times["head"])
    head = [
        add_turns(t, clip_turn(add_turns(h, scale_turn(t, -1.0)), neck)) for t, h in zip(torso, head_turns, strict=True)
    ]
    hands = {
        side: [hand_at(sequences.hands.get(side, ()), time, rest[side]) for time in read_times[part]]
        for side, part in HAND_PARTS.items()
    }
    return tuple(
        KeyFrame(
            moment.time,
            torso[k],
            head[k],
            {side: hands[side][k] for side in SIDES},
            keyed_parts[k],
            moment.syncs,
            _passages(moment, keys, times),
            filled[k],
        )
        for k, moment in enumerate(moments)
    )


def _parts_to_fill(keyed_parts: frozenset[PartName], priorities: Priorities) -> frozenset[PartName]:
    """Return the parts without a key that must be interpolated.

    They are at least as important as all parts with a key.
    """
    highest = max((priorities[part] for part in keyed_parts), default=-np.inf)
    return frozenset(part for part in BODY_PARTS if part not in keyed_parts and priorities[part] >= highest)


def _read_times(
    part: PartName, moments: Sequence[FrameMoment], times: Sequence[float], filled: Sequence[frozenset[PartName]]
) -> list[float]:
    """Return the time [s] of each frame for sampling a part's keys.

    It is the frame's own time where the part is filled, otherwise the time of its key, or of its last one where it has
    none. At the first and last frame it is the outermost key, so that rest stays rest.
    """
    read_times = []
    for k, moment in enumerate(moments):
        part_times = moment.among(times)
        if part_times is None:
            last = bisect_right(times, moment.time) - 1
            read_times.append(moment.time if part in filled[k] or last < 0 else times[last])
        elif k in (0, len(moments) - 1):
            read_times.append(times[0 if k == 0 else -1])
        else:
            read_times.append(part_times)
    return read_times


def _turns(layers: Sequence[Layer], times: Sequence[float]) -> list[Turn]:
    return [Turn(*map(float, row)) for row in sum_layers(layers, np.array(times))]


def _passages(
    moment: FrameMoment, keys: Mapping[PartName, Sequence[TurnKey | HandKey]], times: Mapping[PartName, Sequence[float]]
) -> Mapping[PartName, KeyPassage]:
    """Return spline parameters of the body parts keyed in a frame.

    Of simultaneous keys in several layers the last one counts.
    """
    key_times = {part: moment.among(part_times) for part, part_times in times.items()}
    return {
        part: keys[part][bisect_right(times[part], at) - 1].passage for part, at in key_times.items() if at is not None
    }
