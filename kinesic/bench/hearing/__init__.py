"""Benchmark of barge-in while the robot speaks, on seeded sound mixtures."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bench.hearing.mixtures import Mixture, make_mixtures
from kinesic.bench.hearing.stopping import measure_arm_stops
from kinesic.bench.metric import Metric
from kinesic.hearing.barge_in import BargeInDecision
from kinesic.hearing.ear import FRAME_DURATION, Ear
from kinesic.hearing.voice_activity import VOICE_RATE
from kinesic.serve.loop import TICK_PERIOD
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.loudspeaker import BUFFER_DURATION
from kinesic.speech.speaker import FADE_DURATION

TEST_SEEDS = (2, 3)  # seeds of the measured mixtures; thresholds were chosen on seeds 1 and 4
ROUNDS_PER_SEED = 15  # number of rounds of seven mixtures
OUTPUT_DELAY = TICK_PERIOD + BUFFER_DURATION + FADE_DURATION  # [s] delay from the decision to be quiet to silence
PLANNING_DELAY = 0.09  # [s] delay from the decision to yield to the first changed command
FALSE_KINDS = ("short", "cough", "knock", "music", "none")  # kinds of mixtures in which nobody takes the turn


@dataclass(frozen=True)
class HearingOutcome:
    """Barge-in decisions for a mixture, with their delays."""

    kind: str
    begin: float  # [s] start of the event
    duck: float | None  # [s] delay of the first mute after the event's start; None: no mute
    turn: float | None  # [s] delay of the decision to yield; None: no decision; negative: before the event
    early_ducks: int  # number of mutes before the event
    cpu: float  # [s] CPU time per second of sound


def judge(mixture: Mixture) -> HearingOutcome:
    """Return the barge-in decisions for a mixture."""
    ear, start = Ear(), time.process_time()
    changes = list(ear.hear(mixture.heard, mixture.played))
    cpu = (time.process_time() - start) / (len(mixture.heard) / VOICE_RATE)
    ducks, turns = (
        [change.time - mixture.begin for change in changes if change.decision is decision]
        for decision in (BargeInDecision.DUCK, BargeInDecision.YIELD)
    )
    duck = next((delay for delay in ducks if delay >= 0.0), None)
    return HearingOutcome(
        mixture.kind, mixture.begin, duck, next(iter(turns), None), sum(delay < 0.0 for delay in ducks), cpu
    )


def bench() -> list[Metric]:
    """Measure missed and false turns, delays and CPU time."""
    if fault := espeak_fault():
        totals = ("missed", "false", "sound_off_p95", "arms_still_p95", "own_ducks", "ducked", "cpu")
        names = (*totals, *(f"false_{kind}" for kind in FALSE_KINDS))
        return [Metric(f"hearing.{name}", None, "", None, "lower", why=fault) for name in names]
    outcomes = [judge(mixture) for seed in TEST_SEEDS for mixture in make_mixtures(seed, ROUNDS_PER_SEED)]
    return barge_in_metrics(outcomes, measure_arm_stops())


def barge_in_metrics(outcomes: Sequence[HearingOutcome], stops: Sequence[float]) -> list[Metric]:
    """Return the metrics of all outcomes.

    Args:
        outcomes: of all mixtures.
        stops: times [s] in which the arms of interrupted gestures come to a stop.
    """
    turns = [outcome for outcome in outcomes if outcome.kind == "turn"]
    others = [outcome for outcome in outcomes if outcome.kind != "turn"]
    taken = [outcome for outcome in turns if outcome.turn is not None and outcome.turn >= -FRAME_DURATION]
    off = [outcome.duck + OUTPUT_DELAY for outcome in taken if outcome.duck is not None]
    still = [outcome.turn + PLANNING_DELAY + stop for outcome in taken if outcome.turn is not None for stop in stops]
    early = sum(outcome.turn is not None and outcome.turn < -FRAME_DURATION for outcome in turns)
    is_false = [outcome.turn is not None for outcome in others] + [True] * early
    early_ducks = 60.0 * sum(outcome.early_ducks for outcome in outcomes) / sum(outcome.begin for outcome in outcomes)
    short = [outcome for outcome in outcomes if outcome.kind == "short"]
    return [
        Metric("hearing.missed", _percent(len(turns) - len(taken), len(turns)), "%", 5.0, "lower"),
        Metric("hearing.false", _percent(sum(is_false), len(others)), "%", 5.0, "lower"),
        *(
            Metric(f"hearing.false_{kind}", _percent(sum(flags), len(flags)), "%", None, "lower")
            for kind in FALSE_KINDS
            for flags in [[outcome.turn is not None for outcome in others if outcome.kind == kind]]
        ),
        Metric("hearing.sound_off_p95", 1000 * float(np.percentile(off, 95)), "ms", 350.0, "lower"),
        Metric("hearing.arms_still_p95", float(np.percentile(still, 95)), "s", 1.0, "lower"),
        Metric("hearing.own_ducks", early_ducks, "1/min", None, "lower"),
        Metric("hearing.ducked", _percent(sum(o.duck is not None for o in short), len(short)), "%", None, "lower"),
        Metric("hearing.cpu", 1000 * float(np.mean([o.cpu for o in outcomes])), "ms/s", 20.0, "lower"),
    ]


def _percent(count: int, total: int) -> float:
    return 100.0 * count / max(total, 1)
