"""Storage of cutting planes for later key-time searches.

The time deficit of a hinge depends only on its keys, the times between them, and its limits. A plane is therefore valid
wherever the hinge passes the same keys under the same or tighter limits, independent of all other hinges.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.key_time_lp import CuttingPlane
from kinesic.motion.keys import Keys, Pair, Sync

KeyMark = tuple[tuple[Sync, ...], float]  # sync points at a key of a hinge, and its angle there [rad]
Planes = Mapping[int, Sequence[CuttingPlane]]  # cutting planes of each hinge

SLOPE_TOLERANCE = 1e-4  # slope / steepest slope below which a cutting plane ignores a key
ACTIVE_SLACK = 0.002  # [ln(time ratio)] slack below which a cutting plane counts as active
MAX_STORED_PLANES = 200  # largest number of cutting planes kept between searches
MONOTONE_LIMITS = ("speed", "acceleration", "jerk", "duty")  # limits whose reduction keeps a cutting plane valid


@dataclass(frozen=True, eq=False)
class _StoredPlane:
    """Stored cutting plane over a hinge's successive keys, reusable in other motions."""

    hinge: int
    marks: tuple[KeyMark, ...]  # keys of the plane, with one more key on either side
    slopes: Floats  # (k,) [1/s] slopes over the times of these keys
    bound: float
    limits: Limits  # of the hinge
    bottlenecks: tuple[tuple[Pair, Bottleneck], ...]  # by pair of keys
    reaches: tuple[bool, bool]  # whether the plane involves the first, and the last key of its motion
    slack: float = 0.0  # [ln(time ratio)] at the latest key times

    def of(self, hinge: int) -> "_StoredPlane":
        """Return the same plane for another hinge index."""
        bottlenecks = tuple((pair, replace(bottleneck, hinge=hinge)) for pair, bottleneck in self.bottlenecks)
        return replace(self, hinge=hinge, bottlenecks=bottlenecks)

    def is_valid(self, limits: Limits) -> bool:
        """Return whether the cutting plane also holds for the given motion limits."""
        stored, others = vars(self.limits), vars(limits)
        return all(
            others[name] <= stored[name] if name in MONOTONE_LIMITS else others[name] == stored[name] for name in stored
        )


class PlaneMemory:
    """Cutting planes of earlier searches, applied to later ones."""

    def __init__(self) -> None:
        """Create the storage without any cutting planes."""
        self._planes: list[_StoredPlane] = []
        self._recalled: list[tuple[CuttingPlane, _StoredPlane]] = []

    def part(self, hinges: Sequence[int]) -> "PlaneMemory":
        """Copy active planes of some hinges, with hinges renumbered from 0.

        Only planes that are active at the resulting times: the deficit is only nearly convex, so that planes from
        farther away may exclude feasible times.
        """
        copy, numbers = PlaneMemory(), {hinge: k for k, hinge in enumerate(hinges)}
        active = (plane for plane in self._planes if plane.hinge in numbers and plane.slack < ACTIVE_SLACK)
        copy._planes = [plane.of(numbers[plane.hinge]) for plane in active]
        return copy

    def learn(self, other: "PlaneMemory", hinges: Sequence[int], whole: tuple[bool, bool]) -> None:
        """Replace some hinges' cutting planes by those of a partial search.

        A hinge rests at the first and the last key of its motion. Planes that involve these keys are therefore not
        valid where the whole motion has keys before or after them.

        Args:
            other: memory of the partial search.
            hinges: of the partial search, which numbers them from 0.
            whole: whether its motion begins with the very first key, and ends with the very last one.
        """
        has_start, has_end = whole
        learned = [
            plane.of(hinges[plane.hinge])
            for plane in other._planes
            if (has_start or not plane.reaches[0]) and (has_end or not plane.reaches[1])
        ]
        others = [plane for plane in self._planes if plane.hinge not in hinges]
        self._planes = [*learned, *others][:MAX_STORED_PLANES]

    def store(
        self, keys: Keys, limits: Limits, planes: Planes, bottlenecks: Mapping[Pair, Bottleneck], times: Floats
    ) -> None:
        """Store a finished search's planes and drop unused ones.

        Args:
            keys: of the search.
            limits: of all hinges.
            planes: over the times of all keys.
            bottlenecks: by pair of keys.
            times: (m,) [s] resulting times of all keys.
        """
        recalled = {id(plane): stored for plane, stored in self._recalled}
        used = [
            replace(
                recalled.get(id(plane)) or _make_portable(plane, hinge, keys, limits, bottlenecks),
                slack=float(plane.bound - plane.slopes @ times),
            )
            for hinge, hinge_planes in planes.items()
            for plane in hinge_planes
        ]
        replaced = {id(stored) for stored in recalled.values()}
        others = [stored for stored in self._planes if id(stored) not in replaced]
        self._planes, self._recalled = [*used, *others][:MAX_STORED_PLANES], []

    def recall(self, keys: Keys, limits: Limits) -> tuple[dict[int, list[CuttingPlane]], dict[Pair, Bottleneck]]:
        """Return the stored cutting planes that are valid for given keys.

        Args:
            keys: of the next search.
            limits: of all hinges.
        """
        planes: dict[int, list[CuttingPlane]] = {}
        bottlenecks: dict[Pair, Bottleneck] = {}
        hinges = {plane.hinge for plane in self._planes}
        marks = {hinge: _mark_keys(keys, hinge, keys.exact_rows[hinge]) for hinge in hinges}
        hinge_limits = {hinge: limits.part(np.array([hinge])) for hinge in hinges}
        self._recalled = []
        for stored in self._planes:
            hinge_rows, hinge_marks, count = keys.exact_rows[stored.hinge], marks[stored.hinge], len(stored.marks)
            starts = range(len(hinge_rows) - count + 1)
            first = next((k for k in starts if hinge_marks[k : k + count] == stored.marks), None)
            if first is None or not stored.is_valid(hinge_limits[stored.hinge]):
                continue
            rows = hinge_rows[first : first + count]
            slopes = np.zeros(len(keys.requested_times))
            slopes[rows] = stored.slopes
            plane = CuttingPlane(slopes, stored.bound)
            planes.setdefault(stored.hinge, []).append(plane)
            self._recalled.append((plane, stored))
            if slopes @ keys.requested_times > stored.bound:
                bottlenecks |= {(rows[i], rows[j]): bottleneck for (i, j), bottleneck in stored.bottlenecks}
        return planes, bottlenecks


def _mark_keys(keys: Keys, hinge: int, rows: Sequence[int]) -> tuple[KeyMark, ...]:
    return tuple((keys.syncs[row], float(keys.angles[row, hinge])) for row in rows)


def _make_portable(
    plane: CuttingPlane, hinge: int, keys: Keys, limits: Limits, bottlenecks: Mapping[Pair, Bottleneck]
) -> _StoredPlane:
    """Reduce a cutting plane over all key times to one hinge's keys."""
    hinge_rows = keys.exact_rows[hinge]
    slopes = plane.slopes[hinge_rows]
    involved = np.flatnonzero(np.abs(slopes) > SLOPE_TOLERANCE * np.abs(slopes).max())
    first, last = int(involved[0]), int(involved[-1])
    slopes[first] += slopes[:first].sum()  # so that the sum stays 0: a common shift of all keys changes nothing
    slopes[last] += slopes[last + 1 :].sum()
    slopes[:first] = slopes[last + 1 :] = 0.0
    with_neighbours = slice(max(first - 1, 0), last + 2)
    rows, hinge_limits = hinge_rows[with_neighbours], limits.part(np.array([hinge]))
    index = {row: k for k, row in enumerate(rows)}
    of_hinge = [
        ((index[i], index[j]), bottleneck)
        for (i, j), bottleneck in bottlenecks.items()
        if bottleneck.hinge == hinge and i in index and j in index
    ]
    reaches = first == 0, last == len(hinge_rows) - 1
    marks = _mark_keys(keys, hinge, rows)
    return _StoredPlane(
        hinge, marks, sealed(slopes[with_neighbours]), plane.bound, hinge_limits, tuple(of_hinge), reaches
    )
