"""The voice: marks against the silence that is heard before them, strokes against the words that they belong to.

Nothing is taken from the engine's own events: a sound is written as WAV, read again, and its words are found where
silence ends.
"""

import random
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import median
from time import perf_counter, sleep
from xml.sax.saxutils import escape

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.body.arrays import Floats
from kinesic.body.utterance import Mark, Pause, Script, Sound
from kinesic.controller.perform import dry_run, plan, set_up
from kinesic.controller.performance import Performance
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.controller.tracking_delay import tracking_delay
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.sim.servo_factors import PESSIMISTIC
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recording import read_wav

SEED = 7
SENTENCES = 40
BLOCKS = 10
REPETITIONS = 20
RATES = (0.8, 1.0, 1.25)
PAUSE = 0.3  # [s] put before a mark
BETWEEN = 0.1  # [s] from one utterance to the next, when their time is taken
QUIET = 1e-3  # of the loudest sample
LEAST_SILENCE = 0.15  # [s]; lips that are closed within a word make shorter ones
MARGIN = 0.15  # [s] before and after a stroke, of what is compared
GOALS = {"mark": 5.0, "stroke": 30.0}  # [ms]

WORDS: Mapping[str, tuple[str, ...]] = {
    "en": ("apple", "see", "table", "green", "people", "you", "children", "half", "zebra", "know", "big", "open"),
    "fr": ("arbre", "soleil", "table", "grand", "personne", "vous", "cheval", "haut", "jardin", "neige", "bon", "ici"),
    "de": ("Apfel", "Sonne", "Tisch", "gut", "Pferd", "Straße", "Kinder", "hoch", "Zebra", "Nase", "Baum", "offen"),
    "es": ("agua", "sol", "tiempo", "grande", "perro", "zapato", "calle", "hijo", "jardín", "nieve", "bueno", "ella"),
    "it": ("albero", "sole", "tavolo", "grande", "persona", "zio", "casa", "qui", "giorno", "neve", "buono", "ogni"),
}
LEXEMES = ("offer", "stop", "large", "you", "beat", "welcome")
BLOCK = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{id}">
  <speech id="s"><text>{words[0]} {words[1]} {words[2]} {words[3]} <break time="{pause:g}s"/><sync id="one"/>{words[4]}
    {words[5]} {words[6]} {words[7]} {words[8]} <break time="{pause:g}s"/><sync id="two"/>{words[9]} {words[10]}</text>
  </speech>
  <gesture id="right" lexeme="{lexemes[0]}" mode="RIGHT_HAND" stroke="s:one"/>
  <gesture id="left" lexeme="{lexemes[1]}" mode="LEFT_HAND" stroke="s:two"/>
</bml>
"""


def bench(sentences: int = SENTENCES, blocks: int = BLOCKS) -> list[Figure]:
    """Errors of marks and strokes, and how long saying three words takes."""
    why = espeak_fault()
    marks = [] if why else [1000 * abs(error) for error in mark_errors(sentences)]
    strokes = [] if why else [1000 * abs(error) for error in heard_stroke_errors(blocks)]
    return [
        *_figures("mark", marks, why),
        *_figures("stroke", strokes, why),
        Figure("bml.speech.say", None if why else 1000 * _latency(), "ms", 60.0, "lower", why),
    ]


def _figures(kind: str, errors: list[float], why: str) -> list[Figure]:
    name, goal = f"bml.speech.{kind}_error", GOALS[kind]
    shares = {"median": 50, "p95": 95, "max": 100}
    return [
        Figure(f"{name}_{measure}", float(np.percentile(errors, share)) if errors else None, "ms", goal, "lower", why)
        for measure, share in shares.items()
    ]


def mark_errors(count: int) -> Iterator[float]:
    """Measures marks of sentences, in several languages and at several rates, minus where their silence ends [s]."""
    choice = random.Random(SEED)
    for number in range(count):
        language = list(WORDS)[number % len(WORDS)]
        words = choice.sample(WORDS[language], 9)
        if number % 2:  # the second mark begins a sentence
            words[5], words[6] = f"{words[5]}.", words[6].title()
        text = " ".join(words)
        places = [text.index(f" {words[k]}") + 1 for k in (3, 6)]
        script = Script(
            text,
            tuple(Mark(f"m{place}", place) for place in places),
            language,
            tuple(Pause(place, PAUSE) for place in places),
        )
        said = Espeak().say(script, rate=RATES[number % len(RATES)])
        if said.sound is not None:
            for mark, onset in zip(said.marks.values(), onsets(recorded(said.sound)), strict=True):
                yield mark - onset


def heard_stroke_errors(count: int) -> Iterator[float]:
    """Measures stroke times of the pessimistic twin's hands minus the times when their words are heard [s]."""
    known = set_up(voice="espeak")
    choice = random.Random(SEED)
    for number in range(count):
        words, lexemes = choice.sample(WORDS["en"], 11), choice.sample(LEXEMES, 2)
        text = BLOCK.format(id=f"b{number}", words=list(map(escape, words)), lexemes=lexemes, pause=PAUSE)
        yield from performed_errors(text, known)


def performed_errors(text: str, known: Setup) -> Iterator[float]:
    """Measures the same of one block, with a pause before each mark; strokes that had to move are left out."""
    performance = dry_run(plan(text, known), twin=PESSIMISTIC)
    heard = sound(performance.plan)
    if heard is None:
        return
    words = onsets(recorded(heard))
    sides = {"right": "r", "left": "l"}
    strokes = [sync for sync in performance.plan.syncs if sync.sync == "stroke" and sync.behaviour in sides]
    for sync, word in zip(sorted(strokes, key=lambda sync: sync.asked), words, strict=True):
        if abs(sync.planned - sync.asked) <= SHIFT_TO_WARN:
            yield _stroke(sync, sides[sync.behaviour], performance) - word


def recorded(spoken: Sound) -> Sound:
    """Writes a sound as a WAV file, and reads it again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spoken.wav"
        write_wav(spoken, path)
        return read_wav(path)


def onsets(heard: Sound) -> list[float]:
    """Finds where silences end that lie between sounds [s]."""
    loudness = np.abs(heard.samples)
    loud = np.flatnonzero(loudness > QUIET * loudness.max())
    ends = loud[1:][np.diff(loud) > LEAST_SILENCE * heard.rate]
    return [float(end) / heard.rate for end in ends]


def _stroke(sync: SyncTime, side: str, performance: Performance) -> float:
    """When a hand of the twin makes a stroke [s, performance time]: as the plan, but as late as its speed is."""
    planned = performance.plan
    zero, times = planned.trajectory.zero, performance.measured.times
    own = {each.sync: each.planned for each in planned.syncs if each.behaviour == sync.behaviour}
    near = (times > zero + own["strokeStart"] - MARGIN) & (times < zero + own["strokeEnd"] + MARGIN)
    wanted, performed = (
        _speed(hands[side], times)[near, None] for hands in (performance.reference.hands, performance.measured.hands)
    )
    late = tracking_delay(lambda hinges: wanted[:, hinges], performed, np.array([True]), period=performance.period)
    return zero + sync.planned + float(late[0])


def _speed(path: Floats, times: Floats) -> Floats:
    """(m,) [m/s] along a path (m, 3) [m]."""
    return np.asarray(np.linalg.norm(np.gradient(path, times, axis=0), axis=1))


def _latency() -> float:
    """[s] of saying three words that were never said before, in a warm process, now and then."""
    voice, found = Espeak(), []
    voice.say(Script("Good morning everybody"))
    for number in range(REPETITIONS):
        sleep(BETWEEN)
        began = perf_counter()
        voice.say(Script(f"Say number {number}"))
        found.append(perf_counter() - began)
    return median(found)
