"""Moments: keys and sync points so near to one another that they are one key frame."""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kinesic.expressivity.keyframes import PartName

TOGETHER = 0.01  # [s] nearer than this is at the same time: a shift by less need not be told


@dataclass(frozen=True)
class SyncPoint:
    """A sync point of a behaviour that moves something."""

    time: float  # [s] block time
    behaviour: str
    sync: str


@dataclass(frozen=True)
class Moment:
    """When a key frame is, and what falls on it."""

    time: float  # [s] of the frame
    first: float  # [s]
    last: float  # [s]
    syncs: tuple[tuple[str, str], ...]

    def among(self, times: Sequence[float]) -> float | None:
        """The one of sorted times that falls on this moment, of several the one nearest to the frame; None: none."""
        inside = times[bisect_left(times, self.first) : bisect_right(times, self.last)]
        return _nearest(inside, self.time) if inside else None


def moments(times: Mapping[PartName, Sequence[float]], syncs: Sequence[SyncPoint]) -> list[Moment]:
    """Groups of times: first around the strokes, then what is left, each from its earliest.

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
    return [Moment(a, members[a][0], members[a][-1], tuple(names[a])) for a in anchors]


def _apart(times: Sequence[float]) -> list[float]:
    """Of sorted times those that are not within `TOGETHER` after one that is kept."""
    kept: list[float] = []
    for time in times:
        if not kept or time - kept[-1] >= TOGETHER:
            kept.append(time)
    return kept


def _near(anchors: Sequence[float], time: float) -> float | None:
    """The anchor within `TOGETHER` of a time that is nearest; None when there is none."""
    k = bisect_left(anchors, time)
    near = [anchor for anchor in anchors[max(0, k - 1) : k + 1] if abs(anchor - time) < TOGETHER]
    return _nearest(near, time) if near else None


def _nearest(times: Sequence[float], time: float) -> float:
    """The time that is nearest to another, the earlier of two."""
    return min(times, key=lambda other: abs(other - time))


def _anchor(time: float, strokes: Sequence[float], others: Sequence[float]) -> float:
    """The time of the frame that a time belongs to: that of a stroke, else that of the earliest neighbour."""
    stroke = _near(strokes, time)
    return stroke if stroke is not None else others[bisect_left(others, time + 1e-12) - 1]
