"""Matching of cues against the words of a text."""

from collections.abc import Iterator
from dataclasses import dataclass

from kinesic.expressivity.lexicon.word_stems import word_stem
from kinesic.intent.meaning.context import Context
from kinesic.intent.meaning.cue_table import CueTable
from kinesic.intent.meaning.cues import Cue
from kinesic.intent.meaning.patterns import ANY_NUMBER, ANY_WORD, STEM_SIGN, Pattern, Span

CLASS_SIGN = "@"  # sign before the name of a word class in a cue
START_CLASS = "@start"  # name in a cue for the start of a clause
END_CLASS = "@end"  # name in a cue for the end of a clause
MAX_BARE_FRACTION = 0.6  # largest fraction of content words in an option that a match of function words may omit


@dataclass(frozen=True, eq=False)
class Candidate:
    """Words of a text that match a cue."""

    cue: Cue
    first: int  # index of the first word
    last: int  # index of the last word
    stroke: int  # index of the word of the stroke

    @property
    def count(self) -> int:
        """Number of words of the text that the match covers."""
        return self.last - self.first + 1


def match_cues(context: Context, table: CueTable) -> tuple[Candidate, ...]:
    """Return the cues in a text, the longest where they overlap."""
    ranked = sorted(_find_matches(context, table), key=lambda each: (-each.count, -each.cue.certainty, each.first))
    taken, kept = set[int](), list[Candidate]()
    for candidate in ranked:
        words = set(range(candidate.first, candidate.last + 1))
        if not words & taken:
            taken |= words
            kept.append(candidate)
    return tuple(sorted(kept, key=lambda each: each.first))


def _find_matches(context: Context, table: CueTable) -> Iterator[Candidate]:
    plain = context.plain
    for indices in context.passage.sentences:
        present = {plain[k] for k in indices}
        for first in indices:
            keys = [plain[first], f"{word_stem(plain[first])}{STEM_SIGN}", ANY_WORD]
            if context.is_number(plain[first]):
                keys.append(ANY_NUMBER)
            for key in keys:
                for cue, pattern in table.starts.get(key, ()):
                    for words in pattern.required:  # faster than `any` in the innermost loop
                        if present.isdisjoint(words):
                            break
                    else:
                        span = _match(context, pattern, first)
                        if span is not None and _holds(context, cue, pattern, span):
                            yield Candidate(cue, span.first, span.last, _stroke_word(context, span))


def _match(context: Context, pattern: Pattern, first: int) -> Span | None:
    """Return a pattern's match that begins at a word, or None.

    A match that crosses the punctuation between clauses is replaced by one within the first clause.
    """
    stop = context.sentence(first)[-1] + 1
    span = pattern.match(context.plain, first, stop, context.is_number)
    if span is None or pattern.at_start or not _crosses_punctuation(context, span):
        return span
    return pattern.match(context.plain, first, context.clause_words(first).stop, context.is_number)


def _crosses_punctuation(context: Context, span: Span) -> bool:
    """Return whether another clause begins in a match (`well, done`).

    Closers (`please`), conjunctions and repeated words (`no, no`) begin none.
    """
    stop = context.clause_words(span.first).stop
    if span.last < stop:
        return False
    after = context.plain[stop]
    is_usual = any(context.language.has(name, after) for name in ("closer", "conjunction"))
    return not is_usual and after not in context.plain[span.first : stop]


def _holds(context: Context, cue: Cue, pattern: Pattern, span: Span) -> bool:
    """Return whether the conditions of a cue hold at a match."""
    if pattern.at_start and not context.is_clause_start(span.first):
        return False
    if pattern.at_end and not context.is_clause_end(span.last):
        return False
    if cue.after and not _has_class(context, span.first - 1, span.first, cue.after, START_CLASS):
        return False
    if cue.before and not _has_class(context, span.last + 1, span.last, cue.before, END_CLASS):
        return False
    if cue.not_after and _has_class(context, span.first - 1, span.first, cue.not_after, START_CLASS):
        return False
    if cue.not_before and _has_class(context, span.last + 1, span.last, cue.not_before, END_CLASS):
        return False
    if (cue.near or cue.not_near) and not _holds_near(context, cue, span):
        return False
    if not pattern.at_start and _is_bare(context, pattern, span):
        return False
    kind = context.passage.kinds[context.passage.words[span.first].sentence]
    return cue.where in ("any", kind) or (cue.where == "talk" and context.is_talk(span.first))


def _is_bare(context: Context, pattern: Pattern, span: Span) -> bool:
    """Return whether a match consists of function words and lacks content words.

    The match `a few` of the pattern `a few (crumbs/drops)` lacks its meaning.
    """
    words = context.plain[span.first : span.last + 1]
    if not pattern.options or not all(context.language.has("function", word) for word in words):
        return False
    shares = (sum(not context.language.has("function", word) for word in each) / len(each) for each in pattern.options)
    return max(shares) > MAX_BARE_FRACTION


def _holds_near(context: Context, cue: Cue, span: Span) -> bool:
    """Return whether the other words of the sentence allow a cue."""
    outside = (k for k in context.sentence(span.first) if not span.first <= k <= span.last)
    stems = {word_stem(context.plain[k]) for k in outside}
    return stems.isdisjoint(cue.not_near) and (not cue.near or not stems.isdisjoint(cue.near))


def _has_class(context: Context, k: int, near: int, names: frozenset[str], border: str) -> bool:
    """Return whether a neighbouring word is listed, directly or by word class."""
    is_outside = not 0 <= k < len(context.plain) or context.clauses[k] != context.clauses[near]
    if is_outside:
        return border in names
    word = context.plain[k]
    if word in names:
        return True
    if "@number" in names and context.is_number(word):
        return True
    if "@content" in names and context.passage.words[k].is_content:
        return True
    return any(context.language.has(name[1:], word) for name in names if name.startswith(CLASS_SIGN))


def _stroke_word(context: Context, span: Span) -> int:
    """Return the index of a match's word that carries the stroke."""
    if span.stroke >= 0:
        return span.stroke
    words = context.passage.words
    content = [k for k in range(span.first, span.last + 1) if words[k].is_content]
    return content[-1] if content else span.last
