"""Gesture lexicon: look-up of gesture forms by lexeme and hand mode."""

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, lru_cache
from pathlib import Path

from kinesic.bml.block import HandMode
from kinesic.body.config import ConfigError
from kinesic.body.robot import OTHER_SIDE, Side
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.body_table import body_form
from kinesic.expressivity.lexicon.captured_gesture import GestureCapture
from kinesic.expressivity.lexicon.entries import ChangedEntry, FormsById, LexiconEntry, ParsedEntry, builtin_gestures
from kinesic.expressivity.lexicon.form import GestureForm, Match, StrokeKey
from kinesic.expressivity.lexicon.gestuary import is_enabled, read_gestuary
from kinesic.expressivity.lexicon.names import read_name, split_words
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.lexicon.space import spread_hands
from kinesic.expressivity.lexicon.synonyms import GestureClass, NamedGesture, NameTable, check_names
from kinesic.expressivity.lexicon.toml_file import LexiconPart, join_parts, read_gestures

UNKNOWN_LEXEME = "unknown"  # a lexeme that matches no gesture
DEFAULT_GESTURE = "beat"  # gesture performed by behaviours without a lexeme
MAX_SUGGESTIONS = 3  # largest number of gestures suggested for an unknown lexeme
MAX_NAME_LENGTH = 120  # [characters] longer names are not interpreted
COMPARED_LENGTH = 40  # [characters] length to which a name is cut for comparison with gesture names
FORM_CACHE_SIZE = 128  # largest number of cached pairs of form and hand mode


@dataclass(frozen=True, eq=False)
class Lexicon:
    """Lexicon of gestures and their names.

    The first of equal names counts.
    """

    entries: tuple[LexiconEntry, ...]  # the user's entries first
    users_names: tuple[tuple[str, str], ...] = ()  # (name, gesture) from the user's files
    users_classes: tuple[GestureClass, ...] = ()
    bodies: Mapping[str, BodyForm] = field(default_factory=dict)  # accompanying body motion by category
    captured: tuple[GestureCapture, ...] = ()  # captured gestures among the entries

    @classmethod
    def load(cls, *user_sources: str | Path | LexiconPart | None) -> "Lexicon":
        """Read the user's gestures and those of `configs/gestures/`.

        Args:
            *user_sources: gestuaries (.xml) of Greta, TOML files, folders of TOML files, or parts returned by
                    `read_part`, in order of precedence; None is ignored. All of them precede the gestures of kinesic.

        Raises:
            ConfigError: a file is missing or invalid.
        """
        sources = [source for source in user_sources if source is not None]
        if not sources:
            return builtin_lexicon()
        builtin = builtin_gestures()
        parts = [source if isinstance(source, LexiconPart) else read_part(source) for source in sources]
        user_part = join_parts(parts, {name: table for part in reversed(parts) for name, table in part.bodies.items()})
        bodies = {name: body_form(table) for name, table in {**builtin.bodies, **user_part.bodies}.items()}
        entries: tuple[LexiconEntry, ...] = (*(ParsedEntry(*entry) for entry in user_part.entries), *builtin.entries)
        names = (*user_part.synonyms, *user_part.meanings)
        lexicon = cls(entries, names, user_part.classes, bodies, user_part.captured)
        for problem in check_names(user_part.synonyms, user_part.classes, lexicon.forms_by_id):
            files = [str(source) for source in sources if not isinstance(source, LexiconPart)]
            raise ConfigError(f"{', '.join(files) or 'gestures'}: {problem}")
        return lexicon

    def __repr__(self) -> str:
        return f"<lexicon of {len(self.entries)} gestures in {len(self.categories)} categories>"

    @property
    def categories(self) -> tuple[str, ...]:
        """Categories of all gestures, in alphabetical order."""
        return tuple(sorted({entry.category for entry in self.entries}))

    @cached_property
    def forms(self) -> tuple[GestureForm, ...]:
        """All gesture forms.

        Reading it parses every entry.
        """
        return tuple(entry.form for entry in self.entries)

    @cached_property
    def senses(self) -> tuple[Sense, ...]:
        """Descriptive words of all entries, in the order of the forms."""
        return tuple(entry.sense for entry in self.entries)

    @property
    def synonyms(self) -> tuple[tuple[str, str], ...]:
        """Pairs of synonym and gesture name.

        The first of equal names counts.
        """
        return (
            *self.users_names,
            *builtin_gestures().names.synonyms,
        )  # meanings of kinesic's gestures are excluded: several gestures have the same ones

    @property
    def classes(self) -> tuple[GestureClass, ...]:
        """Gesture classes in order of precedence."""
        return (*self.users_classes, *builtin_gestures().names.classes)

    def read_all(self) -> None:
        """Parse all gestures and names now, so that later look-ups are fast."""
        self.near(UNKNOWN_LEXEME)
        self.find(UNKNOWN_LEXEME)

    @cached_property
    def forms_by_id(self) -> Mapping[str, GestureForm]:
        """Gesture forms by name.

        The first of equal names counts.
        """
        return FormsById(self.entries)

    @cached_property
    def _entries_by_name(self) -> Mapping[str, Sequence[LexiconEntry]]:
        """Lexicon entries of each lower-case gesture name, in lexicon order."""
        entries_by_name: dict[str, list[LexiconEntry]] = {}
        for entry in self.entries:
            entries_by_name.setdefault(entry.id.lower(), []).append(entry)
        return entries_by_name

    def changed(self, change: Callable[[GestureForm], GestureForm]) -> "Lexicon":
        """Return a lexicon with every form changed by a function.

        Names and categories stay the same.
        """
        return replace(self, entries=tuple(ChangedEntry(entry, change) for entry in self.entries))

    @cached_property
    def as_written(self) -> "Lexicon":
        """Lexicon without fallback gestures for hands that lack fingers."""
        return self.changed(_without_fallback)

    @cached_property
    def _names(self) -> NameTable:
        return NameTable({entry.id: entry.category for entry in self.entries}, self.synonyms, self.classes)

    def find(self, lexeme: str, mode: HandMode = "unspecified", category: str | None = None) -> Match | None:
        """Find the gesture of a lexeme, performed by the requested hands.

        Args:
            lexeme: a name in any spelling, or `category=name`; empty: a beat.
            mode: requested hands; unspecified: those in the name, otherwise those of the entry.
            category: preferred among entries of the same name; may name the class of an otherwise unknown gesture.

        Returns:
            The match with the kind of the match; None when the lexeme is unknown.
        """
        if "=" in lexeme:
            category, _, lexeme = (part.strip() for part in lexeme.partition("="))
        form = self._entry(lexeme, category)
        if form is not None:
            return Match(in_mode(form, mode))
        named_gesture = self._names.find(lexeme, category) if len(lexeme) <= MAX_NAME_LENGTH else None
        if named_gesture is not None:
            return self._match(named_gesture, mode)
        if lexeme.strip() or DEFAULT_GESTURE not in self.forms_by_id:
            return None
        return Match(
            in_mode(self.forms_by_id[DEFAULT_GESTURE], mode), "class", f"substituted by {DEFAULT_GESTURE}: no lexeme"
        )

    def near(self, lexeme: str) -> tuple[str, ...]:
        """Suggest gestures with similar names or meanings for an unknown lexeme."""
        lexeme = lexeme[:MAX_NAME_LENGTH]
        words = set(split_words(lexeme))
        scores = [len(words.intersection((*sense.words, sense.category))) for sense in self.senses]
        likely = sorted((k for k, score in enumerate(scores) if score), key=lambda k: (-scores[k], k))
        alike = difflib.get_close_matches(
            "_".join(read_name(lexeme).words)[:COMPARED_LENGTH], self.forms_by_id, n=MAX_SUGGESTIONS
        )
        return tuple(dict.fromkeys([*alike, *(self.entries[k].id for k in likely)]))[:MAX_SUGGESTIONS]

    def names_of(self, gesture: str) -> tuple[str, ...]:
        """Return the synonyms of a gesture."""
        return tuple(name for name, meant in self.synonyms if meant == gesture)

    def named_hands(self, form: GestureForm) -> HandMode:
        """Return a form's hands if unusual for its gesture, otherwise `unspecified`."""
        usual_form = self.forms_by_id.get(form.id)
        if usual_form is None or form.sides == usual_form.sides:
            return "unspecified"
        return "both" if len(form.sides) > 1 else "left" if "l" in form.sides else "right"

    def sense(self, form: GestureForm) -> Sense:
        """Return the descriptive words of a form's gesture, independent of its hands."""
        return next(e.sense for e in self.entries if (e.id, e.category) == (form.id, form.category))

    def _entry(self, lexeme: str, category: str | None) -> GestureForm | None:
        named = self._entries_by_name.get(lexeme.lower(), ())
        preferred = (category or "").lower()
        match = next((entry for entry in named if entry.category.lower() == preferred), named[0] if named else None)
        return None if match is None else match.form

    def _match(self, named_gesture: NamedGesture, mode: HandMode) -> Match:
        """Convert a named gesture to a match with the requested hands.

        The match lists the words of the name that the gesture does not show.
        """
        form = self.forms_by_id[named_gesture.gesture]
        left_out = f'"{" ".join(named_gesture.name.left_out)}" is left out' if named_gesture.name.left_out else ""
        stands = f"it stands for its class, {named_gesture.of}" if named_gesture.of else ""
        why = "; ".join(filter(None, (stands, left_out)))
        posed = in_mode(form, named_gesture.name.hand if mode == "unspecified" else mode)
        return Match(posed, named_gesture.kind, f"substituted by {form.id}: {why}" if why else "")


@cache
def builtin_lexicon() -> Lexicon:
    """Return the lexicon of kinesic's gestures alone, once per process.

    Its look-up tables are thus built once, and caches keyed by a lexicon stay valid.
    """
    builtin = builtin_gestures()
    return Lexicon(builtin.entries, bodies={name: body_form(table) for name, table in builtin.bodies.items()})


@lru_cache(maxsize=FORM_CACHE_SIZE)  # keeps one object per gesture, by which other caches are keyed
def in_mode(form: GestureForm, mode: HandMode) -> GestureForm:
    """Return a gesture form performed by the requested hands.

    One hand: its own motion in the form, otherwise the mirror image of the other hand's. Both: the form itself when
    both hands take part, otherwise its single hand and the mirror image, far enough apart.
    """
    if mode == "unspecified" or (mode == "both" and len(form.sides) != 1):
        return form
    if mode == "both":
        return replace(form, keys=tuple(_doubled(key) for key in form.keys), body=form.body.symmetric)
    side: Side = "l" if mode == "left" else "r"
    source = form if side in form.sides else mirror_form(form)
    keys = tuple(StrokeKey({side: key.hands[side]}) for key in source.keys if side in key.hands)
    return replace(source, keys=keys)


def mirror_form(form: GestureForm) -> GestureForm:
    """Exchange left and right in a gesture form, body motion included."""
    keys = tuple(StrokeKey({OTHER_SIDE[side]: pose for side, pose in key.hands.items()}) for key in form.keys)
    return replace(form, keys=keys, body=form.body.mirrored)


def _doubled(key: StrokeKey) -> StrokeKey:
    """Add the mirror image of the hand to a one-handed key."""
    pose = next(iter(key.hands.values()))
    return spread_hands(StrokeKey({"l": pose, "r": pose}))


def _without_fallback(form: GestureForm) -> GestureForm:
    return replace(form, fallback="")


def read_part(path: str | Path) -> LexiconPart:
    """Read a user's gestures and names from a file or folder.

    Body motion that it does not specify is that of the category.

    Raises:
        ConfigError: a file is missing or invalid.
    """
    path, bodies = Path(path), builtin_gestures().bodies
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
