"""Limits for names and wording of code, docs and commits."""

import re
from dataclasses import dataclass

MAX_FIRST_LINE_WORDS = 12
MAX_SENTENCE_WORDS = 30  # in docs
MAX_PARAMETERS = 6  # of a function, without `self` and `cls`

RIDDLES = re.compile(
    r"\b(what|whatever|who|whoever|whom|nobody|somebody|anybody|anew|beside|told|tells|is said|are said|is called so"
    r"|thereby|likewise|meanwhile|of which|by which|in which case|as much as|so far|else)\b",
    re.IGNORECASE,
)
OLD_WORDS = re.compile(r"\b(shares?|swells?|crowd|crowded|straight between|leads?|led|told|asked for)\b", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Limits:
    """Largest fraction of each kind of text that may break its rule."""

    first_lines: float = 0.03  # docstring first lines: too long, with a semicolon or a riddle
    old_words: float = 0.01  # docstring first lines with a word that the glossary replaces
    constants: float = 0.08  # module constants of one word, or several in one line
    long_sentences: float = 0.10  # sentences of docs above MAX_SENTENCE_WORDS
    long_signatures: int = 32  # number of functions above MAX_PARAMETERS
    shared_names: int = 26  # number of public functions and classes with the name of one in another module


def is_unclear(first_line: str) -> bool:
    """Return whether a docstring's first line breaks a rule."""
    too_long = len(first_line.split()) > MAX_FIRST_LINE_WORDS
    return too_long or ";" in first_line or RIDDLES.search(first_line) is not None


def has_old_word(first_line: str) -> bool:
    """Return whether a docstring's first line has a word that the glossary replaces."""
    return OLD_WORDS.search(first_line) is not None


def is_one_word(constant: str) -> bool:
    """Return whether a constant's name has one word only."""
    return "_" not in constant.strip("_")
