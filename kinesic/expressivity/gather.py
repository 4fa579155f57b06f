"""Gathering: the sequences of all parts become one list of key frames, each of the whole upper body (thesis 8.5).

Keys and sync points so near to one another that they are one moment become one key frame. A part that has no key in a
frame is filled by linear interpolation between its neighbours, or left out, and then keeps its last key. The complex
approach fills every part. The lazy one fills a part only where it is at least as important as what moves there, so that
less is solved and what counts less goes along with what counts more.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import get_args

import numpy as np

from kinesic.body.choices import Gathering
from kinesic.body.robot import SIDES, PartName, Robot, Side
from kinesic.expressivity.hands.keys import HandKey, hand_at
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.keyframes import KeyFrame, Turn
from kinesic.expressivity.turns import Layer, TurnKey, add_turns, clip_turn, room, scale_turn, total
from kinesic.motion.keys import KeyPassage

Priorities = Mapping[PartName, float]

SAME_FRAME = 0.01  # [s] nearer than this is at the same time: a shift by less need not be told

PARTS: tuple[PartName, ...] = get_args(PartName)
HANDS: Mapping[Side, PartName] = {"l": "l_hand", "r": "r_hand"}
PRIORITIES: Mapping[Gathering, Priorities] = {
    "complex": dict.fromkeys(PARTS, 1.0),
    "lazy": {"l_hand": 1.0, "r_hand": 1.0, "torso": 0.5, "head": 0.25},
}


@dataclass(frozen=True)
class SyncPoint:
    """A sync point of a behaviour that moves something."""

    time: float  # [s] block time
    behaviour: str
    sync: str


@dataclass(frozen=True)
class FrameMoment:
    """The time of a key frame, with the sync points that fall on it."""

    time: float  # [s] of the frame
    first: float  # [s]
    last: float  # [s]
    syncs: tuple[tuple[str, str], ...]

    def among(self, times: Sequence[float]) -> float | None:
        """Picks the one of sorted times that falls on this moment, nearest to the frame; None: there is none."""
        inside = times[bisect_left(times, self.first) : bisect_right(times, self.last)]
        return _nearest(inside, self.time) if inside else None


def gather_times(times: Mapping[PartName, Sequence[float]], syncs: Sequence[SyncPoint]) -> list[FrameMoment]:
    """Groups times: first around the strokes, then what is left, each group from its earliest.

    Args:
        times: of the keys of each part, sorted [s].
        syncs: points that must fall on a moment.
    """
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
    return [FrameMoment(a, members[a][0], members[a][-1], tuple(names[a])) for a in anchors]


def _apart(times: Sequence[float]) -> list[float]:
    """Keeps sorted times that are not within `SAME_FRAME` after one that is kept."""
    kept: list[float] = []
    for time in times:
        if not kept or time - kept[-1] >= SAME_FRAME:
            kept.append(time)
    return kept


def _near(anchors: Sequence[float], time: float) -> float | None:
    """The nearest anchor within `SAME_FRAME` of a time; None when there is none."""
    k = bisect_left(anchors, time)
    near = [anchor for anchor in anchors[max(0, k - 1) : k + 1] if abs(anchor - time) < SAME_FRAME]
    return _nearest(near, time) if near else None


def _nearest(times: Sequence[float], time: float) -> float:
    """Of two that are as near the earlier."""
    return min(times, key=lambda other: abs(other - time))


def _anchor(time: float, strokes: Sequence[float], others: Sequence[float]) -> float:
    """The frame that a time belongs to: that of a stroke, else that of the earliest neighbour [s]."""
    stroke = _near(strokes, time)
    return stroke if stroke is not None else others[bisect_left(others, time + 1e-12) - 1]


@dataclass(frozen=True, eq=False)
class Sequences:
    """The sequences of keys of each part of the body, before they are gathered into key frames."""

    torso: tuple[Layer, ...] = ()
    head: tuple[Layer, ...] = ()
    hands: Mapping[Side, tuple[HandKey, ...]] = field(default_factory=dict)

    def keys(self) -> Mapping[PartName, list[TurnKey | HandKey]]:
        """Lists the keys of each part that has some, in the order of their times."""
        keys: dict[PartName, list[TurnKey | HandKey]] = {
            "torso": [key for layer in self.torso for key in layer],
            "head": [key for layer in self.head for key in layer],
        }
        keys.update({HANDS[side]: list(own) for side, own in self.hands.items()})
        return {part: sorted(own, key=lambda key: key.time) for part, own in keys.items() if own}


def gather_frames(
    sequences: Sequences, syncs: Sequence[SyncPoint], robot: Robot, priorities: Priorities = PRIORITIES["complex"]
) -> tuple[KeyFrame, ...]:
    """Makes key frames in strictly increasing time, filling parts that no part with a key exceeds in priority.

    Keys and sync points nearer than 20 ms share a frame, at the time of a stroke if one is among them. Where all
    priorities are equal every part is filled: the complex approach.

    Args:
        sequences: of the parts.
        syncs: points that must fall on a frame.
        robot: whose hands hang at rest, and whose ranges bound torso and neck.
        priorities: of all parts.
    """
    keys = sequences.keys()
    times = {part: [key.time for key in own] for part, own in keys.items()}
    found = gather_times(times, syncs)
    given = [frozenset(part for part in times if moment.among(times[part]) is not None) for moment in found]
    filled = [_parts_to_fill(parts, priorities) for parts in given]
    looked = {part: _read_times(part, found, times.get(part, []), filled) for part in PARTS}
    trunk, neck, rest = room(robot, "torso"), room(robot, "neck"), resting_hands(robot)
    torso = [clip_turn(turn, trunk) for turn in _turns(sequences.torso, looked["torso"])]
    above = _turns(sequences.head, looked["head"])
    head = [add_turns(t, clip_turn(add_turns(h, scale_turn(t, -1.0)), neck)) for t, h in zip(torso, above, strict=True)]
    hands = {
        side: [hand_at(sequences.hands.get(side, ()), time, rest[side]) for time in looked[part]]
        for side, part in HANDS.items()
    }
    return tuple(
        KeyFrame(
            moment.time,
            torso[k],
            head[k],
            {side: hands[side][k] for side in SIDES},
            given[k],
            moment.syncs,
            _passages(moment, keys, times),
            filled[k],
        )
        for k, moment in enumerate(found)
    )


def _parts_to_fill(given: frozenset[PartName], priorities: Priorities) -> frozenset[PartName]:
    """Parts without a key that are at least as important as all that have one."""
    most = max((priorities[part] for part in given), default=-np.inf)
    return frozenset(part for part in PARTS if part not in given and priorities[part] >= most)


def _read_times(
    part: PartName, moments: Sequence[FrameMoment], times: Sequence[float], filled: Sequence[frozenset[PartName]]
) -> list[float]:
    """When the sequence of a part is read for each frame [s].

    At the frame's own time where the part is filled, else at its key, or at its last one where it has none; at the
    outer frames at its outermost key, so that rest stays rest.
    """
    looked = []
    for k, moment in enumerate(moments):
        own = moment.among(times)
        if own is None:
            last = bisect_right(times, moment.time) - 1
            looked.append(moment.time if part in filled[k] or last < 0 else times[last])
        elif k in (0, len(moments) - 1):
            looked.append(times[0 if k == 0 else -1])
        else:
            looked.append(own)
    return looked


def _turns(layers: Sequence[Layer], times: Sequence[float]) -> list[Turn]:
    return [Turn(*map(float, row)) for row in total(layers, np.array(times))]


def _passages(
    moment: FrameMoment, keys: Mapping[PartName, Sequence[TurnKey | HandKey]], times: Mapping[PartName, Sequence[float]]
) -> Mapping[PartName, KeyPassage]:
    """Says how the keys on a moment are passed; of several layers' keys at once the last one counts."""
    near = {part: moment.among(own) for part, own in times.items()}
    return {part: keys[part][bisect_right(times[part], at) - 1].passage for part, at in near.items() if at is not None}
