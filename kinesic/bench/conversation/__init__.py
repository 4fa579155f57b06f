"""Benchmark of scripted dialogues in virtual time."""

from dataclasses import dataclass, field
from itertools import pairwise
from time import process_time

import numpy as np

from kinesic.bench.conversation.dialogues import Dialogue, write_dialogue
from kinesic.bench.conversation.record import DialogueRecord, perform_dialogue
from kinesic.bench.metric import Metric
from kinesic.motion.limit_check import check_limits
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up

DIALOGUE_COUNT = 60  # number of scripted dialogues
CHECKED_MOTION_INTERVAL = 8  # number of motions of which one is checked against all limits
INTERRUPTION_WINDOW = 1.2  # [s] time after the start of a voice in which an end of speech counts as a reaction


@dataclass(eq=False)
class _Results:
    """Measurements of all dialogues."""

    turn_ends: dict[bool, list[float]] = field(default_factory=lambda: {False: [], True: []})  # [s] delays by predictor
    false_ends: int = 0  # number of turn ends detected within a turn
    yields: list[float] = field(default_factory=list)  # [s] delays from a voice to the end of own speech
    missed: int = 0  # number of missed interruptions
    attempts: int = 0  # number of interruptions by a person
    false_yields: int = 0  # number of yields to agreement or coughs
    agreements: int = 0  # number of agreements and coughs
    looking: dict[str, list[float]] = field(default_factory=dict)  # fractions of time looking at a person
    longest_look: float = 0.0  # [s] longest look at a person
    limit_ratio: float = 0.0  # largest ratio of a velocity, acceleration, jerk or angle to its limit
    errors: list[float] = field(default_factory=list)  # [deg] azimuth errors of the head towards a standing person
    seconds: float = 0.0  # [s] virtual time of all dialogues
    nods: int = 0  # number of nods
    listening: float = 0.0  # [s] time of listening


def bench(count: int = DIALOGUE_COUNT, *, first: int = 0) -> list[Metric]:
    """Perform scripted dialogues and measure turns, gaze, interruptions and load.

    Args:
        count: number of dialogues.
        first: seed of the first dialogue; times of the conversational states were chosen on seeds from 1000 on.
    """
    setup, results = set_up(), _Results()
    perform_dialogue(write_dialogue(first + count), setup)  # fills caches
    began = process_time()
    performances = [
        (dialogue, perform_dialogue(dialogue, setup)) for dialogue in map(write_dialogue, range(first, first + count))
    ]
    load = process_time() - began
    for dialogue, performance in performances:
        _measure_turns(dialogue, performance, results)
        _measure_interruptions(dialogue, performance, results)
        _measure_gaze(dialogue, performance, results, setup)
    return _metrics(results, load)


def _metrics(results: _Results, load: float) -> list[Metric]:
    silent, predicted = results.turn_ends[False], results.turn_ends[True]
    turns = len(silent) + len(predicted)
    false = 100.0 * results.false_yields / results.agreements
    gaze = {name: 100.0 * float(np.mean(values)) for name, values in results.looking.items()}
    return [
        Metric("conversation.turn_end_median", round(float(np.median(silent)), 3), "s", 0.7, "lower"),
        Metric("conversation.turn_end_p95", float(np.percentile(silent, 95)), "s", 1.3, "lower"),
        Metric("conversation.predicted_turn_end_median", float(np.median(predicted)), "s", 0.4, "lower"),
        Metric("conversation.false_turn_ends", 100.0 * results.false_ends / turns, "%", 5.0, "lower"),
        Metric("conversation.yield_p95", float(np.percentile(results.yields, 95)), "s", None, "lower"),
        Metric("conversation.missed_interruptions", 100.0 * results.missed / results.attempts, "%", 5.0, "lower"),
        Metric("conversation.false_interruptions", false, "%", 5.0, "lower"),
        Metric("conversation.looks_while_listening", gaze["listening"], "%", None, "higher"),
        Metric("conversation.looks_while_speaking", gaze["speaking"], "%", None, "higher"),
        Metric("conversation.looks_first_second", gaze["first"], "%", 30.0, "lower"),
        Metric("conversation.looks_last_second", gaze["last"], "%", 90.0, "higher"),
        Metric("conversation.longest_look", results.longest_look, "s", 6.0, "lower"),
        Metric("conversation.nods_per_minute", 60.0 * results.nods / results.listening, "1/min", 10.0, "lower"),
        Metric("conversation.limit_ratio", results.limit_ratio, "", 1.001, "lower"),
        Metric("conversation.standing_error_p95", float(np.percentile(results.errors, 95)), "deg", 3.0, "lower"),
        Metric("conversation.load", 100.0 * load / results.seconds, "%", 3.0, "lower"),
    ]


def _measure_turns(dialogue: Dialogue, performance: DialogueRecord, results: _Results) -> None:
    """Measure delays of detected turn ends, and count ends within a turn."""
    ends = [time for time, mode in performance.modes if mode == "thinking"]
    for (turn_begin, turn_end), (begin, _) in zip(dialogue.turns, dialogue.speeches, strict=True):
        results.false_ends += any(turn_begin < time < turn_end for time in ends)
        after = [time for time in ends if turn_end <= time <= begin]
        if after:
            results.turn_ends[dialogue.has_predictor].append(after[0] - turn_end - performance.thinking_delay)


def _measure_interruptions(dialogue: Dialogue, performance: DialogueRecord, results: _Results) -> None:
    """Count missed and false interruptions, and measure their delays."""
    for item in dialogue.interjections:
        stops = [time for time in performance.yields if item.begin <= time <= item.begin + INTERRUPTION_WINDOW]
        if item.takes_turn:
            results.attempts += 1
            results.missed += not stops
            results.yields += [time - item.begin for time in stops[:1]]
        else:
            results.agreements += 1
            results.false_yields += bool(stops)


def _measure_gaze(dialogue: Dialogue, performance: DialogueRecord, results: _Results, setup: Setup) -> None:
    """Measure looks at people, nods, head errors and limits of the motion."""
    for begin, end in dialogue.speeches:
        if not any(begin <= time <= end for time in performance.yields):
            spans = {"speaking": (begin, end), "first": (begin, begin + 1.0), "last": (end - 1.0, end)}
            for name, span in spans.items():
                results.looking.setdefault(name, []).append(performance.looking_fraction(*span))
    changes = [*performance.modes, (dialogue.end, "off")]
    for (time, mode), (stop, _) in pairwise(changes):
        if mode == "listening" and stop - time > 2.0:
            results.looking.setdefault("listening", []).append(performance.looking_fraction(time, stop))
        if mode == "listening":
            results.listening += stop - time
    results.longest_look = max(results.longest_look, performance.longest_look)
    results.nods += performance.nods
    results.errors += performance.errors
    for motion in performance.motions[::CHECKED_MOTION_INTERVAL]:
        peaks = check_limits(motion, setup.limits).by_quantity.values()
        results.limit_ratio = max(results.limit_ratio, *(float(peak.ratios.max()) for peak in peaks))
    results.seconds += dialogue.end
