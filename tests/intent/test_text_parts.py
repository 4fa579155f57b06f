"""Tests of the division of long texts into parts."""

import pytest

from kinesic.intent import text_parts
from kinesic.intent.manuscript.reading import read_manuscript
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.prosody import NO_LAYERS
from kinesic.intent.reading.words import read_text
from kinesic.intent.text_parts import divide_long_text

SENTENCE = "The old boat lay in the sand."


@pytest.fixture(autouse=True)
def _short_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Divide texts of more than 40 words into parts of 10 to 20 words."""
    monkeypatch.setattr(text_parts, "MAX_TEXT_WORDS", 40)
    monkeypatch.setattr(text_parts, "MIN_PART_WORDS", 10)
    monkeypatch.setattr(text_parts, "MAX_PART_WORDS", 20)


def words_of(spoken: str, language: str = "en") -> list[str]:
    return [word.text for word in read_text(spoken, load_language(language)).words]


def lengths(text: str, language: str = "en") -> list[int]:
    return [len(words_of(part.text, language)) for part in divide_long_text(text, language=language)]


def test_text_that_fits_into_one_plan_has_one_part():
    text = " ".join(["word"] * 40)
    assert [part.text for part in divide_long_text(text)] == [text]
    assert len(divide_long_text(f"{text} word")) > 1


def test_parts_contain_all_words_of_the_text_in_order():
    text = "\n\n".join(f"# Chapter {k}\n\n{SENTENCE} It cost {k * 117} euros, *really*!" for k in range(12))
    parts = divide_long_text(text)
    whole = words_of(read_manuscript(text)[0])
    assert [word for part in parts for word in words_of(part.text)] == whole


def test_parts_end_at_the_last_paragraph_within_their_length():
    assert lengths("\n\n".join([SENTENCE] * 12)) == [14, 14, 14, 14, 14, 14]
    paragraph = f"{SENTENCE} {SENTENCE}"
    assert lengths("\n\n".join(["It was."] + [paragraph] * 3)) == [16, 14, 14]


def test_part_without_a_paragraph_ends_after_the_punctuation_of_a_sentence():
    parts = divide_long_text(" ".join(['"The old boat lay in the sand."'] * 8))
    assert [part.text[-7:] for part in parts] == [' sand."'] * len(parts)


def test_text_without_sentences_is_divided_between_phrases_or_words():
    assert lengths("old boats, new sails, " * 12) == [20, 20, 8]
    assert lengths("boat " * 45) == [20, 20, 5]


def test_number_of_several_words_stays_in_one_part():
    text = "boat " * 18 + "555-867-5309 " + "boat " * 30  # the number has three words
    assert lengths(text)[0] == 18
    assert "555-867-5309" in divide_long_text(text)[1].text


def test_warnings_about_omitted_text_are_those_of_the_first_part():
    parts = divide_long_text(f"{SENTENCE} " * 8 + "\n```\ncode\n```\n")
    assert len(parts) > 1
    assert parts[0].warnings
    assert not any(part.warnings for part in parts[1:])


def test_voice_of_a_long_passage_is_kept_in_the_next_part():
    parts = divide_long_text(f'<speak><prosody rate="slow">{" ".join([SENTENCE] * 8)}</prosody></speak>')
    layers = {word.prosody for part in parts for word in read_text(part.text, load_language("en")).words}
    assert len(parts) > 1
    assert len(layers) == 1
    assert layers != {NO_LAYERS}


def test_voice_that_changes_between_two_parts_is_that_of_the_whole_text():
    slow = f'<prosody rate="slow">{SENTENCE} {SENTENCE}</prosody>'
    text = f"<speak>{SENTENCE} {SENTENCE} {slow} {SENTENCE} {SENTENCE} {slow}</speak>"
    english, parts = load_language("en"), divide_long_text(text)
    whole = read_text(read_manuscript(text)[0], english).words
    assert len(parts) == 4
    assert [word.prosody for part in parts for word in read_text(part.text, english).words] == [
        word.prosody for word in whole
    ]


def test_unspaced_language_is_divided_between_sentences():
    sentence = "\u53e4\u3044\u8239\u306f\u7802\u306e\u4e0a\u306b\u3042\u3063\u305f\u3002"
    parts = divide_long_text(sentence * 12, language="ja")
    assert len(parts) > 1
    assert "".join(part.text for part in parts) == sentence * 12
    assert all(part.text.endswith("\u3002") for part in parts)


def test_only_lines_of_the_chosen_speaker_are_in_the_parts():
    text = f"ANNA: {SENTENCE}\nBEN: No, it did not.\n" * 12
    assert "not" not in " ".join(part.text for part in divide_long_text(text, character="anna"))
