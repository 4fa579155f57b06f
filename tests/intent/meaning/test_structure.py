"""Tests of gestures that follow from the structure of a sentence."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.behaviours import ChosenBehaviour

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")


def gestures_of(text: str) -> list[ChosenBehaviour]:
    behaviours = plan_behaviours(text, LEXICON, NEUTRAL)[1].behaviours
    return [behaviour for behaviour in behaviours if behaviour.channel == "gesture"]


def shown(text: str) -> dict[str, int]:
    """Return the gestures of a text with the indices of their words."""
    return {behaviour.lexeme: behaviour.intent.word for behaviour in gestures_of(text)}


def test_successive_bare_numbers_are_counted_on_the_fingers() -> None:
    assert shown("He goes past one, goes past two, and shoots!")["count_one"] == 3
    assert "count_one" not in shown("I saw one, and she saw one.")
    assert "count_one" not in shown("One is cheap, two are dear.")


def test_short_final_clause_with_not_gets_a_denying_gesture() -> None:
    assert shown("You lift it with the knees, not with the back.")["no_low"] == 6
    assert "no_low" not in shown("They came for the view, not only for the food.")
    assert "no_low" not in shown("You lift it with the knees, not with the back, as I said before.")


def test_second_of_two_compared_degrees_gets_the_gesture_of_contrast() -> None:
    assert shown("This one's heavier, but that one's stronger.")["contrast_left_right"] == 6
    assert "contrast_left_right" not in shown("This one is heavier, that one is stronger, and mine is newer.")
    assert "contrast_left_right" not in shown("This one's heavier than iron.")


@pytest.mark.parametrize("quote", ['"{}"', "\u201c{}\u201d"])
def test_reported_speaker_between_commas_is_not_read_as_a_list_item(quote: str) -> None:
    text = f"{quote.format('Get out,')} she shouted, {quote.format('and close the door!')}"
    assert not any("of a list" in each.intent.reason for each in gestures_of(text))
    assert any("of a list" in each.intent.reason for each in gestures_of("Get milk, flour, and butter."))


def test_word_repeated_after_by_gets_a_gesture_of_repeated_placing() -> None:
    assert shown("Brick by brick, they built a tower.")["one_after_another"] == 2
    assert "one_after_another" not in shown("They built a tower by hand, by day.")


def test_opening_word_such_as_well_gets_no_beat_unless_it_is_emphasised() -> None:
    assert all(each.intent.word > 0 for each in gestures_of("Well, the old captain described the whole story."))
    assert any(each.intent.word == 0 for each in gestures_of("*Well*, the old captain described the whole story."))
