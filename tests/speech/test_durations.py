import pytest

from kinesic.body.utterance import Mark, Script
from kinesic.speech.durations import MORA, PHRASE_PAUSE, SENTENCE_PAUSE, SYLLABLE, WORD, DurationModel

VOICE = DurationModel()
SPEECH = (
    "Good morning, and welcome to our laboratory. My name is Kim, and I will show you what this robot can do. "
    "It has two arms with eight joints each; every motion that you will see was planned before it began."
)


def duration(text: str, language: str = "en") -> float:
    return VOICE.say(Script(text, language=language)).duration


def test_english_is_spoken_at_150_to_180_words_a_minute():
    words_per_minute = len(SPEECH.split()) / duration(SPEECH) * 60
    assert 150 <= words_per_minute <= 180


def test_one_letter_is_a_word():
    assert duration("a") == pytest.approx(SYLLABLE + WORD)


def test_more_syllables_take_longer():
    assert duration("banana") == pytest.approx(3 * SYLLABLE + WORD)


def test_punctuation_between_words_is_a_pause():
    plain = duration("one two")
    assert duration("one, two") == pytest.approx(plain + PHRASE_PAUSE)
    assert duration("one\ntwo") == pytest.approx(plain)
    assert duration("one. two") == pytest.approx(plain + SENTENCE_PAUSE)


def test_the_longest_pause_counts_once():
    assert duration("one, ... ?!\n two") == pytest.approx(duration("one. two"))


def test_silence_at_the_ends_is_left_out():
    assert duration("\n... one two.\n\n") == pytest.approx(duration("one two"))


def test_a_decimal_point_is_no_sentence():
    assert duration("3.5") == pytest.approx(duration("35"))


def test_a_chinese_or_japanese_character_is_one_mora():
    assert duration("こんにちは", "ja") == pytest.approx(5 * MORA)
    assert duration("你好。世界", "zh") == pytest.approx(4 * MORA + SENTENCE_PAUSE)


def test_a_mark_falls_where_the_next_word_starts():
    text = "one, two three"
    said = VOICE.say(Script(text, (Mark("before", 0), Mark("two", 5), Mark("pause", 3), Mark("after", len(text)))))
    assert said.marks["before"] == 0.0
    assert said.marks["two"] == pytest.approx(duration("one") + PHRASE_PAUSE)
    assert said.marks["pause"] == said.marks["two"]
    assert said.marks["after"] == said.duration


def test_of_marks_with_the_same_name_the_first_counts():
    said = VOICE.say(Script("one two", (Mark("m", 0), Mark("m", 7))))
    assert said.marks == {"m": 0.0}


@pytest.mark.parametrize("text", ["", "   \n", "...", "?!"])
def test_nothing_to_say_takes_no_time(text: str):
    said = VOICE.say(Script(text, (Mark("m", 0), Mark("n", len(text)))))
    assert said.duration == 0.0
    assert said.marks == {"m": 0.0, "n": 0.0}
    assert said.phonemes == ()


def test_phonemes_fill_a_word():
    said = VOICE.say(Script("mama"))
    assert [phoneme.symbol for phoneme in said.phonemes] == ["m", "a", "m", "a"]
    assert said.phonemes[1].duration == pytest.approx(2 * said.phonemes[0].duration)
    assert sum(phoneme.duration for phoneme in said.phonemes) == pytest.approx(said.duration)


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_a_rate_that_is_none_is_refused(rate: float):
    with pytest.raises(ValueError, match="rate is"):
        VOICE.say(Script("one"), rate=rate)
