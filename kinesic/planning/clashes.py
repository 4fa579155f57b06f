"""Search for strokes of one hand that are too close in time.

The time that a hand needs between strokes depends on joint angles, and is known only after inverse kinematics. An
estimate with stops at every reversal finds candidates. For these alone, key times are searched exactly, with the hinges
of the hand only, so that quick and final plans agree.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kinesic.bml.block import Gesture, Pointing
from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.busy_hands import Clash
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.budget import Budget
from kinesic.motion.condition import condition
from kinesic.motion.double_s import IntervalDurations, compute_velocity_durations, least_rest_times_of
from kinesic.motion.key_time_lp import KeyTimeProblem, solve_key_times
from kinesic.motion.keys import HOLD_TOLERANCE, KeyPosture, Keys, Pair
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.planning.setup import Setup

VISIBLE_CLASH = 0.2  # [s] growth of the interval between two strokes that viewers notice
MAX_EXACT_SEARCHES = 12  # exact searches per block; remaining pairs are judged by an estimate
MAX_EXACT_PAIRS = 4 * MAX_EXACT_SEARCHES  # number of candidate pairs above which only the estimate is used
SEARCH_BUDGET = 100_000  # spline segments that all exact searches of a block may evaluate
NEGLIGIBLE_CLASH = 0.02  # [s] growth of the interval between two strokes up to which both gestures stay as they are


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Two successive gestures of one hand, possibly too close in time."""

    behaviours: tuple[str, str]
    strokes: Pair  # indices of the key postures of their strokes
    hinges: tuple[int, ...]  # hinges of the arms that perform both gestures
    brief: bool = False  # whether each stroke is a single key

    @property
    def cache_key(self) -> tuple[tuple[str, str], tuple[int, ...], bool]:
        """Cache key for the measured timing conflict of this gesture pair."""
        return self.behaviours, self.hinges, self.brief

    def moved_apart(self, keys: Keys, times: Floats) -> float:
        """Return the interval between both strokes minus the requested interval [s].

        `times` (m,) [s] are new times of all keys.
        """
        first, second = self.strokes
        return float((times - keys.requested_times)[second] - (times - keys.requested_times)[first])


class ClashFinder:
    """Finder of gesture pairs whose strokes planning must visibly move apart.

    The threshold is `VISIBLE_CLASH`, summed over neighbours before and after.
    """

    def __init__(self, setup: Setup) -> None:
        """Create a finder that has found no clashes yet.

        Args:
            setup: robot and limits.
        """
        self.clashes: dict[frozenset[str], Clash] = {}
        self.memory = PlaneMemory()  # cutting planes found by the exact searches
        self.crowded = False  # whether there were too many candidates for exact searches
        self._setup, self._budget = setup, Budget(SEARCH_BUDGET)
        self._exact_separations: dict[
            tuple[tuple[str, str], tuple[int, ...], bool], float
        ] = {}  # [s] separations by cache key, estimates where no exact search was made

    @property
    def spent(self) -> bool:
        """Whether the budget of exact searches is used up.

        From then on, the estimate decides.
        """
        return self._budget.spent

    def look(self, frames: KeyFrames, postures: Sequence[KeyPosture]) -> frozenset[str]:
        """Search for new timing conflicts and return the ids of their behaviours.

        Of a chain of gestures only the worst neighbours count, and those far from them: once one gesture yields, the
        others may have time. With a spent budget, every second gesture of a chain yields at once, as a round for each
        would take too long. Pairs whose strokes became brief are searched again.

        Args:
            frames: of a block.
            postures: solved for these frames.

        Returns:
            Ids of the new clashing behaviours; empty if there are none.
        """
        pairs = _neighbours(frames, postures, self._setup)
        new_pairs = [pair for pair in pairs if not self._is_known(pair)]
        estimates = self._suspects(new_pairs, postures)
        self.crowded = len(estimates) > MAX_EXACT_PAIRS
        if self.crowded:
            self._budget.spend(2 * SEARCH_BUDGET)
        candidates = [pair for pair, _ in estimates]
        separations = [self._search(pair, estimate, postures) for pair, estimate in estimates]
        new_behaviours, handled = set[str](), set[str]()
        for pair, separation, total in sorted(
            zip(candidates, separations, sum_chains(candidates, separations), strict=True), key=_worst_first
        ):
            if separation > NEGLIGIBLE_CLASH and total > VISIBLE_CLASH and handled.isdisjoint(pair.behaviours):
                self.clashes[frozenset(pair.behaviours)] = Clash(separation, pair.brief)
                handled |= {*pair.behaviours} if self.spent else _with_neighbours(pair, pairs)
                new_behaviours |= {*pair.behaviours}
        return frozenset(new_behaviours)

    def _is_known(self, pair: Neighbours) -> bool:
        clash = self.clashes.get(frozenset(pair.behaviours))
        return clash is not None and (clash.brief or not pair.brief)

    def _suspects(
        self, new_pairs: Sequence[Neighbours], postures: Sequence[KeyPosture]
    ) -> list[tuple[Neighbours, float]]:
        """Return gesture pairs that may lack time, with the estimated separation [s].

        The list is empty if the summed deficit of all gaps is too small, because no two keys move apart by more than
        this sum.
        """
        if not new_pairs:
            return []
        keys = Keys.of(postures, self._setup.limits)
        problem = KeyTimeProblem(keys, _gaps(keys), lead_in=0.0)
        if problem.total_deficit < VISIBLE_CLASH - NEGLIGIBLE_CLASH:
            return []
        times = solve_key_times(problem)
        separations = [pair.moved_apart(keys, times) for pair in new_pairs]
        sums = sum_chains(new_pairs, separations)
        rows = zip(new_pairs, separations, sums, strict=True)
        return [
            (pair, separation)
            for pair, separation, total in rows
            if separation > NEGLIGIBLE_CLASH and total > VISIBLE_CLASH
        ]

    def _search(self, pair: Neighbours, estimate: float, postures: Sequence[KeyPosture]) -> float:
        key, budget = pair.cache_key, self._budget
        if key not in self._exact_separations:
            is_exact = len(self._exact_separations) < MAX_EXACT_SEARCHES and not budget.spent
            least_gaps = _search(pair, postures, self._setup, budget, self.memory) if is_exact else estimate
            self._exact_separations[key] = estimate if budget.spent else least_gaps
        return self._exact_separations[key]


def sum_chains(pairs: Sequence[Neighbours], separations: Sequence[float]) -> list[float]:
    """Return each pair's largest separation [s] summed along a chain of conflicts.

    The separation of a pair is the growth of the interval between its strokes.

    Args:
        pairs: in the order of their strokes.
        separations: [s] for each pair; values below `NEGLIGIBLE_CLASH` end a chain.
    """
    before, after = defaultdict[str, float](float), defaultdict[str, float](float)
    excesses = [
        (*pair.behaviours, separation)
        for pair, separation in zip(pairs, separations, strict=True)
        if separation > NEGLIGIBLE_CLASH
    ]
    for first, second, separation in excesses:
        before[second] = max(before[second], before[first] + separation)
    for first, second, separation in reversed(excesses):
        after[first] = max(after[first], after[second] + separation)
    return [
        before[pair.behaviours[0]] + separation + after[pair.behaviours[1]]
        for pair, separation in zip(pairs, separations, strict=True)
    ]


def _with_neighbours(pair: Neighbours, pairs: Sequence[Neighbours]) -> set[str]:
    """Return both behaviours of a pair and their neighbouring gestures."""
    return {id for other in pairs if {*other.behaviours} & {*pair.behaviours} for id in other.behaviours}


def _worst_first(row: tuple[Neighbours, float, float]) -> float:
    return -row[1]


def compute_reversal_times(keys: Keys) -> IntervalDurations:
    """Compute minimum rest-to-rest times [s] between successive reversals of each hinge.

    The result is mostly pessimistic, as a hinge may reverse while it brakes.
    """
    intervals = [
        (hinge, pair)
        for hinge, rows in enumerate(keys.exact_rows)
        for pair in _monotone_intervals(keys.angles[rows, hinge].tolist(), rows)
    ]
    hinges, begins, ends = np.array([(hinge, i, j) for hinge, (i, j) in intervals], dtype=np.intp).reshape(-1, 3).T
    turns = keys.angles[ends, hinges] - keys.angles[begins, hinges]
    return dict(zip(intervals, least_rest_times_of(hinges, turns, keys.limits).tolist(), strict=True))


def _gaps(keys: Keys) -> dict[Pair, float]:
    """Estimate minimum times [s] between keys from velocity limits and reversals."""
    gaps = dict(keys.gaps)
    for least_gaps in (compute_velocity_durations(keys, keys.limits), compute_reversal_times(keys)):
        for (_, pair), least in least_gaps.items():
            gaps[pair] = max(gaps.get(pair, 0.0), least)
    return gaps


def _monotone_intervals(angles: Sequence[float], rows: Sequence[int]) -> list[Pair]:
    """Return the first and last index of each monotone run of keys.

    A hold is a run of its own.
    """
    steps = [after - before for before, after in pairwise(angles)]
    intervals = [0 if abs(step) < HOLD_TOLERANCE else 1 if step > 0.0 else -1 for step in steps]
    turned = (k for k, (before, after) in enumerate(pairwise(intervals), 1) if before != after)
    return [(rows[i], rows[j]) for i, j in pairwise([0, *turned, len(steps)]) if i < j]


def _neighbours(frames: KeyFrames, postures: Sequence[KeyPosture], setup: Setup) -> list[Neighbours]:
    """Return the pairs of successive gestures of each hand."""
    row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
    gestures = [one.behaviour for one in frames.timeline.timed if isinstance(one.behaviour.action, Gesture | Pointing)]
    moving = [gesture.id for gesture in gestures if (gesture.id, "stroke") in row_of]
    sides: dict[tuple[str, str], list[int]] = {}
    for side in SIDES:
        rows = [id for id in moving if f"{side}_hand" in frames.uses[id]]
        for pair in pairwise(sorted(rows, key=lambda id: row_of[id, "stroke"])):
            sides.setdefault(pair, []).extend(setup.robot.arm(side).joints)
    brief_ids = {
        id for id in moving if len({row_of.get((id, sync)) for sync in ("strokeStart", "stroke", "strokeEnd")}) == 1
    }
    return [
        Neighbours((a, b), (row_of[a, "stroke"], row_of[b, "stroke"]), tuple(hinges), {a, b} <= brief_ids)
        for (a, b), hinges in sorted(sides.items(), key=lambda pair: row_of[pair[0][1], "stroke"])
    ]


def _search(
    pair: Neighbours, postures: Sequence[KeyPosture], setup: Setup, budget: Budget, memory: PlaneMemory
) -> float:
    """Compute the planned minus the requested interval [s] of two strokes.

    Only the arms of both gestures are planned, between the nearest exact keys before and after.
    """
    keyed = np.array([any(posture.keyed[hinge] for hinge in pair.hinges) for posture in postures])
    begin, end = _around(pair, postures, keyed)
    rows = sorted({row for row in range(begin, end + 1) if keyed[row]} | {*pair.strokes})  # some strokes move no hand
    hinges = np.array(pair.hinges, dtype=np.intp)
    part = tuple(_part(postures[row], hinges, whole=row in (rows[0], rows[-1])) for row in rows)
    cache_key = memory.part(pair.hinges)
    times = condition(part, setup.limits.part(hinges), budget=budget, memory=cache_key).planned
    memory.learn(cache_key, pair.hinges, (rows[0] == 0, rows[-1] == len(postures) - 1))
    first, second = (rows.index(row) for row in pair.strokes)
    requested = [posture.time for posture in part]
    return float(times[second] - times[first] - (requested[second] - requested[first]))


def _around(pair: Neighbours, postures: Sequence[KeyPosture], keyed: Flags) -> Pair:
    """Return indices of the nearest exact keys before and after two gestures."""
    gesture_rows = [
        row
        for row, posture in enumerate(postures)
        if any(behaviour in pair.behaviours for behaviour, _ in posture.syncs)
    ]
    exact_rows = np.flatnonzero(keyed & np.array([posture.is_exact for posture in postures]))
    before, after = exact_rows[exact_rows <= min(gesture_rows)], exact_rows[exact_rows >= max(gesture_rows)]
    return int(before[-1] if before.size else exact_rows[0]), int(after[0] if after.size else exact_rows[-1])


def _part(posture: KeyPosture, hinges: Indices, *, whole: bool) -> KeyPosture:
    """Return a key posture reduced to some hinges.

    With `whole`, all of them have a key.
    """
    keyed = tuple(whole or posture.keyed[hinge] for hinge in hinges)
    passages = tuple(posture.passages[hinge] for hinge in hinges) if posture.passages else ()
    return KeyPosture(posture.time, sealed(posture.angles[hinges]), keyed, posture.syncs, passages, posture.is_exact)
