"""Removal of silence at both ends of a phrase."""

from dataclasses import replace

import numpy as np

from kinesic.body.utterance import Phoneme, Sound
from kinesic.speech.engines.phrase import EngineError, SpokenPhrase

SILENCE_RATIO = 4e-3  # largest amplitude of silence / largest amplitude of the phrase (-48 dB)


def trim(spoken: SpokenPhrase) -> SpokenPhrase:
    """Remove the silence before and after a phrase, and shift its times.

    Raises:
        EngineError: the sound is silent, or has values that are not finite.
    """
    samples, rate = spoken.sound.samples, spoken.sound.rate
    amplitudes = np.abs(samples)
    loudest = float(amplitudes.max(initial=0.0))
    if not np.isfinite(loudest) or loudest == 0.0:
        raise EngineError("the engine returned no sound")
    audible = np.flatnonzero(amplitudes > SILENCE_RATIO * loudest)
    first, last = int(audible[0]), int(audible[-1]) + 1
    lead, duration = first / rate, (last - first) / rate

    def shift(time: float) -> float:
        return min(max(time - lead, 0.0), duration)

    return replace(
        spoken,
        sound=Sound.of(rate, samples[first:last]),
        words=tuple(replace(word, start=shift(word.start), stop=shift(word.stop)) for word in spoken.words),
        phonemes=tuple(_shift(phoneme, lead, duration) for phoneme in spoken.phonemes),
        accents=tuple(shift(time) for time in spoken.accents),
    )


def _shift(phoneme: Phoneme, lead: float, duration: float) -> Phoneme:
    """Return a phoneme with times from the first audible sample.

    Its sound lies within the duration; its mouth shape may begin earlier.
    """
    start = min(max(phoneme.start - lead, 0.0), duration)
    end = min(max(phoneme.end - lead, start), duration)
    return replace(
        phoneme,
        start=start,
        duration=end - start,
        onset=None if phoneme.onset is None else phoneme.onset - lead,
        release=None if phoneme.release is None else phoneme.release - lead,
    )
