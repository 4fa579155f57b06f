"""Finds how well the force of strokes meets the words that a document ties them to, by one rule for plan and twin.

Where people talk, the hand is fastest about when the accented syllable sounds (Pouw and Dixon 2019).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from kinesic.bml.block import Speech
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES
from kinesic.controller.play import command_times
from kinesic.motion.keys import Sync
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime, find_bonds

SILENT = "end"  # the one sync point of a speech at which no word begins


@dataclass(frozen=True)
class StrokeLag:
    """One stroke of the hands that a document ties to a word, and when the wrist is fastest; block time."""

    behaviour: str
    sync: str  # the stroke: `stroke`, or `stroke:2` where it is repeated
    word: str  # sync point of the speech: `s:mark`
    accent: float  # [s] when the word sounds, with the offset that the document adds
    stroke: float  # [s] planned
    fastest: float  # [s] when the wrist is fastest, of all times that are nearer to this stroke than to others

    @property
    def lag(self) -> float:
        """By how much the wrist is fastest later than the word [s]; negative where the hand leads."""
        return self.fastest - self.accent


def planned_lags(plan: Plan) -> tuple[StrokeLag, ...]:
    """Measures the planned motion; see `measure_lags`."""
    times = command_times(plan.duration)
    origins = plan.setup.robot.skeleton.frames(plan.trajectory.sample(times)[0]).origins
    return measure_lags(plan, times, {side: origins[:, plan.setup.robot.arm(side).wrist] for side in SIDES})


def measure_lags(plan: Plan, times: Floats, hands: Mapping[str, Floats]) -> tuple[StrokeLag, ...]:
    """Measures each stroke of the hands that is tied to a word, in planned order.

    Of two hands the faster one counts, between `ready` and `strokeEnd`. What was stopped before is left out.

    Args:
        plan: of what was performed.
        times: (m,) [s] performance time of the samples.
        hands: "l", "r" -> (m, 3) [m] the wrist's centre in the world.
    """
    speeds = {side: np.linalg.norm(np.gradient(path, times, axis=0), axis=1) for side, path in hands.items()}
    words = _words(plan)
    planned: dict[str, dict[str, float]] = {}
    for sync in plan.syncs:
        planned.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    found = []
    for sync in plan.syncs:
        sides = [side for side in SIDES if f"{side}_hand" in plan.keyframes.uses.get(sync.behaviour, ())]
        if sync.is_stroke and sides and (sync.behaviour, sync.sync) in words:
            begin, end = np.searchsorted(times - plan.trajectory.zero, _window(sync, planned[sync.behaviour]))
            if end == len(times):
                continue  # it was stopped before
            fastest = np.max([speeds[side][begin : end + 1] for side in sides], axis=0).argmax()
            at = float(times[begin + fastest]) - plan.trajectory.zero
            found.append(StrokeLag(sync.behaviour, sync.sync, *words[sync.behaviour, sync.sync], sync.planned, at))
    return tuple(found)


def median_lag(lags: Sequence[StrokeLag]) -> float | None:
    """Finds the median of how far the fastest moments are from their words, either way [s]; None without strokes."""
    return median(abs(each.lag) for each in lags) if lags else None


def _window(stroke: SyncTime, times: Mapping[str, float]) -> tuple[float, float]:
    """From `ready` to `strokeEnd` [s], but half-way to the strokes before and after, if it is repeated."""
    others = [time for name, time in times.items() if name.startswith("stroke:") or name == "stroke"]
    halves = [(stroke.planned + time) / 2 for time in others]
    before, after = ([half for half in halves if sign * (half - stroke.planned) > 0.0] for sign in (-1, 1))
    return (
        max([times.get("ready", stroke.planned), *before]),
        min([times.get("strokeEnd", stroke.planned), *after]),
    )


def _words(plan: Plan) -> Mapping[Sync, tuple[str, float]]:
    """Sync points that coincide with a word's, with its name and time [s]."""
    bonds = {(bond.earlier, bond.later): bond.least for bond in find_bonds(plan.timeline)}
    beside: dict[Sync, list[tuple[Sync, float]]] = {}
    for (earlier, later), least in bonds.items():
        if (later, earlier) in bonds:
            beside.setdefault(earlier, []).append((later, least))
    return {
        sync: (":".join(word), time)
        for word, spoken in _spoken(plan)
        for sync, time in _coinciding(word, spoken, beside).items()
    }


def _spoken(plan: Plan) -> Iterator[tuple[Sync, float]]:
    """Sync points of speeches at which a word begins, with their times [s]."""
    for timed in plan.timeline.timed:
        if isinstance(timed.behaviour.action, Speech):
            for sync, time in timed.times.items():
                if sync != SILENT:
                    yield (timed.behaviour.id, sync), time


def _coinciding(word: Sync, time: float, beside: Mapping[Sync, Sequence[tuple[Sync, float]]]) -> dict[Sync, float]:
    """Times [s] of all sync points that a document ties to a word, if need be through others."""
    found, waiting = {word: time}, [word]
    while waiting:
        here = waiting.pop()
        for other, offset in beside.get(here, ()):
            if other not in found:
                found[other] = found[here] + offset
                waiting.append(other)
    return found
