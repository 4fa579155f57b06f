"""Recognition of stage directions by their first word and position."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

import msgspec

from kinesic.body.config import CONFIGS, read_toml

ACT_FILE = CONFIGS / "intents" / "directions.toml"
MAX_DIRECTION_WORDS = 8  # number of words of the longest stage direction
_WORD_PATTERN = re.compile(r"[^\W\d_]+(?:['\u2019-][^\W\d_]+)*")
_VERB_ENDINGS = ("s", "es", "ed", "ing", "d")  # endings of verbs


class _Table(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    acts: dict[str, str]
    words: dict[str, str]
    emoticons: dict[str, str]


@dataclass(frozen=True, eq=False)
class Acts:
    """Stage directions with their behaviours, and word classes that identify directions."""

    behaviours: Mapping[str, str]  # direction or emoji -> channel and lexeme; empty: no behaviour shows it
    classes: Mapping[str, frozenset[str]]  # words and tags that distinguish directions from text
    emoticons: Mapping[str, str]  # emoticon or kaomoji -> emoji with the same meaning

    def has(self, name: str, word: str) -> bool:
        """Return whether a word or tag belongs to a word class."""
        return word in self.classes[name]

    def find(self, words: str) -> str | None:
        """Return a stage direction's behaviour, such as `head NOD`.

        Returns:
            Channel and lexeme, empty if nothing can show the direction; None for an unknown one.
        """
        if words in self.behaviours:
            return self.behaviours[words]
        parts = self.content(words)
        for verb in base_forms(parts[0]) if parts else ():
            for count in range(min(len(parts), 3), 0, -1):
                behaviour = self.behaviours.get(" ".join((verb, *parts[1:count])))
                if behaviour is not None:
                    return behaviour
        return None

    def content(self, words: str) -> list[str]:
        """Return the words of a stage direction that carry its meaning."""
        tokens = [word.lower() for word in _WORD_PATTERN.findall(words)]
        if len(tokens) > 2 and tokens[0] == "the" and tokens[2].endswith("s"):  # the robot waves
            tokens = tokens[2:]
        return [
            word for word in tokens if not self.has("skipped", word) and not (word.endswith("ly") and len(word) > 4)
        ]

    def is_pause(self, words: str) -> bool:
        """Return whether a stage direction requests a pause."""
        return bool({*self.content(words)[:1], *self.content(words)[-1:]} & self.classes["pauses"])

    def is_direction(self, words: str, *, begins: bool, ends: bool, is_bracketed: bool = False) -> bool:
        """Return whether words in brackets or asterisks are a stage direction.

        Args:
            words: text between the signs.
            begins: whether a sentence or phrase begins at them.
            ends: whether a sentence or line ends with them.
            is_bracketed: whether the signs are brackets, which never mark stress.
        """
        parts = self.content(words)
        count = len(_WORD_PATTERN.findall(words))
        if not parts or count > MAX_DIRECTION_WORDS or re.search(r"[\d/=@+]", words):
            return False
        first = parts[0]
        if len(parts) > 1 and self.has("auxiliaries", parts[1]):
            return False
        is_third_person = first.endswith("s") and not first.endswith(("ss", "us", "'s")) and len(first) > 3
        is_third_person = is_third_person and not self.has("not_verbs", first)
        if self.find(" ".join(parts)) is not None or self.is_pause(words):
            if is_bracketed:
                return True
            return begins or ends or len(parts) > 1 if is_third_person else begins and ends
        return is_third_person and words[:1].islower() and (begins or (ends and not is_bracketed))


def base_forms(verb: str) -> Iterator[str]:
    """Yield a verb and its possible base forms (`waving`: `wave`)."""
    yield verb
    for ending in _VERB_ENDINGS:
        stem = verb.removesuffix(ending)
        if stem != verb and len(stem) > 1:
            yield stem
            yield stem + "e"
            if stem[-1] == "i":
                yield stem[:-1] + "y"
            if stem[-1] == stem[-2]:
                yield stem[:-1]


@lru_cache(maxsize=1)
def load_acts() -> Acts:
    """Read the table of stage directions and their behaviours.

    Raises:
        ConfigError: the file is invalid.
    """
    table = read_toml(ACT_FILE, _Table)
    return Acts(table.acts, {name: frozenset(text.split()) for name, text in table.words.items()}, table.emoticons)
