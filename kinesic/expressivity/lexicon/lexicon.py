"""The lexicon: from a lexeme and a mode to the form of a gesture, or to a sensible substitute."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from kinesic.bml.block import Mode
from kinesic.body.config import CONFIGS
from kinesic.body.robot import OTHER_SIDE, Side
from kinesic.expressivity.lexicon.form import GestureForm, Match, StrokeKey
from kinesic.expressivity.lexicon.gestuary import is_enabled, read_gestuary
from kinesic.expressivity.lexicon.space import spread_hands
from kinesic.expressivity.lexicon.synonyms import Sense, nearest_sense, read_lexeme
from kinesic.expressivity.lexicon.toml_file import read_gestures

_NAMELESS = "beat"  # what a gesture without a lexeme most likely is


@dataclass(frozen=True, eq=False)
class Lexicon:
    """Gestures and the words that speak of them; of two with one name, the first counts."""

    forms: tuple[GestureForm, ...]
    senses: tuple[Sense, ...]  # of the forms, in the same order

    @classmethod
    def load(cls, path: str | Path | None = None) -> "Lexicon":
        """Reads the gestures of `configs/gestures/`, behind those of a file or folder of the user's.

        Args:
            path: a gestuary of Greta's (.xml), a TOML file, or a folder of TOML files.

        Raises:
            ConfigError: a file is missing or wrong.
        """
        entries = (*(() if path is None else _entries(Path(path))), *_own())
        return cls(tuple(form for form, _ in entries), tuple(sense for _, sense in entries))

    def find(self, lexeme: str, mode: Mode = "unspecified", category: str | None = None) -> Match | None:
        """Finds the gesture of a lexeme, with the hands that the mode asks for.

        Args:
            lexeme: a name, in any case, or `category=name`; empty: a beat.
            mode: which hands; unspecified: those of the entry, or those that a substituted lexeme names.
            category: preferred among entries of one name; what a lexeme without meaning falls back to.

        Returns:
            The match, which says why when it is a substitute; None when the lexeme means nothing here.
        """
        if "=" in lexeme:
            category, _, lexeme = (part.strip() for part in lexeme.partition("="))
        form = self._entry(lexeme, category)
        if form is not None:
            return Match(in_mode(form, mode))
        return self._substitute(lexeme, mode, category)

    def sense(self, form: GestureForm) -> Sense:
        """Returns the words that describe a gesture form, whichever hands perform it."""
        return next(
            sense
            for own, sense in zip(self.forms, self.senses, strict=True)
            if (own.id, own.category) == (form.id, form.category)
        )

    def _entry(self, lexeme: str, category: str | None) -> GestureForm | None:
        named = [form for form in self.forms if form.id.lower() == lexeme.lower()]
        wanted = (category or "").lower()
        return next((form for form in named if form.category.lower() == wanted), named[0] if named else None)

    def _substitute(self, lexeme: str, mode: Mode, category: str | None) -> Match | None:
        """Finds the gesture that the words of a lexeme speak of, else one of its category."""
        reading, kind = read_lexeme(lexeme), read_lexeme(category or "").words
        found = nearest_sense(reading.words, self.senses) or nearest_sense(kind, self.senses)
        why = f'"{" ".join(found[1])}"' if found is not None else "no lexeme"
        if found is None and not lexeme.strip():
            found = nearest_sense((_NAMELESS,), self.senses)
        if found is None:
            return None
        form = self.forms[found[0]]
        side = reading.mode if mode == "unspecified" else mode
        return Match(in_mode(form, side), f"substituted by {form.id}: {why}")


def in_mode(form: GestureForm, mode: Mode) -> GestureForm:
    """Gives a form the hands that a mode asks for.

    One side: what this hand does in the form, else the mirror image of what the other does. Both: the form as it
    is when both hands take part, else its one hand and its mirror image, far enough apart.
    """
    if mode == "unspecified" or (mode == "both" and len(form.sides) != 1):
        return form
    if mode == "both":
        return replace(form, keys=tuple(_doubled(key) for key in form.keys))
    side: Side = "l" if mode == "left" else "r"
    source = form if side in form.sides else mirror_form(form)
    keys = tuple(StrokeKey({side: key.hands[side]}) for key in source.keys if side in key.hands)
    return replace(form, keys=keys)


def mirror_form(form: GestureForm) -> GestureForm:
    """Mirrors a form: each hand does what the other did."""
    keys = tuple(StrokeKey({OTHER_SIDE[side]: pose for side, pose in key.hands.items()}) for key in form.keys)
    return replace(form, keys=keys)


def _doubled(key: StrokeKey) -> StrokeKey:
    """Adds its mirror image to a one-handed key."""
    pose = next(iter(key.hands.values()))
    return spread_hands(StrokeKey({"l": pose, "r": pose}))


@cache
def _own() -> tuple[tuple[GestureForm, Sense], ...]:
    """The entries of `configs/gestures/`, which are many and do not change while a program runs."""
    return tuple(read_gestures(CONFIGS / "gestures"))


def _entries(path: Path) -> list[tuple[GestureForm, Sense]]:
    """Reads a file of the user's."""
    if path.suffix.lower() != ".xml":
        return read_gestures(path)
    forms = [form for form in read_gestuary(path) if is_enabled(form)]
    return [(form, Sense(read_lexeme(form.id).words, form.category.lower())) for form in forms]
