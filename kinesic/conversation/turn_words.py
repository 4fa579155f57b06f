"""Words that stop speech, agree, or announce more words, from `configs/turn_words.toml`."""

import re
from dataclasses import dataclass
from functools import cache, cached_property

import msgspec

from kinesic.body.config import CONFIGS, read_toml

WORD_PATTERN = re.compile(r"[\w'-]+")  # regular expression of one word
UNSPACED_LANGUAGES = ("ja",)  # languages that write no spaces between words


class TurnWordTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of the words of one language."""

    stop: tuple[str, ...]  # words that stop the robot's speech
    agreement: tuple[str, ...]  # words of agreement, which do not take the turn
    unfinished: tuple[str, ...]  # last words that announce further words
    fillers: tuple[str, ...]


@dataclass(frozen=True)
class TurnWords:
    """Words of one language that stop speech, agree, or announce more words."""

    language: str = ""  # language tag; empty: a language without such words
    stop: tuple[str, ...] = ()  # words that stop the robot's speech
    agreement: tuple[str, ...] = ()  # words of agreement, which do not take the turn
    unfinished: tuple[str, ...] = ()  # last words that announce further words
    fillers: tuple[str, ...] = ()  # short utterances that fill the time until an answer

    def has_stop_word(self, text: str) -> bool:
        """Return whether a text begins with a stop word.

        Leading words of agreement are skipped.
        """
        return _begins_with(self._rest(text), self.stop, spaced=self._is_spaced)

    def without_agreement(self, text: str) -> tuple[str, ...]:
        """Return the words of a text without leading words of agreement."""
        rest = self._rest(text)
        return tuple(rest.split()) if self._is_spaced else tuple(rest)

    def is_unfinished(self, text: str) -> bool:
        """Return whether a text ends with a conjunction, article or hesitation."""
        words = _normalised(text)
        return any(words.endswith(f" {end}" if self._is_spaced else end) or words == end for end in self.unfinished)

    @property
    def _is_spaced(self) -> bool:
        return self.language not in UNSPACED_LANGUAGES

    @cached_property
    def _agreement(self) -> tuple[str, ...]:
        """Words of agreement, longest first."""
        return tuple(sorted(map(_normalised, self.agreement), key=len, reverse=True))

    def _rest(self, text: str) -> str:
        """Return a normalised text without leading words of agreement."""
        rest = _normalised(text)
        while (
            first := next((w for w in self._agreement if _begins_with(rest, (w,), spaced=self._is_spaced)), "")
        ) != "":
            rest = rest[len(first) :].strip()
        return rest


NO_TURN_WORDS = TurnWords()


@cache
def turn_words(language: str) -> TurnWords:
    """Read the turn words of a language, such as `en` or `en-GB`.

    The result is empty for a language without an entry.
    """
    tag = language.replace("_", "-").partition("-")[0].lower()
    table = _turn_word_tables().get(tag)
    if table is None:
        return NO_TURN_WORDS
    return TurnWords(tag, table.stop, table.agreement, table.unfinished, table.fillers)


@cache
def _turn_word_tables() -> dict[str, TurnWordTable]:
    return read_toml(CONFIGS / "turn_words.toml", dict[str, TurnWordTable])


def _normalised(text: str) -> str:
    """Return lower-case words separated by single spaces."""
    return " ".join(WORD_PATTERN.findall(text.lower().replace("\u2019", "'")))


def _begins_with(text: str, phrases: tuple[str, ...], *, spaced: bool) -> bool:
    return any(text == phrase or text.startswith(f"{phrase} " if spaced else phrase) for phrase in phrases)
