"""Synchrony of gesture strokes with words, in plan and twin.

In human speech, the hand is fastest about when the accented syllable sounds (Pouw and Dixon 2019).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bml.timing.words import find_tied_words
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime


@dataclass(frozen=True)
class StrokeLag:
    """Times of a word, its gesture stroke and the highest wrist speed.

    All times are block times.
    """

    behaviour: str
    sync: str  # `stroke`, or `stroke:2` for a repetition
    word: str  # sync point of the speech, such as `s:mark`
    accent: float  # [s] time of the word plus the offset in the document
    stroke: float  # [s] planned time of the stroke
    fastest: float  # [s] time of the highest wrist speed within the span of this stroke

    @property
    def lag(self) -> float:
        """Delay [s] of the highest wrist speed after the word's accent."""
        return self.fastest - self.accent


def measure_planned_lags(plan: Plan) -> tuple[StrokeLag, ...]:
    """Measure the delays between words and strokes in the planned motion.

    See `measure_lags`.
    """
    times = plan.command_times
    origins = plan.setup.robot.skeleton.frames(plan.trajectory.sample(times)[0]).origins
    return measure_lags(plan, times, {side: origins[:, plan.setup.robot.arm(side).wrist] for side in SIDES})


def measure_lags(plan: Plan, times: Floats, hands: Mapping[str, Floats]) -> tuple[StrokeLag, ...]:
    """Measure each stroke's delay after its word, from given hand paths.

    The faster hand counts, between `ready` and `strokeEnd`. Strokes after a stop are left out. The order is the planned
    one.

    Args:
        plan: with the strokes and words.
        times: (m,) [s] performance time of the samples.
        hands: "l", "r" -> (m, 3) [m] the wrist's centre in the world.
    """
    speeds = {side: np.linalg.norm(np.gradient(path, times, axis=0), axis=1) for side, path in hands.items()}
    words = find_tied_words(plan.timeline)
    planned: dict[str, dict[str, float]] = {}
    for sync in plan.syncs:
        planned.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    lags = []
    for sync in plan.syncs:
        sides = [side for side in SIDES if f"{side}_hand" in plan.keyframes.uses.get(sync.behaviour, ())]
        if sync.is_stroke and sides and (sync.behaviour, sync.sync) in words:
            begin, end = np.searchsorted(
                times - plan.trajectory.zero, _find_stroke_window(sync, planned[sync.behaviour])
            )
            if end == len(times):
                continue  # the run stopped before the stroke
            fastest = np.max([speeds[side][begin : end + 1] for side in sides], axis=0).argmax()
            at = float(times[begin + fastest]) - plan.trajectory.zero
            word = words[sync.behaviour, sync.sync]
            lags.append(StrokeLag(sync.behaviour, sync.sync, word.name, word.time, sync.planned, at))
    return tuple(lags)


def compute_median_lag(lags: Sequence[StrokeLag]) -> float | None:
    """Compute the median absolute stroke delay [s], or None without strokes."""
    return float(np.median([abs(stroke.lag) for stroke in lags])) if lags else None


def _find_stroke_window(stroke: SyncTime, times: Mapping[str, float]) -> tuple[float, float]:
    """Return the planned time span of a stroke [s].

    It lasts from `ready` to `strokeEnd`; repeated strokes are separated half-way.
    """
    others = [time for name, time in times.items() if name.startswith("stroke:") or name == "stroke"]
    halves = [(stroke.planned + time) / 2 for time in others]
    before, after = ([half for half in halves if sign * (half - stroke.planned) > 0.0] for sign in (-1, 1))
    return (
        max([times.get("ready", stroke.planned), *before]),
        min([times.get("strokeEnd", stroke.planned), *after]),
    )
