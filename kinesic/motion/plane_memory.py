"""Remembers the cutting planes of one search of key times for the next: a block is planned again with few other keys.

What a hinge lacks hangs on the angles of its own keys, the times between them, and its limits alone. So a plane holds
wherever the hinge passes the same keys again, under the same limits or tighter ones, whatever all others do.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.key_time_lp import CuttingPlane
from kinesic.motion.keys import Keys, Pair, Sync

KeyMark = tuple[tuple[Sync, ...], float]  # sync points that fall on a key of a hinge, and its angle there [rad]
Cuts = Mapping[int, Sequence[CuttingPlane]]  # of each hinge

SLIGHT = 1e-4  # share of the steepest slope below which a plane is not about a key
TIGHT = 0.002  # share of the time by which times keep a plane that holds them back
MOST_PLANES = 200  # planes that are remembered
GROWING = ("speed", "acceleration", "jerk", "duty")  # limits within which a plane holds under smaller ones, too


@dataclass(frozen=True, eq=False)
class _KnownPlane:
    """A plane over keys of a hinge that follow one another, in any motion that has them."""

    hinge: int
    marks: tuple[KeyMark, ...]  # the keys, with one more on either side, between which the hinge may swing
    slopes: Floats  # (k,) [1/s] over their times
    bound: float
    limits: Limits  # of the hinge
    met: tuple[tuple[Pair, Bottleneck], ...]  # what was too fast between which of the keys
    reaches: tuple[bool, bool]  # whether it is about the first, and the last key of the motion for which it was found
    spare: float = 0.0  # share of the time by which the times that were found last keep it

    def of(self, hinge: int) -> "_KnownPlane":
        """The same plane where its hinge has another number."""
        met = tuple((pair, replace(found, hinge=hinge)) for pair, found in self.met)
        return replace(self, hinge=hinge, met=met)

    def holds(self, limits: Limits) -> bool:
        """Whether it holds under other limits of the hinge."""
        own, others = vars(self.limits), vars(limits)
        return all(others[name] <= own[name] if name in GROWING else others[name] == own[name] for name in own)


class PlaneMemory:
    """The planes of the last searches, with which the next one begins."""

    def __init__(self) -> None:
        """Nothing is known yet."""
        self._planes: list[_KnownPlane] = []
        self._recalled: list[tuple[CuttingPlane, _KnownPlane]] = []

    def part(self, hinges: Sequence[int]) -> "PlaneMemory":
        """Copies what is known of some hinges, for a search of other keys, which numbers them from 0.

        Of planes only those that hold back the times which were found: shortage is nearly convex alone, so that others,
        from farther away, may cut off times that would do.
        """
        found, number = PlaneMemory(), {hinge: k for k, hinge in enumerate(hinges)}
        own = (plane for plane in self._planes if plane.hinge in number and plane.spare < TIGHT)
        found._planes = [plane.of(number[plane.hinge]) for plane in own]
        return found

    def learn(self, other: "PlaneMemory", hinges: Sequence[int], whole: tuple[bool, bool]) -> None:
        """Takes over what a search of some hinges alone has left, in place of what was known of them.

        A hinge rests at the first and the last key of its motion: what was found about these does not hold where there
        are others before, or after them.

        Args:
            other: what it has left.
            hinges: that it numbers from 0.
            whole: whether its motion began with the first key of all, and ended with the last one.
        """
        begun, ended = whole
        found = [
            plane.of(hinges[plane.hinge])
            for plane in other._planes
            if (begun or not plane.reaches[0]) and (ended or not plane.reaches[1])
        ]
        others = [plane for plane in self._planes if plane.hinge not in hinges]
        self._planes = [*found, *others][:MOST_PLANES]

    def keep(self, keys: Keys, limits: Limits, cuts: Cuts, met: Mapping[Pair, Bottleneck], times: Floats) -> None:
        """Learns the planes that a search ends with, and forgets those that it was given and did without.

        Args:
            keys: of the search.
            limits: of all hinges.
            cuts: the planes, over the times of all keys.
            met: what was too fast between which keys.
            times: (m,) [s] of all keys, with which it ends.
        """
        known = {id(cut): plane for cut, plane in self._recalled}
        found = [
            replace(
                known.get(id(cut)) or _portable(cut, hinge, keys, limits, met),
                spare=float(cut.bound - cut.slopes @ times),
            )
            for hinge, own in cuts.items()
            for cut in own
        ]
        forgotten = {id(plane) for plane in known.values()}
        others = [plane for plane in self._planes if id(plane) not in forgotten]
        self._planes, self._recalled = [*found, *others][:MOST_PLANES], []

    def recall(self, keys: Keys, limits: Limits) -> tuple[dict[int, list[CuttingPlane]], dict[Pair, Bottleneck]]:
        """Finds the planes of each hinge that hold for other keys, and what is too fast between these as asked.

        Args:
            keys: that are sought again.
            limits: of all hinges.
        """
        cuts: dict[int, list[CuttingPlane]] = {}
        met: dict[Pair, Bottleneck] = {}
        hinges = {plane.hinge for plane in self._planes}
        marks = {hinge: _marks(keys, hinge, keys.own[hinge]) for hinge in hinges}
        parts = {hinge: limits.part(np.array([hinge])) for hinge in hinges}
        self._recalled = []
        for plane in self._planes:
            own, here, count = keys.own[plane.hinge], marks[plane.hinge], len(plane.marks)
            first = next((k for k in range(len(own) - count + 1) if here[k : k + count] == plane.marks), None)
            if first is None or not plane.holds(parts[plane.hinge]):
                continue
            rows = own[first : first + count]
            slopes = np.zeros(len(keys.asked))
            slopes[rows] = plane.slopes
            cut = CuttingPlane(slopes, plane.bound)
            cuts.setdefault(plane.hinge, []).append(cut)
            self._recalled.append((cut, plane))
            if slopes @ keys.asked > plane.bound:
                met |= {(rows[i], rows[j]): found for (i, j), found in plane.met}
        return cuts, met


def _marks(keys: Keys, hinge: int, rows: Sequence[int]) -> tuple[KeyMark, ...]:
    return tuple((keys.syncs[row], float(keys.angles[row, hinge])) for row in rows)


def _portable(cut: CuttingPlane, hinge: int, keys: Keys, limits: Limits, met: Mapping[Pair, Bottleneck]) -> _KnownPlane:
    """A plane over the times of all keys, as one over those that it is about."""
    own = keys.own[hinge]
    slopes = cut.slopes[own]
    about = np.flatnonzero(np.abs(slopes) > SLIGHT * np.abs(slopes).max())
    first, last = int(about[0]), int(about[-1])
    slopes[first] += slopes[:first].sum()  # so that they still change nothing when all keys move together
    slopes[last] += slopes[last + 1 :].sum()
    slopes[:first] = slopes[last + 1 :] = 0.0
    wide = slice(max(first - 1, 0), last + 2)
    rows, part = own[wide], limits.part(np.array([hinge]))
    place = {row: k for k, row in enumerate(rows)}
    within = [
        ((place[i], place[j]), found)
        for (i, j), found in met.items()
        if found.hinge == hinge and i in place and j in place
    ]
    reaches = first == 0, last == len(own) - 1
    return _KnownPlane(hinge, _marks(keys, hinge, rows), sealed(slopes[wide]), cut.bound, part, tuple(within), reaches)
