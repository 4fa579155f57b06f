"""Recognition of gesture names of several words in a text."""

from collections.abc import Iterator, Mapping
from functools import lru_cache

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.word_stems import word_stem
from kinesic.intent.meaning.context import Context
from kinesic.intent.meaning.cues import PICTURE_INTENT, Cue
from kinesic.intent.meaning.matching import Candidate

NAME_CERTAINTY = 0.58  # certainty of a gesture whose name stands in the text
LONG_NAME_BONUS = 0.04  # added certainty for each word of the name beyond the second one
MIN_CONTENT_WORDS = 2  # smallest number of content words of a name of fewer than `LONG_NAME` words
LONG_NAME = 4  # [words] length from which a name is distinctive without content words
MIN_NAME_WORDS = 2  # [words] shortest name that is looked for; single words mean too many things
SILENT_CATEGORIES = frozenset({"beat", "rest"})  # gesture categories whose names describe a movement, not a meaning


@lru_cache(maxsize=4)
def index_names(lexicon: Lexicon) -> Mapping[str, tuple[tuple[tuple[str, ...], str], ...]]:
    """Return a lexicon's multi-word gesture names by their first word's stem."""
    categories = {entry.id: entry.category for entry in reversed(lexicon.entries)}
    names: dict[str, list[tuple[tuple[str, ...], str]]] = {}
    seen = set[tuple[str, ...]]()
    for synonym, gesture in lexicon.synonyms:
        stems = tuple(word_stem(word) for word in synonym.lower().replace("-", " ").split())
        if len(stems) < MIN_NAME_WORDS or stems in seen or categories.get(gesture, "rest") in SILENT_CATEGORIES:
            continue
        seen.add(stems)
        names.setdefault(stems[0], []).append((stems, gesture))
    return {first: tuple(sorted(found, key=lambda each: -len(each[0]))) for first, found in names.items()}


def find_names(context: Context, lexicon: Lexicon) -> Iterator[Candidate]:
    """Yield a candidate for each gesture name that occurs in a text."""
    names = index_names(lexicon)
    stems = [word_stem(word.replace("'", "")) for word in context.plain]
    for first, stem in enumerate(stems):
        end = context.sentence(first)[-1] + 1
        for name, gesture in names.get(stem, ()):
            stop = first + len(name)
            is_here = stop <= end and tuple(stems[first:stop]) == name
            if is_here and context.clauses[first] == context.clauses[stop - 1] and _is_distinct(context, first, stop):
                yield _candidate(context, gesture, first, stop - 1)
                break


def _is_distinct(context: Context, first: int, stop: int) -> bool:
    """Return whether words that match a gesture name are specific enough.

    They have `MIN_CONTENT_WORDS` content words, or are `LONG_NAME` words in all.
    """
    content = sum(context.passage.words[k].is_content for k in range(first, stop))
    return content >= MIN_CONTENT_WORDS or stop - first >= LONG_NAME


def _candidate(context: Context, gesture: str, first: int, last: int) -> Candidate:
    content = [k for k in range(first, last + 1) if context.passage.words[k].is_content]
    certainty = NAME_CERTAINTY + LONG_NAME_BONUS * (last - first + 1 - MIN_NAME_WORDS)
    says = f"is a name of the gesture {gesture}"
    cue = Cue(says, (), (gesture,), "word", certainty, PICTURE_INTENT, "any")
    return Candidate(cue, first, last, content[-1] if content else last)
