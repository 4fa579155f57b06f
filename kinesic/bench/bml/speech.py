"""Benchmark of synthesised speech: mark times, stroke times and latency.

It measures mark times compared with audible silences, strokes with words.

The engine's own events are not used: a sound is written as WAV and read again; a word starts where a silence ends.
"""

import random
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import median
from time import perf_counter, sleep
from xml.sax.saxutils import escape

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.utterance import Mark, Pause, Script, Sound
from kinesic.controller.dry_run import dry_run
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.tracking_delay import estimate_tracking_delays
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import PESSIMISTIC_FACTORS
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recording import read_wav

SENTENCE_SEED = 7  # seed of the random sentences
SENTENCE_COUNT = 40  # number of synthesised sentences whose mark errors are measured
BLOCK_COUNT = 10  # number of spoken blocks whose stroke errors are measured
LATENCY_REPETITIONS = 20  # utterances timed for the synthesis latency
VOICE_RATES = (0.8, 1.0, 1.25)  # speech rate factors of the synthesised sentences
MARK_PAUSE = 0.3  # [s] pause inserted before each mark
UTTERANCE_INTERVAL = 0.1  # [s] interval between utterances whose latency is measured
SILENCE_RATIO = 1e-3  # silence threshold / amplitude of the loudest sample
MIN_SILENCE = 0.15  # [s] shortest pause between words; closed lips within a word are silent for less
STROKE_MARGIN = 0.15  # [s] margin around a stroke for the comparison of planned and performed hand speed
MAX_ERRORS = {"mark": 5.0, "stroke": 30.0}  # [ms] goals of mark and stroke errors

WORDS_BY_LANGUAGE: Mapping[str, tuple[str, ...]] = {
    "en": ("apple", "see", "table", "green", "people", "you", "children", "half", "zebra", "know", "big", "open"),
    "fr": ("arbre", "soleil", "table", "grand", "personne", "vous", "cheval", "haut", "jardin", "neige", "bon", "ici"),
    "de": ("Apfel", "Sonne", "Tisch", "gut", "Pferd", "Straße", "Kinder", "hoch", "Zebra", "Nase", "Baum", "offen"),
    "es": ("agua", "sol", "tiempo", "grande", "perro", "zapato", "calle", "hijo", "jardín", "nieve", "bueno", "ella"),
    "it": ("albero", "sole", "tavolo", "grande", "persona", "zio", "casa", "qui", "giorno", "neve", "buono", "ogni"),
}
GESTURE_LEXEMES = ("offer", "stop", "large", "you", "beat", "welcome")
BLOCK_TEMPLATE = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{id}">
  <speech id="s"><text>{words[0]} {words[1]} {words[2]} {words[3]} <break time="{pause:g}s"/><sync id="one"/>{words[4]}
    {words[5]} {words[6]} {words[7]} {words[8]} <break time="{pause:g}s"/><sync id="two"/>{words[9]} {words[10]}</text>
  </speech>
  <gesture id="right" lexeme="{lexemes[0]}" mode="RIGHT_HAND" stroke="s:one"/>
  <gesture id="left" lexeme="{lexemes[1]}" mode="LEFT_HAND" stroke="s:two"/>
</bml>
"""


def bench(sentences: int = SENTENCE_COUNT, blocks: int = BLOCK_COUNT) -> list[Metric]:
    """Measure mark and stroke errors, and synthesis latency of a short utterance."""
    why = espeak_fault()
    marks = [] if why else [1000 * abs(error) for error in mark_errors(sentences)]
    strokes = [] if why else [1000 * abs(error) for error in heard_stroke_errors(blocks)]
    return [
        *_metrics("mark", marks, why),
        *_metrics("stroke", strokes, why),
        Metric("bml.speech.say", None if why else 1000 * _measure_latency(), "ms", 60.0, "lower", why),
    ]


def _metrics(kind: str, errors: list[float], why: str) -> list[Metric]:
    name, goal = f"bml.speech.{kind}_error", MAX_ERRORS[kind]
    percentiles = {"median": 50, "p95": 95, "max": 100}
    return [
        Metric(f"{name}_{measure}", float(np.percentile(errors, percent)) if errors else None, "ms", goal, "lower", why)
        for measure, percent in percentiles.items()
    ]


def mark_errors(count: int) -> Iterator[float]:
    """Yield each mark's time minus the audible start of its word [s].

    The sentences are in several languages and at several rates.
    """
    rng = random.Random(SENTENCE_SEED)
    for number in range(count):
        language = list(WORDS_BY_LANGUAGE)[number % len(WORDS_BY_LANGUAGE)]
        words = rng.sample(WORDS_BY_LANGUAGE[language], 9)
        if number % 2:  # the second mark starts a sentence
            words[5], words[6] = f"{words[5]}.", words[6].title()
        text = " ".join(words)
        positions = [text.index(f" {words[k]}") + 1 for k in (3, 6)]
        script = Script(
            text,
            tuple(Mark(f"m{position}", position) for position in positions),
            language,
            tuple(Pause(position, MARK_PAUSE) for position in positions),
        )
        utterance = Espeak().say(script, rate=VOICE_RATES[number % len(VOICE_RATES)])
        if utterance.sound is not None:
            for mark, onset in zip(utterance.marks.values(), find_onsets(write_and_read(utterance.sound)), strict=True):
                yield mark - onset


def heard_stroke_errors(count: int) -> Iterator[float]:
    """Yield stroke times of the pessimistic twin minus audible word times [s]."""
    setup = set_up(voice="espeak")
    rng = random.Random(SENTENCE_SEED)
    for number in range(count):
        words, lexemes = rng.sample(WORDS_BY_LANGUAGE["en"], 11), rng.sample(GESTURE_LEXEMES, 2)
        text = BLOCK_TEMPLATE.format(id=f"b{number}", words=list(map(escape, words)), lexemes=lexemes, pause=MARK_PAUSE)
        yield from block_stroke_errors(text, setup)


def block_stroke_errors(text: str, setup: Setup) -> Iterator[float]:
    """Yield stroke time errors [s] relative to audible words of a block.

    Strokes that were shifted by the schedule are left out.
    """
    performance = dry_run(plan(text, setup), twin=PESSIMISTIC_FACTORS)
    audio = sound(performance.plan)
    if audio is None:
        return
    words = find_onsets(write_and_read(audio))
    sides = {"right": "r", "left": "l"}
    strokes = [sync for sync in performance.plan.syncs if sync.sync == "stroke" and sync.behaviour in sides]
    for sync, word in zip(sorted(strokes, key=lambda sync: sync.requested), words, strict=True):
        if abs(sync.planned - sync.requested) <= SHIFT_TO_WARN:
            yield _find_stroke_time(sync, sides[sync.behaviour], performance) - word


def write_and_read(spoken: Sound) -> Sound:
    """Write a sound as a WAV file and read it again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spoken.wav"
        write_wav(spoken, path)
        return read_wav(path)


def find_onsets(audio: Sound) -> list[float]:
    """Find the times [s] at which sound resumes after a silence."""
    loudness = np.abs(audio.samples)
    loud = np.flatnonzero(loudness > SILENCE_RATIO * loudness.max())
    ends = loud[1:][np.diff(loud) > MIN_SILENCE * audio.rate]
    return [float(end) / audio.rate for end in ends]


def _find_stroke_time(sync: SyncTime, side: str, performance: DryRun) -> float:
    """Return the time [s] of a stroke in the twin's performance.

    It is the planned time plus the delay of the performed hand velocity.
    """
    planned = performance.plan
    zero, times = planned.trajectory.zero, performance.measured.times
    planned_times = {point.sync: point.planned for point in planned.syncs if point.behaviour == sync.behaviour}
    is_near = (times > zero + planned_times["strokeStart"] - STROKE_MARGIN) & (
        times < zero + planned_times["strokeEnd"] + STROKE_MARGIN
    )
    planned_speed, performed_speed = (
        _compute_speed(hands[side], times)[is_near, None]
        for hands in (performance.reference.hands, performance.measured.hands)
    )
    delay = estimate_tracking_delays(
        lambda hinges: planned_speed[:, hinges], performed_speed, np.array([True]), period=performance.period
    )
    return zero + sync.planned + float(delay[0])


def _compute_speed(path: Floats, times: Floats) -> Floats:
    """Return the speed (m,) [m/s] along a path (m, 3) [m]."""
    return np.asarray(np.linalg.norm(np.gradient(path, times, axis=0), axis=1))


def _measure_latency() -> float:
    """Measure the median time [s] to synthesize a new three-word utterance."""
    voice, times = Espeak(), []
    voice.say(Script("Good morning everybody"))
    for number in range(LATENCY_REPETITIONS):
        sleep(UTTERANCE_INTERVAL)
        began = perf_counter()
        voice.say(Script(f"Say number {number}"))
        times.append(perf_counter() - began)
    return median(times)
