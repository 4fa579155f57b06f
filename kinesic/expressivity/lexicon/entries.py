"""The entries of a lexicon: each is known by its name at once, and read when it is first asked for.

Most documents ask for a few gestures, and reading all that come with kinesic takes longer than to plan one.
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

FOLDER = CONFIGS / "gestures"
BODIES, NAMES = "bodies.toml", "synonyms.toml"  # the files that hold no gestures
_HEADING = re.compile(r"^(?=\[\[gesture\]\]$)", re.MULTILINE)
_ID = re.compile(r'^id = "(\w+)"$', re.MULTILINE)


@dataclass(frozen=True, eq=False)
class ReadEntry:
    """A gesture that is read already."""

    form: GestureForm
    sense: Sense

    @property
    def id(self) -> str:
        """Its name."""
        return self.form.id

    @property
    def category(self) -> str:
        """Of its form."""
        return self.form.category


@dataclass(frozen=True, eq=False)
class WrittenEntry:
    """A gesture of kinesic's own as it is written, which is trusted to be one."""

    id: str
    category: str
    text: str  # its table, behind the category
    path: Path  # of its file
    bodies: Bodies

    @cached_property
    def _entry(self) -> tuple[GestureForm, Sense]:
        file = fit_schema(tomllib.loads(self.text), GestureFile, self.path)
        return make_part(self.path, file, self.bodies).entries[0]

    @property
    def form(self) -> GestureForm:
        """What it looks like."""
        return self._entry[0]

    @property
    def sense(self) -> Sense:
        """The words that speak of it."""
        return self._entry[1]


@dataclass(frozen=True, eq=False)
class ChangedEntry:
    """A gesture of another form."""

    entry: "LexiconEntry"
    change: Callable[[GestureForm], GestureForm]  # leaves its name and category

    @property
    def id(self) -> str:
        """Its name."""
        return self.entry.id

    @property
    def category(self) -> str:
        """Of its form."""
        return self.entry.category

    @cached_property
    def form(self) -> GestureForm:
        """What it looks like."""
        return self.change(self.entry.form)

    @property
    def sense(self) -> Sense:
        """The words that speak of it."""
        return self.entry.sense


LexiconEntry = ReadEntry | WrittenEntry | ChangedEntry


class FormsById(Mapping[str, GestureForm]):
    """Gesture forms by their names; of two with one name, the first."""

    def __init__(self, entries: Sequence[LexiconEntry]) -> None:
        """Reads none yet."""
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
class OwnGestures:
    """What `configs/gestures/` holds."""

    entries: tuple[WrittenEntry, ...]
    bodies: Bodies

    @cached_property
    def names(self) -> LexiconPart:
        """Names and classes of gestures."""
        return make_part(FOLDER / NAMES, read_toml(FOLDER / NAMES, GestureFile), self.bodies)


@cache
def own_gestures() -> OwnGestures:
    """Finds the gestures that come with kinesic, which are many and do not change while a program runs."""
    bodies = {str(name): table for name, table in read_toml(FOLDER / BODIES, GestureFile).bodies.items()}
    paths = sorted(path for path in FOLDER.glob("*.toml") if path.name not in (BODIES, NAMES))
    return OwnGestures(tuple(entry for path in paths for entry in _written(path, bodies)), bodies)


def _written(path: Path, bodies: Bodies) -> Iterator[WrittenEntry]:
    """The gestures of a file, whose tables stand below its category."""
    head, *tables = _HEADING.split(path.read_text("utf-8"))
    category = str(tomllib.loads(head)["category"])
    for table in tables:
        yield WrittenEntry(_ID.findall(table)[0], category, head + table, path, bodies)
