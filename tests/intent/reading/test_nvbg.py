"""The rules of English find what those of the NonVerbal Behavior Generator find, at the same words."""

import os
import random
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from xml.etree import ElementTree

import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.matching import find_rules
from kinesic.intent.reading.words import read_text

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
RULES = CORPUS / "nvbg" / "rule_input_general.xml"
OF_GRAMMAR = {
    "first_NP",
    "first_VP",
    "noun_phrase",
    "interjection",
    "compound_sentence",
}  # found by a parser, not by words
SAME = {  # their function -> ours
    "affirmation": {"affirmation", "performative-greet"},  # theirs counts `hello`
    "inclusivity": {"inclusivity"},
    "intensification": {"intensification"},
    "emo_positive": {"positive"},
    "greeting_animation": {"performative-farewell"},
    "you_animation": {"deictic-you", "deictic-you-all"},
    "me_animation": {"deictic-me"},
    "negation_animation": {"negation"},
    "contrast_animation": {"contrast"},
    "assumption_animation": {"assumption"},
    "rhetorical_animation": {"rhetorical"},
    "question_animation": {"question"},
    "deictic_animation": {"world-place-there"},
    "obligation_animation": {"obligation"},
}
OPENINGS = ("", "Yes, ", "Yeah, ", "No, ", "Hello, ", "Hi, ", "However, ", "Maybe ", "Perhaps ", "But ", "Goodbye, ")
WHO = ("I", "you", "my sister", "your friends", "the men from the harbour", "nobody", "a teacher of mine")
DO = (
    "must see", "cannot see", "did not see", "really liked", "didn't find", "couldn't leave", "absolutely loved",
    "wanted", "wasn't in", "completely forgot", "dont know", "spoke about",
)  # fmt: skip
WHAT = (
    "the whole town", "a huge house over there", "everything", "nothing", "very good bread", "a nice garden",
    "plenty of bread", "the great bridge", "quite important things", "all the fantastic boats",
    "a wonderful day", "me and yours",
)  # fmt: skip
QUESTIONS = (
    "Where is my coat?", "Who took your bag, and why?", "How did you find me?", "When must we go?", "Do you like it?",
    "Why is nobody here?", "Isn't it so nice there?", "Do they know how the full story goes?", "Bye, who are you?",
)  # fmt: skip
TRAPS = (
    "That is all right, I know how you feel.", "Not only the boats but also the nets are mine.", "I do hope so.",
    "There is nothing good in there.", "They left when it was dark, so we came.", "It is not very important to me.",
    "All of you know why.", "He is nothing but a liar.", "I would say so, but who knows.",
    "Your place or mine, that's all.", "So far, so good.", "As far as I know, no one asked where you were.",
)  # fmt: skip


def sentences() -> list[str]:
    """Draws 200 sentences of the templates."""
    spoken = [f"{opening}{who} {do} {what}." for opening, who, do, what in product(OPENINGS, WHO, DO, WHAT)]
    return [*QUESTIONS, *TRAPS, *random.Random(1).sample(spoken, 200 - len(QUESTIONS) - len(TRAPS))]


@pytest.fixture(scope="module")
def oracle():
    """Their words by function."""
    if not RULES.exists():
        pytest.skip(f"no rules at {RULES}")
    rules = ElementTree.parse(RULES).getroot().iter("rule")
    return {
        name: {(each.text or "").strip().rstrip(",").lower() for each in rule.iter("pattern")}
        for rule in rules
        if (name := rule.get("keyword")) not in OF_GRAMMAR
    }


def disagreements(oracle, texts) -> Iterator[tuple[str, str, str, bool]]:
    """Yields text, word and function for all that they find, and whether we do not."""
    language = load_language()
    for text in texts:
        passage = read_text(text, language)
        found = find_rules(passage, language)
        for k, word in enumerate(passage.words):
            ours = {each.rule.intent for each in found if each.first <= k <= each.last}
            for function, words in oracle.items():
                if word.plain in words:
                    yield text, word.plain, function, not ours & SAME[function]


def test_the_functions_are_those_that_the_oracle_has(oracle):
    assert set(oracle) == set(SAME)
    assert sum(map(len, oracle.values())) > 55


def test_english_agrees_with_nvbg_at_the_same_words(oracle):
    found = list(disagreements(oracle, sentences()))
    assert {function for _, _, function, _ in found} == set(SAME), "every function is tried"
    wrong = [f"{word} ({function}): {text}" for text, word, function, differs in found if differs]
    assert len(found) > 400
    assert len(wrong) <= 0.05 * len(found), wrong


def test_nothing_is_denied_where_nvbg_finds_no_negation(oracle):
    language = load_language()
    denials = oracle["negation_animation"] | {"nobody", "never", "neither", "nor", "none", "nowhere", "cannot"}
    for text in sentences():
        passage = read_text(text, language)
        for each in find_rules(passage, language):
            if each.rule.intent == "negation":
                assert {passage.words[k].plain for k in range(each.first, each.last + 1)} & denials, text
