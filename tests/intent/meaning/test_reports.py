"""Plain reports, which mention words without acting them out."""

import tomllib
from pathlib import Path

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import plan_behaviours
from kinesic.intent.meaning.context import Context
from kinesic.intent.meaning.reports import is_past, is_told
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text

LEXICON, NEUTRAL, ENGLISH = Lexicon.load(), Style.load("neutral"), load_language("en")
CATEGORIES = {entry.id: entry.category for entry in reversed(LEXICON.entries)}
SENTENCES = Path(__file__).with_name("judged_sentences.toml")
MIN_PLAIN_PRECISION = 0.91  # fraction of fitting gestures in plain sentences
MIN_HITS = 0.75  # fraction of expressive sentences with a fitting gesture on its word


def shown(text: str) -> list[tuple[str, ...]]:
    """Return each gesture for a text, with the words near its stroke.

    They are the words before, at and after the stroke.
    """
    passage, selection = plan_behaviours(text, LEXICON, NEUTRAL, seed=0)
    words = ["", *(word.plain for word in passage.words), ""]
    gestures = [behaviour for behaviour in selection.behaviours if behaviour.channel == "gesture"]
    return [
        (each.lexeme, *words[each.intent.word : each.intent.word + 3]) for each in gestures if each.intent.word >= 0
    ]


def pictures(text: str) -> set[str]:
    """Return the gestures for a text, without beats."""
    return {name for name, *_ in shown(text) if CATEGORIES[name] != "beat"}


def context(text: str) -> Context:
    return Context(read_text(text, ENGLISH), ENGLISH)


def test_first_finite_verb_determines_whether_a_clause_is_past() -> None:
    for text in (
        "I sent it back.",
        "The rain kept us in.",
        "We walked home.",
        "They were asleep.",
        "I put it off last week.",
    ):
        assert is_past(context(text), 0), text
    for text in ("I think it broke.", "We have walked home.", "I feed the hens.", "She has a broken leg.",
                 "I put it off.", "The tired man sleeps."):  # fmt: skip
        assert not is_past(context(text), 0), text


def test_past_events_count_as_a_plain_report_but_opinions_and_talk_to_the_listener_do_not() -> None:
    for text in (
        "I sent the forms back on Tuesday.",
        "My brother plays the guitar in a band.",
        "He lives across the road.",
    ):
        assert is_told(context(text), 2), text
    for text in ("I think we need a bigger boat here.", "I sent you the forms on Tuesday.", "I was so cold that night!",
                 "We sold it.", "Oh, I sent the forms back on Tuesday."):  # fmt: skip
        assert not is_told(context(text), 2), text


def test_action_word_gets_a_gesture_only_if_its_report_contains_no_other_facts() -> None:
    for alone, among, gesture in [
        ("We drove to the coast.", "We drove to the coast and stayed with her old aunt.", "steering_wheel"),
        ("Then the rain came.", "The rain kept us inside the house for most of the weekend.", "rain"),
        ("Somebody knocked on the door.", "I knocked on the wrong door and apologised to a neighbour.", "knock"),
        ("Go round the corner.", "I opened an account at the bank round the corner.", "this_way"),
        ("She rang me!", "The doctor rang me about the results of the tests.", "phone_call"),
        ("For three years I waited.", "He held the post for three years and then moved to Wales.", "time_span"),
    ]:
        assert gesture in pictures(alone), alone
        assert gesture not in pictures(among), among


def test_repeated_or_stressed_word_of_a_plain_report_gets_a_gesture() -> None:
    assert pictures("It went up and up for months.") & {"rise", "growth_curve"}
    assert not pictures("It went up for months.") & {"rise", "growth_curve"}
    assert "rain" in pictures("The *rain* kept us inside the house for most of the weekend.")


def test_proper_name_gets_no_gesture_of_the_equal_common_word() -> None:
    assert "path_along" in pictures("I march every day.")
    assert not pictures("The committee put the decision off until March.")
    assert not pictures("The train to Reading was late.") & {"open_book"}


def test_comparison_of_sizes_in_a_report_gets_a_size_gesture() -> None:
    for text, gesture in [
        ("There stands a boat as tall as this door.", "tall"),
        ("It has ears as big as plates.", "large"),
        ("The chip is as small as a grain of rice.", "small_pinch tiny_low"),
    ]:
        assert pictures(text) & set(gesture.split()), text
    assert not pictures("It is not as tall as the old one.") & {"tall"}


def test_gestures_fit_judged_plain_sentences_and_hit_three_quarters_of_the_expressive_ones() -> None:
    sentences = tomllib.loads(SENTENCES.read_text(encoding="utf-8"))
    marks = [
        CATEGORIES[name] == "beat" or name in accepted.split()
        for text, accepted in sentences["plain"].items()
        for name, *_ in shown(text)
    ]
    assert sum(marks) >= MIN_PLAIN_PRECISION * len(marks)
    hits = [
        any(f"{name}@{word}" in accepted.split() for name, *words in shown(text) for word in words)
        for text, accepted in sentences["expressive"].items()
    ]
    assert sum(hits) >= MIN_HITS * len(hits)
