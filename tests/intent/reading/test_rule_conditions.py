"""Tests of the conditions of language rules."""

import pytest

from kinesic.intent.reading.language import Language, Rule
from kinesic.intent.reading.matching import find_rules
from kinesic.intent.reading.words import read_text


def rule(intent: str = "x", *, where: str = "anywhere", not_before: str = "", not_after: str = "") -> Rule:
    return Rule(
        intent, "means it", 0.5, where, "word", frozenset(not_before.split()), frozenset(not_after.split()), (), ""
    )


def found(text: str, **rules: Rule) -> list[tuple[str, int, int]]:
    """Return (intent, first word, last word) of all matches.

    The names of `rules` are words joined by underscores.
    """
    language = Language("en", {"function": frozenset()}, {}, {tuple(k.split("_")): (v,) for k, v in rules.items()})
    return [(each.rule.intent, each.first, each.last) for each in find_rules(read_text(text, language), language)]


def test_word_rule_matches_every_occurrence_in_text_order() -> None:
    assert found("no he said no", no=rule()) == [("x", 0, 0), ("x", 3, 3)]
    assert found("he said yes", no=rule()) == []


def test_phrase_rule_matches_only_within_one_sentence() -> None:
    assert found("of course he did", of_course=rule()) == [("x", 0, 1)]
    assert found("He thought of. Course it was", of_course=rule()) == []
    assert found("so of course", of_course=rule()) == [("x", 1, 2)]


def test_longest_of_nested_phrase_rules_with_the_same_intent_matches() -> None:
    rules = {"thank_you_so_much": rule(), "thank_you": rule(), "so_much": rule(), "you": rule("y")}
    assert found("thank you so much", **rules) == [("x", 0, 3), ("y", 1, 1)]
    assert found("thank you so", **rules) == [("x", 0, 1), ("y", 1, 1)]
    assert found("so much thank you", **rules) == [("x", 0, 1), ("x", 2, 3), ("y", 3, 3)]


@pytest.mark.parametrize(
    ("text", "matches"),
    [("no", True), ("no way", True), ("no problem", False), ("no. Problem", True), ("the problem no", True)],
)
def test_language_rule_can_be_excluded_by_the_following_word(text: str, matches: bool) -> None:
    assert bool(found(text, no=rule(not_before="problem"))) == matches


@pytest.mark.parametrize(
    ("text", "matches"),
    [("like", True), ("i like", True), ("looks like", False), ("He looks. Like this", True), ("like looks", True)],
)
def test_language_rule_can_be_excluded_by_the_preceding_word(text: str, matches: bool) -> None:
    assert bool(found(text, like=rule(not_after="looks"))) == matches


@pytest.mark.parametrize(
    ("where", "texts"),
    [
        ("anywhere", {"so it is": True, "it is so": True, "is it so?": True, "it, so, is": True}),
        ("first", {"so it is": True, "it is so": False, "It is. So it was": True}),
        ("last", {"so it is": False, "it is so": True, "It is so. It was": True, "is it so?": True}),
        (
            "tag",
            {
                "it is so": False,
                "it is so?": True,
                "so is it?": False,
                "Is it so? He was": True,
                "He is so. Yes?": False,
            },
        ),
        ("question", {"so is it?": True, "so it is": False, "So it is. Is it?": False}),
        ("statement", {"so is it?": False, "so it is": True, "so it is!": True}),
        ("alone", {"so": True, "so, it is": True, "so it is": False, "it is, so, yes": True}),
    ],
)
def test_language_rule_can_be_limited_to_a_position_in_the_sentence_or_to_a_sentence_type(
    where: str, texts: dict[str, bool]
) -> None:
    assert {text: bool(found(text, so=rule(where=where))) for text in texts} == texts


def test_phrase_rule_restricted_to_lone_phrases_ignores_longer_phrases() -> None:
    assert found("of course, he did", of_course=rule(where="alone")) == [("x", 0, 1)]
    assert found("well of course, he did", of_course=rule(where="alone")) == []
