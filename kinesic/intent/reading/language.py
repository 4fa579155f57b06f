"""The rules of a language, from `configs/intents/LANGUAGE.toml`: closed classes of words, and what words mean."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml

PhrasePosition = Literal[
    "anywhere", "first", "last", "question", "statement", "tag", "alone"
]  # tag: last in a question
RuleScope = Literal["word", "clause", "sentence"]  # how far from its word an intent goes on

FOLDER = CONFIGS / "intents"
ENGLISH = "en"


class _Rule(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    intent: str
    words: list[str]
    says: str
    certainty: float = 0.7
    where: PhrasePosition = "anywhere"
    reach: RuleScope = "word"
    not_before: str = ""
    not_after: str = ""
    lexemes: list[str] = []
    style: str = ""


class _Table(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    tag: str
    rule: list[_Rule]
    classes: dict[str, str]
    emoticons: dict[str, str]


@dataclass(frozen=True)
class Rule:
    """Words that mean something."""

    intent: str  # name of a behaviour set
    says: str  # what they mean, for people
    certainty: float  # 0..1
    where: PhrasePosition
    reach: RuleScope
    not_before: frozenset[str]  # it does not hold where one of these follows
    not_after: frozenset[str]  # nor where one of these goes before
    lexemes: tuple[str, ...]  # gestures that show it better than its set
    style: str  # manner that it asks for in its sentence; empty: none


@dataclass(frozen=True)
class Language:
    """What is known of a language."""

    tag: str
    classes: Mapping[str, frozenset[str]]  # closed classes: function, conjunction, determiner, auxiliary, ...
    emoticons: Mapping[str, str] = field(default_factory=dict)  # emoticon -> intent
    rules: Mapping[tuple[str, ...], tuple[Rule, ...]] = field(default_factory=dict)  # words -> what they mean

    def has(self, name: str, word: str) -> bool:
        """Whether a word is of a closed class."""
        return word in self.classes.get(name, frozenset())

    @property
    def has_particles(self) -> bool:
        """Whether its words are written without spaces, and its particles tell where they end."""
        return "particle" in self.classes

    @cached_property
    def _known(self) -> frozenset[str]:
        return frozenset().union(*self.classes.values(), *self.rules)

    def knows(self, word: str) -> bool:
        """Whether a word is of any class or rule."""
        return word in self._known

    @cached_property
    def longest(self) -> int:
        """Words of the longest pattern."""
        return max((len(words) for words in self.rules), default=0)

    @cached_property
    def emoticon(self) -> str:
        """A regular expression that matches every emoticon, the longest first; of none, one that never matches."""
        longest_first = sorted(self.emoticons, key=len, reverse=True)
        return "|".join(rf"(?<!\w){re.escape(each)}(?!\w)" for each in longest_first) or r"(?!)"


@lru_cache(maxsize=16)
def load_language(tag: str = ENGLISH) -> Language:
    """Reads a language; one that is too precise (`en-GB`) is taken as what it is one of.

    Raises:
        ConfigError: there are no rules for it, or they are wrong.
    """
    known, base = sorted(each.stem for each in FOLDER.glob("??.toml")), tag.lower().partition("-")[0]
    if base not in known:  # never a path
        raise ConfigError(f"no rules for the language {tag!r}; there are {', '.join(known)}")
    path = FOLDER / f"{base}.toml"
    return _language(read_toml(path, _Table), path)


def _language(table: _Table, path: Path) -> Language:
    rules: dict[tuple[str, ...], list[Rule]] = {}
    for each in table.rule:
        if not 0.0 <= each.certainty <= 1.0:
            raise ConfigError(f"{path}: certainty of {each.intent} is {each.certainty}; 0 to 1 is possible")
        rule = Rule(
            each.intent,
            each.says,
            each.certainty,
            each.where,
            each.reach,
            frozenset(each.not_before.split()),
            frozenset(each.not_after.split()),
            tuple(each.lexemes),
            each.style,
        )
        for words in each.words:
            rules.setdefault(tuple(words.split()), []).append(rule)
    return Language(
        table.tag,
        {name: frozenset(words.split()) for name, words in table.classes.items()},
        table.emoticons,
        {words: tuple(found) for words, found in rules.items()},
    )
