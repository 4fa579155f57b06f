"""Tests of gestures for sizes of things, for welcomes and for farewells."""

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.pacing.memory import NO_MEMORY, ChoiceMemory, PastGesture

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")
SMALL = {"small_pinch", "tiny_low", "narrow_low"}


def gestures(text: str, memory: ChoiceMemory = NO_MEMORY) -> set[str]:
    """Return the gestures for a text, without beats."""
    _, selection = plan_behaviours(text, LEXICON, NEUTRAL, seed=3, memory=memory)
    shown = {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == "gesture"}
    return {name for name in shown if not name.startswith("beat")}


def test_size_before_a_thing_gets_one_size_gesture() -> None:
    for text, fitting in [
        ("The bakery has a big oven.", {"large"}),
        ("The workshop has spacious old halls.", {"large"}),
        ("The guests sleep in a little wooden cabin.", SMALL),
        ("The shelves hold very small bottles.", SMALL),
        ("The barn has a high roof.", {"tall"}),
        ("The cellar has a low brown ceiling.", {"flat_hand_level"}),
        ("The sailor has a short rope.", {"narrow_low", "between_fingers"}),
    ]:
        shown = gestures(text)
        assert len(shown) == 1, text
        assert shown <= fitting, text


def test_size_of_a_detail_or_of_nothing_concrete_gets_no_size_gesture() -> None:
    sizes = {*SMALL, "large", "tall", "flat_hand_level", "between_fingers"}
    for text in [
        "The firm was called after a small cat.",
        "The tailor lives near the big church.",
        "The council made a long speech.",
        "The firm keeps a low profile.",
        "The company pays a high price.",
        "The report describes a small risk.",
    ]:
        assert not gestures(text) & sizes, text


def test_hope_to_meet_again_is_a_farewell_but_joy_at_meeting_again_is_a_welcome() -> None:
    waves = {"wave_small", "wave_low"}
    for text in [
        "We hope to see you back soon.",
        "I look forward to welcoming you again.",
        "Hope you'll visit us again.",
        "See you again on Friday!",
        "Until we meet again!",
    ]:
        assert gestures(text) & waves, text
    assert "welcome" in gestures("How lovely to see you again!")
    assert not gestures("I cannot hope to see you again.") & {*waves, "welcome"}


def test_welcome_to_a_place_opens_the_arms_even_after_a_greeting() -> None:
    for text in ("Hi there, and welcome to our bakery!", "Good afternoon, welcome aboard.", "Welcome to the library."):
        assert "welcome" in gestures(text), text


def test_recently_shown_gesture_is_replaced_by_another_one_of_its_meaning() -> None:
    waves = tuple(PastGesture(name, seconds, "") for seconds, name in enumerate(("wave_small", "wave_low")))
    assert gestures("Goodbye, everyone!", ChoiceMemory(waves, 12.0, 1)) == {"greet_wave"}
    pinches = tuple(PastGesture(name, seconds, "") for seconds, name in enumerate(("small_pinch", "tiny_low")))
    assert gestures("The ring has a tiny pearl.", ChoiceMemory(pinches, 12.0, 1)) == {"narrow_low"}
    everything = (*waves, PastGesture("greet_wave", 3.0, ""))
    assert not gestures("Goodbye, everyone!", ChoiceMemory(everything, 12.0, 1))
