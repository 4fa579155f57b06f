"""Speech engine of hibari: one phrase to samples, phonemes, words and accents."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.utterance import Phoneme, Samples, Sound
from kinesic.speech.engines.phrase import EngineError, Phrase, ProsodySection, SpokenPhrase, SpokenWord, UnreadableError
from kinesic.speech.hibari.accents import find_pitch_accents
from kinesic.speech.hibari.model import FRAME_SAMPLES, SAMPLE_RATE, Floats32, HibariModel, Prediction, load_model
from kinesic.speech.hibari.phoneme_times import place_phonemes
from kinesic.speech.hibari.pronunciation import Pronunciation, pronounce
from kinesic.speech.writing import unreadable_letters

MIN_PITCH = 0.5  # smallest factor on the pitch
MAX_PITCH = 2.0  # largest factor on the pitch
READER_VOICE = "gmw/en-US"  # name of American English in `unreadable_letters`
TRIAL_TEXT = "a"  # text spoken to check that hibari works
MAX_LISTED_LETTERS = 40  # largest number of unreadable letters in a remark


@dataclass(frozen=True)
class Hibari:
    """American English voice of the package hibari-tts, without network."""

    name: str = "hibari"

    def speak(self, phrase: Phrase, /) -> SpokenPhrase:
        """Synthesise an English phrase.

        Raises:
            UnreadableError: no word of the phrase can be read.
            EngineError: the package is missing, or its model fails.
        """
        model = load_model()
        missing = unreadable_letters(phrase.text, READER_VOICE)
        text = phrase.text.translate(dict.fromkeys(map(ord, missing), " "))
        reading = pronounce(text, model.letter_ids)
        if not reading.words:
            raise UnreadableError(f"no word of {phrase.text!r} can be read")
        prediction = _predict(model, reading, phrase)
        phonemes, indices = place_phonemes(reading.letters, prediction)
        remarks = (f"hibari cannot read {missing[:MAX_LISTED_LETTERS]}: it is omitted",) if missing else ()
        words = tuple(_place_words(reading, phonemes, indices))
        return SpokenPhrase(
            Sound.of(SAMPLE_RATE, _change_volume(prediction.samples, words, phrase.sections)),
            words,
            phonemes,
            find_pitch_accents(prediction.pitch, phonemes),
            remarks,
        )


@lru_cache(maxsize=1)
def hibari_fault() -> str:
    """Return why hibari cannot speak, with a remedy.

    The result is empty if it can.
    """
    try:
        Hibari().speak(Phrase(TRIAL_TEXT))
    except EngineError as error:
        return str(error)
    return ""


def _predict(model: HibariModel, reading: Pronunciation, phrase: Phrase) -> Prediction:
    """Synthesise the letters of a phrase with its rate and pitch."""
    rates = [phrase.rate * factor for factor in _letter_factors(reading, phrase.sections, "rate")]
    factors = _letter_factors(reading, phrase.sections, "pitch")
    pitches = np.clip(np.array(factors, np.float32) * phrase.pitch, MIN_PITCH, MAX_PITCH)
    prediction = model.predict(reading.letters, rates, pitches[:1])
    if len(set(pitches.tolist())) == 1:
        return prediction
    frames = _spread(pitches, prediction)  # durations depend on the rate alone
    return model.predict(reading.letters, rates, frames)


def _letter_factors(reading: Pronunciation, sections: Sequence[ProsodySection], kind: str) -> list[float]:
    """Return the product of the sections' factors for each letter."""
    factors = [1.0] * len(reading.letters)
    for number, ((begin, _), (first, _)) in enumerate(reading.words):
        end = reading.words[number + 1][1][0] if number + 1 < len(reading.words) else len(factors)
        value = 1.0
        for section in sections:
            if section.begin <= begin < section.end:
                value *= section.rate if kind == "rate" else section.pitch
        factors[0 if number == 0 else first : end] = [value] * (end - (0 if number == 0 else first))
    return factors


def _spread(pitches: Floats32, prediction: Prediction) -> Floats32:
    """Convert the letters' pitch factors to a pitch factor per frame."""
    padded = np.concatenate([pitches[:1], pitches, pitches[-1:]])
    frames_per_unit = len(prediction.pitch) // int(prediction.durations.sum())
    return np.repeat(padded, frames_per_unit * prediction.durations).astype(np.float32)


def _place_words(reading: Pronunciation, phonemes: Sequence[Phoneme], indices: Sequence[int]) -> list[SpokenWord]:
    """Return the words with the times of their first and last sounds."""
    words: list[SpokenWord] = []
    for (begin, end), (first, last) in reading.words:
        inside = [phoneme for phoneme, index in zip(phonemes, indices, strict=True) if first <= index < last]
        if inside:
            words.append(SpokenWord(begin, end, inside[0].start, inside[-1].end))
    return words


def _change_volume(samples: Samples, words: Sequence[SpokenWord], sections: Sequence[ProsodySection]) -> Samples:
    """Multiply samples by the smoothed volumes of their sections."""
    if all(section.volume == 1.0 for section in sections):
        return np.clip(samples, -1.0, 1.0)
    times, gains = [], []
    for word in words:
        gain = 1.0
        for section in sections:
            if section.begin <= word.begin < section.end:
                gain *= section.volume
        middle = (word.start + word.stop) / 2
        half = max((word.stop - word.start) / 2 - FRAME_SAMPLES / SAMPLE_RATE, 0.0)
        times += [middle - half, middle + half]
        gains += [gain, gain]
    curve = np.interp(np.arange(len(samples)) / SAMPLE_RATE, times, gains)
    return np.clip(samples * curve, -1.0, 1.0).astype(np.float32)
