"""Voice that joins the phrases of a speech engine."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kinesic.body.utterance import Phoneme, Script, Sound, Utterance, Voice
from kinesic.speech.durations import DurationModel
from kinesic.speech.engines.audible import trim
from kinesic.speech.engines.estimate import complete
from kinesic.speech.engines.mark_times import place_marks
from kinesic.speech.engines.phrase import EngineError, Phrase, SpeechEngine, SpokenPhrase, SpokenWord, UnreadableError
from kinesic.speech.engines.phrasing import PlacedPhrase, divide
from kinesic.speech.voice_level import open_vowels_by_level

CACHED_PHRASES = 64  # number of cached phrases
MAX_CHARACTERS = 25_000  # [characters] longest script, about half an hour: longer than a block may last
DEFAULT_SAMPLE_RATE = 24_000  # [Hz] sample rate of a speech without words
IGNORED_ELEMENTS = ("say-as", "voice")  # SSML elements without effect on phrases


@dataclass(frozen=True)
class EngineVoice:
    """Voice that speaks each phrase with an engine."""

    engine: SpeechEngine
    substitute: Voice | None = None  # voice of scripts that the engine cannot speak; None: silent, with durations

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Speak a script phrase by phrase.

        A script that the engine cannot speak is said by the substitute, with a remark. Phrases that it cannot read are
        left out, with a remark.

        Args:
            script: text to say; of marks with the same name the first counts.
            rate: 1 is the engine's normal rate.
            pitch: factor of the voice's pitch.

        Raises:
            ValueError: rate or pitch is not a finite number above 0.
        """
        for name, value in (("rate", rate), ("pitch", pitch)):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}, must be a finite number above 0")
        try:
            if len(script.text) > MAX_CHARACTERS:
                raise EngineError(f"a text of {len(script.text)} characters is longer than {MAX_CHARACTERS}")
            placed, trailing = divide(script, rate=rate, pitch=pitch)
            parts, remarks = self._speak_phrases(placed)
            utterance = _join(script, self.engine.name, parts, trailing)
            return replace(utterance, remarks=(*remarks, *utterance.remarks))
        except EngineError as error:
            return self._substitute(script, str(error), rate, pitch)

    def _speak_phrases(
        self, placed: Iterable[PlacedPhrase]
    ) -> tuple[list[tuple[PlacedPhrase, SpokenPhrase]], list[str]]:
        """Speak the readable phrases, and return remarks on unreadable ones.

        Raises:
            EngineError: the engine fails, or can read none of them.
        """
        parts: list[tuple[PlacedPhrase, SpokenPhrase]] = []
        remarks: list[str] = []
        for place in placed:
            try:
                parts.append((place, speak_phrase(self.engine, place.phrase)))
            except UnreadableError as error:
                remarks.append(f"{self.engine.name}: {error}: it is omitted")
        if remarks and not parts:
            raise EngineError("no word of the text can be read")
        return parts, remarks

    def _substitute(self, script: Script, why: str, rate: float, pitch: float) -> Utterance:
        if self.substitute is None:
            text = script.text[:MAX_CHARACTERS]
            reason = f"no sound: {self.engine.name}: {why}"
            return DurationModel(reason).say(replace(script, text=text), rate=rate)
        utterance = self.substitute.say(script, rate=rate, pitch=pitch)
        remark = f"{self.engine.name}: {why}: {utterance.voice} speaks instead"
        return replace(utterance, remarks=(remark, *utterance.remarks))


@lru_cache(maxsize=CACHED_PHRASES)
def speak_phrase(engine: SpeechEngine, phrase: Phrase) -> SpokenPhrase:
    """Speak a phrase, trim its silence, and estimate missing times.

    Raises:
        EngineError: the engine fails, or its times are invalid.
    """
    spoken = engine.speak(phrase)
    _check_times(spoken, len(phrase.text))
    return complete(phrase, trim(spoken))


def _check_times(spoken: SpokenPhrase, length: int) -> None:
    """Reject unordered or infinite times, and words outside of the phrase."""
    for name, starts in (("word", [w.start for w in spoken.words]), ("phoneme", [p.start for p in spoken.phonemes])):
        if not all(map(math.isfinite, starts)) or starts != sorted(starts):
            raise EngineError(f"its {name} times are not finite and in order")
    bounds = [bound for word in spoken.words for bound in (word.begin, word.end)]
    if bounds != sorted(bounds) or (bounds and not 0 <= bounds[0] <= bounds[-1] <= length):
        raise EngineError(f"its words are not in order within the {length} characters of the phrase")
    if not all(map(math.isfinite, (*(w.stop for w in spoken.words), *(p.end for p in spoken.phonemes)))):
        raise EngineError("its end times are not finite")


def _join(script: Script, name: str, parts: list[tuple[PlacedPhrase, SpokenPhrase]], trailing: float) -> Utterance:
    """Join phrases and silences to an utterance."""
    rates = {spoken.sound.rate for _, spoken in parts} or {DEFAULT_SAMPLE_RATE}
    if len(rates) > 1:
        raise EngineError(f"its phrases have different sample rates: {sorted(rates)} Hz")
    (sample_rate,) = rates
    pieces: list[np.ndarray[tuple[int], np.dtype[np.float32]]] = []
    words: list[SpokenWord] = []
    phonemes: list[Phoneme] = []
    accents: list[float] = []
    count = 0  # samples so far
    for place, spoken in parts:
        silence = round(place.silence * sample_rate)
        start = (count + silence) / sample_rate
        pieces += [np.zeros(silence, np.float32), np.asarray(spoken.sound.samples)]
        count += silence + len(spoken.sound.samples)
        words += [_move_word(word, place.begin, start) for word in spoken.words]
        phonemes += [_move_phoneme(phoneme, start) for phoneme in spoken.phonemes]
        accents += [start + time for time in spoken.accents]
    pieces.append(np.zeros(round(trailing * sample_rate), np.float32))
    sound = Sound.of(sample_rate, np.concatenate(pieces))
    return Utterance(
        sound.duration,
        place_marks(script, words, sound.duration),
        open_vowels_by_level(phonemes, sound),
        name,
        sound,
        _collect_remarks(script, name, (spoken for _, spoken in parts)),
        tuple(accents),
    )


def _move_word(word: SpokenWord, begin: int, start: float) -> SpokenWord:
    return SpokenWord(word.begin + begin, word.end + begin, word.start + start, word.stop + start)


def _move_phoneme(phoneme: Phoneme, start: float) -> Phoneme:
    return replace(
        phoneme,
        start=phoneme.start + start,
        onset=None if phoneme.onset is None else phoneme.onset + start,
        release=None if phoneme.release is None else phoneme.release + start,
    )


def _collect_remarks(script: Script, name: str, phrases: Iterable[SpokenPhrase]) -> tuple[str, ...]:
    """Return the distinct remarks of phrases, and one on ignored SSML elements."""
    ignored = sorted({e.element for e in script.emphases if e.element in IGNORED_ELEMENTS and e.begin < e.end})
    remarks = dict.fromkeys(remark for spoken in phrases for remark in spoken.remarks)
    if ignored:
        remarks[f"{name} has no effect of {', '.join(ignored)}: the text is spoken as usual"] = None
    return tuple(remarks)
