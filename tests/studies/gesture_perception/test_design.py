"""Selection of gestures and of the wrong options beside the right one."""

from collections import Counter

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.studies.gesture_perception.design import (
    LABEL_WORDS,
    MEANING_CATEGORIES,
    OPTION_COUNT,
    OPTION_SEPARATOR,
    Meaning,
    draw_meanings,
    draw_questions,
)


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


def meant(*words: str) -> Meaning:
    return Meaning("_".join(words), Sense(words, "emblem"))


def test_random_seed_determines_the_gestures_drawn_for_a_study(lexicon: Lexicon):
    drawn = draw_meanings(lexicon, 48, 3)
    assert len({item.gesture for item in drawn}) == 48
    assert {item.sense.category for item in drawn} <= set(MEANING_CATEGORIES)
    assert drawn == draw_meanings(lexicon, 48, 3)
    assert drawn != draw_meanings(lexicon, 48, 4)


def test_study_of_listed_gestures_contains_exactly_these_gestures(lexicon: Lexicon):
    assert {meaning.gesture for meaning in draw_meanings(lexicon, 6, 0, ("beat", "stop"))} == {"beat", "stop"}


@pytest.mark.parametrize("seed", range(5))
def test_wrong_meanings_are_offered_almost_equally_often(lexicon: Lexicon, seed: int):
    meanings = draw_meanings(lexicon, 48, seed)
    questions = draw_questions(meanings, seed)
    assert [question.right for question in questions] == list(meanings)
    offered = Counter(foil.gesture for question in questions for foil in question.foils)
    assert set(offered) == {meaning.gesture for meaning in meanings}
    assert max(offered.values()) - min(offered.values()) <= 2
    for question in questions:
        assert len({option.gesture for option in question.options}) == OPTION_COUNT
        assert len({option.label for option in question.options}) == OPTION_COUNT
    assert questions == draw_questions(meanings, seed)


def test_options_of_a_question_share_no_word(lexicon: Lexicon):
    for question in draw_questions(draw_meanings(lexicon, 300, 1), 1):
        words = [word for option in question.options for word in option.sense.words[:LABEL_WORDS]]
        assert len(words) == len(set(words))


def test_options_of_a_question_have_pairwise_dissimilar_meanings():
    families = ("sea", "fire", "drum", "sleep", "stop", "photo")
    meanings = [meant(name, f"{name}{k}") for k in "xyz" for name in families]
    for question in draw_questions(meanings, 0):
        assert sorted(option.sense.words[0] for option in question.options) == sorted(families)


def test_gesture_meanings_with_a_common_word_are_similar():
    hello = meant("hello", "hi", "wave", "bye")
    assert hello.is_similar(meant("sea", "ocean", "water", "waves")), "an inflection beyond the shown label"
    assert meant("sea", "ocean", "water", "waves").is_similar(hello)
    assert not hello.is_similar(meant("stop", "halt", "wait"))
    assert hello.label == "hello, hi, wave"


def test_gesture_study_with_too_few_different_meanings_is_refused(lexicon: Lexicon):
    with pytest.raises(ConfigError, match="has only 1 different meanings among 2 gestures and needs 5"):
        draw_questions(draw_meanings(lexicon, 6, 0, ("stop", "piano")), 0)


@pytest.mark.parametrize(
    ("named", "what"), [(("stopp",), "no gesture stopp.*did you mean stop"), (("stop", "stop"), "named 2 times")]
)
def test_unknown_gesture_names_of_a_study_are_refused(lexicon: Lexicon, named: tuple[str, ...], what: str):
    with pytest.raises(ConfigError, match=what):
        draw_meanings(lexicon, 6, 0, named)


def test_lexicon_names_do_not_contain_the_answer_separator(lexicon: Lexicon):
    assert not [form.id for form in lexicon.forms if OPTION_SEPARATOR in form.id]
