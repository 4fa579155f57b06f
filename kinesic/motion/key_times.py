"""Finds key times at which every hinge can pass its keys, as near to the asked ones as possible.

A linear program moves key times as little as needed, strokes least of all. The least time of a hinge from one key to
the next is that of its full speed; the time with a rest at both is always enough. Times that are too short for some
hinge are cut off by a plane, its shortage linearised, and the program is solved again (Kelley, The cutting-plane
method, 1960). What a hinge lacks is nearly convex in the logarithm of its time, so that mostly a few planes suffice.
Where they do not, and at once where a stroke is repeated, times are stretched along the motions (`stretching`); where
even that leads to no end, the hinge rests at each of its keys, which is always possible.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise, takewhile

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.double_s import Gaps, Way, full_speed, rest_to_rest
from kinesic.motion.infeasibility import (
    MARGIN,
    Bottleneck,
    Infeasibility,
    guess_share,
    measure_shortage,
    planes_before,
    short_ways,
)
from kinesic.motion.key_time_lp import CuttingPlane, KeyTimeProblem, relax_key_times, strain
from kinesic.motion.keys import SAME, Keys, Pair
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import SplineSegment, tight_segments
from kinesic.motion.stretching import stretch_until_enough
from kinesic.motion.trajectory import STEP

PLANES = 40  # of a way before its times are stretched
LOOKS = 150_000  # pieces of segments that are measured before what is short rests; a count, the same on every host
KEYS = 400  # in whose linear program there is the work of as many pieces; it grows with their square
REPEATS = 2  # strokes once more, from which on times are stretched before any plane is tried
STRETCHES = 6  # of a way before its hinge rests
LONGER = 1.1  # on rests that do not suffice after all
LONGEST = 100.0  # times as long as a rest should suffice, before nothing does
ENOUGH = -MARGIN / 4  # amount at which a segment does not lack time
ROUGH = 1.3  # share of a limit on a smooth way that makes a segment suspect
ABOUT = 2.0  # [s] about what is short that are stretched with it
NEAR = 0.02  # share of the time within which a segment is looked at again


class Search:
    """A search for feasible key times, which goes on with each segment that turns out to be infeasible."""

    def __init__(
        self, keys: Keys, limits: Limits, lead_in: float, budget: Budget = ENDLESS, memory: PlaneMemory | None = None
    ) -> None:
        """Begins with the asked times, or the nearest with which full speeds would do.

        Args:
            keys: what was asked.
            limits: of all hinges.
            lead_in: [s] by which the first key may come earlier.
            budget: for the pieces that are measured; where it is spent, what is short rests.
            memory: of planes that other searches have found for the same hinges.
        """
        self._keys, self._limits, self._lead_in, self._budget = keys, limits, lead_in, budget
        self.met: dict[Pair, Bottleneck] = {}  # what was too fast as asked, between which keys
        self._gaps = dict(keys.gaps)
        self._cuts: dict[int, list[CuttingPlane]] = {}  # of each hinge
        self._tries: Counter[Way] = Counter()  # to give each more time
        self._spans: dict[Way, float] = {}  # [s] in which ways have a motion, found by stretching
        self._looked = 0  # pieces of all segments that were measured
        self._stiff: set[Way] = set()  # for which stretching found nothing
        self._rests: dict[Way, float] = {}  # by which rests at both ends are longer
        self._tight: dict[tuple[int, bytes, float], tuple[SplineSegment, ...]] = {}  # by hinge and its times
        self._shortages: dict[tuple[object, ...], Infeasibility | None] = {}  # that were looked at
        self._spare: dict[tuple[object, ...], Infeasibility] = {}  # likewise, of which a bound was enough
        self._lengthen_to_full_speed()
        spaced = all(keys.asked[j] - keys.asked[i] >= gap - SAME for (i, j), gap in self._gaps.items())
        self.times = keys.asked if spaced else relax_key_times(self._problem(self._gaps))
        self._memory = memory or PlaneMemory()
        self._recall()

    def avoid(self, lost: SplineSegment) -> None:
        """Moves the times until every segment that is known to lack time has a motion again.

        Raises:
            ArithmeticError: a hinge cannot even move from rest to rest.
        """
        if self._budget.spent:
            self._rest_wherever_short(lost)
            return
        fresh = [*self._segments(self.times)]
        parts = [segment for segment in fresh if segment.within(lost)]
        pending = [segment for segment in fresh if not self._tries and self._suspect(segment) and segment not in parts]
        lacking = [*(self._lacking(parts) or [(lost, self._shortage(lost))]), *self._lacking(pending)]
        while lacking:
            for segment, found in lacking:
                self._lengthen(segment, found)
                self._note(segment, found)
            short = {way for segment, found in lacking for way in short_ways(segment, found)}
            stretched = short & self._spans.keys()
            if not stretched:
                self._relax(short)
            elif not self._stretch(stretched):
                continue
            about = {way for segment, _ in lacking for way in segment.ways}
            near = [*self._near()]
            tight = [segment for segment in near if not about.isdisjoint(segment.ways)]
            lacking = self._lacking(tight) or self._lacking(near)

    def remember(self) -> None:
        """Leaves the planes of this search to the next."""
        self._memory.keep(self._keys, self._limits, self._cuts, self.met, self.times)

    def _recall(self) -> None:
        """Begins with the planes that are known already, unless rests would do better."""
        cuts, met = self._memory.recall(self._keys, self._limits)
        planes = [cut for own in cuts.values() for cut in own]
        if not any(cut.slopes @ self.times > cut.bound for cut in planes):
            return
        try:
            times = relax_key_times(self._problem(self._gaps, planes))
        except ArithmeticError:  # planes of other keys that leave no times between these
            return
        if strain(self._keys, times) <= self._enough:
            self.times, self._cuts = times, cuts
            for pair, found in met.items():
                self._meet(pair, found)

    def _rest_wherever_short(self, lost: SplineSegment) -> None:
        """Lets hinges rest in a segment that lacks time, and at once wherever else a smooth way exceeds a limit."""
        fast = [segment for segment in self._segments(self.times) if guess_share(segment, self._limits) > 1.0]
        short = set(lost.ways) | {way for segment in fast for way in segment.ways} - self._rests.keys()
        self._rest(short)
        self._relax(short)

    def _lacking(self, pending: list[SplineSegment]) -> list[tuple[SplineSegment, Infeasibility | None]]:
        """Those that lack time, as far as the budget allows to measure them: others turn up as they have no motion."""
        within = takewhile(lambda segment: not self._budget.spent, pending)
        found = [(segment, self._shortage(segment, ENOUGH)) for segment in within]
        return [(segment, lack) for segment, lack in found if lack is None or lack.amount > ENOUGH]

    def _lengthen(self, segment: SplineSegment, found: Infeasibility | None) -> None:
        """Sees to it that a segment gets more time: by a plane, by a stretch, in the end by rests."""
        ways = set(short_ways(segment, found))
        self._tries.update(ways)
        tries = max((self._tries[way] for way in ways), default=0)
        spent = self._budget.spent or self._looked > LOOKS or tries > PLANES + STRETCHES
        if spent:
            self._rest(set(segment.ways))
        elif found is None or ways & self._rests.keys():
            self._rest(ways)
        elif ways & self._spans.keys() or tries > PLANES or (self._in_rhythm(segment, ways) and not ways & self._stiff):
            self._drop_cuts(ways)
            self._spans |= dict.fromkeys(ways, 0.0)
        else:
            self._cuts.setdefault(segment.hinge, []).extend(planes_before(segment, found, self.times))

    def _shortage(self, segment: SplineSegment, enough: float | None = None) -> Infeasibility | None:
        """Remembered by keys and places, which determine it: many a segment stays the same when others move."""
        known = (segment.hinge, segment.marks, segment.grid.pieces, segment.places.tobytes())
        if known in self._shortages:
            return self._shortages[known]
        if enough is not None and known in self._spare:
            return self._spare[known]
        found = measure_shortage(segment, self._limits, enough=enough)
        work = segment.grid.pieces * (1 if found is None else found.programs)
        self._budget.spend(work)
        self._looked += work
        if found is None or enough is None or found.amount > enough:
            self._shortages[known] = found
        else:
            self._spare[known] = found
        return found

    def _segments(self, times: Floats, hinges: Iterable[int] | None = None) -> Iterator[SplineSegment]:
        """Those of a motion that may lack time, each as short as can be; of all hinges, if none are given."""
        every = range(len(self._keys.own)) if hinges is None else hinges
        for hinge in every:
            known = (hinge, (times[self._keys.own[hinge]] - times[0]).tobytes(), float(times[-1] - times[0]))
            if known not in self._tight:
                own = tight_segments(times, self._keys, STEP, self._rests_of_hinges, [hinge])
                self._tight[known] = tuple(own)
            yield from self._tight[known]

    def _suspect(self, segment: SplineSegment) -> bool:
        return guess_share(segment, self._limits) > ROUGH

    def _near(self) -> Iterator[SplineSegment]:
        """Segments that may lack time now: those about a plane which the times hardly keep, and those with spans."""
        for hinge in sorted({*self._cuts, *(hinge for hinge, _ in self._spans)}):
            cuts = (cut for cut in self._cuts.get(hinge, ()) if cut.slopes @ self.times > cut.bound - NEAR)
            tight = [cut.slopes != 0.0 for cut in cuts]
            ways = {way for way in self._spans if way[0] == hinge}
            if not tight and not ways:
                continue
            about = np.any(tight, axis=0) if tight else np.zeros(len(self.times), dtype=bool)
            for segment in self._segments(self.times, [hinge]):
                if any(about[key] for mark in segment.marks for key in mark) or not ways.isdisjoint(segment.ways):
                    yield segment

    def _in_rhythm(self, segment: SplineSegment, ways: set[Way]) -> bool:
        """Whether a hinge goes back and forth there over a repeated stroke; planes would hardly find its times."""
        again = sum(bool(self._keys.again[key]) for key in {key for _, pair in ways for key in pair})
        return again >= REPEATS and segment.turns >= 2 * again

    def _note(self, segment: SplineSegment, found: Infeasibility | None) -> None:
        """Notes the limits that are met in a segment."""
        if found is None:
            return
        for pair, quantity in zip(segment.pairs, found.binding, strict=True):
            if quantity is not None and pair[0] != pair[1]:
                self._meet(pair, Bottleneck(segment.hinge, quantity, float(np.exp(found.amount))))

    def _meet(self, pair: Pair, found: Bottleneck) -> None:
        if pair not in self.met or found.ratio > self.met[pair].ratio:
            self.met[pair] = found

    def _stretch(self, short: set[Way]) -> bool:
        """Stretches times about some ways until they suffice, else hinges rest; False: planes are to be tried first."""
        here = [self.times[key] for _, pair in short for key in pair]
        begin, end = min(here) - ABOUT, max(here) + ABOUT
        open_ways = {way for way in self._spans if begin <= self.times[way[1][0]] <= end}

        def measure(times: Floats) -> list[tuple[SplineSegment, Infeasibility | None]]:
            every = self._segments(times, sorted({hinge for hinge, _ in open_ways}))
            tight = [segment for segment in every if not open_ways.isdisjoint(segment.ways)]
            return [(segment, self._shortage(segment)) for segment in tight]

        for segment, lack in measure(self.times):
            self._note(segment, lack)
        kept = self._lengthened({way: span for way, span in self._spans.items() if way not in open_ways})
        problem = self._problem(kept, self._all_cuts)
        times = stretch_until_enough(problem, self.times, self._limits, measure, self._budget)
        if times is None and max(self._tries[way] for way in short) <= PLANES:
            self._stiff |= open_ways
            self._spans = {way: span for way, span in self._spans.items() if way not in open_ways}
            return False
        if times is None:
            self._rest(short)
            self._relax(short)
            return True
        self.times = times
        self._spans |= {(hinge, (i, j)): float(times[j] - times[i]) for hinge, (i, j) in open_ways}
        return True

    def _problem(self, gaps: Mapping[Pair, float], cuts: Sequence[CuttingPlane] = ()) -> KeyTimeProblem:
        return KeyTimeProblem(self._keys, gaps, self._lead_in, cuts)

    @property
    def _all_cuts(self) -> list[CuttingPlane]:
        return [cut for own in self._cuts.values() for cut in own]

    def _lengthened(self, spans: Gaps) -> dict[Pair, float]:
        """All gaps, with those that were found by stretching."""
        gaps = dict(self._gaps)
        for (_, pair), span in spans.items():
            gaps[pair] = max(gaps[pair], span)
        return gaps

    def _drop_cuts(self, ways: Iterable[Way]) -> None:
        """Forgets the planes between the keys of some ways."""
        for hinge, pair in ways:
            self._cuts[hinge] = [cut for cut in self._cuts.get(hinge, ()) if not cut.slopes[list(pair)].any()]

    def _rest(self, ways: Iterable[Way]) -> None:
        """Lets hinges rest at both ends of some ways; for longer, where they already do."""
        for way in ways:
            hinge, pair = way
            self._rests[way] = longer = LONGER * self._rests[way] if way in self._rests else 1.0
            if longer > LONGEST:
                raise ArithmeticError(f"hinge {hinge} cannot move within its limits, however slowly")
            self._spans.pop(way, None)
            self._gaps[pair] = max(self._gaps[pair], longer * self._all_rests[way])
        self._drop_cuts(ways)

    def _relax(self, short: set[Way]) -> None:
        """Solves the linear program; where planes leave no times, or worse ones than rests, hinges rest instead."""
        every = {way for way in self._all_rests if self._cuts.get(way[0])}
        for resting in (set[Way](), short, every):
            self._rest(resting - self._rests.keys())
            self._budget.spend(len(self.times) ** 2 / KEYS)
            gaps, cuts = self._lengthened(self._spans), self._all_cuts
            try:
                self.times = relax_key_times(self._problem(gaps, cuts))
            except ArithmeticError:
                continue
            if not cuts or strain(self._keys, self.times) <= self._enough:
                break

    @cached_property
    def _enough(self) -> float:
        """Strain when all hinges rest at all keys."""
        gaps = dict(self._keys.gaps)
        for (_, pair), rest in self._all_rests.items():
            gaps[pair] = max(gaps[pair], LONGER * rest)
        return strain(self._keys, relax_key_times(self._problem(gaps)))

    @cached_property
    def _all_rests(self) -> Gaps:
        return rest_to_rest(self._keys, self._limits)

    @cached_property
    def _rests_of_hinges(self) -> list[Floats]:
        """(g,) [s] of each hinge, from rest to rest at its keys."""
        ways = [[(hinge, pair) for pair in pairwise(own)] for hinge, own in enumerate(self._keys.own)]
        return [np.array([self._all_rests[way] for way in own]) for own in ways]

    def _lengthen_to_full_speed(self) -> None:
        keys, limits, times = self._keys, self._limits, self._keys.asked.tolist()
        for (hinge, pair), gap in full_speed(keys, limits).items():
            self._gaps[pair] = max(self._gaps[pair], gap)
            asked = times[pair[1]] - times[pair[0]]
            if gap > max(asked, keys.gaps[pair]) + SAME:
                rated = limits.speed[hinge] <= limits.duty[hinge] / limits.viscous[hinge]
                self._meet(pair, Bottleneck(hinge, "speed" if rated else "duty", gap / max(asked, keys.gaps[pair])))
