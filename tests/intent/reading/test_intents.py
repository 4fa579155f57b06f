"""Tests of intents found in a text: words, times and certainty."""

import re
from collections.abc import Mapping

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.intent.intents import Intent
from kinesic.intent.reading.language import Language, Rule, load_language
from kinesic.intent.reading.passage import Passage, Word
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text

LEXICON, ENGLISH = Lexicon.load(), load_language()
CATEGORY_CERTAINTIES = {"iconic": 0.45, "metaphoric": 0.38}
EMOTICON_CERTAINTY, EMPHASIS_BONUS, LONG_TEXT = 0.7, 0.25, 8


def rule(*, certainty: float = 0.5, reach: str = "word", lexemes: tuple[str, ...] = (), style: str = "") -> Rule:
    return Rule("meaning", "means it", certainty, "anywhere", reach, frozenset(), frozenset(), lexemes, style)


def language_with(rules: Mapping[str, Rule], tag: str = "en") -> Language:
    """Return a language with English word classes and the given rules."""
    return Language(tag, ENGLISH.classes, ENGLISH.emoticons, {tuple(k.split()): (v,) for k, v in rules.items()})


def intents(text: str, language: Language = ENGLISH, **options: bool) -> dict[str, list[Intent]]:
    results: dict[str, list[Intent]] = {}
    for intent in find_intents(read_text(text, language), language, LEXICON, **options):
        results.setdefault(intent.name, []).append(intent)
    return results


def meaning(text: str, **rules: Rule) -> tuple[Intent, Passage]:
    language = language_with({name.replace("_", " "): each for name, each in rules.items()})
    (intent,) = intents(text, language)["meaning"]
    return intent, read_text(text, language)


def test_text_without_words_has_no_intents() -> None:
    assert find_intents(read_text("... :-)", ENGLISH), ENGLISH, LEXICON) == ()


def test_intent_stroke_is_on_the_last_content_word_of_the_matched_phrase() -> None:
    intent, passage = meaning("he came back to us", came_back_to=rule())
    assert intent.word == 2
    assert passage.words[2].plain == "back"
    assert intent.start == passage.onset(1)
    assert intent.end == passage.close(3)
    assert intent.reason == "'came back to' means it"
    assert meaning("he was to us", to=rule())[0].word == 2, "without a content word the last one"


@pytest.mark.parametrize(("reach", "last"), [("word", 1), ("clause", 3), ("sentence", 6)])
def test_intent_of_a_language_rule_may_extend_to_the_clause_or_sentence(reach: str, last: int) -> None:
    text = "I never saw it, because he slept. He left"
    intent, passage = meaning(text, never=rule(reach=reach))
    assert intent.end == passage.close(last)
    assert intent.start == passage.onset(1)


def test_intent_has_the_gestures_and_style_of_its_language_rule() -> None:
    intent, _ = meaning("it is good", good=rule(lexemes=("A", "B"), style="joyful"))
    assert intent.lexemes == ("A", "B")
    assert intent.style == "joyful"


@pytest.mark.parametrize(
    ("text", "certainty"),
    [
        ("he came back", 0.5),
        ("he *came* back", 0.5 + EMPHASIS_BONUS),
        ("*he* came back", 0.5),
        ("he came *back*", 0.75),
    ],
)
def test_emphasis_increases_the_certainty_of_an_intent(text: str, certainty: float) -> None:
    assert meaning(text, came_back=rule())[0].certainty == pytest.approx(certainty)


def test_certainty_of_an_intent_is_at_most_one() -> None:
    assert meaning("he *came*", came=rule(certainty=0.9))[0].certainty == 1.0


def test_word_with_a_gesture_in_the_lexicon_gives_an_illustrating_intent() -> None:
    result = intents("They write in the rain")
    shown = {item.lexemes: item for name in CATEGORY_CERTAINTIES for item in result.get(name, [])}
    assert shown
    for (lexeme,), intent in shown.items():
        form = LEXICON.forms_by_id[lexeme]
        assert intent.name == form.category
        assert intent.certainty == CATEGORY_CERTAINTIES[form.category]
        assert f"{form.category} gesture" in intent.reason
        assert intent.word in (1, 4)
    emphatic = intents("They *write* in the rain")
    assert max(item.certainty for name in CATEGORY_CERTAINTIES for item in emphatic.get(name, [])) == pytest.approx(
        CATEGORY_CERTAINTIES[next(iter(shown.values())).name] + EMPHASIS_BONUS
    )


def test_only_english_content_words_of_sufficient_length_are_illustrated() -> None:
    def illustrated(words: tuple[Word, ...], language: str) -> list[str]:
        passage = Passage(words, ("statement",), language=language)
        result = find_intents(passage, language_with({}, language), LEXICON, begins=False, ends=False)
        return [intent.name for intent in result if intent.name in CATEGORY_CERTAINTIES]

    def word(plain: str, *, is_content: bool = True) -> tuple[Word, ...]:
        return (Word(plain, plain, "", 0, 0, is_content),)

    assert illustrated(word("write"), "en")
    assert not illustrated(word("write", is_content=False), "en")
    assert not illustrated(word("write"), "de")
    assert not illustrated(word("go"), "en")


@pytest.mark.parametrize(
    ("text", "name", "style"),
    [("I like it :-)", "emotion-joy", "joyful"), ("I lost it :-(", "emotion-sadness", "sad")],
)
def test_emoticon_gives_an_emotion_to_its_whole_sentence(text: str, name: str, style: str) -> None:
    shown = [intent for intent in intents(text)[name] if intent.certainty == EMOTICON_CERTAINTY]
    (intent,) = shown
    passage = read_text(text, ENGLISH)
    assert intent.style == style
    assert intent.start == passage.onset(0)
    assert intent.end == passage.close(2)
    assert intent.word == 2


@pytest.mark.parametrize(
    ("count", "begins", "looks"), [(LONG_TEXT, True, False), (LONG_TEXT + 1, True, True), (20, False, False)]
)
def test_only_a_long_text_at_the_start_of_a_turn_has_a_turn_begin_intent(count: int, begins: bool, looks: bool) -> None:
    text = " ".join(["word"] * count)
    result = intents(text, begins=begins)
    assert ("turn-begin" in result) == looks
    if looks:
        (intent,) = result["turn-begin"]
        passage = read_text(text, ENGLISH)
        assert intent.start.seconds == 0.0
        assert intent.stroke == intent.end == passage.close(2)


def test_text_has_intents_for_turn_begin_and_turn_end_by_default() -> None:
    text = " ".join(["word"] * 20)
    assert "turn-begin" in intents(text)
    assert "turn-end" in intents(text)


def test_reason_of_an_intent_quotes_words_of_the_text() -> None:
    passage = read_text("We saw apples, bread, cheese and wine yesterday", ENGLISH)
    for intent in find_intents(passage, ENGLISH, LEXICON):
        if quoted := re.match(r"'([^']*)'", intent.reason):
            assert quoted[1] in "We saw apples bread cheese and wine yesterday"
            last = intent.word
            assert quoted[1].split()[-1] == passage.words[last].text


def test_emoticon_in_a_sentence_without_words_has_no_emotion() -> None:
    passage = Passage(
        (Word("yes", "yes", "", 1, 0, is_content=True),), ("statement", "statement"), feelings=((0, "emotion-joy"),)
    )
    result = find_intents(passage, language_with({}), LEXICON)
    assert "emotion-joy" not in {item.name for item in result}


def test_turn_end_intent_is_on_the_last_word_of_the_text() -> None:
    (intent,) = intents("he came home")["turn-end"]
    assert intent.word == 2
    assert "turn-end" not in intents("he came home", ends=False)


@pytest.mark.parametrize(
    ("text", "ends", "phrases", "sentences"),
    [
        ("he came, he saw. He left", True, [1], [3]),
        ("he came, he saw. He left.", False, [1, 5], [3]),
        ("he came, he saw. He left", False, [1], [3]),
        ("he came", True, [], []),
        ("he came.", False, [1], []),
    ],
)
def test_phrases_and_sentences_have_boundary_intents_at_their_ends(
    text: str, ends: bool, phrases: list[int], sentences: list[int]
) -> None:
    result = intents(text, ends=ends)
    assert [item.word for item in result.get("boundary-phrase", [])] == phrases
    assert [item.word for item in result.get("boundary-sentence", [])] == sentences
    assert all(item.certainty > result["boundary-phrase"][0].certainty for item in result.get("boundary-sentence", []))


def test_intents_are_in_the_order_of_their_strokes() -> None:
    passage = read_text("No, he did *not* say that there were three boxes, because it rained. :-)", ENGLISH)
    result = find_intents(passage, ENGLISH, LEXICON)
    keys = [(item.stroke.seconds, -item.certainty) for item in result]
    assert keys == sorted(keys)
    assert len(result) > 5


def test_stroke_of_an_intent_is_within_its_duration_and_phrase() -> None:
    for intent in find_intents(read_text("the house, which he built, is red", ENGLISH), ENGLISH, LEXICON):
        if intent.word >= 0:
            assert intent.start.seconds <= intent.stroke.seconds <= intent.end.seconds
            assert intent.phrase == read_text("the house, which he built, is red", ENGLISH).words[intent.word].phrase
