"""The lexicon: from a lexeme and a mode to the form of a gesture that means it."""

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path

from kinesic.bml.block import HandMode
from kinesic.body.config import ConfigError
from kinesic.body.robot import OTHER_SIDE, Side
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.body_table import body_form
from kinesic.expressivity.lexicon.entries import ChangedEntry, FormsById, LexiconEntry, ReadEntry, own_gestures
from kinesic.expressivity.lexicon.form import GestureForm, Match, StrokeKey
from kinesic.expressivity.lexicon.gestuary import is_enabled, read_gestuary
from kinesic.expressivity.lexicon.names import read_name, split_words
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.lexicon.space import spread_hands
from kinesic.expressivity.lexicon.synonyms import GestureClass, NamedGesture, NameTable, check_names
from kinesic.expressivity.lexicon.toml_file import LexiconPart, join_parts, read_gestures

UNKNOWN = "unknown"  # means no gesture
NAMELESS = "beat"  # what a gesture without a lexeme most likely is
MOST_NEAR = 3  # gestures that are named when a lexeme is unknown
LONGEST_NAME = 120  # characters of a name that are read; a longer one is none
COMPARED = 40  # characters of a name that are compared with others
FORMS_KEPT = 512  # forms that are turned to other hands


@dataclass(frozen=True, eq=False)
class Lexicon:
    """Gestures, and the names that mean them; of two gestures with one name, the first counts."""

    entries: tuple[LexiconEntry, ...]  # those of the user first
    users_names: tuple[tuple[str, str], ...] = ()  # (name, gesture) that the user's files say
    users_classes: tuple[GestureClass, ...] = ()
    bodies: Mapping[str, BodyForm] = field(default_factory=dict)  # what the body does, by category

    @classmethod
    def load(cls, *users_own: str | Path | LexiconPart | None) -> "Lexicon":
        """Reads the gestures and names of `configs/gestures/`, behind those of files or folders of the user's.

        Args:
            users_own: gestuaries (.xml) of Greta, TOML files, folders of TOML files, or what `read_part` has read of
                them, the most important first; None: none.

        Raises:
            ConfigError: a file is missing or wrong.
        """
        own = own_gestures()
        given = [each for each in users_own if each is not None]
        parts = [each if isinstance(each, LexiconPart) else read_part(each) for each in given]
        users = join_parts(parts, {name: table for part in reversed(parts) for name, table in part.bodies.items()})
        bodies = {name: body_form(table) for name, table in {**own.bodies, **users.bodies}.items()}
        entries: tuple[LexiconEntry, ...] = (*(ReadEntry(*entry) for entry in users.entries), *own.entries)
        lexicon = cls(entries, (*users.synonyms, *users.meanings), users.classes, bodies)
        problems = check_names(users.synonyms, users.classes, lexicon.forms_by_id) if given else ()
        for problem in problems:
            files = [str(each) for each in given if not isinstance(each, LexiconPart)]
            raise ConfigError(f"{', '.join(files) or 'gestures'}: {problem}")
        return lexicon

    @cached_property
    def forms(self) -> tuple[GestureForm, ...]:
        """All gesture forms, which are read for it."""
        return tuple(entry.form for entry in self.entries)

    @cached_property
    def senses(self) -> tuple[Sense, ...]:
        """Of the forms, in the same order."""
        return tuple(entry.sense for entry in self.entries)

    @property
    def synonyms(self) -> tuple[tuple[str, str], ...]:
        """(name, gesture); of two with one name, the first counts."""
        return (
            *self.users_names,
            *own_gestures().names.synonyms,
        )  # our meanings are too loose: many gestures share them

    @property
    def classes(self) -> tuple[GestureClass, ...]:
        """Of gestures, in the order in which they are tried."""
        return (*self.users_classes, *own_gestures().names.classes)

    def read_all(self) -> None:
        """Reads all gestures and names now, and nothing any more when they are asked for."""
        self.near(UNKNOWN)
        self.find(UNKNOWN)

    @cached_property
    def forms_by_id(self) -> Mapping[str, GestureForm]:
        """Gesture forms by their names; of two with one name, the first."""
        return FormsById(self.entries)

    @cached_property
    def _entries_by_name(self) -> Mapping[str, Sequence[LexiconEntry]]:
        """All entries of each name in small letters, in their order."""
        found: dict[str, list[LexiconEntry]] = {}
        for entry in self.entries:
            found.setdefault(entry.id.lower(), []).append(entry)
        return found

    def changed(self, change: Callable[[GestureForm], GestureForm]) -> "Lexicon":
        """Changes the form of every gesture, but neither its name nor its category."""
        return replace(self, entries=tuple(ChangedEntry(entry, change) for entry in self.entries))

    @cached_property
    def as_written(self) -> "Lexicon":
        """The same gestures without others for hands that cannot make their shapes: each is itself on every robot."""
        return self.changed(_without_fallback)

    @cached_property
    def _names(self) -> NameTable:
        return NameTable({entry.id: entry.category for entry in self.entries}, self.synonyms, self.classes)

    def find(self, lexeme: str, mode: HandMode = "unspecified", category: str | None = None) -> Match | None:
        """Finds the gesture of a lexeme, with the hands that the mode asks for.

        Args:
            lexeme: a name in any spelling, or `category=name`; empty: a beat.
            mode: which hands; unspecified: those that the name says, else those of the entry.
            category: preferred among entries of one name; may name the class of a gesture of which no more is known.

        Returns:
            The match, which says how it was found; None when the lexeme means nothing here.
        """
        if "=" in lexeme:
            category, _, lexeme = (part.strip() for part in lexeme.partition("="))
        form = self._entry(lexeme, category)
        if form is not None:
            return Match(in_mode(form, mode))
        found = self._names.find(lexeme, category) if len(lexeme) <= LONGEST_NAME else None
        if found is not None:
            return self._match(found, mode)
        if lexeme.strip() or NAMELESS not in self.forms_by_id:
            return None
        return Match(in_mode(self.forms_by_id[NAMELESS], mode), "class", f"substituted by {NAMELESS}: no lexeme")

    def near(self, lexeme: str) -> tuple[str, ...]:
        """Names gestures that an unknown lexeme may have meant: by their letters, or by words that speak of them."""
        lexeme = lexeme[:LONGEST_NAME]
        words = set(split_words(lexeme))
        scores = [len(words.intersection((*sense.words, sense.category))) for sense in self.senses]
        likely = sorted((k for k, score in enumerate(scores) if score), key=lambda k: (-scores[k], k))
        alike = difflib.get_close_matches("_".join(read_name(lexeme).words)[:COMPARED], self.forms_by_id, n=MOST_NEAR)
        return tuple(dict.fromkeys([*alike, *(self.entries[k].id for k in likely)]))[:MOST_NEAR]

    def names_of(self, gesture: str) -> tuple[str, ...]:
        """Lists the names that mean a gesture, beside its own."""
        return tuple(name for name, meant in self.synonyms if meant == gesture)

    def sense(self, form: GestureForm) -> Sense:
        """Returns the words that describe a gesture form, whichever hands perform it."""
        return next(e.sense for e in self.entries if (e.id, e.category) == (form.id, form.category))

    def _entry(self, lexeme: str, category: str | None) -> GestureForm | None:
        named = self._entries_by_name.get(lexeme.lower(), ())
        wanted = (category or "").lower()
        found = next((entry for entry in named if entry.category.lower() == wanted), named[0] if named else None)
        return None if found is None else found.form

    def _match(self, found: NamedGesture, mode: HandMode) -> Match:
        """Gives what a name means the hands that are asked for, and says what of the name it does not show."""
        form = self.forms_by_id[found.gesture]
        left_out = f'"{" ".join(found.name.left_out)}" is left out' if found.name.left_out else ""
        stands = f"it stands for its class, {found.of}" if found.of else ""
        why = "; ".join(filter(None, (stands, left_out)))
        posed = in_mode(form, found.name.hand if mode == "unspecified" else mode)
        return Match(posed, found.kind, f"substituted by {form.id}: {why}" if why else "")


@lru_cache(maxsize=FORMS_KEPT)  # so that one gesture is one form, of which others remember what it takes
def in_mode(form: GestureForm, mode: HandMode) -> GestureForm:
    """Gives a form the hands that a mode asks for.

    One side: what this hand does in the form, else the mirror image of what the other does. Both: the form as it
    is when both hands take part, else its one hand and its mirror image, far enough apart.
    """
    if mode == "unspecified" or (mode == "both" and len(form.sides) != 1):
        return form
    if mode == "both":
        return replace(form, keys=tuple(_doubled(key) for key in form.keys), body=form.body.symmetric)
    side: Side = "l" if mode == "left" else "r"
    source = form if side in form.sides else mirror_form(form)
    keys = tuple(StrokeKey({side: key.hands[side]}) for key in source.keys if side in key.hands)
    return replace(source, keys=keys)


@lru_cache(maxsize=FORMS_KEPT)
def mirror_form(form: GestureForm) -> GestureForm:
    """Mirrors a form: each hand does what the other did, and the body goes to the other side."""
    keys = tuple(StrokeKey({OTHER_SIDE[side]: pose for side, pose in key.hands.items()}) for key in form.keys)
    return replace(form, keys=keys, body=form.body.mirrored)


def _doubled(key: StrokeKey) -> StrokeKey:
    """Adds its mirror image to a one-handed key."""
    pose = next(iter(key.hands.values()))
    return spread_hands(StrokeKey({"l": pose, "r": pose}))


def _without_fallback(form: GestureForm) -> GestureForm:
    return replace(form, fallback="")


def read_part(path: str | Path) -> LexiconPart:
    """Reads a file or folder of the user's, whose bodies do what is usual where it does not say it.

    Raises:
        ConfigError: a file is missing or wrong.
    """
    path, bodies = Path(path), own_gestures().bodies
    if path.suffix.lower() != ".xml":
        return read_gestures(path, bodies)
    usual = {name: body_form(table) for name, table in bodies.items()}
    forms = [
        replace(form, body=usual.get(form.category.lower(), NO_BODY))
        for form in read_gestuary(path)
        if is_enabled(form)
    ]
    return LexiconPart(tuple((form, Sense(_words(form), form.category.lower())) for form in forms))


def _words(form: GestureForm) -> tuple[str, ...]:
    return tuple(word for word in read_name(form.id).words if not word.isdigit())
