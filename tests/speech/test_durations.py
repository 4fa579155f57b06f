import pytest

from kinesic.body.utterance import Emphasis, Mark, Script
from kinesic.speech.durations import (
    MORA_DURATION,
    PHRASE_PAUSE,
    SENTENCE_PAUSE,
    SYLLABLE_DURATION,
    WORD_DURATION,
    DurationModel,
)

SILENT_VOICE = DurationModel()
SAMPLE_TEXT = (  # two sentences
    "Good morning, and welcome to our laboratory. My name is Kim, and I will show you what this robot can do. "
    "It has two arms with eight joints each; every motion that you will see was planned before it began."
)


def duration(text: str, language: str = "en") -> float:
    return SILENT_VOICE.say(Script(text, language=language)).duration


def test_estimated_english_speech_rate_is_150_to_180_words_per_minute():
    words_per_minute = len(SAMPLE_TEXT.split()) / duration(SAMPLE_TEXT) * 60
    assert 150 <= words_per_minute <= 180


def test_estimated_duration_of_a_single_letter_is_that_of_a_one_syllable_word():
    assert duration("a") == pytest.approx(SYLLABLE_DURATION + WORD_DURATION)


def test_words_with_more_syllables_take_longer():
    assert duration("banana") == pytest.approx(3 * SYLLABLE_DURATION + WORD_DURATION)


def test_punctuation_between_words_gives_a_pause():
    plain = duration("one two")
    assert duration("one, two") == pytest.approx(plain + PHRASE_PAUSE)
    assert duration("one\ntwo") == pytest.approx(plain)
    assert duration("one. two") == pytest.approx(plain + SENTENCE_PAUSE)


def test_successive_punctuation_marks_give_one_pause():
    assert duration("one, ... ?!\n two") == pytest.approx(duration("one. two"))


def test_silence_before_and_after_a_speech_is_omitted():
    assert duration("\n... one two.\n\n") == pytest.approx(duration("one two"))


def test_decimal_point_does_not_end_a_sentence():
    assert duration("3.5") == pytest.approx(duration("35"))


def test_chinese_or_japanese_character_is_one_mora():
    assert duration("こんにちは", "ja") == pytest.approx(5 * MORA_DURATION)
    assert duration("你好。世界", "zh") == pytest.approx(4 * MORA_DURATION + SENTENCE_PAUSE)


def test_speech_mark_falls_at_the_start_of_the_next_word():
    text = "one, two three"
    utterance = SILENT_VOICE.say(
        Script(text, (Mark("before", 0), Mark("two", 5), Mark("pause", 3), Mark("after", len(text))))
    )
    assert utterance.marks["before"] == 0.0
    assert utterance.marks["two"] == pytest.approx(duration("one") + PHRASE_PAUSE)
    assert utterance.marks["pause"] == utterance.marks["two"]
    assert utterance.marks["after"] == utterance.duration


def test_first_of_two_speech_marks_with_the_same_name_sets_the_time_of_that_name():
    utterance = SILENT_VOICE.say(Script("one two", (Mark("m", 0), Mark("m", 7))))
    assert utterance.marks == {"m": 0.0}


@pytest.mark.parametrize("text", ["", "   \n", "...", "?!"])
def test_empty_speech_has_an_estimated_duration_of_zero(text: str):
    utterance = SILENT_VOICE.say(Script(text, (Mark("m", 0), Mark("n", len(text)))))
    assert utterance.duration == 0.0
    assert utterance.marks == {"m": 0.0, "n": 0.0}
    assert utterance.phonemes == ()


def test_estimated_phonemes_fill_the_duration_of_a_word():
    utterance = SILENT_VOICE.say(Script("mama"))
    assert [phoneme.symbol for phoneme in utterance.phonemes] == ["m", "a", "m", "a"]
    assert utterance.phonemes[1].duration == pytest.approx(2 * utterance.phonemes[0].duration)
    assert sum(phoneme.duration for phoneme in utterance.phonemes) == pytest.approx(utterance.duration)


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_invalid_speech_rate_is_rejected(rate: float):
    with pytest.raises(ValueError, match="rate is"):
        SILENT_VOICE.say(Script("one"), rate=rate)


@pytest.mark.parametrize(
    ("rate", "factor"), [("slow", 1 / 0.8), ("50%", 2.0), ("+25%", 0.8), ("2", 0.5), ("loud", 1.0), ("1%", 5.0)]
)
def test_prosody_rate_changes_the_estimated_duration_of_its_own_words(rate: str, factor: float):
    text = "one two three"
    slowed = Emphasis(4, 7, "prosody", (("rate", rate),))
    plain, spoken = (
        SILENT_VOICE.say(Script(text, (Mark("two", 4), Mark("three", 8)), emphases=sections))
        for sections in ((), (slowed,))
    )
    lengths = [item.marks["three"] - item.marks["two"] for item in (plain, spoken)]
    assert lengths[1] == pytest.approx(factor * lengths[0])
    assert spoken.duration - plain.duration == pytest.approx(lengths[1] - lengths[0])
