"""Comparison of English rules with those of the NonVerbal Behavior Generator."""

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

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
NVBG_RULES = CORPUS_FOLDER / "nvbg" / "rule_input_general.xml"
GRAMMAR_FUNCTIONS = {
    "first_NP",
    "first_VP",
    "noun_phrase",
    "interjection",
    "compound_sentence",
}  # Found by a parser instead of words
EQUIVALENT_INTENTS = {  # NVBG function to kinesic intent
    "affirmation": {"affirmation", "performative-greet"},  # NVBG counts `hello`
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
OPENING_WORDS = (
    "",
    "Yes, ",
    "Yeah, ",
    "No, ",
    "Hello, ",
    "Hi, ",
    "However, ",
    "Maybe ",
    "Perhaps ",
    "But ",
    "Goodbye, ",
)
SUBJECT_PHRASES = ("I", "you", "my sister", "your friends", "the men from the harbour", "nobody", "a teacher of mine")
VERB_PHRASES = (
    "must see", "cannot see", "did not see", "really liked", "didn't find", "couldn't leave", "absolutely loved",
    "wanted", "wasn't in", "completely forgot", "dont know", "spoke about",
)  # fmt: skip
OBJECT_PHRASES = (
    "the whole town", "a huge house over there", "everything", "nothing", "very good bread", "a nice garden",
    "plenty of bread", "the great bridge", "quite important things", "all the fantastic boats",
    "a wonderful day", "me and yours",
)  # fmt: skip
QUESTION_SENTENCES = (
    "Where is my coat?", "Who took your bag, and why?", "How did you find me?", "When must we go?", "Do you like it?",
    "Why is nobody here?", "Isn't it so nice there?", "Do they know how the full story goes?", "Bye, who are you?",
)  # fmt: skip
TRICKY_SENTENCES = (
    "That is all right, I know how you feel.", "Not only the boats but also the nets are mine.", "I do hope so.",
    "There is nothing good in there.", "They left when it was dark, so we came.", "It is not very important to me.",
    "All of you know why.", "He is nothing but a liar.", "I would say so, but who knows.",
    "Your place or mine, that's all.", "So far, so good.", "As far as I know, no one asked where you were.",
)  # fmt: skip


def sentences() -> list[str]:
    """Draw 200 sentences from the templates."""
    spoken = [
        f"{opening}{who} {do} {what}."
        for opening, who, do, what in product(OPENING_WORDS, SUBJECT_PHRASES, VERB_PHRASES, OBJECT_PHRASES)
    ]
    return [
        *QUESTION_SENTENCES,
        *TRICKY_SENTENCES,
        *random.Random(1).sample(spoken, 200 - len(QUESTION_SENTENCES) - len(TRICKY_SENTENCES)),
    ]


@pytest.fixture(scope="module")
def oracle():
    """Return the words that NVBG assigns to each function."""
    if not NVBG_RULES.exists():
        pytest.skip(f"no rules at {NVBG_RULES}")
    rules = ElementTree.parse(NVBG_RULES).getroot().iter("rule")
    return {
        name: {(item.text or "").strip().rstrip(",").lower() for item in rule.iter("pattern")}
        for rule in rules
        if (name := rule.get("keyword")) not in GRAMMAR_FUNCTIONS
    }


def disagreements(oracle, texts) -> Iterator[tuple[str, str, str, bool]]:
    """Yield text, word, function and disagreement for all NVBG matches."""
    language = load_language()
    for text in texts:
        passage = read_text(text, language)
        matches = find_rules(passage, language)
        for k, word in enumerate(passage.words):
            ours = {item.rule.intent for item in matches if item.first <= k <= item.last}
            for function, words in oracle.items():
                if word.plain in words:
                    yield text, word.plain, function, not ours & EQUIVALENT_INTENTS[function]


def test_each_nvbg_function_has_an_equivalent_intent(oracle):
    assert set(oracle) == set(EQUIVALENT_INTENTS)
    assert sum(map(len, oracle.values())) > 55


def test_english_rules_agree_with_nvbg_in_95_percent_of_sentences(oracle):
    results = list(disagreements(oracle, sentences()))
    assert {function for _, _, function, _ in results} == set(EQUIVALENT_INTENTS), "every function is tried"
    wrong = [f"{word} ({function}): {text}" for text, word, function, differs in results if differs]
    assert len(results) > 400
    assert len(wrong) <= 0.05 * len(results), wrong


def test_negations_contain_an_nvbg_negation_word(oracle):
    language = load_language()
    denials = oracle["negation_animation"] | {"nobody", "never", "neither", "nor", "none", "nowhere", "cannot"}
    for text in sentences():
        passage = read_text(text, language)
        for rule in find_rules(passage, language):
            if rule.rule.intent == "negation":
                assert {passage.words[k].plain for k in range(rule.first, rule.last + 1)} & denials, text
