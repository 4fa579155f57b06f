"""Recordings for tests: synthesised speech with pauses and noise."""

import re
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.utterance import Mark, Phoneme, Script, Sound
from kinesic.speech.espeak import Espeak

RECORDED_TEXT = "Peter, please bring my big blue umbrella before it begins to rain."  # text of the recordings


@dataclass(frozen=True, eq=False)
class SpokenText:
    """Sound of a text with the true start times of its words."""

    sound: Sound
    starts: Floats  # (words,) [s]
    phonemes: tuple[Phoneme, ...]


def speak(
    voice: Espeak,
    text: str = RECORDED_TEXT,
    *,
    language: str = "en-gb",
    rate: float = 0.85,
    pitch: float = 1.3,
    pauses: dict[int, float] | None = None,
    noise: float = 0.0,
) -> SpokenText:
    """Synthesise a text with another voice than that of renditions.

    Args:
        voice: engine.
        text: of the recording.
        language: accent.
        rate: of speech.
        pitch: factor of the voice's pitch.
        pauses: index of a word -> silence inserted before it [s].
        noise: standard deviation of the added noise, as a fraction of that of the speech.
    """
    marks = tuple(Mark(f"w{k}", place.start()) for k, place in enumerate(re.finditer(r"\w+", text)))
    spoken = voice.say(Script(text, marks, language=language), rate=rate, pitch=pitch)
    assert spoken.sound is not None
    starts = np.array([spoken.marks[mark.name] for mark in marks])
    samples, shift = spoken.sound.samples.astype(float), np.zeros(len(starts))
    for word, duration in sorted((pauses or {}).items(), reverse=True):
        at = round((starts[word] - 0.04) * spoken.sound.rate)
        samples = np.insert(samples, at, np.zeros(round(duration * spoken.sound.rate)))
        shift[word:] += duration
    if noise:
        samples = samples + np.random.default_rng(5).normal(0.0, noise * float(samples.std()), len(samples))
    return SpokenText(Sound.of(spoken.sound.rate, samples), starts + shift, spoken.phonemes)
