"""Finds gestures so near to one another that their strokes would move far apart, and with them all that is about.

What a hand needs from one stroke to the next depends on its joint angles, so that it shows only after these are known.
An estimate says which neighbours may lack time: every hinge rests where it turns round. For these alone key times are
searched exactly, for the hinges of the hand alone, so that a quick plan and a better one come to the same verdict.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kinesic.bml.block import Gesture, Pointing
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.engaged import Clash
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.budget import Budget
from kinesic.motion.condition import condition
from kinesic.motion.double_s import Gaps, full_speed, least_rest_times_of
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times
from kinesic.motion.keys import HOLD, Choices, KeyPosture, Keys, Pair
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.planning.setup import Setup

VISIBLE_CLASH = 0.2  # [s] by which strokes may move apart; more is seen beside a word
SEARCHES = 12  # of a block; what comes after is judged by the estimate
MANY = 4 * SEARCHES  # neighbours that may lack time: more are a crowd, which the estimate alone judges
WORK = 100_000  # pieces of splines that all searches may measure
NEGLIGIBLE_CLASH = 0.02  # [s] of which nobody needs to give way


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Two gestures that follow one another on a hand."""

    behaviours: tuple[str, str]
    strokes: Pair  # their keys
    hinges: tuple[int, ...]  # of the hands that do both
    brief: bool = False  # whether each stroke is one key alone

    @property
    def known_as(self) -> tuple[tuple[str, str], tuple[int, ...], bool]:
        """What a search for their times is remembered by."""
        return self.behaviours, self.hinges, self.brief

    def moved_apart(self, keys: Keys, times: Floats) -> float:
        """By how much the strokes are farther apart than asked [s], at times (m,) [s] of the keys."""
        first, second = self.strokes
        return float((times - keys.asked)[second] - (times - keys.asked)[first])


class ClashFinder:
    """Finds neighbours whose strokes would have to move, with those before and after, by more than `VISIBLE_CLASH`."""

    def __init__(self, setup: Setup) -> None:
        """Nothing is found yet.

        Args:
            setup: robot and limits.
        """
        self.clashes: dict[frozenset[str], Clash] = {}
        self.memory = PlaneMemory()  # of what searches for the times of neighbours have found
        self.crowded = False  # whether the last look found so many that nothing can be searched exactly
        self._setup, self._budget = setup, Budget(WORK)
        self._exactly: dict[tuple[tuple[str, str], tuple[int, ...], bool], float] = {}  # [s], which takes long

    @property
    def spent(self) -> bool:
        """Whether more was searched than there is a budget for: from now on the estimate alone decides."""
        return self._budget.spent

    def look(self, frames: KeyFrames, postures: Sequence[KeyPosture]) -> frozenset[str]:
        """Adds clashes to those that were found before, and names their behaviours; none: there are no more.

        Of a row of gestures only the worst neighbours count, and those that are farther off: when one of two has given
        way, the others may have time. In a crowd, on which the budget is spent, every second one of a row gives way at
        once: a round of its own for each of the worst would take too long. Strokes that became brief are new.

        Args:
            frames: of a block.
            postures: that solve them.
        """
        every = _neighbours(frames, postures, self._setup)
        coming = [each for each in every if not self._is_known(each)]
        guesses = self._suspects(coming, postures)
        self.crowded = len(guesses) > MANY
        if self.crowded:
            self._budget.spend(2 * WORK)
        suspects = [each for each, _ in guesses]
        apart = [self._search(each, guess, postures) for each, guess in guesses]
        added, near = set[str](), set[str]()
        for each, here, whole in sorted(
            zip(suspects, apart, chain_sums(suspects, apart), strict=True), key=_worst_first
        ):
            if here > NEGLIGIBLE_CLASH and whole > VISIBLE_CLASH and near.isdisjoint(each.behaviours):
                self.clashes[frozenset(each.behaviours)] = Clash(here, each.brief)
                near |= {*each.behaviours} if self.spent else _beside(each, every)
                added |= {*each.behaviours}
        return frozenset(added)

    def _is_known(self, pair: Neighbours) -> bool:
        clash = self.clashes.get(frozenset(pair.behaviours))
        return clash is not None and (clash.brief or not pair.brief)

    def _suspects(self, coming: Sequence[Neighbours], postures: Sequence[KeyPosture]) -> list[tuple[Neighbours, float]]:
        """Neighbours that may lack so much time, and how much [s], in the order of their strokes.

        There are none where all gaps together lack less: keys move away from where they are asked only as far as gaps
        that lack time push them, so that no two move apart by more than the sum.
        """
        if not coming:
            return []
        keys = Keys.of(postures, self._setup.limits)
        problem = KeyTimeProblem(keys, _gaps(keys), lead_in=0.0)
        if problem.lacking < VISIBLE_CLASH - NEGLIGIBLE_CLASH:
            return []
        times = relax_key_times(problem)
        apart = [each.moved_apart(keys, times) for each in coming]
        sums = chain_sums(coming, apart)
        rows = zip(coming, apart, sums, strict=True)
        return [(each, here) for each, here, whole in rows if here > NEGLIGIBLE_CLASH and whole > VISIBLE_CLASH]

    def _search(self, pair: Neighbours, guess: float, postures: Sequence[KeyPosture]) -> float:
        known, budget = pair.known_as, self._budget
        if known not in self._exactly:
            exactly = len(self._exactly) < SEARCHES and not budget.spent
            found = _search(pair, postures, self._setup, budget, self.memory) if exactly else guess
            self._exactly[known] = guess if budget.spent else found
        return self._exactly[known]


def chain_sums(pairs: Sequence[Neighbours], apart: Sequence[float]) -> list[float]:
    """Adds up what strokes move apart along each chain of neighbours, from the first that has no time to the last [s].

    Args:
        pairs: in the order of their strokes.
        apart: [s] for each; what is less than `NEGLIGIBLE_CLASH` ends a chain.
    """
    before, after = defaultdict[str, float](float), defaultdict[str, float](float)
    lacking = [(*pair.behaviours, here) for pair, here in zip(pairs, apart, strict=True) if here > NEGLIGIBLE_CLASH]
    for first, second, here in lacking:
        before[second] = max(before[second], before[first] + here)
    for first, second, here in reversed(lacking):
        after[first] = max(after[first], after[second] + here)
    return [
        before[pair.behaviours[0]] + here + after[pair.behaviours[1]] for pair, here in zip(pairs, apart, strict=True)
    ]


def _beside(pair: Neighbours, every: Sequence[Neighbours]) -> set[str]:
    """Two neighbours, and those of either."""
    return {id for other in every if {*other.behaviours} & {*pair.behaviours} for id in other.behaviours}


def _worst_first(row: tuple[Neighbours, float, float]) -> float:
    return -row[1]


def least_times_between_turns(keys: Keys) -> Gaps:
    """Computes the time [s] in which each hinge can rest at both ends of each way that it goes in one direction.

    That is mostly more than it needs, as it may turn round while it brakes.
    """
    ways = [
        (hinge, pair) for hinge, own in enumerate(keys.own) for pair in _ways(keys.angles[own, hinge].tolist(), own)
    ]
    hinges, begins, ends = np.array([(hinge, i, j) for hinge, (i, j) in ways], dtype=np.intp).reshape(-1, 3).T
    turns = keys.angles[ends, hinges] - keys.angles[begins, hinges]
    return dict(zip(ways, least_rest_times_of(hinges, turns, keys.limits).tolist(), strict=True))


def _gaps(keys: Keys) -> dict[Pair, float]:
    """Least times between keys [s]: rests where hinges turn round, full speed in between."""
    gaps = dict(keys.gaps)
    for found in (full_speed(keys, keys.limits), least_times_between_turns(keys)):
        for (_, pair), least in found.items():
            gaps[pair] = max(gaps.get(pair, 0.0), least)
    return gaps


def _ways(angles: Sequence[float], rows: Sequence[int]) -> list[Pair]:
    """The keys between which a hinge goes on in one direction, or is held, from its angles [rad] at some rows."""
    steps = [after - before for before, after in pairwise(angles)]
    ways = [0 if abs(step) < HOLD else 1 if step > 0.0 else -1 for step in steps]
    turned = (k for k, (before, after) in enumerate(pairwise(ways), 1) if before != after)
    return [(rows[i], rows[j]) for i, j in pairwise([0, *turned, len(steps)]) if i < j]


def _neighbours(frames: KeyFrames, postures: Sequence[KeyPosture], setup: Setup) -> list[Neighbours]:
    """Gestures of each hand, two by two in the order of their strokes."""
    row_of = {sync: row for row, posture in enumerate(postures) for sync in posture.syncs}
    gestures = [one.behaviour for one in frames.timeline.timed if isinstance(one.behaviour.action, Gesture | Pointing)]
    moving = [gesture.id for gesture in gestures if (gesture.id, "stroke") in row_of]
    sides: dict[tuple[str, str], list[int]] = {}
    for side in SIDES:
        own = [id for id in moving if f"{side}_hand" in frames.uses[id]]
        for pair in pairwise(sorted(own, key=lambda id: row_of[id, "stroke"])):
            sides.setdefault(pair, []).extend(setup.robot.arm(side).joints)
    brief = {
        id for id in moving if len({row_of.get((id, sync)) for sync in ("strokeStart", "stroke", "strokeEnd")}) == 1
    }
    return [
        Neighbours((a, b), (row_of[a, "stroke"], row_of[b, "stroke"]), tuple(hinges), {a, b} <= brief)
        for (a, b), hinges in sorted(sides.items(), key=lambda pair: row_of[pair[0][1], "stroke"])
    ]


def _search(
    pair: Neighbours, postures: Sequence[KeyPosture], setup: Setup, budget: Budget, memory: PlaneMemory
) -> float:
    """Measures how far two strokes move apart [s] when only their hands move, from rest before to rest after."""
    keyed = np.array([any(posture.keyed[hinge] for hinge in pair.hinges) for posture in postures])
    begin, end = _around(pair, postures, keyed)
    rows = sorted({row for row in range(begin, end + 1) if keyed[row]} | {*pair.strokes})  # some strokes move no hand
    hinges = np.array(pair.hinges, dtype=np.intp)
    part = tuple(_part(postures[row], hinges, whole=row in (rows[0], rows[-1])) for row in rows)
    known = memory.part(pair.hinges)
    times = condition(part, setup.limits.part(hinges), budget=budget, memory=known).planned
    memory.learn(known, pair.hinges, (rows[0] == 0, rows[-1] == len(postures) - 1))
    first, second = (rows.index(row) for row in pair.strokes)
    asked = [posture.time for posture in part]
    return float(times[second] - times[first] - (asked[second] - asked[first]))


def _around(pair: Neighbours, postures: Sequence[KeyPosture], keyed: Flags) -> Pair:
    """The keys of a hand at which the first of two gestures begins and the second has ended, or the nearest without."""
    rows = [
        row
        for row, posture in enumerate(postures)
        if any(behaviour in pair.behaviours for behaviour, _ in posture.syncs)
    ]
    own = np.flatnonzero(keyed & np.array([posture.firm for posture in postures]))
    before, after = own[own <= min(rows)], own[own >= max(rows)]
    return int(before[-1] if before.size else own[0]), int(after[0] if after.size else own[-1])


def _part(posture: KeyPosture, hinges: Choices, *, whole: bool) -> KeyPosture:
    """Some hinges of a key, all of them keyed if it is to be whole."""
    keyed = tuple(whole or posture.keyed[hinge] for hinge in hinges)
    passages = tuple(posture.passages[hinge] for hinge in hinges) if posture.passages else ()
    return KeyPosture(posture.time, sealed(posture.angles[hinges]), keyed, posture.syncs, passages, posture.firm)
