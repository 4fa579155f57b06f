"""Phrase structure of a text: accents, noun phrases, verb phrases and lists."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinesic.body.scripts import PHRASE_STOPS, SENTENCE_STOPS
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import Passage

MAX_ITEM_WORDS = 5  # [words] longest item of a list
_CLAUSE_SIGNS = frozenset(PHRASE_STOPS + SENTENCE_STOPS)
MIN_ITEMS = 3  # smallest number of items that make a list
QUOTATION_ENDS = (',"', ",'", ",\u201d", ",\u2019", ",\xbb")  # punctuation of quoted speech before `she said`
STRESS_DISTANCE = 3  # largest distance [words] from a weak word to the content word that carries its stroke


@dataclass(frozen=True)
class PhrasePart:
    """Words with a role in the text, such as list items."""

    intent: str
    first: int
    last: int
    says: str
    certainty: float


def accent_of(passage: Passage, phrase: int) -> int:
    """Return the index of a phrase's accented word.

    It is the last word that the writer emphasises, otherwise the last content word. A phrase without content words has
    its accent on the last word.
    """
    indices = passage.phrases[phrase]
    emphatic = [k for k in indices if passage.words[k].emphatic]
    return (emphatic or passage.content[phrase] or list(indices))[-1]


def stressed_near(passage: Passage, index: int) -> int:
    """Return the index of the word that carries an intent's stroke.

    A content word, an emphasised one, and one in a phrase without content words, keeps it. Other words (`you`, `my`,
    `not`) are weak: the stroke falls on the next content word of their phrase, otherwise on the last one before them.
    """
    words = passage.words
    content = passage.content[words[index].phrase]
    if words[index].is_content or words[index].emphatic or not content:
        return index
    at = bisect_right(content, index)
    if at < len(content) and content[at] <= index + STRESS_DISTANCE:
        return content[at]
    return min(content[max(at - 1, 0) : at + 1], key=lambda k: abs(k - index))


@dataclass(frozen=True)
class Grammar:
    """Noun phrases, verbs and clauses of a passage, as word indices."""

    things: tuple[tuple[int, int], ...]  # indices of first and last word of each noun phrase
    verbs: tuple[int, ...]  # index of the first verb of each sentence with a verb
    clauses: tuple[int, ...]  # index of the last word of each word's clause


def read_grammar(passage: Passage, language: Language) -> Grammar:
    """Find the phrase structure by word classes and punctuation."""
    things = [
        noun_phrase for sentence in passage.sentences for noun_phrase in _find_noun_phrases(passage, language, sentence)
    ]
    verbs = [verb for sentence in passage.sentences for verb in _find_first_verb(passage, language, sentence)]
    return Grammar(tuple(things), tuple(verbs), tuple(clause_ends(passage, language)))


def find_phrases(passage: Passage, language: Language, grammar: Grammar) -> Iterator[PhrasePart]:
    """Yield accents, emphasised words, noun phrases, first verbs and lists."""
    for number, indices in enumerate(passage.phrases):
        k = accent_of(passage, number)
        if language.has("opener", passage.words[k].plain) and not passage.words[k].emphatic:
            continue  # a lone `well` or `so` carries no accent
        yield PhrasePart("accent", k, k, "carries the accent of its phrase", 0.3 if len(indices) > 1 else 0.2)
    for k, word in enumerate(passage.words):
        if word.emphatic:
            yield PhrasePart("emphasis-strong", k, k, "is stressed by the writer", 0.85)
    named = set[int]()  # sentences with a noun phrase up to here
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
    """Return the index of the last word of each word's clause.

    A clause ends at punctuation, or before a word that begins another clause.
    """
    words = passage.words
    ends = list(range(len(words)))
    for k in reversed(ends[:-1]):
        after = words[k + 1]
        is_over = after.sentence != words[k].sentence or not _CLAUSE_SIGNS.isdisjoint(after.before)
        if not (is_over or language.has("negation_end", after.plain)):
            ends[k] = ends[k + 1]
    return ends


def _find_noun_phrases(passage: Passage, language: Language, sentence: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Yield the noun phrases: each determiner with its noun.

    The noun is the first content word after it that is not a known adjective.
    """
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


def _find_first_verb(passage: Passage, language: Language, sentence: Sequence[int]) -> Iterator[int]:
    """Yield a sentence's first verb: auxiliary, or word after the subject."""
    for k in sentence:
        is_verb = language.has("auxiliary", passage.words[k].plain)
        after = k > sentence[0] and language.has("subject", passage.words[k - 1].plain)
        if is_verb or (after and passage.words[k].is_content):
            yield k
            return


def _list(passage: Passage, language: Language, sentence: Sequence[int]) -> Iterator[PhrasePart]:
    """Yield the items of a list such as `a, b and c`.

    Items are short parts between commas, the last one after `and` or `or`.
    """
    if any(passage.words[k].before.startswith(QUOTATION_ENDS) for k in sentence):
        return  # the commas around `she said` separate no items
    pieces: list[list[int]] = [[]]
    joint = False
    for k in sentence:
        word = passage.words[k]
        joins = language.has("list_joint", word.plain)
        if k > sentence[0] and ("," in word.before or joins) and pieces[-1]:
            pieces.append([])
        joint |= joins and len(pieces) >= MIN_ITEMS
        if not joins:
            pieces[-1].append(k)
    items = [piece for piece in pieces[1:-1] if 0 < len(piece) <= MAX_ITEM_WORDS]
    if not joint or len(items) != len(pieces) - 2 or not pieces[-1]:
        return
    items = [pieces[0][-MAX_ITEM_WORDS:], *items, pieces[-1][:MAX_ITEM_WORDS]]
    for number, item in enumerate(items):
        content = [k for k in item if passage.words[k].is_content] or item
        k = content[0] if number == len(items) - 1 else content[-1]
        side = ("left", "right")[number % 2]
        yield PhrasePart(f"listing-{side}", k, k, f"is item {number + 1} of a list", 0.45)
