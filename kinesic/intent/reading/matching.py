"""Finds the words of a text for which a language has rules."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from kinesic.intent.reading.language import Language, Rule
from kinesic.intent.reading.passage import Passage


@dataclass(frozen=True)
class Finding:
    """Words of a text that mean something by a rule."""

    rule: Rule
    first: int  # index of its first word
    last: int  # and of its last one

    @property
    def count(self) -> int:
        """How many words it has."""
        return self.last - self.first + 1


def find_rules(passage: Passage, language: Language) -> tuple[Finding, ...]:
    """Finds every rule that holds, in order; of rules for one intent that begin at a word, the one with most words."""
    found: dict[tuple[int, str], Finding] = {}
    for each in _matches(passage, language):
        if holds(each, passage):
            key = (each.first, each.rule.intent)
            if key not in found or found[key].count < each.count:
                found[key] = each
    return tuple(sorted(_outermost(found.values()), key=lambda each: (each.first, each.last)))


def _matches(passage: Passage, language: Language) -> Iterator[Finding]:
    words = passage.words
    for first in range(len(words)):
        for count in range(1, min(language.longest, len(words) - first) + 1):
            last = first + count - 1
            if words[last].sentence != words[first].sentence:
                break
            for rule in language.rules.get(tuple(word.plain for word in words[first : last + 1]), ()):
                yield Finding(rule, first, last)


def holds(finding: Finding, passage: Passage) -> bool:
    """Whether a rule holds where its words stand."""
    words, rule = passage.words, finding.rule
    here = words[finding.first].sentence
    before = words[finding.first - 1] if finding.first else None
    after = words[finding.last + 1] if finding.last + 1 < len(words) else None
    if before is not None and before.sentence == here and before.plain in rule.not_after:
        return False
    if after is not None and after.sentence == here and after.plain in rule.not_before:
        return False
    kind = passage.kinds[here]
    match rule.where:
        case "first":
            return before is None or before.sentence != here
        case "last":
            return after is None or after.sentence != here
        case "tag":
            return kind == "question" and (after is None or after.sentence != here)
        case "question":
            return kind == "question"
        case "statement":
            return kind != "question"
        case "alone":
            return len(passage.phrases[words[finding.first].phrase]) == finding.count
    return True


def _outermost(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Leaves out what has other words around it that mean the same; the findings are in the order of their words."""
    reached: dict[str, int] = {}  # intent -> the last word that it has so far
    for each in findings:
        if each.last > reached.get(each.rule.intent, -1):
            reached[each.rule.intent] = each.last
            yield each
