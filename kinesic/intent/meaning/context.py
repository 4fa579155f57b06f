"""Circumstances of a word: clause, negation, question, wish, report, persons."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from kinesic.body.scripts import PHRASE_STOPS
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import Passage

NEGATION_REACH = 5  # [words] largest distance of a denied word after the negating word
REPORT_DISTANCE = 3  # [words] largest distance of a reporting verb from its quotation
OPENING_QUOTES = frozenset('"\u201c\u201e\xab')
CLOSING_QUOTES = frozenset('"\u201d\u201c\xbb')
FRAGMENT_LENGTH = 4  # [words] sentences up to this length count as addressed to the listener
NUMBER_DIGITS = frozenset("0123456789")  # characters with which a number in digits begins


@dataclass(frozen=True, eq=False)
class Context:
    """Words of a passage with their clauses, negations, questions and reports."""

    passage: Passage
    language: Language

    @cached_property
    def plain(self) -> tuple[str, ...]:
        """Words of the passage in lower case, without punctuation."""
        return tuple(word.plain for word in self.passage.words)

    @cached_property
    def clauses(self) -> tuple[int, ...]:
        """Clause index of each word."""
        numbers = list[int]()
        for k in range(len(self.passage.words)):
            numbers.append(numbers[-1] + self._begins_clause(k) if k else 0)
        return tuple(numbers)

    def _begins_clause(self, k: int) -> bool:
        words = self.passage.words
        if words[k].sentence != words[k - 1].sentence or set(words[k].before) & {*PHRASE_STOPS, "(", '"'}:
            return True
        if words[k].pause:
            return True
        follows = words[k + 1].plain if k + 1 < len(words) else ""
        return self.language.has("conjunction", words[k].plain) and (
            self.language.has("subject", follows) or self.language.has("contracted", follows)
        )

    @cached_property
    def _clause_ranges(self) -> tuple[range, ...]:
        """Word indices of each clause."""
        starts = [k for k, number in enumerate(self.clauses) if not k or number != self.clauses[k - 1]]
        return tuple(range(start, stop) for start, stop in pairwise([*starts, len(self.clauses)]))

    def clause_words(self, k: int) -> range:
        """Return the indices of all words in a word's clause."""
        return self._clause_ranges[self.clauses[k]]

    def is_clause_start(self, k: int) -> bool:
        """Return whether only openers (`well`, `and`) precede a word in its clause."""
        first = self.clause_words(k).start
        return all(self.language.has("opener", self.plain[j]) for j in range(first, k))

    def is_clause_end(self, k: int) -> bool:
        """Return whether only closers (`then`) follow a word in its clause."""
        stop = self.clause_words(k).stop
        return all(self.language.has("closer", self.plain[j]) for j in range(k + 1, stop))

    def is_number(self, word: str) -> bool:
        """Return whether a word is a number."""
        return word[:1] in NUMBER_DIGITS or self.language.has("number", word)

    def sentence(self, k: int) -> Sequence[int]:
        """Return the indices of all words in a word's sentence."""
        return self.passage.sentences[self.passage.words[k].sentence]

    def is_question(self, k: int) -> bool:
        """Return whether a word's sentence is a question."""
        return self.passage.kinds[self.passage.words[k].sentence] == "question"

    def is_negated(self, k: int, idioms: Collection[int]) -> bool:
        """Return whether a negation denies a word.

        Args:
            k: index of the word.
            idioms: words of idioms, in which negating words deny nothing.
        """
        first = max(self.clause_words(k).start, k - NEGATION_REACH)
        for j in reversed(range(first, k)):
            if self.language.has("negation_end", self.plain[j]):
                return False
            if self.language.has("denial", self.plain[j]) and j not in idioms:
                return True
        return False

    def is_own_denial(self, at: int) -> bool:
        """Return whether a negation counts as a denial by the speaker.

        It does not in a question, a report or a condition (`if you don't`), if it denies something bad (`not a single
        mistake`), or if another denial takes it back (`never without`).
        """
        clause = self.clause_words(at)
        is_condition = any(self.language.has("condition", self.plain[k]) for k in range(clause.start, at))
        denies_bad = any(
            self.language.has(name, self.plain[k]) for k in range(at + 1, clause.stop) for name in ("sad", "stern")
        )
        denials = sum(self.language.has("denial", self.plain[k]) for k in clause)
        is_taken_back = denials > 1 and any(self.language.has("denied_lack", self.plain[k]) for k in clause)
        return not (self.is_question(at) or self.is_reported(at) or is_condition or denies_bad or is_taken_back)

    def is_wished(self, k: int) -> bool:
        """Return whether an earlier word expresses a wish, condition or future."""
        return any(self.language.has("wish", self.plain[j]) for j in self.sentence(k) if j < k)

    def is_reported(self, k: int) -> bool:
        """Return whether a word is quoted or follows another person's reporting verb.

        The verb stands earlier in the sentence and does not follow `I` or `we`.
        """
        if self.is_quoted(k):
            return True
        before = [j for j in self.sentence(k) if j < k]
        others = any(self.plain[j] in ("he", "she", "they") or self.passage.words[j].is_content for j in before)
        return others and any(
            self.language.has("report", self.plain[j]) and not (j and self.plain[j - 1] in ("i", "we")) for j in before
        )

    def is_quoted(self, k: int) -> bool:
        """Return whether a word is in a quotation attributed to a speaker."""
        return k in self._quoted

    @cached_property
    def _quoted(self) -> frozenset[int]:
        """Indices of the words in quotations next to a reporting verb."""
        quotations, opening = list[range](), -1
        for k, word in enumerate(self.passage.words):
            is_closed = opening >= 0 and not CLOSING_QUOTES.isdisjoint(word.before)
            if is_closed:
                quotations.append(range(opening, k))
            if OPENING_QUOTES.isdisjoint(word.before.rpartition(" ")[2]):
                opening = -1 if is_closed else opening
            else:
                opening = k if opening < 0 or is_closed or "\u201c" in word.before else -1
        if opening >= 0 and not CLOSING_QUOTES.isdisjoint(self.passage.tail):
            quotations.append(range(opening, len(self.plain)))
        return frozenset(k for quotation in quotations if self._is_attributed(quotation) for k in quotation)

    def _is_attributed(self, quotation: range) -> bool:
        """Return whether a reporting verb stands just before or after a quotation."""
        before = range(max(quotation.start - REPORT_DISTANCE, 0), quotation.start)
        after = range(quotation.stop, min(quotation.stop + REPORT_DISTANCE, len(self.plain)))
        return any(self.language.has("report", self.plain[j]) for j in (*before, *after))

    def is_felt(self, k: int) -> bool:
        """Return whether the speaker feels the emotion that a word names.

        The last subject before it in its clause is the speaker, or there is none.
        """
        clause = self.clause_words(k)
        for j in reversed(range(clause.start, k)):
            if self.language.has("speaker", self.plain[j]) and not self._owns_other(j, k):
                return True
            if self.language.has("other", self.plain[j]):
                return False
        leading = [j for j in range(clause.start, k) if self.passage.words[j].is_content]
        return not leading or k - clause.start <= 1

    def _owns_other(self, j: int, k: int) -> bool:
        """Return whether a possessive as in `my sister` names another person."""
        return j + 1 < k and self.language.has("possessive", self.plain[j]) and self._is_other_noun(j + 1)

    def _is_other_noun(self, j: int) -> bool:
        return self.passage.words[j].is_content and not self.language.has("own_body", self.plain[j])

    def is_others(self, k: int) -> bool:
        """Return whether the last person before a word is a third person."""
        clause = self.clause_words(k)
        for j in reversed(range(clause.start, k)):
            if self.language.has("listener", self.plain[j]):
                return False
            if self.language.has("speaker", self.plain[j]):
                return self._owns_other(j, k)
            if self.language.has("other", self.plain[j]):
                return True
        return False

    def is_asked_within(self, k: int) -> bool:
        """Return whether a word follows the first word of a yes-no question."""
        if not self.is_question(k):
            return False
        clause = self.clause_words(k)
        first = next((j for j in clause if not self.language.has("opener", self.plain[j])), clause.start)
        return first < k and self.language.has("fact_auxiliary", self.plain[first])

    def is_request(self, k: int) -> bool:
        """Return whether a word's sentence is a request (`could you`)."""
        words = [self.plain[j] for j in self.sentence(k) if not self.language.has("opener", self.plain[j])]
        return len(words) > 1 and self.language.has("request", words[0]) and self.language.has("listener", words[1])

    def is_talk(self, k: int) -> bool:
        """Return whether the sentence of word k addresses the listener.

        Otherwise it reports something.
        """
        indices = self.sentence(k)
        if self.passage.kinds[self.passage.words[k].sentence] != "statement" or len(indices) <= FRAGMENT_LENGTH:
            return True
        if self.language.has("imperative", self.plain[indices[0]]):
            return True
        names = ("speaker", "listener", "talk_marker")
        return any(self.language.has(name, self.plain[j]) for j in indices for name in names)
