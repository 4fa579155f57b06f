"""Lexicon entries that are parsed at their first use.

Their names are available at once. Most documents need a few gestures, and reading all that come with kinesic takes
longer than planning one.
"""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from kinesic.body.config import CONFIGS, fit_schema, read_toml
from kinesic.expressivity.lexicon.body_table import Bodies
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.lexicon.toml_file import GestureFile, LexiconPart, make_part

GESTURE_FOLDER = CONFIGS / "gestures"  # folder of the built-in gestures
BODIES_FILE = "bodies.toml"  # name of the file with body motion by category, without gestures
NAMES_FILE = "synonyms.toml"  # name of the file with synonyms and classes, without gestures
_TABLE_HEADING = re.compile(r"^(?=\[\[gesture\]\]$)", re.MULTILINE)  # start of each gesture in a TOML file
_GESTURE_ID = re.compile(r'^id = "(\w+)"$', re.MULTILINE)  # line with the name of a gesture


@dataclass(frozen=True, eq=False)
class ParsedEntry:
    """Gesture whose form is already parsed."""

    form: GestureForm
    sense: Sense

    @property
    def id(self) -> str:
        """Name of the gesture."""
        return self.form.id

    @property
    def category(self) -> str:
        """Category of the gesture."""
        return self.form.category


@dataclass(frozen=True, eq=False)
class TomlEntry:
    """Built-in gesture as TOML text that is parsed at its first use."""

    id: str
    category: str
    text: str  # TOML of the gesture, preceded by the category
    path: Path  # path of the TOML file
    bodies: Bodies

    @cached_property
    def _entry(self) -> tuple[GestureForm, Sense]:
        file = fit_schema(tomllib.loads(self.text), GestureFile, self.path)
        return make_part(self.path, file, self.bodies).entries[0]

    @property
    def form(self) -> GestureForm:
        """Form of the gesture."""
        return self._entry[0]

    @property
    def sense(self) -> Sense:
        """Words that describe the gesture."""
        return self._entry[1]


@dataclass(frozen=True, eq=False)
class ChangedEntry:
    """Lexicon entry whose gesture form is changed by a function on access."""

    entry: "LexiconEntry"
    change: Callable[[GestureForm], GestureForm]  # must keep name and category

    @property
    def id(self) -> str:
        """Name of the gesture."""
        return self.entry.id

    @property
    def category(self) -> str:
        """Category of the gesture."""
        return self.entry.category

    @cached_property
    def form(self) -> GestureForm:
        """Changed form of the gesture."""
        return self.change(self.entry.form)

    @property
    def sense(self) -> Sense:
        """Words that describe the gesture."""
        return self.entry.sense


LexiconEntry = ParsedEntry | TomlEntry | ChangedEntry


class FormsById(Mapping[str, GestureForm]):
    """Mapping from gesture names to forms that are parsed on access.

    The first of equal names counts.
    """

    def __init__(self, entries: Sequence[LexiconEntry]) -> None:
        """Index the entries by name, without parsing their forms."""
        self._entries = {entry.id: entry for entry in reversed(entries)}

    def __getitem__(self, id: str) -> GestureForm:
        return self._entries[id].form

    def __contains__(self, id: object) -> bool:
        return id in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)


@dataclass(frozen=True, eq=False)
class BuiltinGestures:
    """Gestures, names and classes in `configs/gestures/`."""

    entries: tuple[TomlEntry, ...]
    bodies: Bodies

    @cached_property
    def names(self) -> LexiconPart:
        """Synonyms and classes of gestures."""
        return make_part(GESTURE_FOLDER / NAMES_FILE, read_toml(GESTURE_FOLDER / NAMES_FILE, GestureFile), self.bodies)


@cache
def builtin_gestures() -> BuiltinGestures:
    """Find the gestures that come with kinesic, once per process."""
    bodies = {str(name): table for name, table in read_toml(GESTURE_FOLDER / BODIES_FILE, GestureFile).bodies.items()}
    paths = sorted(path for path in GESTURE_FOLDER.glob("*.toml") if path.name not in (BODIES_FILE, NAMES_FILE))
    return BuiltinGestures(tuple(entry for path in paths for entry in _entries_of_file(path, bodies)), bodies)


def _entries_of_file(path: Path, bodies: Bodies) -> Iterator[TomlEntry]:
    """Yield the gestures of a file with their category."""
    head, *tables = _TABLE_HEADING.split(path.read_text("utf-8"))
    category = str(tomllib.loads(head)["category"])
    for table in tables:
        yield TomlEntry(_GESTURE_ID.findall(table)[0], category, head + table, path, bodies)
