import random

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.matching import find_rules
from kinesic.intent.reading.words import read_text


def test_outermost_of_nested_rule_matches_is_kept() -> None:
    language = load_language()
    chance = random.Random(1)
    rules = [" ".join(words) for words in language.rules]
    for _ in range(200):
        passage = read_text(" ".join(chance.choices(rules, k=12)), language)
        matches = find_rules(passage, language)
        assert list(matches) == sorted(matches, key=lambda each: (each.first, each.last))
        spans = {(item.rule.intent, item.first, item.last) for item in matches}
        for intent, first, last in spans:
            around = [span for span in spans - {(intent, first, last)} if span[0] == intent]
            assert not [item for item in around if item[1] <= first and last <= item[2]]


def test_nested_rule_matches_of_different_intents_are_kept() -> None:
    language = load_language()
    passage = read_text("Thank you so much, my friend.", language)
    spans = {(rule.first, rule.last) for rule in find_rules(passage, language)}
    assert len(spans) > 1
