"""Measures lips that speak: when they close and open beside the sound that is heard, and how fast.

Where lips are is taken from the head's mesh. When they should be there is taken from the samples of the voice alone:
a burst, or the end of a nasal, is the steepest rise of loudness in three bands, and the end of the vowel before the
steepest fall. The voice's own times say no more than in which part of the sound to look.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.utterance import VOWELS, Phoneme, Script, Sound, Utterance
from kinesic.expressivity.face.visemes import visemes
from kinesic.face.assets.action_units import deform
from kinesic.face.assets.lips import Lips, lips
from kinesic.face.assets.mesh import Mesh, load_head
from kinesic.speech.espeak import Espeak

SENTENCES = (
    "Peter Piper picked a pepper, but nobody helped him.",
    "Tomorrow morning my family may come by boat.",
    "The camera is above the table, maybe beside the lamp.",
    "Pretty blue umbrellas bob up and down in May.",
    "I am sorry about the broken cup, Emma.",
)
RATES = {"slow": 0.8, "quick": 1.25}
BILABIAL = ("p", "b", "m")
OPEN_SOUNDS = VOWELS | frozenset("lɹrwj")  # between which and closed lips a step is heard
TICK = 0.01  # [s] of what servos and screens get
OPEN = 0.3  # [mm] between lips that can be seen to be apart
BESIDE = 0.03  # [s] round a sound, in which its burst is looked for
BEFORE = 0.07  # [s] before it, in which the sound before may stop
BANDS = (400.0, 900.0, 1500.0, 3500.0, 8000.0)  # [Hz]; between the second and the third lies what nasals keep
KEPT = (0, 2, 3)  # of the bands between them
SPECTRUM_WINDOW, HOP = 0.012, 0.001  # [s]
QUIET = 3e-4  # of a band's mean power, below which nothing is heard
MIDDLE = slice(9, 16)  # columns of the lips


class Closing(NamedTuple):
    """Lips that close for one or several sounds, beside the sound; times in seconds of the utterance."""

    sounds: str
    shut: float | None  # when they have closed; None: never
    open: float | None  # when they open again
    stops: float | None  # when the vowel before is heard to stop; None: none is
    bursts: float | None  # when their opening is heard; None: it is not

    @property
    def is_late(self) -> bool:
        """Whether the vowel before stops while the lips are still apart."""
        return self.shut is not None and self.stops is not None and self.shut > self.stops


@dataclass(frozen=True, eq=False)
class Talk:
    """What one utterance does to the lips."""

    closings: tuple[Closing, ...]
    fastest: float  # [mm/s] of one lip from the other


def measure_lips(sentences: Sequence[str] = SENTENCES) -> dict[str, float]:
    """Measures all figures of the lips, for the voices' rates; the voice must be there."""
    head = load_head("female")
    found: dict[str, float] = {}
    for name, rate in RATES.items():
        talks = [talk(Espeak().say(Script(text), rate=rate), head) for text in sentences]
        closings = [closing for each in talks for closing in each.closings]
        errors = [1000 * abs(each.open - each.bursts) for each in closings if each.open and each.bursts]
        found[f"face.lips.{name}_release_median"] = float(np.median(errors))
        found[f"face.lips.{name}_release_p95"] = float(np.percentile(errors, 95))
        found[f"face.lips.{name}_open"] = sum(each.shut is None for each in closings)
        found[f"face.lips.{name}_late"] = sum(each.is_late for each in closings)
        found[f"face.lips.{name}_fastest"] = max(each.fastest for each in talks)
    return found


def talk(said: Utterance, head: Mesh) -> Talk:
    """Measures the lips of a head that says something."""
    assert said.sound is not None
    times = np.arange(-0.3, said.duration + 0.3, TICK)
    shown = visemes(said.phonemes, times)
    mouth = lips(head)
    rows = [{channel: row[k] for channel, row in shown.items()} for k in range(len(times))]
    apart = np.array([_apart(head, mouth, row) for row in rows])
    heard = loudness_steps(said.sound)
    closings = tuple(_closing(run, (times, apart), heard) for run in _runs(said.phonemes))
    return Talk(closings, float(np.abs(np.diff(apart)).max() / TICK))


def loudness_steps(sound: Sound) -> tuple[Floats, Floats]:
    """Finds how much louder a sound is right after each moment than right before, with silence round it.

    Returns:
        (n,) [s] moments, and (n,) [dB] the mean over three bands.
    """
    wide, hop = round(SPECTRUM_WINDOW * sound.rate), round(HOP * sound.rate)
    samples = np.pad(sound.samples.astype(np.float64), 10 * wide)
    frames = np.lib.stride_tricks.sliding_window_view(samples, wide)[::hop]
    power = np.abs(np.fft.rfft(frames * np.hanning(wide), 4 * wide)) ** 2
    places = np.searchsorted(np.fft.rfftfreq(4 * wide, 1.0 / sound.rate), BANDS)
    bands = np.add.reduceat(power, places[:-1], axis=1)[:, KEPT]
    level = 10.0 * np.log10(bands + QUIET * bands.mean(axis=0))
    across = round(wide / hop)
    moments = (np.arange(len(level) - across) + across) * hop / sound.rate - 10 * wide / sound.rate
    return moments, np.asarray((level[across:] - level[:-across]).mean(axis=1))


def _apart(head: Mesh, mouth: Lips, units: dict[str, float]) -> float:
    """How far the lips are apart in the middle [mm]."""
    return float(-1000.0 * mouth.overlap(deform(head, units))[MIDDLE].min())


@dataclass(frozen=True, eq=False)
class _Run:
    """Sounds for which lips close once."""

    sounds: list[Phoneme]
    before: str  # letters of the neighbours, where no pause is between them
    after: str

    @property
    def is_heard_to_open(self) -> bool:
        """Stops burst; the end of a nasal is heard before what is open."""
        return self.sounds[-1].letters[-1] != "m" or self.after in OPEN_SOUNDS


def _runs(phonemes: Sequence[Phoneme]) -> Iterator[_Run]:
    """Yields sounds for which lips close once."""
    run: list[Phoneme] = []
    before = ""
    for sound, after in zip(phonemes, (*phonemes[1:], None), strict=True):
        follows = after is not None and after.start - sound.end < HOP
        letter = after.letters[:1] if after is not None and follows else ""
        if sound.letters[:1] in BILABIAL:
            run.append(sound)
            if letter not in BILABIAL:
                yield _Run(run, before, letter)
                run = []
        if not run:
            before = sound.letters[-1:] if follows else ""


def _closing(run: _Run, mouth: tuple[Floats, Floats], heard: tuple[Floats, Floats]) -> Closing:
    """Looks at one closure: the stretch of closed lips that is nearest to where its opening is heard."""
    (times, apart), (moments, steps) = mouth, heard
    begin, end = run.sounds[0].start, run.sounds[-1].end
    near = (moments > begin - BESIDE) & (moments < end + BESIDE)
    bursts = float(moments[near][steps[near].argmax()])
    earlier = (moments > begin - BEFORE) & (moments < bursts - SPECTRUM_WINDOW)
    closing = Closing(
        "".join(sound.letters for sound in run.sounds),
        shut=None,
        open=None,
        stops=float(moments[earlier][steps[earlier].argmin()]) if run.before in OPEN_SOUNDS else None,
        bursts=bursts if run.is_heard_to_open else None,
    )
    closed = np.flatnonzero((apart < OPEN) & (times > begin - BEFORE) & (times < end))
    if not len(closed):
        return closing
    parted = np.flatnonzero(apart >= OPEN)
    place = closed[np.abs(times[closed] - bursts).argmin()]
    first, last = parted[parted < place].max(initial=-1) + 1, parted[parted > place].min(initial=len(apart))
    return closing._replace(shut=_crossing(times, apart, first - 1), open=_crossing(times, apart, last - 1))


def _crossing(times: Floats, apart: Floats, place: int) -> float:
    """When lips begin or cease to be seen apart [s], between a place and the next."""
    if not 0 <= place < len(times) - 1:
        return float(times[0 if place < 0 else -1])
    return float(times[place] + TICK * (OPEN - apart[place]) / (apart[place + 1] - apart[place]))
