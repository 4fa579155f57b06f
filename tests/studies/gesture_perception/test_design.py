"""Which gestures a study asks for, and the wrong meanings beside the right one."""

from collections import Counter

import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.studies.gesture_perception.design import (
    CATEGORIES,
    OPTIONS,
    SEPARATOR,
    WORDS,
    Meaning,
    draw_meanings,
    draw_questions,
)


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


def meant(*words: str) -> Meaning:
    return Meaning("_".join(words), Sense(words, "emblem"))


def test_gestures_are_drawn_by_seed_from_those_that_mean_something_alone(lexicon: Lexicon):
    drawn = draw_meanings(lexicon, 48, 3)
    assert len({each.gesture for each in drawn}) == 48
    assert {each.sense.category for each in drawn} <= set(CATEGORIES)
    assert drawn == draw_meanings(lexicon, 48, 3)
    assert drawn != draw_meanings(lexicon, 48, 4)


def test_named_gestures_are_taken_all(lexicon: Lexicon):
    assert {each.gesture for each in draw_meanings(lexicon, 6, 0, ("beat", "stop"))} == {"beat", "stop"}


@pytest.mark.parametrize("seed", range(5))
def test_every_meaning_is_offered_with_five_others_and_about_as_often_as_any(lexicon: Lexicon, seed: int):
    meanings = draw_meanings(lexicon, 48, seed)
    questions = draw_questions(meanings, seed)
    assert [question.right for question in questions] == list(meanings)
    offered = Counter(foil.gesture for question in questions for foil in question.foils)
    assert set(offered) == {each.gesture for each in meanings}
    assert max(offered.values()) - min(offered.values()) <= 2
    for question in questions:
        assert len({option.gesture for option in question.options}) == OPTIONS
        assert len({option.label for option in question.options}) == OPTIONS
    assert questions == draw_questions(meanings, seed)


def test_no_two_meanings_of_a_question_share_a_word(lexicon: Lexicon):
    for question in draw_questions(draw_meanings(lexicon, 300, 1), 1):
        words = [word for option in question.options for word in option.sense.words[:WORDS]]
        assert len(words) == len(set(words))


def test_wrong_meanings_are_not_like_one_another():
    families = ("sea", "fire", "drum", "sleep", "stop", "photo")
    meanings = [meant(name, f"{name}{k}") for k in "xyz" for name in families]
    for question in draw_questions(meanings, 0):
        assert sorted(option.sense.words[0] for option in question.options) == sorted(families)


def test_meanings_are_alike_when_a_word_of_one_speaks_of_the_other():
    hello = meant("hello", "hi", "wave", "bye")
    assert hello.like(meant("sea", "ocean", "water", "waves")), "an inflection, behind what participants read"
    assert meant("sea", "ocean", "water", "waves").like(hello)
    assert not hello.like(meant("stop", "halt", "wait"))
    assert hello.label == "hello, hi, wave"


def test_too_few_different_meanings_are_told(lexicon: Lexicon):
    with pytest.raises(ConfigError, match="finds 1 other meanings among 2 gestures, and needs 5"):
        draw_questions(draw_meanings(lexicon, 6, 0, ("stop", "piano")), 0)


@pytest.mark.parametrize(
    ("named", "what"), [(("stopp",), "no gesture stopp.*did you mean stop"), (("stop", "stop"), "named 2 times")]
)
def test_wrong_names_are_told(lexicon: Lexicon, named: tuple[str, ...], what: str):
    with pytest.raises(ConfigError, match=what):
        draw_meanings(lexicon, 6, 0, named)


def test_no_gesture_of_ours_has_the_separator_of_answers_in_its_name(lexicon: Lexicon):
    assert not [form.id for form in lexicon.forms if SEPARATOR in form.id]
