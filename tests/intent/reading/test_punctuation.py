"""Tests of sentences, phrases, emphasis and pauses by punctuation."""

import pytest

from kinesic.intent.reading.language import Language, load_language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.words import read_text

ENGLISH = load_language()
DASH_PAUSE, ELLIPSIS_PAUSE, LONGEST_BREAK = 0.15, 0.4, 10.0  # [s]


def read(text: str, language: Language = ENGLISH) -> Passage:
    return read_text(text, language)


def plain(text: str) -> list[str]:
    return [word.plain for word in read(text).words]


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        ("", []),
        ("...", []),
        ("It rains", ["statement"]),
        ("It rains. It snows!", ["statement", "exclamation"]),
        ("Does it rain? Yes.", ["question", "statement"]),
        ("Really?! No!? Oh!", ["question", "question", "exclamation"]),
        ("It rains! ?", ["question"]),
        ("It rains. !", ["statement"]),
        ("Dr. Brown met Prof. Gray.", ["statement"]),
        ("Plan B. starts", ["statement"]),
        ("It is for I. You know", ["statement", "statement"]),
        ("He ate 3. She ate 4.", ["statement", "statement"]),
        ("It costs 3.50 or 1,000.", ["statement"]),
        ('He said "yes." She left.', ["statement", "statement"]),
        ("Dr.! Brown", ["exclamation", "statement"]),
        ("\uff01 Yes\uff1f No\uff01", ["question", "exclamation"]),
    ],
)
def test_sentences_end_at_stops_but_not_at_abbreviations(text: str, kinds: list[str]) -> None:
    assert list(read(text).kinds) == kinds


def test_words_have_the_index_of_their_sentence() -> None:
    assert [word.sentence for word in read("It rains. Does it? Yes").words] == [0, 0, 1, 1, 2]


@pytest.mark.parametrize(
    ("text", "phrases"),
    [
        ("one two three", [0, 0, 0]),
        ("one, two; three: four", [0, 1, 2, 3]),
        ("one (two) three", [0, 1, 2]),
        ("one - two -- three \u2014 four", [0, 1, 2, 3]),
        ("well-known words", [0, 0]),
        ("one... two", [0, 1]),
        ("one. two", [0, 1]),
        ("big dogs and cats", [0, 0, 0, 0]),
        ("very big old dogs and cats", [0, 0, 0, 0, 1, 1]),
        ("three old dogs and cats", [0, 0, 0, 0, 0]),
        ("yes, big old dogs and cats", [0, 1, 1, 1, 1, 1]),
        ("one 'two' three", [0, 0, 0]),
        ("one \u201ctwo\u201d three", [0, 1, 2]),
    ],
)
def test_phrases_end_at_punctuation_or_before_a_conjunction(text: str, phrases: list[int]) -> None:
    assert [word.phrase for word in read(text).words] == phrases


@pytest.mark.parametrize(
    ("text", "pauses"),
    [
        ("one two", [0.0, 0.0]),
        ("one, two", [0.0, 0.0]),
        ("one... two", [0.0, ELLIPSIS_PAUSE]),
        ("one \u2026 two", [0.0, ELLIPSIS_PAUSE]),
        ("one - two", [0.0, DASH_PAUSE]),
        ("one -- ... two", [0.0, DASH_PAUSE + ELLIPSIS_PAUSE]),
        ('one <break time="1500ms"/> two', [0.0, 1.5]),
        ('one <break time="2s"/> - two three', [0.0, 2.0 + DASH_PAUSE, 0.0]),
        ('one <break time="11s"/> two', [0.0, LONGEST_BREAK]),
    ],
)
def test_pause_by_punctuation_or_break_tag_precedes_the_next_word(text: str, pauses: list[float]) -> None:
    assert [word.pause for word in read(text).words] == pytest.approx(pauses)


def test_ellipsis_after_the_last_word_gives_a_trailing_pause() -> None:
    passage = read("one ...")
    assert passage.tail_pause == ELLIPSIS_PAUSE
    assert passage.tail == "..."
    assert read("one").tail_pause == 0.0


@pytest.mark.parametrize(
    ("text", "emphatic"),
    [
        ("we *never* do", ["never"]),
        ("we **never ever** do", ["never", "ever"]),
        ("we _never_ do", ["never"]),
        ("snake_case words", []),
        ("we NEVER do", ["never"]),
        ("we DO", ["do"]),
        ("plan B works", []),
        ("the USA is large", []),
        ("NEVER EVER DO THIS", []),
        ("I DID SO <b>today or tomorrow</b>", ["did", "so"]),
        ("GO", ["go"]),
        ("<emphasis>we</emphasis> do", ["we"]),
    ],
)
def test_emphasis_is_written_by_asterisks_capitals_or_tags(text: str, emphatic: list[str]) -> None:
    assert [word.plain for word in read(text).words if word.emphatic] == emphatic


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("We NEVER do", ["We", "never", "do"]),
        ("Don\u2019t!", ["Don\u2019t"]),
        ("NEVER DO A THING", ["never", "do", "A", "thing"]),
        ("the USA is", ["the", "USA", "is"]),
    ],
)
def test_words_in_capitals_are_spoken_in_lower_case_except_acronyms(text: str, spoken: list[str]) -> None:
    assert [word.text for word in read(text).words] == spoken


def test_words_may_contain_numbers_and_inner_punctuation() -> None:
    assert plain("Don\u2019t pay 1,000.50 or 20% on the 3rd!") == [
        "don't", "pay", "1,000.50", "or", "20%", "on", "the", "3rd",
    ]  # fmt: skip
    assert plain("one\x00two\ufeffthree") == ["one", "two", "three"]


def test_punctuation_and_spaces_between_words_are_kept() -> None:
    words = read("Well,  then - go").words
    assert [word.before for word in words] == ["", ", ", ", "]
    assert [words[0].end, words[1].end, words[2].end] == [4, 11, 16]


def test_function_words_are_not_content_words() -> None:
    assert [word.plain for word in read("the rain was on my house").words if word.is_content] == ["rain", "house"]


@pytest.mark.parametrize(
    ("text", "feelings"),
    [
        ("I like it :-)", [(0, "emotion-joy")]),
        ("I like it. :-) He went.", [(0, "emotion-joy")]),
        (":-) I like it.", [(0, "emotion-joy")]),
        ("He went. I like it :-)", [(1, "emotion-joy")]),
        ("He went. I like it. :-)", [(1, "emotion-joy")]),
        ("x:-)", []),
        (":-)", []),
    ],
)
def test_emoticons_give_an_emotion_to_their_sentence(text: str, feelings: list[tuple[int, str]]) -> None:
    assert [(sentence, name) for sentence, name in read(text).feelings] == feelings


@pytest.mark.parametrize(
    ("text", "is_over"), [("", True), ("one", False), ("one,", True), ("one.", True), ("one -- ", True), ("Dr.", False)]
)
def test_streamed_phrase_is_complete_after_punctuation_but_not_after_abbreviations(text: str, is_over: bool) -> None:
    assert read(text).is_over == is_over
