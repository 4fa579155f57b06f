"""Tests of cues for places, directions, compared amounts and compared times."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")


def gestures(text: str) -> set[str]:
    """Return the gestures for a text."""
    _, selection = plan_behaviours(text, LEXICON, NEUTRAL, seed=0)
    return {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == "gesture"}


@pytest.mark.parametrize(
    ("text", "gesture"),
    [
        ("Ask the lady behind you.", "point_past_listener"),
        ("Somebody tapped me on the shoulder.", "own_shoulder"),
        ("I'm fed up to here with it.", "up_to_here"),
        ("We were squeezed together all night.", "hands_converge"),
        ("I'm warning you.", "warning_finger"),
        ("If only I had listened.", "palm_to_forehead"),
        ("It's hers, without exception.", "flat_hand_wipe"),
        ("This costs much more than mine.", "more_than"),
        ("It was gone in a flash.", "fast_off"),
    ],
)
def test_words_of_place_and_comparison_get_an_illustrating_gesture(text: str, gesture: str):
    assert gesture in gestures(text)


@pytest.mark.parametrize(
    ("text", "gesture"),
    [
        ("Put it all behind you.", "point_past_listener"),
        ("He has a chip on my shoulder.", "own_shoulder"),
        ("She was fed up to here with him.", "palm_to_forehead"),
        ("You are more than welcome.", "more_than"),
        ("Give me time.", "give_me"),
    ],
)
def test_place_words_in_other_senses_get_no_illustrating_gesture(text: str, gesture: str):
    assert gesture not in gestures(text)


@pytest.mark.parametrize(
    ("text", "gesture"),
    [
        ("It all boils down to trust.", "focus"),
        ("I beg to differ.", "open_low"),
        ("On top of that, the roof leaks.", "layers"),
        ("You have to admit it has its advantages.", "you_low"),
        ("Follow the river to the mill.", "path_along"),
        ("Go back the way you came.", "past_over_shoulder"),
        ("Keep left at the pub.", "left"),
        ("A kite circled over the field.", "circle_drawn"),
        ("The balloon drifted slowly across the lake.", "slow_glide"),
        ("She pushed the heavy gate open.", "open_door"),
    ],
)
def test_phrases_of_argument_direction_and_movement_get_an_illustrating_gesture(text: str, gesture: str):
    assert gesture in gestures(text)
