"""gitlint rule for the mood of commit subjects."""

import re

from gitlint.git import GitCommit
from gitlint.rules import CommitMessageTitle, LineRule, RuleViolation

STATEMENT = re.compile(
    r": (is|are|has|have|the|a|an|what|who|where|when|no|nobody|nothing|each|every|all|some)\b"  # describes a state
    r"|: \w+(?<!e)(?<!emb)(?<!sh)ed\b"  # past tense
    r"|: \w+ing\b"  # gerund
    r"|: (?!always )\w+[^su]s\b"  # third person
)


class ImperativeSubject(LineRule):
    """Require a verb in the imperative after the scope."""

    id = "UK1"
    name = "imperative-subject"
    target = CommitMessageTitle

    def validate(self, title: str, _commit: GitCommit) -> list[RuleViolation]:
        """Return a violation if the subject states something."""
        if STATEMENT.search(title):
            return [RuleViolation(self.id, "the subject after the scope is not imperative", title)]
        return []
