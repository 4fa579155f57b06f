"""Benchmark of lip motion in speech.

It measures closing and opening compared with the sound, and speed.

The lips' positions come from the head's mesh. The expected times come from the audio samples alone: a burst, or the end
of a nasal, is the steepest rise of loudness in three bands, and the end of the vowel before it the steepest fall. The
voice's own times only limit the part of the sound to search.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.utterance import VOWEL_LETTERS, Phoneme, Script, Sound, Utterance
from kinesic.expressivity.face.visemes import visemes
from kinesic.face.assets.action_units import deform
from kinesic.face.assets.lips import Lips, find_lips
from kinesic.face.assets.mesh import Mesh, load_head
from kinesic.speech.espeak import Espeak

LIP_SENTENCES = (
    "Peter Piper picked a pepper, but nobody helped him.",
    "Tomorrow morning my family may come by boat.",
    "The camera is above the table, maybe beside the lamp.",
    "Pretty blue umbrellas bob up and down in May.",
    "I am sorry about the broken cup, Emma.",
)
SPEECH_RATES = {"slow": 0.8, "quick": 1.25}  # speech rate factors by name of the metric
BILABIAL_LETTERS = ("p", "b", "m")  # phonetic letters of sounds with closed lips
OPEN_SOUNDS = VOWEL_LETTERS | frozenset("lɹrwj")  # letters of sounds that differ audibly from closed lips
CONTROL_PERIOD = 0.01  # [s] period at which lip motion is sampled, as by servos and screens
MIN_VISIBLE_GAP = 0.3  # [mm] smallest visible gap between the lips
BURST_WINDOW = 0.03  # [s] time before and after a sound in which its burst is searched
STOP_WINDOW = 0.07  # [s] time before a sound in which the end of the previous sound is searched
BAND_EDGES = (
    400.0,
    900.0,
    1500.0,
    3500.0,
    8000.0,
)  # [Hz] edges of the loudness bands; nasals stay loud from 900 to 1500 Hz, which is not used
USED_BANDS = (0, 2, 3)  # indices of the BAND_EDGES bands whose loudness is measured
SPECTRUM_WINDOW = 0.012  # [s] length of a short-time spectrum
HOP_TIME = 0.001  # [s] interval between successive spectra
SILENCE_POWER = 3e-4  # power added to a frequency band, as a fraction of its mean, to avoid log(0)
MIDDLE_COLUMNS = slice(9, 16)  # columns of lip vertices in the middle of the mouth


class Closing(NamedTuple):
    """One closure of the lips with its times in motion and sound.

    Times of the utterance [s].
    """

    sounds: str
    shut: float | None  # [s] time when the lips close; None: never
    open: float | None  # [s] time when the lips open again; None: never closed
    stops: float | None  # [s] time when the preceding vowel audibly ends; None: no vowel
    bursts: float | None  # [s] time when the lips audibly open; None: not audible

    @property
    def is_late(self) -> bool:
        """Whether the lips close only after the preceding vowel's audible end."""
        return self.shut is not None and self.stops is not None and self.shut > self.stops


@dataclass(frozen=True, eq=False)
class LipMotion:
    """Lip closures and largest lip speed of one utterance."""

    closings: tuple[Closing, ...]
    fastest: float  # [mm/s] largest speed between the lips


def measure_lips(sentences: Sequence[str] = LIP_SENTENCES) -> dict[str, float]:
    """Measure all lip metrics at slow and quick speech rates.

    A voice is required.
    """
    head = load_head("female")
    metrics: dict[str, float] = {}
    for name, rate in SPEECH_RATES.items():
        talks = [measure_talk(Espeak().say(Script(text), rate=rate), head) for text in sentences]
        closings = [closing for talk in talks for closing in talk.closings]
        errors = [1000 * abs(closing.open - closing.bursts) for closing in closings if closing.open and closing.bursts]
        metrics[f"face.lips.{name}_release_median"] = float(np.median(errors))
        metrics[f"face.lips.{name}_release_p95"] = float(np.percentile(errors, 95))
        metrics[f"face.lips.{name}_open"] = sum(closing.shut is None for closing in closings)
        metrics[f"face.lips.{name}_late"] = sum(closing.is_late for closing in closings)
        metrics[f"face.lips.{name}_fastest"] = max(talk.fastest for talk in talks)
    return metrics


def measure_talk(utterance: Utterance, head: Mesh) -> LipMotion:
    """Measure the lips of a head during an utterance."""
    assert utterance.sound is not None
    times = np.arange(-0.3, utterance.duration + 0.3, CONTROL_PERIOD)
    shown = visemes(utterance.phonemes, times)
    mouth = find_lips(head)
    rows = [{channel: row[k] for channel, row in shown.items()} for k in range(len(times))]
    gap = np.array([_measure_lip_gap(head, mouth, row) for row in rows])
    loudness = loudness_steps(utterance.sound)
    closings = tuple(_measure_closing(run, (times, gap), loudness) for run in _find_runs(utterance.phonemes))
    return LipMotion(closings, float(np.abs(np.diff(gap)).max() / CONTROL_PERIOD))


def loudness_steps(sound: Sound) -> tuple[Floats, Floats]:
    """Return the change of a sound's loudness [dB] around each time.

    Returns:
        Times (n,) [s], and changes (n,) [dB], averaged over three bands.
    """
    wide, hop = round(SPECTRUM_WINDOW * sound.rate), round(HOP_TIME * sound.rate)
    samples = np.pad(sound.samples.astype(np.float64), 10 * wide)
    frames = np.lib.stride_tricks.sliding_window_view(samples, wide)[::hop]
    power = np.abs(np.fft.rfft(frames * np.hanning(wide), 4 * wide)) ** 2
    edges = np.searchsorted(np.fft.rfftfreq(4 * wide, 1.0 / sound.rate), BAND_EDGES)
    bands = np.add.reduceat(power, edges[:-1], axis=1)[:, USED_BANDS]
    level = 10.0 * np.log10(bands + SILENCE_POWER * bands.mean(axis=0))
    across = round(wide / hop)
    step_times = (np.arange(len(level) - across) + across) * hop / sound.rate - 10 * wide / sound.rate
    return step_times, np.asarray((level[across:] - level[:-across]).mean(axis=1))


def _measure_lip_gap(head: Mesh, mouth: Lips, units: dict[str, float]) -> float:
    """Return the largest gap in the middle of the lips [mm]."""
    return float(-1000.0 * mouth.overlap(deform(head, units))[MIDDLE_COLUMNS].min())


@dataclass(frozen=True, eq=False)
class _Run:
    """Successive bilabial sounds (p, b, m) with a single lip closure."""

    sounds: list[Phoneme]
    before: str  # last letter of the sound before, empty after a pause
    after: str  # first letter of the sound after, empty before a pause

    @property
    def is_heard_to_open(self) -> bool:
        """Whether the lip opening is audible in the sound.

        Bursts always are, nasals only before open sounds.
        """
        return self.sounds[-1].letters[-1] != "m" or self.after in OPEN_SOUNDS


def _find_runs(phonemes: Sequence[Phoneme]) -> Iterator[_Run]:
    """Yield successive bilabial sounds with a single lip closure."""
    run: list[Phoneme] = []
    before = ""
    for sound, after in zip(phonemes, (*phonemes[1:], None), strict=True):
        follows = after is not None and after.start - sound.end < HOP_TIME
        letter = after.letters[:1] if after is not None and follows else ""
        if sound.letters[:1] in BILABIAL_LETTERS:
            run.append(sound)
            if letter not in BILABIAL_LETTERS:
                yield _Run(run, before, letter)
                run = []
        if not run:
            before = sound.letters[-1:] if follows else ""


def _measure_closing(run: _Run, mouth: tuple[Floats, Floats], loudness: tuple[Floats, Floats]) -> Closing:
    """Measure one lip closure in motion and sound from its bilabial sounds."""
    (times, gap), (step_times, steps) = mouth, loudness
    begin, end = run.sounds[0].start, run.sounds[-1].end
    is_near = (step_times > begin - BURST_WINDOW) & (step_times < end + BURST_WINDOW)
    bursts = float(step_times[is_near][steps[is_near].argmax()])
    is_earlier = (step_times > begin - STOP_WINDOW) & (step_times < bursts - SPECTRUM_WINDOW)
    closing = Closing(
        "".join(sound.letters for sound in run.sounds),
        shut=None,
        open=None,
        stops=float(step_times[is_earlier][steps[is_earlier].argmin()]) if run.before in OPEN_SOUNDS else None,
        bursts=bursts if run.is_heard_to_open else None,
    )
    closed = np.flatnonzero((gap < MIN_VISIBLE_GAP) & (times > begin - STOP_WINDOW) & (times < end))
    if not len(closed):
        return closing
    visible = np.flatnonzero(gap >= MIN_VISIBLE_GAP)
    index = closed[np.abs(times[closed] - bursts).argmin()]
    first, last = visible[visible < index].max(initial=-1) + 1, visible[visible > index].min(initial=len(gap))
    return closing._replace(
        shut=_find_crossing_time(times, gap, first - 1), open=_find_crossing_time(times, gap, last - 1)
    )


def _find_crossing_time(times: Floats, gap: Floats, index: int) -> float:
    """Interpolate the time [s] of the lip gap's crossing of `MIN_VISIBLE_GAP`."""
    if not 0 <= index < len(times) - 1:
        return float(times[0 if index < 0 else -1])
    return float(times[index] + CONTROL_PERIOD * (MIN_VISIBLE_GAP - gap[index]) / (gap[index + 1] - gap[index]))
