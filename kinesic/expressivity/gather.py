"""Gathering: the sequences of all parts become one list of key frames, each of the whole upper body.

This is the "complex" approach of thesis 8.5: every part counts the same, and what a key frame does not ask for is
filled by linear interpolation between the part's own neighbours.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.hands import resting
from kinesic.expressivity.keyframes import KeyFrame, PartName, Turn
from kinesic.expressivity.phases import HandKey, hand_at
from kinesic.expressivity.turns import MERGE, Layer, clipped, plus, room, scaled, total

HANDS: Mapping[Side, PartName] = {"l": "l_hand", "r": "r_hand"}


@dataclass(frozen=True)
class SyncPoint:
    """A sync point of a behaviour that moves something."""

    time: float  # [s] block time
    behaviour: str
    sync: str


@dataclass(frozen=True, eq=False)
class Sequences:
    """What the parts do, each for itself."""

    torso: tuple[Layer, ...] = ()
    head: tuple[Layer, ...] = ()
    hands: Mapping[Side, tuple[HandKey, ...]] = field(default_factory=dict)

    def times(self) -> Mapping[PartName, list[float]]:
        """When each part has a key, in order [s]."""
        times: dict[PartName, list[float]] = {
            "torso": [key.time for layer in self.torso for key in layer],
            "head": [key.time for layer in self.head for key in layer],
        }
        times.update({HANDS[side]: [key.time for key in keys] for side, keys in self.hands.items()})
        return {part: sorted(found) for part, found in times.items() if found}


@dataclass(frozen=True)
class _Moment:
    """Keys and sync points so near to one another that they are one key frame."""

    time: float  # [s] of the frame
    first: float  # [s]
    last: float  # [s]
    syncs: tuple[tuple[str, str], ...]


def gathered(sequences: Sequences, syncs: Sequence[SyncPoint], robot: Robot) -> tuple[KeyFrame, ...]:
    """Key frames in strictly increasing time, from the sequences of the parts.

    Keys and sync points nearer than 20 ms share a frame, at the time of a stroke if one is among them.

    Args:
        sequences: of the parts.
        syncs: points that must fall on a frame.
        robot: whose hands hang at rest, and whose ranges bound torso and neck.
    """
    times = sequences.times()
    moments = _moments(times, syncs)
    given = [frozenset(part for part in times if _within(times[part], moment)) for moment in moments]
    trunk = room(robot, "torso")
    torso = [clipped(turn, trunk) for turn in _turns("torso", sequences.torso, moments, times)]
    above = _turns("head", sequences.head, moments, times)
    neck = room(robot, "neck")
    head = [plus(t, clipped(plus(h, scaled(t, -1.0)), neck)) for t, h in zip(torso, above, strict=True)]
    rest = resting(robot)
    hands = {
        side: [
            hand_at(sequences.hands.get(side, ()), time, rest[side]) for time in _looked(HANDS[side], moments, times)
        ]
        for side in SIDES
    }
    return tuple(
        KeyFrame(moment.time, torso[k], head[k], {side: hands[side][k] for side in SIDES}, given[k], moment.syncs)
        for k, moment in enumerate(moments)
    )


def _moments(times: Mapping[PartName, list[float]], syncs: Sequence[SyncPoint]) -> list[_Moment]:
    """Groups of times: first around the strokes, then what is left, each from its earliest."""
    strokes = _apart(sorted(point.time for point in syncs if point.sync.partition(":")[0] == "stroke"))
    every = sorted({point.time for point in syncs}.union(*times.values()))
    others = _apart([time for time in every if _near(strokes, time) is None])
    anchors = sorted([*strokes, *others])
    members: dict[float, list[float]] = {anchor: [] for anchor in anchors}
    for time in every:
        members[_anchor(time, strokes, others)].append(time)
    names: dict[float, list[tuple[str, str]]] = {anchor: [] for anchor in anchors}
    for point in sorted(syncs, key=lambda point: point.time):
        names[_anchor(point.time, strokes, others)].append((point.behaviour, point.sync))
    return [_Moment(a, members[a][0], members[a][-1], tuple(names[a])) for a in anchors]


def _apart(times: Sequence[float]) -> list[float]:
    """Of sorted times those that are not within `MERGE` after one that is kept."""
    kept: list[float] = []
    for time in times:
        if not kept or time - kept[-1] >= MERGE:
            kept.append(time)
    return kept


def _near(anchors: Sequence[float], time: float) -> float | None:
    """The anchor within `MERGE` of a time that is nearest; None when there is none."""
    k = bisect_left(anchors, time)
    near = [anchor for anchor in anchors[max(0, k - 1) : k + 1] if abs(anchor - time) < MERGE]
    return _nearest(near, time) if near else None


def _nearest(times: Sequence[float], time: float) -> float:
    """The time that is nearest to another, the earlier of two."""
    return min(times, key=lambda other: abs(other - time))


def _anchor(time: float, strokes: Sequence[float], others: Sequence[float]) -> float:
    """The time of the frame that a time belongs to: that of a stroke, else that of the earliest neighbour."""
    stroke = _near(strokes, time)
    return stroke if stroke is not None else others[bisect_left(others, time + 1e-12) - 1]


def _within(times: Sequence[float], moment: _Moment) -> bool:
    k = bisect_left(times, moment.first)
    return k < len(times) and times[k] <= moment.last


def _looked(part: PartName, moments: Sequence[_Moment], times: Mapping[PartName, list[float]]) -> list[float]:
    """When the sequence of a part is read for each frame [s].

    At the frame's own time where the part has a key at it or none near it, else at its nearest key; at the outer
    frames at its outermost key, so that rest stays rest.
    """
    keys = times.get(part, [])
    found = []
    for k, moment in enumerate(moments):
        inside = keys[bisect_left(keys, moment.first) : bisect_right(keys, moment.last)]
        if not inside:
            found.append(moment.time)
        elif k in (0, len(moments) - 1):
            found.append(inside[0 if k == 0 else -1])
        else:
            found.append(_nearest(inside, moment.time))
    return found


def _turns(
    part: PartName,
    layers: Sequence[Layer],
    moments: Sequence[_Moment],
    times: Mapping[PartName, list[float]],
) -> list[Turn]:
    """Sum of a part's layers for each frame."""
    sums = total(layers, np.array(_looked(part, moments, times)))
    return [Turn(*map(float, row)) for row in sums]
