import pytest

from kinesic.body.utterance import Emphasis, Pause, Script
from kinesic.speech.durations import PHRASE_PAUSE, SENTENCE_PAUSE
from kinesic.speech.engines.phrase import Phrase, ProsodySection
from kinesic.speech.engines.phrasing import MAX_PHRASE_LENGTH, divide


def divide_texts(script: Script) -> list[tuple[str, float]]:
    return [(place.phrase.text, place.silence) for place in divide(script, rate=1.0, pitch=1.0)[0]]


@pytest.mark.parametrize(
    ("text", "sentences"),
    [
        ("One. Two!", ["One.", "Two!"]),
        ('He said "no." Then left.', ['He said "no."', "Then left."]),
        ("Dr. Smith and J. Doe met Mrs. Low.", ["Dr. Smith and J. Doe met Mrs. Low."]),
        ("It is Jan. 5th. So am I. Good.", ["It is Jan. 5th.", "So am I.", "Good."]),
        ("Well... then go. 3.5 is small.", ["Well... then go.", "3.5 is small."]),
        ("one, two; three", ["one, two; three"]),
    ],
)
def test_text_is_divided_at_sentence_ends(text: str, sentences: list[str]):
    silences = [0.0] + [SENTENCE_PAUSE] * (len(sentences) - 1)
    assert divide_texts(Script(text)) == list(zip(sentences, silences, strict=True))


def test_pause_divides_a_sentence_and_the_part_before_it_ends_with_a_comma():
    script = Script("It is large, I think.", pauses=(Pause(6, 0.4), Pause(13, 0.05), Pause(13, 0.1)))
    assert divide_texts(script) == [("It is,", 0.0), ("large,", 0.4), ("I think.", PHRASE_PAUSE)]


def test_pause_requested_inside_a_word_is_placed_after_the_word():
    assert divide_texts(Script("don't go", pauses=(Pause(4, 0.4),))) == [("don't,", 0.0), ("go", 0.4)]


def test_dividing_a_text_into_phrases_returns_the_pauses_before_and_after_it():
    placed, trailing = divide(Script(" one ", pauses=(Pause(0, 0.2), Pause(5, 0.3))), rate=1.0, pitch=1.0)
    assert [(place.phrase.text, place.begin, place.silence) for place in placed] == [("one", 1, 0.2)]
    assert trailing == 0.3


def test_higher_speech_rate_shortens_silences_of_punctuation_but_not_requested_pauses():
    script = Script("One. Two", pauses=(Pause(0, 0.2),))
    first, second = divide(script, rate=2.0, pitch=1.5)[0]
    assert (first.silence, second.silence) == (0.2, SENTENCE_PAUSE / 2)
    assert second.phrase == Phrase("Two", "en", 2.0, 1.5)


def test_long_sentence_is_split_into_phrases_of_limited_length_preferably_at_commas():
    clause = "word " * 20 + "end, "
    for text in (clause * 10, "word " * 200, "x" * 1000):
        parts = divide(Script(text), rate=1.0, pitch=1.0)[0]
        assert all(len(place.phrase.text) <= MAX_PHRASE_LENGTH + 1 for place in parts)
        assert (
            "".join(place.phrase.text.rstrip(",") for place in parts).replace(" ", "")
            == text.replace(",", "").replace(" ", "")
            or "," in text
        )
    assert all(place.phrase.text.endswith("end,") for place in divide(Script(clause * 10), rate=1.0, pitch=1.0)[0])


def test_prosody_section_across_two_sentences_is_clipped_to_each_of_them():
    slow = Emphasis(2, 9, "prosody", (("rate", "slow"),))
    first, second = divide(Script("One. Two three", emphases=(slow,)), rate=1.0, pitch=1.0)[0]
    assert first.phrase.sections == (ProsodySection(2, 4, rate=0.8),)
    assert second.phrase.sections == (ProsodySection(0, 4, rate=0.8),)
