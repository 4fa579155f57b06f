"""Look-up of gestures by the words of a name, synonyms and classes.

It compares words, never single letters. The names come from `[synonyms]` and `[classes]` of lexicon files.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from kinesic.body.config import suggestion
from kinesic.expressivity.lexicon.form import MatchKind
from kinesic.expressivity.lexicon.names import CATEGORY_WORDS, SIDE_WORDS, GestureName, read_name, split_words

POINTING_CATEGORY = "deictic"  # category of gestures that point

_CLASS_FILLERS = frozenset(  # prepositions and body parts that do not change the meaning of a class
    {"at", "to", "of", "on", "in", "with", "by", "for", "toward", "towards"}
    | {"hand", "hands", "arm", "arms", "finger", "fingers", "index", "forefinger"}
)
_BEAT_DIRECTIONS = frozenset(
    {"forward", "forwards", "front", "back", "up", "upward", "down", "downward"}
)  # direction words that beats do not perform
_NEGATION_WORDS = frozenset({"no", "not", "dont", "never", "none", "without"})


@dataclass(frozen=True)
class GestureClass:
    """Class of gesture names, with the gesture that represents it."""

    name: str
    gesture: str  # id of the representative
    words: tuple[tuple[str, ...], ...]  # phrases that name the class
    not_in: tuple[tuple[str, ...], ...] = ()  # excluded phrases with another meaning, such as "beat it"

    def others(self, words: Sequence[str]) -> tuple[str, ...] | None:
        """Return the words of a name outside this class's phrases.

        Returns:
            None if no phrase of the class, or an excluded one, occurs.
        """
        named = self._named(words)
        return tuple(word for k, word in enumerate(words) if k not in named) if named else None

    def before(self, words: Sequence[str]) -> frozenset[str]:
        """Return the words of a name before the class's first phrase."""
        return frozenset(words[: min(self._named(words), default=0)])

    def _named(self, words: Sequence[str]) -> set[int]:
        """Return the positions of this class's words in a name.

        Empty if the name contains an excluded phrase.
        """
        if any(_places(phrase, words) for phrase in self.not_in):
            return set()
        return set().union(*(_places(phrase, words) for phrase in self.words))


def _places(phrase: Sequence[str], words: Sequence[str]) -> set[int]:
    """Return the word positions covered by all occurrences of a phrase."""
    length = len(phrase)
    starts = (k for k in range(len(words) - length + 1) if tuple(words[k : k + length]) == tuple(phrase))
    return {k for start in starts for k in range(start, start + length)}


@dataclass(frozen=True)
class NamedGesture:
    """Gesture found by its name, with the kind of match."""

    gesture: str  # name of the gesture
    kind: MatchKind
    name: GestureName  # matched words, with the hand and the words that the gesture does not show
    of: str = ""  # name of the class that the gesture represents


@dataclass(frozen=True, eq=False)
class NameTable:
    """Look-up table of gesture names, synonyms and classes."""

    categories: Mapping[str, str]  # category of each gesture, by gesture id
    synonyms: Sequence[tuple[str, str]]  # (name as written, id); the first of equal names counts
    classes: tuple[GestureClass, ...]  # classes in order of precedence

    @cached_property
    def _by_words(self) -> Mapping[tuple[str, ...], tuple[str, MatchKind]]:
        """Gesture and match kind by the words of its names and synonyms.

        Names of gestures precede synonyms.
        """
        names_by_words: dict[tuple[str, ...], tuple[str, MatchKind]] = {}
        for gesture in self.categories:
            names_by_words.setdefault(read_name(gesture).words, (gesture, "exact"))
        synonyms_by_words: dict[tuple[str, ...], tuple[str, MatchKind]] = {}
        for name, gesture in self.synonyms:
            synonyms_by_words.setdefault(read_name(name).words, (gesture, "synonym"))
        return {**synonyms_by_words, **names_by_words}

    @cached_property
    def _by_joined_words(self) -> Mapping[str, tuple[str, MatchKind]]:
        """Gesture and match kind by name or synonym without spaces, if unambiguous.

        `now here` and `nowhere` are then the same name.
        """
        unique_names: dict[str, tuple[str, MatchKind]] = {}
        ambiguous: set[str] = set()
        for words, entry in self._by_words.items():
            key = "".join(words)
            if unique_names.setdefault(key, entry)[0] != entry[0]:
                ambiguous.add(key)
        return {key: entry for key, entry in unique_names.items() if key not in ambiguous}

    def find(self, name: str, category: str | None = None) -> NamedGesture | None:
        """Find the gesture for a name, or None.

        A gesture of this name comes first, in any spelling, then a synonym, then the representative of a class that one
        of the words names.

        Args:
            name: as written in the document.
            category: of the gesture, if the document gives it; it may name a class, or be the beginning of a name.
        """
        read, category_words = read_name(name), split_words(category or "")
        for shorter in read.shortened():
            entry = self._look_up(shorter.words) or (
                self._by_words.get((*category_words, *shorter.words)) if category_words else None
            )
            if entry is not None:
                return NamedGesture(*entry, self._with_sides(entry[0], shorter, read))
        numberless = GestureName(tuple(word for word in read.words if not word.isdigit()), read.hand)
        classified = replace(numberless, words=(*read_name(category or "").words, *numberless.words))
        for gesture_class in self.classes:
            if gesture_class.others(classified.words) is not None:
                return self._of_class(gesture_class, classified)
        return None

    def _with_sides(self, gesture: str, shorter: GestureName, whole: GestureName) -> GestureName:
        """Add unused side words of pointing gesture names to `left_out`.

        The side may be the direction to point, and not only the hand.
        """
        if self.categories[gesture] != POINTING_CATEGORY:
            return shorter
        shown = {*shorter.words, *shorter.left_out, "both"}
        return replace(
            shorter, left_out=(*shorter.left_out, *(w for w in whole.words if w in SIDE_WORDS.keys() - shown))
        )

    def _look_up(self, words: tuple[str, ...]) -> tuple[str, MatchKind] | None:
        return self._by_words.get(words) or self._by_joined_words.get("".join(words)) if words else None

    def _of_class(self, gesture_class: GestureClass, name: GestureName) -> NamedGesture | None:
        """Find a gesture of a class by the name's remaining words.

        The phrases of the class are left out of the name.

        The representative of the class is used if the other words name no gesture. The result is None when they name a
        gesture of another category, two gestures of this one, or a negation, since the class would change the meaning.
        """
        is_other_category = (
            self.categories[gesture_class.gesture] != POINTING_CATEGORY
        )  # sides and directions do not matter
        if is_other_category:
            name = name.sideless()
        others = gesture_class.others(name.words) or ()
        remaining = replace(name, words=tuple(word for word in others if word not in _CLASS_FILLERS | CATEGORY_WORDS))
        if is_other_category:
            remaining = remaining.without(_BEAT_DIRECTIONS)
        if not remaining.words:
            return NamedGesture(gesture_class.gesture, "class", remaining, gesture_class.name)
        for shorter in remaining.shortened() if is_other_category else (remaining,):
            entry = self._look_up((*split_words(gesture_class.name), *shorter.words)) or self._look_up(shorter.words)
            if entry is not None and self._same_category(entry[0], gesture_class.gesture):
                return NamedGesture(entry[0], "synonym", shorter)
            if entry is not None and (
                is_other_category or self.categories[entry[0]] != "iconic"
            ):  # any object may be pointed at
                return None
        if _NEGATION_WORDS & set(remaining.words):
            return None
        named = {word: entry[0] for word in remaining.words if (entry := self._look_up((word,))) is not None}
        same_category = {gesture for gesture in named.values() if self._same_category(gesture, gesture_class.gesture)}
        if len(same_category) > 1:
            return None
        if not same_category:
            if not is_other_category and gesture_class.before(name.words) & set(
                remaining.words
            ):  # a noun such as match point
                return None
            return NamedGesture(
                gesture_class.gesture, "class", remaining.without(frozenset(remaining.words)), gesture_class.name
            )
        gesture = same_category.pop()
        return NamedGesture(
            gesture, "synonym", remaining.without(frozenset(w for w in remaining.words if named.get(w) != gesture))
        )

    def _same_category(self, one: str, other: str) -> bool:
        return self.categories[one] == self.categories[other]


def check_names(
    synonyms: Iterable[tuple[str, str]], classes: Iterable[GestureClass], gestures: Iterable[str]
) -> Iterator[str]:
    """Yield problems of names: unknown gestures, duplicates and conflicts.

    Args:
        synonyms: (name, gesture).
        classes: of gestures.
        gestures: ids of all gestures.
    """
    gesture_ids = sorted(gestures)
    names = {read_name(gesture).words for gesture in gesture_ids}
    seen: dict[tuple[str, ...], str] = {}
    for gesture_class in classes:
        if gesture_class.gesture not in gesture_ids:
            hint = suggestion(gesture_class.gesture, gesture_ids)
            yield f"class {gesture_class.name}: no gesture {gesture_class.gesture}{hint}"
    for name, gesture in synonyms:
        words = read_name(name).words
        if gesture not in gesture_ids:
            yield f"synonym {name}: no gesture {gesture}{suggestion(gesture, gesture_ids)}"
        elif not words:
            yield f"synonym {name!r} of {gesture} has no word that describes a movement"
        elif words in names:
            yield f"synonym {name} of {gesture} is a gesture itself"
        elif words in seen:
            yield f"synonym {name} of {gesture} is one of {seen[words]} already"
        seen.setdefault(words, gesture)


def class_of(name: str, gesture: str, words: Iterable[str], not_in: Iterable[str] = ()) -> GestureClass:
    """Create a gesture class from its phrases and excluded phrases."""
    named, otherwise = (tuple(read_name(phrase).words for phrase in phrases) for phrases in (words, not_in))
    return GestureClass(name, gesture, named, otherwise)
