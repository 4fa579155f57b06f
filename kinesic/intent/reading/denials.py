"""Filter for negation words that deny nothing, in languages without cues."""

from collections.abc import Sequence
from dataclasses import replace

from kinesic.intent.intents import Intent
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.matching import Finding
from kinesic.intent.reading.passage import Passage

NEGATION_INTENT = "negation"  # name of the intent of negations
HAND_CHANNEL = frozenset({"gesture"})  # channel of hand gestures


def drop_harmless_denials(findings: Sequence[Finding], passage: Passage) -> tuple[Finding, ...]:
    """Drop negations in questions and in idioms such as `keine Ahnung`."""
    return tuple(
        finding
        for finding in findings
        if finding.rule.intent != NEGATION_INTENT
        or not (_is_asked(finding, passage) or any(_covers(other, finding) for other in findings))
    )


def mute_statements(intent: Intent, passage: Passage, language: Language) -> Intent:
    """Remove the gesture from a negation that is no refusal."""
    if intent.name != NEGATION_INTENT:
        return intent
    word = passage.words[intent.word]
    is_first = passage.sentences[word.sentence][0] == intent.word
    is_refusal = is_first and language.has("refusal", word.plain)
    return intent if is_refusal else replace(intent, muted=intent.muted | HAND_CHANNEL)


def _is_asked(finding: Finding, passage: Passage) -> bool:
    return passage.kinds[passage.words[finding.first].sentence] == "question"


def _covers(other: Finding, finding: Finding) -> bool:
    is_other = other.rule.intent != NEGATION_INTENT and other.count > finding.count
    return is_other and other.first <= finding.first and finding.last <= other.last
