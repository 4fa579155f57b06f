"""Language rules of `configs/intents/LANGUAGE.toml`: word classes and meanings.

A language without rules has beats, pauses and questions.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Literal

import msgspec

from kinesic.body.config import CONFIGS, ConfigError, read_toml

PhrasePosition = Literal[
    "anywhere", "first", "last", "question", "statement", "tag", "alone"
]  # tag: at the end of a question
RuleScope = Literal["word", "clause", "sentence"]  # extent of an intent

RULE_FOLDER = CONFIGS / "intents"  # folder of the language rules
ENGLISH_TAG = "en"  # language tag of English
_TAG_PATTERN = re.compile(r"[A-Za-z]{2,3}(?:[-_][A-Za-z0-9]{2,8}){0,3}|[A-Za-z]{2,3}-x-[A-Za-z0-9]{2,8}")  # BCP 47


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


class Fractions(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Names of fractions, and words that identify dates, ratings and counts."""

    numerators: list[str]  # names of 1, 2, 3, ...
    denominators: dict[str, list[str]]  # denominator -> singular and plural of the fraction's name
    joint: str  # word between a whole number and a fraction
    pairs: list[str]  # numbers with a slash that are no fraction, such as `24/7`
    pair_ends: list[str]  # words after two numbers that are no fraction, such as `3/4 time`
    count_word: str
    count_heads: list[str]  # words before a number of a whole, such as `step 1/3`
    rating_words: str
    rating_scales: list[str]  # denominators of ratings, such as `8/10`
    rating_ends: list[str]  # words after ratings, such as `4/5 stars`
    date_heads: list[str]  # words before dates without a year, such as `on 3/4`
    part_words: list[str]  # words after a fraction that make a date impossible
    begins_with_denominator: bool = False  # whether the denominator comes first, and all is one word (Japanese)


class _Table(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    tag: str
    rule: list[_Rule]
    classes: dict[str, str]
    emoticons: dict[str, str]
    fractions: Fractions | None = None
    units: dict[str, str] = {}


class _PlainLanguages(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    question_mark: dict[str, str]
    names: dict[str, str]


@dataclass(frozen=True)
class Rule:
    """Meaning of certain words, with the conditions under which it applies."""

    intent: str  # name of a behaviour set
    says: str  # meaning, for people
    certainty: float  # 0..1
    where: PhrasePosition
    reach: RuleScope
    not_before: frozenset[str]  # words that exclude the rule if they follow
    not_after: frozenset[str]  # words that exclude the rule if they precede
    lexemes: tuple[str, ...]  # gestures that show the intent better than those of its behaviour set
    style: str  # style that the rule requests for the sentence; empty: none


@dataclass(frozen=True)
class Language:
    """Word classes, emoticons and rules of a language."""

    tag: str
    classes: Mapping[str, frozenset[str]]  # closed classes: function, conjunction, determiner, auxiliary, ...
    emoticons: Mapping[str, str] = field(default_factory=dict)  # emoticon -> intent
    rules: Mapping[tuple[str, ...], tuple[Rule, ...]] = field(default_factory=dict)  # words -> rules that match them
    voice: str = ""  # language tag of the voice, with the region: `en-GB`; empty: tag of the language
    question_mark: str = ""  # sign that is a question mark in this language only
    fractions: Fractions | None = None  # names of fractions in this language; None: fractions stay as written
    units: Mapping[str, str] = field(default_factory=dict)  # unit with a slash -> its spoken words
    warning: str = ""  # message about what is missing in a language without rules; empty with rules

    @property
    def has_rules(self) -> bool:
        """Whether rules give meanings to words in this language."""
        return bool(self.rules)

    def has(self, name: str, word: str) -> bool:
        """Return whether a word belongs to a closed word class."""
        return word in self.classes.get(name, frozenset())

    @property
    def number_word(self) -> str:
        """Word spoken for the abbreviation in `No. 5`, or an empty text."""
        return "".join(self.classes.get("number_word", ()))

    @property
    def has_particles(self) -> bool:
        """Whether particles separate words written without spaces (Japanese)."""
        return "particle" in self.classes

    @cached_property
    def _known(self) -> frozenset[str]:
        return frozenset().union(*self.classes.values(), *self.rules)

    def knows(self, word: str) -> bool:
        """Return whether a word occurs in any word class or rule."""
        return word in self._known

    @cached_property
    def longest(self) -> int:
        """Number of words in the language's longest rule."""
        return max((len(words) for words in self.rules), default=0)

    @cached_property
    def emoticon(self) -> str:
        """Regular expression that matches every emoticon, the longest first.

        Without emoticons it never matches.
        """
        longest_first = sorted(self.emoticons, key=len, reverse=True)
        return "|".join(rf"(?<!\w){re.escape(emoticon)}(?!\w)" for emoticon in longest_first) or r"(?!)"

    @cached_property
    def unit(self) -> str:
        """Regular expression that matches every unit, or nothing without units."""
        return "|".join(rf"(?<![^\W\d]|/){re.escape(unit)}(?![\w/])" for unit in self.units) or r"(?!)"


@lru_cache(maxsize=16)
def load_language(tag: str = ENGLISH_TAG) -> Language:
    """Read the rules of a language.

    A regional tag (`en-GB`) has the rules of its language, and its own voice. A language without rules has beats,
    pauses and questions.

    Raises:
        ConfigError: the tag is not a language tag, or its rules are invalid.
    """
    tags = list_languages()
    check_tag(tag)  # prevents a path as a tag
    voice = tag.replace("_", "-")
    base = voice.lower().partition("-")[0]
    if base not in tags:
        return _plain_language(base, voice, tags)
    path = RULE_FOLDER / f"{base}.toml"
    return replace(_language(read_toml(path, _Table), path), voice="" if voice == base else voice)


def check_tag(tag: str) -> None:
    """Check that a text is a language tag.

    Raises:
        ConfigError: the text is not a language tag.
    """
    if not _TAG_PATTERN.fullmatch(tag):
        raise ConfigError(f"language {tag!r} is not a language tag such as en, en-GB, pt-BR or zh")


@lru_cache(maxsize=1)
def list_languages() -> tuple[str, ...]:
    """Return the tags of the languages with rules."""
    return tuple(sorted(file.stem for file in RULE_FOLDER.glob("??.toml")))


def _plain_language(base: str, voice: str, tags: tuple[str, ...]) -> Language:
    """Return a language without rules."""
    known = read_toml(RULE_FOLDER / "languages.toml", _PlainLanguages)
    name = f"{known.names[base]} ({voice})" if base in known.names else repr(voice)
    given = "only voice, beats, pauses and questions are given"
    return Language(
        base,
        {},
        load_language().emoticons,
        voice="" if voice == base else voice,
        question_mark=known.question_mark.get(base, ""),
        warning=f"{name} has no rules of meaning: {given}; rules exist for {', '.join(tags)}",
    )


def _language(table: _Table, path: Path) -> Language:
    rules: dict[tuple[str, ...], list[Rule]] = {}
    for entry in table.rule:
        if not 0.0 <= entry.certainty <= 1.0:
            raise ConfigError(f"{path}: certainty of {entry.intent} is {entry.certainty}; 0 to 1 is possible")
        rule = Rule(
            entry.intent,
            entry.says,
            entry.certainty,
            entry.where,
            entry.reach,
            frozenset(entry.not_before.split()),
            frozenset(entry.not_after.split()),
            tuple(entry.lexemes),
            entry.style,
        )
        for words in entry.words:
            rules.setdefault(tuple(words.split()), []).append(rule)
    return Language(
        table.tag,
        {name: frozenset(words.split()) for name, words in table.classes.items()},
        table.emoticons,
        {words: tuple(rules_of_words) for words, rules_of_words in rules.items()},
        fractions=table.fractions,
        units=table.units,
    )
