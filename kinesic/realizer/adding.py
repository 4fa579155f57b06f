"""Movements of the trunk add up: a nod goes over a gaze, the lean of one reach over that of another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.limits import Limits
from kinesic.motion.trajectory import STEP
from kinesic.motion.transition import LEAST, SAME, crossed, excesses, kept, lengthened
from kinesic.planning.quick_plan import duration
from kinesic.realizer.busy import ARMS, Busy
from kinesic.realizer.work import Failed, Work

EASE = 1.5  # times the least time, in which what stays gives way


def added(work: Work, alone: Flags, limits: Limits, names: Sequence[str]) -> Floats | Failed:
    """Both motions added, nearest to their sum where that exceeds a limit.

    Args:
        work: what is laid over what.
        alone: (n,) hinges of which only what runs counts.
        limits: of all hinges.
        names: of all hinges.

    Returns:
        (k + 3, n) [rad] control points; a behaviour of the block where a hinge cannot do both.
    """
    turns = [turn for each in work.performed for turn in _turns(each, work, limits)]
    count = max([len(work.base), *(ceil(turn.over / STEP) + 2 * LEAST for turn in turns)])
    base, coming = lengthened(work.base, count), lengthened(work.coming, count)
    change = coming - coming[0]
    change[:, alone] = 0.0
    for gone in work.dropped:
        _flatten(change, gone, work, limits)
    for turn in turns:
        change -= turn.share(count)[:, None] * turn.left
    found = np.asarray(base + change)
    rows, moved = np.flatnonzero(np.abs(change).max(axis=1) > SAME), np.flatnonzero(np.abs(change).max(axis=0) > SAME)
    if not len(rows):
        return found
    first, last = max(work.cut, int(rows[0]) - LEAST), min(int(rows[-1]) + 1, len(found) - LEAST)
    if last - first < LEAST:
        return found
    over = excesses(found[first : last + LEAST, moved], limits.part(moved)) > 1.0
    for hinge in moved[over].tolist():
        wish = np.clip(found[:, hinge], limits.lower[hinge], limits.upper[hinge])
        column = kept(wish, first, last, limits, hinge)
        if column is None:
            return work.blamed(f"{names[hinge]} cannot do both within its limits")
        found[:, hinge] = column
    return found


def _flatten(change: Floats, gone: Busy, work: Work, limits: Limits) -> None:
    """Takes out of what a block changes (k + 3, n) [rad] what a behaviour did that is left out."""
    begin, end = max(0, floor(gone.begin / STEP)), min(ceil(gone.end / STEP), len(change) - LEAST)
    beside = [each for each in work.performed if each.begin < gone.end and gone.begin < each.end]
    own = gone.hinges & ~np.any([each.hinges for each in beside], axis=0) if beside else np.ones_like(gone.hinges)
    for hinge in np.flatnonzero(own).tolist() if begin < end else ():
        column = change[:, hinge]
        way = crossed(column, np.full(len(column), column[end + 1]), begin, end, limits, hinge)
        if way is not None:
            change[begin : end + 1, hinge] = way[begin : end + 1]


@dataclass(frozen=True, eq=False)
class _Turn:
    """What an earlier behaviour has left gives way to one of its kind, while that lasts or for good."""

    left: Floats  # (n,) [rad]
    begin: float  # [s] from here
    gone: float  # [s] until here it gives way
    back: float  # [s] from here
    end: float  # [s] until here it comes back, or never

    @property
    def over(self) -> float:
        """When it is over [s]."""
        return self.end if np.isfinite(self.end) else self.gone

    def share(self, count: int) -> Floats:
        """(count,) of what was left that is taken out, by control points."""
        times = np.asarray((np.arange(count) - LEAST) * STEP, dtype=np.float64)
        back = rise(times, self.back, self.end) if np.isfinite(self.end) else 0.0
        return np.asarray(rise(times, self.begin, self.gone) * (1.0 - back))


def _turns(each: Busy, work: Work, limits: Limits) -> Iterator[_Turn]:
    for role in each.roles - set(ARMS):
        left = next((other.offset for other in work.held if role in other.roles and other.end <= each.begin), None)
        if left is not None:
            least = EASE * max(duration(float(way), limits, hinge) for hinge, way in enumerate(left))
            gone, end = max(each.ready, each.begin + least), np.inf if each.stays else each.end
            yield _Turn(left, each.begin, gone, min(each.relax, each.end - least), end)


def rise(times: Floats, begin: float, end: float) -> Floats:
    """From 0 to 1 between two times [s], smooth up to the acceleration, at some times (m,) [s]."""
    u = np.clip((times - begin) / max(end - begin, STEP), 0.0, 1.0)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))
