from dataclasses import dataclass, replace

import numpy as np
import pytest

from kinesic.body.utterance import Emphasis, Mark, Pause, Phoneme, Script, Sound
from kinesic.speech.durations import SENTENCE_PAUSE, DurationModel
from kinesic.speech.engines.engine_voice import MAX_CHARACTERS, EngineVoice
from kinesic.speech.engines.phrase import EngineError, Phrase, SpokenPhrase, SpokenWord

from .tone_engine import WORD_DURATION, ToneEngine

TONE_VOICE = EngineVoice(ToneEngine())  # voice whose words are tones
TIME_PRECISION = 0.001  # [s] accepted error of times, a few samples


def test_phrases_are_joined_with_the_silences_of_punctuation_and_pauses():
    script = Script("One two. Three", (Mark("two", 4), Mark("three", 9)), pauses=(Pause(4, 0.5),))
    utterance = TONE_VOICE.say(script)
    assert utterance.marks["two"] == pytest.approx(WORD_DURATION + 0.5, abs=TIME_PRECISION)
    assert utterance.marks["three"] == pytest.approx(2 * WORD_DURATION + 0.5 + SENTENCE_PAUSE, abs=TIME_PRECISION)
    assert utterance.duration == pytest.approx(3 * WORD_DURATION + 0.5 + SENTENCE_PAUSE, abs=TIME_PRECISION)
    assert utterance.sound is not None
    assert utterance.sound.duration == utterance.duration
    assert [phoneme.start for phoneme in utterance.phonemes] == pytest.approx(
        [0.0, utterance.marks["two"], utterance.marks["three"]], abs=TIME_PRECISION
    )
    assert utterance.accents == pytest.approx([phoneme.start for phoneme in utterance.phonemes], abs=TIME_PRECISION)


def test_requested_pause_keeps_its_length_at_half_and_double_speech_rate():
    for rate in (0.5, 2.0):
        plain = TONE_VOICE.say(Script("One two", (Mark("m", 4),), pauses=(Pause(4, 0.2),)), rate=rate)
        longer = TONE_VOICE.say(Script("One two", (Mark("m", 4),), pauses=(Pause(4, 0.9),)), rate=rate)
        assert longer.marks["m"] - plain.marks["m"] == pytest.approx(0.7, abs=TIME_PRECISION)
        assert longer.duration - plain.duration == pytest.approx(0.7, abs=TIME_PRECISION)
        assert plain.marks["m"] == pytest.approx(WORD_DURATION / rate + 0.2, abs=TIME_PRECISION)


def test_pauses_before_and_after_the_text_lengthen_the_utterance():
    utterance = TONE_VOICE.say(Script("One", (Mark("a", 0), Mark("b", 3)), pauses=(Pause(0, 0.3), Pause(3, 0.4))))
    assert utterance.duration == pytest.approx(0.7 + WORD_DURATION, abs=TIME_PRECISION)
    assert utterance.sound is not None
    audible = np.flatnonzero(utterance.sound.samples) / utterance.sound.rate
    assert (audible[0], audible[-1]) == pytest.approx((0.3, 0.3 + WORD_DURATION), abs=TIME_PRECISION)


@pytest.mark.parametrize("text", ["", "  ", "...", "?!"])
def test_text_without_words_lasts_as_long_as_its_pauses(text: str):
    utterance = TONE_VOICE.say(Script(text, (Mark("m", 0),), pauses=(Pause(len(text), 0.25, after=1),)))
    assert (utterance.duration, utterance.marks, utterance.phonemes) == (0.25, {"m": 0.0}, ())


def test_unreadable_phrase_is_left_out_with_a_remark():
    utterance = TONE_VOICE.say(Script("One. xx two", pauses=(Pause(5, 0.1), Pause(8, 0.1))))
    assert utterance.duration == pytest.approx(2 * WORD_DURATION + 0.1, abs=TIME_PRECISION)
    assert utterance.remarks == ("tones: no word of 'xx,' can be read: it is omitted",)


def test_text_without_a_readable_word_gives_no_sound_or_uses_the_fallback_voice():
    silent, substituted = TONE_VOICE.say(Script("xx")), EngineVoice(ToneEngine(), DurationModel()).say(Script("xx"))
    assert silent.sound is None
    assert "no word of the text can be read" in silent.remarks[0]
    assert "durations speaks instead" in substituted.remarks[0]


def test_text_above_the_length_limit_is_not_spoken():
    utterance = TONE_VOICE.say(Script("a " * MAX_CHARACTERS))
    assert utterance.sound is None
    assert f"{2 * MAX_CHARACTERS} characters" in utterance.remarks[0]


def test_unsupported_ssml_element_adds_a_remark():
    emphases = (Emphasis(0, 3, "say-as"), Emphasis(0, 3, "emphasis"))
    assert "say-as" in TONE_VOICE.say(Script("one", emphases=emphases)).remarks[0]
    assert TONE_VOICE.say(Script("one", emphases=emphases[1:])).remarks == ()


@dataclass(frozen=True)
class FaultyEngine:
    """Engine with one fault."""

    fault: str
    name: str = "faulty"

    def speak(self, phrase: Phrase, /) -> SpokenPhrase:
        """Return a spoken phrase with the fault."""
        spoken = ToneEngine().speak(phrase)
        word = SpokenWord(0, 3, 0.3, 0.4)
        if self.fault == "raises":
            raise EngineError("it broke")
        if self.fault == "rates" and phrase.text.startswith("Two"):
            return replace(spoken, sound=Sound.of(16000, spoken.sound.samples))
        faulty = {
            "silent": replace(spoken, sound=Sound.of(8000, np.zeros(100))),
            "nan": replace(spoken, sound=Sound.of(8000, [float("nan")])),
            "order": replace(spoken, phonemes=(Phoneme("a", 0.4, 0.1), Phoneme("b", 0.3, 0.1))),
            "infinite": replace(spoken, words=(replace(word, stop=float("inf")),)),
            "outside": replace(spoken, words=(replace(word, end=99),)),
        }
        return faulty.get(self.fault, spoken)


@pytest.mark.parametrize("fault", ["raises", "rates", "silent", "nan", "order", "infinite", "outside"])
def test_faulty_engine_gives_estimated_times_with_a_remark(fault: str):
    utterance = EngineVoice(FaultyEngine(fault)).say(Script("One. Two.", (Mark("m", 5),)))
    assert (utterance.voice, utterance.sound) == ("durations", None)
    assert utterance.marks == DurationModel().say(Script("One. Two.", (Mark("m", 5),))).marks
    assert utterance.remarks[0].startswith("no sound: faulty: ")


@pytest.mark.parametrize("reports", ["words", "nothing"])
def test_word_and_phoneme_times_that_an_engine_omits_are_estimated_from_its_sound(reports: str):
    utterance = EngineVoice(ToneEngine(reports)).say(Script("One two", (Mark("m", 4),)))
    assert utterance.marks["m"] == pytest.approx(WORD_DURATION, abs=0.05)
    assert len(utterance.phonemes) == len(DurationModel().say(Script("One two")).phonemes)
    assert utterance.phonemes[0].start < 0.02
    assert utterance.phonemes[-1].end == pytest.approx(utterance.duration, abs=0.02)


@pytest.mark.parametrize("kind", ["rate", "pitch"])
@pytest.mark.parametrize("value", [0.0, float("nan")])
def test_speech_rate_or_pitch_outside_its_range_is_rejected_by_an_engine_voice(kind: str, value: float):
    with pytest.raises(ValueError, match=f"{kind} is"):
        TONE_VOICE.say(Script("one"), **{kind: value})


def test_words_and_silence_between_sentences_scale_with_the_speech_rate():
    slow, quick = (TONE_VOICE.say(Script("One. Two", (Mark("m", 5),)), rate=rate) for rate in (0.5, 2.0))
    assert slow.marks["m"] == pytest.approx(4 * quick.marks["m"], abs=TIME_PRECISION)
