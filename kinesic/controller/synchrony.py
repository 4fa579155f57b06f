"""Finds how well the force of strokes meets the words that a document ties them to, by one rule for plan and twin.

Where people talk, the hand is fastest about when the accented syllable sounds (Pouw and Dixon 2019).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bml.timing.words import find_words
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES
from kinesic.controller.play import command_times
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime


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
    words = find_words(plan.timeline)
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
            word = words[sync.behaviour, sync.sync]
            found.append(StrokeLag(sync.behaviour, sync.sync, word.name, word.time, sync.planned, at))
    return tuple(found)


def median_lag(lags: Sequence[StrokeLag]) -> float | None:
    """Finds the median of how far the fastest moments are from their words, either way [s]; None without strokes."""
    return float(np.median([abs(each.lag) for each in lags])) if lags else None


def _window(stroke: SyncTime, times: Mapping[str, float]) -> tuple[float, float]:
    """From `ready` to `strokeEnd` [s], but half-way to the strokes before and after, if it is repeated."""
    others = [time for name, time in times.items() if name.startswith("stroke:") or name == "stroke"]
    halves = [(stroke.planned + time) / 2 for time in others]
    before, after = ([half for half in halves if sign * (half - stroke.planned) > 0.0] for sign in (-1, 1))
    return (
        max([times.get("ready", stroke.planned), *before]),
        min([times.get("strokeEnd", stroke.planned), *after]),
    )
