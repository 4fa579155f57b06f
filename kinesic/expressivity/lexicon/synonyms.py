"""Finds the gesture that a name means, by words and never by letters: itself, a synonym, or a gesture of its class.

The names come from the `[synonyms]` and `[classes]` of lexicon files.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from kinesic.body.config import suggestion
from kinesic.expressivity.lexicon.form import MatchKind
from kinesic.expressivity.lexicon.names import CATEGORIES, SIDE_WORDS, GestureName, read_name, split_words

POINTING = "deictic"  # the category

_FILLERS = frozenset(  # of a class: words between it and what is meant, and what does it
    {"at", "to", "of", "on", "in", "with", "by", "for", "toward", "towards"}
    | {"hand", "hands", "arm", "arms", "finger", "fingers", "index", "forefinger"}
)
_PLACES = frozenset(
    {"forward", "forwards", "front", "back", "up", "upward", "down", "downward"}
)  # where a beat is done
_NEGATIONS = frozenset({"no", "not", "dont", "never", "none", "without"})


@dataclass(frozen=True)
class GestureClass:
    """A kind of gesture that one gesture may stand for, when no more is known."""

    name: str
    gesture: str  # its id
    words: tuple[tuple[str, ...], ...]  # words, or several in a row, that name the class
    not_in: tuple[tuple[str, ...], ...] = ()  # words in a row that name something else, such as beat, it

    def others(self, words: Sequence[str]) -> tuple[str, ...] | None:
        """Returns what some words say beside the class; None when they do not name it."""
        named = self._named(words)
        return tuple(word for k, word in enumerate(words) if k not in named) if named else None

    def before(self, words: Sequence[str]) -> frozenset[str]:
        """Returns the words that stand before the first of the class."""
        return frozenset(words[: min(self._named(words), default=0)])

    def _named(self, words: Sequence[str]) -> set[int]:
        """Where words of the class stand; nowhere, when they are in a phrase that says something else."""
        if any(_places(phrase, words) for phrase in self.not_in):
            return set()
        return set().union(*(_places(phrase, words) for phrase in self.words))


def _places(phrase: Sequence[str], words: Sequence[str]) -> set[int]:
    """Where words in a row stand among others."""
    length = len(phrase)
    starts = (k for k in range(len(words) - length + 1) if tuple(words[k : k + length]) == tuple(phrase))
    return {k for start in starts for k in range(start, start + length)}


@dataclass(frozen=True)
class NamedGesture:
    """The gesture that a name means."""

    gesture: str  # its id
    kind: MatchKind
    name: GestureName  # what was left of the name, with the hand and what is not shown
    of: str = ""  # the class that it stands for


@dataclass(frozen=True, eq=False)
class NameTable:
    """All names of all gestures."""

    categories: Mapping[str, str]  # of each gesture by id
    synonyms: Sequence[tuple[str, str]]  # (name as written, id); of two with one name, the first counts
    classes: tuple[GestureClass, ...]  # in the order in which they are tried

    @cached_property
    def _spelled(self) -> Mapping[tuple[str, ...], tuple[str, MatchKind]]:
        """Words of a name -> gesture; a gesture's own name goes before synonyms."""
        own: dict[tuple[str, ...], tuple[str, MatchKind]] = {}
        for gesture in self.categories:
            own.setdefault(read_name(gesture).words, (gesture, "exact"))
        known: dict[tuple[str, ...], tuple[str, MatchKind]] = {}
        for name, gesture in self.synonyms:
            known.setdefault(read_name(name).words, (gesture, "synonym"))
        return {**known, **own}

    @cached_property
    def _run_together(self) -> Mapping[str, tuple[str, MatchKind]]:
        """Names without gaps between their words; `now here` and `nowhere` are then one, and neither counts."""
        found: dict[str, tuple[str, MatchKind]] = {}
        several: set[str] = set()
        for words, entry in self._spelled.items():
            key = "".join(words)
            if found.setdefault(key, entry)[0] != entry[0]:
                several.add(key)
        return {key: entry for key, entry in found.items() if key not in several}

    def find(self, name: str, category: str | None = None) -> NamedGesture | None:
        """Finds the gesture that a name means.

        First comes a gesture of this name, however it is spelled, then a synonym, then the gesture that stands for a
        class that one of its words names.

        Args:
            name: as a document writes it.
            category: of the gesture, as far as the document says; it may name a class, or begin a name.
        """
        read, within = read_name(name), split_words(category or "")
        for shorter in read.shortened():
            entry = self._look_up(shorter.words) or (self._spelled.get((*within, *shorter.words)) if within else None)
            if entry is not None:
                return NamedGesture(*entry, self._with_sides(entry[0], shorter, read))
        numberless = GestureName(tuple(word for word in read.words if not word.isdigit()), read.hand)
        classified = replace(numberless, words=(*read_name(category or "").words, *numberless.words))
        for each in self.classes:
            if each.others(classified.words) is not None:
                return self._of_class(each, classified)
        return None

    def _with_sides(self, gesture: str, shorter: GestureName, whole: GestureName) -> GestureName:
        """Leaves a side out of what a pointing gesture shows: it may be where to point, and not the hand alone."""
        if self.categories[gesture] != POINTING:
            return shorter
        shown = {*shorter.words, *shorter.left_out, "both"}
        return replace(
            shorter, left_out=(*shorter.left_out, *(w for w in whole.words if w in SIDE_WORDS.keys() - shown))
        )

    def _look_up(self, words: tuple[str, ...]) -> tuple[str, MatchKind] | None:
        return self._spelled.get(words) or self._run_together.get("".join(words)) if words else None

    def _of_class(self, each: GestureClass, name: GestureName) -> NamedGesture | None:
        """Finds the gesture of a class that the other words ask for, else the one that stands for the class.

        Nothing is found when they ask for a gesture of another category, for two of this one, or for none at all: the
        class alone would say something else.
        """
        beside = self.categories[each.gesture] != POINTING  # words of a side and place are beside the point
        if beside:
            name = name.sideless()
        others = each.others(name.words) or ()
        asked = replace(name, words=tuple(word for word in others if word not in _FILLERS | CATEGORIES))
        if beside:
            asked = asked.without(_PLACES)
        if not asked.words:
            return NamedGesture(each.gesture, "class", asked, each.name)
        for shorter in asked.shortened() if beside else (asked,):
            entry = self._look_up((*split_words(each.name), *shorter.words)) or self._look_up(shorter.words)
            if entry is not None and self._alike(entry[0], each.gesture):
                return NamedGesture(entry[0], "synonym", shorter)
            if entry is not None and (beside or self.categories[entry[0]] != "iconic"):  # any thing may be pointed at
                return None
        if _NEGATIONS & set(asked.words):
            return None
        named = {word: entry[0] for word in asked.words if (entry := self._look_up((word,))) is not None}
        alike = {gesture for gesture in named.values() if self._alike(gesture, each.gesture)}
        if len(alike) > 1:
            return None
        if not alike:
            if not beside and each.before(name.words) & set(asked.words):  # a noun: match point
                return None
            return NamedGesture(each.gesture, "class", asked.without(frozenset(asked.words)), each.name)
        gesture = alike.pop()
        return NamedGesture(
            gesture, "synonym", asked.without(frozenset(w for w in asked.words if named.get(w) != gesture))
        )

    def _alike(self, one: str, other: str) -> bool:
        return self.categories[one] == self.categories[other]


def check_names(
    synonyms: Iterable[tuple[str, str]], classes: Iterable[GestureClass], gestures: Iterable[str]
) -> Iterator[str]:
    """Yields what is wrong with names: an unknown gesture, a name of two gestures, or one that a gesture has itself.

    Args:
        synonyms: (name, gesture).
        classes: of gestures.
        gestures: ids of all gestures.
    """
    known = sorted(gestures)
    own = {read_name(gesture).words for gesture in known}
    seen: dict[tuple[str, ...], str] = {}
    for each in classes:
        if each.gesture not in known:
            yield f"class {each.name}: no gesture {each.gesture}{suggestion(each.gesture, known)}"
    for name, gesture in synonyms:
        words = read_name(name).words
        if gesture not in known:
            yield f"synonym {name}: no gesture {gesture}{suggestion(gesture, known)}"
        elif not words:
            yield f"synonym {name!r} of {gesture} has no word that says what is done"
        elif words in own:
            yield f"synonym {name} of {gesture} is a gesture itself"
        elif words in seen:
            yield f"synonym {name} of {gesture} is one of {seen[words]} already"
        seen.setdefault(words, gesture)


def class_of(name: str, gesture: str, words: Iterable[str], not_in: Iterable[str] = ()) -> GestureClass:
    """Makes a class of gestures from the words that name it, and phrases in which they say something else."""
    named, otherwise = (tuple(read_name(phrase).words for phrase in phrases) for phrases in (words, not_in))
    return GestureClass(name, gesture, named, otherwise)
