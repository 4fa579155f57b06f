"""Patterns of words: alternatives, optional words, inflections, places in a clause."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

from kinesic.expressivity.lexicon.word_stems import word_stem

START_SIGN = "^"  # sign before a pattern that matches only at the start of a clause
END_SIGN = "$"  # sign after a pattern that matches only at the end of a clause
STROKE_SIGN = "*"  # sign before the word of a pattern on which the stroke falls
STEM_SIGN = "~"  # sign after a word of a pattern that matches with any inflection
ANY_WORD = "_"  # sign in a pattern that matches any one word
NOT_ENDING = "n't"  # ending of negated contractions
NOT_WORD = "not"  # second word of negated contractions in full (do not)
IRREGULAR_FORMS: Mapping[str, str] = {"can't": "can", "won't": "will"}  # negative contraction -> its first word in full
FULL_ENDINGS: Mapping[str, str] = {"m": "am", "re": "are", "ve": "have", "ll": "will"}  # contracted -> full verb
# Words of which the ending `'s` stands for `is`; of nouns, it shows possession.
IS_WORDS = frozenset({"it", "that", "he", "she", "there", "here", "what", "who", "where", "how", "everything", "this"})
OTHER_FORMS: Mapping[str, str] = {"can't": "cannot"}  # word -> other spelling that a pattern also matches
NO_FORMS: Mapping[str, frozenset[str]] = {}  # irregular forms of a language without irregular verbs
ANY_NUMBER = "#"  # sign in a pattern that matches a number word


@dataclass(frozen=True)
class Slot:
    """Position in a pattern, with the words that it accepts."""

    words: frozenset[str]
    stems: frozenset[str] = frozenset()  # stems of words that match in any inflection
    is_optional: bool = False
    is_stroke: bool = False
    is_any: bool = False
    is_number: bool = False

    def accepts(self, word: str, *, is_number: bool) -> bool:
        """Return whether a word of the text fits this position."""
        if self.is_any or word in self.words or (self.is_number and is_number):
            return True
        return bool(self.stems) and word_stem(word) in self.stems


@dataclass(frozen=True)
class Pattern:
    """Sequence of word positions, possibly tied to a clause's start or end."""

    slots: tuple[Slot, ...]
    at_start: bool = False
    at_end: bool = False

    @property
    def min_words(self) -> int:
        """Smallest number of words that the pattern matches.

        A pattern with optional words needs one of them, unless it is bound to the start of a clause.
        """
        return 1 if self.at_start or len(self.slots) == 1 else 2

    @cached_property
    def required(self) -> tuple[frozenset[str], ...]:
        """Alternative words at each required position without placeholder.

        A sentence that matches contains one word of each position.
        """
        literal = (slot for slot in self.slots if not (slot.is_optional or slot.stems or slot.is_any or slot.is_number))
        return tuple(slot.words for slot in literal)

    @cached_property
    def options(self) -> tuple[frozenset[str], ...]:
        """Alternative words at each optional position with several of them."""
        return tuple(slot.words for slot in self.slots if slot.is_optional and len(slot.words) > 1)

    @property
    def first_words(self) -> frozenset[str]:
        """Possible first words and stems (`wav~`) of a match, `_` for any."""
        keys = set[str]()
        for slot in self.slots:
            keys |= slot.words | {f"{stem}{STEM_SIGN}" for stem in slot.stems}
            if slot.is_any or slot.is_number:
                keys.add(ANY_NUMBER if slot.is_number else ANY_WORD)
            if not slot.is_optional:
                break
        return frozenset(keys)

    def match(self, words: Sequence[str], first: int, stop: int, is_number: Callable[[str], bool]) -> "Span | None":
        """Match the pattern with the words of a text, beginning at `first`.

        Args:
            words: plain words of the text.
            first: index of the first word of the match.
            stop: index after the last word that may belong to it.
            is_number: function that returns whether a word is a number.

        Returns:
            The longest match, or None.
        """
        span = self._extend(Span(first, first - 1, -1), 0, words, stop, is_number)
        return span if span is not None and span.last - span.first + 1 >= self.min_words else None

    def _extend(
        self, span: "Span", slot_index: int, words: Sequence[str], stop: int, is_number: Callable[[str], bool]
    ) -> "Span | None":
        """Extend a match by the pattern's positions from an index on."""
        if slot_index == len(self.slots):
            return span if span.last >= span.first else None
        slot, at = self.slots[slot_index], span.last + 1
        if at < stop and slot.accepts(words[at], is_number=is_number(words[at])):
            longer = Span(span.first, at, at if slot.is_stroke else span.stroke)
            result = self._extend(longer, slot_index + 1, words, stop, is_number)
            if result is not None:
                return result
        return self._extend(span, slot_index + 1, words, stop, is_number) if slot.is_optional else None


@dataclass(frozen=True)
class Span:
    """Words of a text that a pattern matches."""

    first: int
    last: int
    stroke: int  # index of the marked word, or -1


def read_pattern(text: str, irregular: Mapping[str, frozenset[str]] = NO_FORMS) -> Pattern:
    """Read a pattern such as `^not bad (at *all)` or `break~ up/down`.

    Args:
        text: the pattern.
        irregular: further forms of verbs, such as `broke` and `broken` of `break`.

    Raises:
        ValueError: a pattern without a required word.
    """
    bare = text.strip()
    at_start, at_end = bare.startswith(START_SIGN), bare.endswith(END_SIGN)
    bare = bare.removeprefix(START_SIGN).removesuffix(END_SIGN).strip()
    slots, is_optional = list[Slot](), False
    for part in bare.replace("(", " ( ").replace(")", " ) ").split():
        if part in ("(", ")"):
            is_optional = part == "("
        else:
            slots.append(_add_forms(_read_slot(part, is_optional=is_optional), part, irregular))
    if not any(not slot.is_optional and not slot.is_any for slot in slots):
        raise ValueError(f"the pattern {text!r} has no required word")
    return Pattern(tuple(slots), at_start, at_end)


def spell_out(pattern: Pattern) -> Pattern | None:
    """Return a pattern with contractions written in full (`do not`, `it is`).

    An optional contraction has a full form only if it is negative, since its parts are optional, too.

    Returns:
        None for a pattern without contractions.
    """
    slots = list[Slot]()
    for slot in pattern.slots:
        forms = [form for form in map(_full_form, slot.words) if form is not None]
        full = [form for form in forms if form[1] == NOT_WORD or not slot.is_optional]
        if not full:
            slots.append(slot)
            continue
        firsts, seconds = (frozenset(words) for words in zip(*full, strict=True))
        is_negated = NOT_WORD in seconds
        slots.append(Slot(firsts, is_optional=slot.is_optional, is_stroke=slot.is_stroke and not is_negated))
        slots.append(Slot(seconds, is_optional=slot.is_optional, is_stroke=slot.is_stroke and is_negated))
    return replace(pattern, slots=tuple(slots)) if len(slots) > len(pattern.slots) else None


def _full_form(word: str) -> tuple[str, str] | None:
    """Return both words of a contraction, or None for another word."""
    if word.endswith(NOT_ENDING):
        return IRREGULAR_FORMS.get(word, word.removesuffix(NOT_ENDING)), NOT_WORD
    first, _, ending = word.partition("'")
    second = "is" if ending == "s" and first in IS_WORDS else FULL_ENDINGS.get(ending, "")
    return (first, second) if second else None


def _add_forms(slot: Slot, part: str, irregular: Mapping[str, frozenset[str]]) -> Slot:
    """Add the irregular forms of the slot's inflected words."""
    if not slot.stems:
        return slot
    verbs = (word.removesuffix(STEM_SIGN) for word in part.removeprefix(STROKE_SIGN).split("/") if STEM_SIGN in word)
    return replace(slot, words=slot.words.union(*(irregular.get(verb, frozenset()) for verb in verbs)))


@lru_cache(maxsize=8192)
def _read_slot(part: str, *, is_optional: bool) -> Slot:
    is_stroke = part.startswith(STROKE_SIGN)
    alternatives = part.removeprefix(STROKE_SIGN).split("/")
    alternatives += [OTHER_FORMS[word] for word in alternatives if word in OTHER_FORMS]
    stems = frozenset(
        word_stem(alternative.removesuffix(STEM_SIGN))
        for alternative in alternatives
        if alternative.endswith(STEM_SIGN)
    )
    words = frozenset(alternative for alternative in alternatives if not alternative.endswith(STEM_SIGN)) - {
        ANY_WORD,
        ANY_NUMBER,
    }
    return Slot(words, stems, is_optional, is_stroke, ANY_WORD in alternatives, ANY_NUMBER in alternatives)
