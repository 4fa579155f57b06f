"""Tests of words in other senses than their gesture shows."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours

LEXICON, NEUTRAL = Lexicon.load(), Style.load("neutral")


def shown(text: str, channel: str = "gesture") -> set[str]:
    """Return the lexemes of one channel for a text."""
    _, selection = plan_behaviours(text, LEXICON, NEUTRAL, seed=0)
    return {behaviour.lexeme for behaviour in selection.behaviours if behaviour.channel == channel}


def is_beat(lexemes: set[str]) -> bool:
    return all(lexeme.startswith("beat") for lexeme in lexemes)


@pytest.mark.parametrize(
    ("literal", "other", "gesture"),
    [
        ("We climbed up the tower.", "Temperatures climbed up the scale.", "climb_ladder"),
        ("My bag is so heavy.", "The traffic is so heavy.", "lift_weight"),
        ("I opened the door.", "I opened the letter.", "open_door"),
        ("Cut along the line.", "We were cut off.", "cut"),
        ("It's the second door on the right.", "The right answer is no.", "right"),
        ("I'm so hot today.", "The soup is so hot today.", "wipe_brow"),
        ("Turn the radio down!", "Heat the oil and turn it down.", "quieter"),
        ("The moon was shining overhead.", "Our overhead costs are huge.", "up"),
        ("Sorry, I was miles away.", "The shop is ten miles away.", "dream_off"),
        ("We ran down the hill.", "Tears ran down my face.", "run"),
        ("Then I stretched it out.", "Then I stretched out my hand.", "pull_thread"),
        ("It broke in two.", "The bell rings in two minutes.", "break_apart"),
        ("Turn left at the oak.", "My left knee hurts.", "left"),
        ("Who knows!", "Ask a man who knows about cars.", "shrug_small"),
        ("The exam was a piece of cake.", "I had a piece of cake.", "thumb_up"),
        ("Look at the time!", "I lived in Rome at the time.", "watch_time"),
        ("Hold it!", "Breathe in and hold it.", "stop_low"),
        ("I stood in the middle of the road.", "I was in the middle of a chapter.", "between_fingers"),
        ("He scratched his head.", "He scratched the table.", "head_scratch"),
        ("She yawned.", "She was young.", "yawn"),
        ("The ball sailed over the bar.", "We sailed over to the island.", "arc_over"),
        ("It's a goal!", "My goal is a quiet life.", "joy_cheer"),
        ("We looked everywhere but found nothing.", "The point is the whole point.", "everything_circle"),
        ("How much are the tickets?", "How much time have we got?", "money"),
        ("The rope snapped.", "The reporter snapped a picture.", "break_apart"),
        ("Cut the onion in half.", "They cut the prices in half.", "cut"),
    ],
)
def test_gesture_accompanies_only_the_literal_sense_of_its_words(literal: str, other: str, gesture: str):
    assert gesture in shown(literal)
    assert gesture not in shown(other)


@pytest.mark.parametrize(
    "text",
    ["That question really threw me.", "My head was swimming.", "I had chicken wings for lunch.",
     "You're on fire today!", "They fell out over money.", "I like it this way, but that way we save an hour.",
     "She was up all night.", "They pulled the plug on it.",
     "Hard work never killed anyone.", "Our next stop is Reading.",
     "He drives a hard bargain.", "Go right ahead and ask."],
)  # fmt: skip
def test_figurative_words_get_no_illustrating_gesture(text: str):
    assert is_beat(shown(text))


def test_ironic_praise_and_an_admitted_mistake_get_no_positive_gesture():
    assert shown("Brilliant!") & {"thumb_up", "thumb_up_low"}
    assert is_beat(shown("Oh, brilliant, the train is late."))
    assert is_beat(shown("Brilliant, it's raining again.") - {"rain"})
    assert "heart" in shown("I made it myself.")
    assert "heart" not in shown("It was a mistake, and I made it myself.")


def test_crying_for_joy_does_not_show_sadness():
    assert "sadness" in shown("It was awful, I could cry.")
    assert "sadness" not in shown("I'm so happy for you, I could cry.")


def test_only_words_about_the_ignorance_of_the_speaker_get_a_shrug():
    assert shown("I have no idea what it is.") & {"doubt_shrug", "shrug_small"}
    assert is_beat(shown("He has no idea what it is."))


def test_retracted_denial_gets_no_head_shake():
    assert "SHAKE" in shown("The second step never works.", "head")
    assert "SHAKE" not in shown("The second step never works without the first.", "head")


def test_accented_words_get_nods_only_in_long_texts_without_reported_speech():
    long = "We walked along the river to the old mill and had lunch in the garden behind the house."
    assert "NOD" not in shown("He put the cup on the table.", "head")
    assert "NOD" in shown(long, "head")
    assert "NOD" not in shown(f"They say that {long}", "head")


def test_denied_emblem_is_not_shown():
    assert "thumb_up_low" in shown("I think that's a good idea.") | shown("That's a good idea!")
    assert not shown("I don't think that's a good idea.") & {"thumb_up", "thumb_up_low"}
    assert "heart" not in shown("It wasn't my fault.")


def test_scope_of_a_denial_ends_at_a_conjunction():
    assert "large" in shown("It was not expensive but it was a huge house.")
    assert "large" not in shown("It was not a huge house.")


def test_emblem_within_a_yes_no_question_is_not_shown():
    assert shown("Have a good weekend!") & {"wave_low", "wave_small"}
    assert not shown("Did you have a good weekend?") & {"wave_low", "wave_small"}
    assert not shown("We always have a good time there.") & {"wave_low", "wave_small"}


def test_feelings_of_another_person_are_not_shown():
    assert "rub_hands" in shown("I can't wait to meet you.")
    assert "rub_hands" not in shown("My sister can't wait to meet you.")
    assert "rub_hands" not in shown("I can't wait any longer.")
    assert "thanks" not in shown("I owe you an apology.")
    assert "embarrassed" not in shown("Shame on you!", "face")
    assert "joy" not in shown("My sister is so happy about it.", "face")
    assert "joy" in shown("I'm so happy about it.", "face")


@pytest.mark.parametrize(
    "text",
    ["You have no idea how happy I am.", "I wouldn't say no to a biscuit.", "Nothing could be easier.",
     "I couldn't have done it without you.", "I've never been so happy."],
)  # fmt: skip
def test_head_does_not_shake_at_negative_words_of_praise(text: str):
    assert "SHAKE" not in shown(text, "head")


def test_denied_feeling_is_not_shown_on_the_face():
    assert "worry" not in shown("No, that's not the problem.", "face")
    assert "SHAKE" in shown("No, that's not the problem.", "head")


@pytest.mark.parametrize("text", ["I nearly died laughing.", "This cake is to die for."])
def test_exaggerations_such_as_dying_of_laughter_do_not_show_sadness(text: str):
    assert "sadness" not in shown(text, "face")


@pytest.mark.parametrize(
    "text",
    [
        '"I hate you," she read aloud, and closed the door.',
        "\u201cI hate you!\u201d he shouted.",
        'She said, "I hate you," and left.',
        'He whispered: "I hate you."',
    ],
)
def test_feelings_in_quotations_of_other_people_are_not_shown(text: str):
    assert "anger" not in shown(text) | shown(text, "face")


def test_feelings_in_quotation_marks_without_a_reporting_verb_are_shown():
    assert "anger" in shown('"I hate you."')
    assert "heart" in shown('"I love you so much." That is what matters.')
    assert "heart" not in shown('"I love you so much," he said.')
    assert "anger" in shown('He said: "Go." I hate you.')
    assert shown("Stop it!") & {"stop", "stop_low"}
    assert is_beat(shown('"Stop it!" he shouted, and went home.'))
