"""Finds what the build of a text means: the accent of each phrase, noun and verb phrases, and lists."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import COMMAS, Passage

LONGEST_ITEM = 5  # words of one thing in a list
LEAST_ITEMS = 3
STRESS_REACH = 3  # words within which a weak word leaves its stroke to one that is stressed


@dataclass(frozen=True)
class PhrasePart:
    """Words that mean something by where they stand."""

    intent: str
    first: int
    last: int
    says: str
    certainty: float


def accent_of(passage: Passage, phrase: int) -> int:
    """Finds the word of a phrase that is accented: one that the writer stresses, else the last content word.

    A phrase of small words alone has its accent on the last.
    """
    indices = passage.phrases[phrase]
    emphatic = [k for k in indices if passage.words[k].emphatic]
    return (emphatic or passage.content[phrase] or list(indices))[-1]


def stressed_near(passage: Passage, index: int) -> int:
    """Finds the word on which the stroke of a meaning falls.

    A content word, a stressed one, and one in a phrase without content words, keeps it. Others (`you`, `my`, `not`) are
    weak: it falls on the next content word of their phrase, else on the last one before them.
    """
    words = passage.words
    content = passage.content[words[index].phrase]
    if words[index].is_content or words[index].emphatic or not content:
        return index
    at = bisect_right(content, index)
    if at < len(content) and content[at] <= index + STRESS_REACH:
        return content[at]
    return min(content[max(at - 1, 0) : at + 1], key=lambda k: abs(k - index))


@dataclass(frozen=True)
class Grammar:
    """How the words of a passage belong together, by their indices."""

    things: tuple[tuple[int, int], ...]  # first and last word of each noun phrase
    verbs: tuple[int, ...]  # the first verb of each sentence that has one
    clauses: tuple[int, ...]  # for each word the last one of its clause


def read_grammar(passage: Passage, language: Language) -> Grammar:
    """Finds how words belong together, by closed classes of words and punctuation."""
    things = [each for sentence in passage.sentences for each in _noun_phrases(passage, language, sentence)]
    verbs = [each for sentence in passage.sentences for each in _first_verb(passage, language, sentence)]
    return Grammar(tuple(things), tuple(verbs), tuple(clause_ends(passage, language)))


def find_phrases(passage: Passage, language: Language, grammar: Grammar) -> Iterator[PhrasePart]:
    """Yields accents, noun phrases, first verb phrases and lists, and what is stressed."""
    for number, indices in enumerate(passage.phrases):
        k = accent_of(passage, number)
        yield PhrasePart("accent", k, k, "carries the accent of its phrase", 0.3 if len(indices) > 1 else 0.2)
    for k, word in enumerate(passage.words):
        if word.emphatic:
            yield PhrasePart("emphasis-strong", k, k, "is stressed by the writer", 0.85)
    named = set[int]()  # sentences that have named something
    for first, last in grammar.things:
        is_first = passage.words[first].sentence not in named
        named.add(passage.words[first].sentence)
        name = "first-noun-phrase" if is_first else "noun-phrase"
        yield PhrasePart(
            name, first, last, "names the first thing of its sentence" if is_first else "names a thing", 0.15
        )
    for k in grammar.verbs:
        yield PhrasePart("first-verb-phrase", k, k, "says what is done", 0.15)
    for sentence in passage.sentences:
        yield from _list(passage, language, sentence)


def clause_ends(passage: Passage, language: Language) -> list[int]:
    """Finds the last word of the clause of each word: up to punctuation, or to a word that begins another clause."""
    words = passage.words
    ends = list(range(len(words)))
    for k in reversed(ends[:-1]):
        after = words[k + 1]
        is_over = after.sentence != words[k].sentence or any(each in after.before for each in f"{COMMAS}.")
        if not (is_over or language.has("negation_end", after.plain)):
            ends[k] = ends[k + 1]
    return ends


def _noun_phrases(passage: Passage, language: Language, sentence: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Each determiner with its noun: the first content word behind it that is no adjective, as far as one can tell."""
    for k in sentence:
        if not language.has("determiner", passage.words[k].plain):
            continue
        noun = k
        for j in range(k + 1, min(k + 5, sentence[-1] + 1)):
            word = passage.words[j]
            if word.phrase != passage.words[k].phrase or not (word.is_content or j == k + 1):
                break
            noun = j if word.is_content else noun
            if word.is_content and not language.has("adjective", word.plain):
                break
        if noun != k:
            yield k, noun


def _first_verb(passage: Passage, language: Language, sentence: Sequence[int]) -> Iterator[int]:
    """The first verb: an auxiliary, or what follows the subject."""
    for k in sentence:
        is_verb = language.has("auxiliary", passage.words[k].plain)
        after = k > sentence[0] and language.has("subject", passage.words[k - 1].plain)
        if is_verb or (after and passage.words[k].is_content):
            yield k
            return


def _list(passage: Passage, language: Language, sentence: Sequence[int]) -> Iterator[PhrasePart]:
    """The items of `a, b and c`: short pieces between commas, the last one behind `and` or `or`."""
    pieces: list[list[int]] = [[]]
    joint = False
    for k in sentence:
        word = passage.words[k]
        joins = language.has("list_joint", word.plain)
        if k > sentence[0] and ("," in word.before or joins) and pieces[-1]:
            pieces.append([])
        joint |= joins and len(pieces) >= LEAST_ITEMS
        if not joins:
            pieces[-1].append(k)
    items = [piece for piece in pieces[1:-1] if 0 < len(piece) <= LONGEST_ITEM]
    if not joint or len(items) != len(pieces) - 2 or not pieces[-1]:
        return
    items = [pieces[0][-LONGEST_ITEM:], *items, pieces[-1][:LONGEST_ITEM]]
    for number, item in enumerate(items):
        content = [k for k in item if passage.words[k].is_content] or item
        k = content[0] if number == len(items) - 1 else content[-1]
        side = ("left", "right")[number % 2]
        yield PhrasePart(f"listing-{side}", k, k, f"is item {number + 1} of a list", 0.45)
