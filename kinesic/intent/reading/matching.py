"""Matching of language rules against the words of a text."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from kinesic.intent.reading.language import Language, Rule
from kinesic.intent.reading.passage import Passage, is_phrase_start


@dataclass(frozen=True)
class Finding:
    """Words of a text that match a language rule."""

    rule: Rule
    first: int  # index of the first word
    last: int  # index of the last word

    @property
    def count(self) -> int:
        """Number of words that the rule matches."""
        return self.last - self.first + 1


def find_rules(passage: Passage, language: Language) -> tuple[Finding, ...]:
    """Return rule matches in order, the longest per intent and first word."""
    longest: dict[tuple[int, str], Finding] = {}
    for finding in _matches(passage, language):
        if holds(finding, passage):
            key = (finding.first, finding.rule.intent)
            if key not in longest or longest[key].count < finding.count:
                longest[key] = finding
    return tuple(sorted(_keep_outermost(longest.values()), key=lambda finding: (finding.first, finding.last)))


def _matches(passage: Passage, language: Language) -> Iterator[Finding]:
    words = passage.words
    for first in range(len(words)):
        for count in range(1, min(language.longest, len(words) - first) + 1):
            last = first + count - 1
            is_other = last > first and words[last].plain != words[last - 1].plain
            if words[last].sentence != words[first].sentence or (is_other and is_phrase_start(words[last])):
                break
            for rule in language.rules.get(tuple(word.plain for word in words[first : last + 1]), ()):
                yield Finding(rule, first, last)


def holds(finding: Finding, passage: Passage) -> bool:
    """Return whether a rule match satisfies the rule's conditions."""
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


def _keep_outermost(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Drop rule matches inside a longer match of the same intent.

    The findings are in the order of their words.
    """
    last_words: dict[str, int] = {}  # intent -> index of its last word up to here
    for finding in findings:
        if finding.last > last_words.get(finding.rule.intent, -1):
            last_words[finding.rule.intent] = finding.last
            yield finding
