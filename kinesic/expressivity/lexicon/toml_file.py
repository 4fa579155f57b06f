"""The tables of `configs/gestures/*.toml`, and how they become parts of the lexicon."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Literal, get_args

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError, check_inside, read_toml, suggestion
from kinesic.body.robot import Side
from kinesic.expressivity.keyframes import Touch
from kinesic.expressivity.lexicon.body_table import PLAIN_TABLE, Bodies, BodyFormTable, body_form, overlay_table
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.hand_shapes import Finger, FingerMotion, find_shape, finger_motions, hand_shapes
from kinesic.expressivity.lexicon.paths import HandPath, PathKind, SizeTrend, shape_path
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.lexicon.space import position
from kinesic.expressivity.lexicon.synonyms import GestureClass, class_of
from kinesic.expressivity.style.effort import Tempo

Category = Literal["beat", "deictic", "iconic", "metaphoric", "emblem", "adaptor", "emotion", "rest"]
AxisName = Literal["forward", "outward", "up"]

NO_BODIES: Bodies = MappingProxyType({})
_AXES: tuple[AxisName, ...] = ("forward", "outward", "up")
_DIRECTIONS: Mapping[str, tuple[int, int, int]] = {
    "forward": (1, 0, 0),
    "back": (-1, 0, 0),
    "out": (0, 1, 0),
    "in": (0, -1, 0),
    "up": (0, 0, 1),
    "down": (0, 0, -1),
}


class StrictTable(msgspec.Struct, forbid_unknown_fields=True):
    """A table whose unknown keys are errors."""


class PathTable(StrictTable):
    """How a hand comes to its key from the one before; axes in the order of `at`."""

    kind: PathKind
    amplitude: float | tuple[float, float, float] | None = None  # [arm lengths]
    frequency: float | tuple[float, float, float] | None = None  # turns on the whole way
    shift: float | tuple[float, float, float] | None = None  # turns
    amplitude_variation: SizeTrend | None = None
    frequency_variation: SizeTrend = "none"
    points: list[tuple[str | float, str | float, str | float]] = []  # as in `at`


class HandTable(StrictTable):
    """One hand in one key."""

    at: tuple[str | float, str | float, str | float]  # outward, up, forward: sectors or [arm lengths]
    palm: str | None = None  # direction words such as "up" or "forward in"
    pointing: str | None = None  # direction words
    shape: str | None = None  # of `configs/hands.toml`, or another name of it
    openness: float = 0.0  # 0..1
    fixed: list[AxisName] = []  # axes that spatial extent leaves alone
    touch: Touch | None = None  # what the hand is laid on
    tip: Finger | None = None  # the finger whose tip touches it
    path: PathTable | None = None  # goes over that of the key


class KeyTable(StrictTable):
    """One stroke key: either `both`, or a hand for itself."""

    path: PathTable | None = None  # of each hand that has none of its own

    left: HandTable | None = None
    right: HandTable | None = None
    both: HandTable | None = None


class GestureTable(StrictTable):
    """One gesture."""

    id: str
    keys: list[KeyTable]
    meanings: list[str] = []  # words that speak of it, the most characteristic first
    says: str = ""  # what is done and what it means, in one line
    tempo: str = "neutral"  # one of `Tempo`
    body: BodyFormTable = PLAIN_TABLE  # goes over that of the category
    fingers: str = ""  # what fingers do while the stroke lasts: a motion of `configs/hands.toml`
    fallback: str = ""  # id of the gesture for a hand that cannot make its shapes


class ClassTable(StrictTable):
    """A class of gestures, and the gesture that stands for it."""

    gesture: str
    words: list[str]  # that name the class; several in one mean: in a row
    not_in: list[str] = []  # phrases in which these words say something else


class GestureFile(StrictTable):
    """One file: the gestures of a category, and names that find gestures."""

    category: Category | None = None
    gesture: list[GestureTable] = []
    synonyms: dict[str, list[str]] = {}  # by gesture, of this file or another
    classes: dict[str, ClassTable] = {}
    bodies: dict[Category, BodyFormTable] = {}  # what the body does in all gestures of a category


@dataclass(frozen=True, eq=False)
class LexiconPart:
    """What files say."""

    entries: tuple[tuple[GestureForm, Sense], ...] = ()
    synonyms: tuple[tuple[str, str], ...] = ()  # (name, gesture)
    meanings: tuple[tuple[str, str], ...] = ()  # (word, gesture), looser than synonyms
    classes: tuple[GestureClass, ...] = ()
    bodies: Bodies = field(default_factory=dict)


def read_gestures(path: Path, bodies: Bodies = NO_BODIES) -> LexiconPart:
    """Reads the gestures and names of a TOML file, or of all TOML files in a folder in the order of their names.

    Args:
        path: of the file or folder.
        bodies: what the body does in gestures of a category of which the files do not say it.

    Raises:
        ConfigError: a file is missing or wrong, or a folder holds none.
    """
    paths = sorted(path.glob("*.toml")) if path.is_dir() else [path]
    if not paths:
        raise ConfigError(f"{path}: a folder without .toml files")
    if path.is_dir():
        for each in paths:
            check_inside(path, each)
    files = [(each, read_toml(each, GestureFile)) for each in paths]
    known: dict[str, BodyFormTable] = {**bodies}
    for each, file in files:
        _check_bodies(each, file)
        known |= {str(category): table for category, table in file.bodies.items()}
    return join_parts([make_part(each, file, known) for each, file in files], known)


def _check_bodies(path: Path, file: GestureFile) -> None:
    """Refuse out-of-range amounts, which gestures of other files would inherit."""
    for category, table in file.bodies.items():
        try:
            body_form(table)
        except ValueError as error:
            raise ConfigError(f"{path}: [bodies.{category}]: {error}") from None


def join_parts(parts: Sequence[LexiconPart], bodies: Bodies) -> LexiconPart:
    """Puts parts one behind the other; of two entries with one name, the first counts."""
    return LexiconPart(
        tuple(entry for part in parts for entry in part.entries),
        tuple(pair for part in parts for pair in part.synonyms),
        tuple(pair for part in parts for pair in part.meanings),
        tuple(each for part in parts for each in part.classes),
        bodies,
    )


def make_part(path: Path, file: GestureFile, bodies: Bodies) -> LexiconPart:
    """Makes what one file says of its tables.

    Args:
        path: of the file, for messages.
        file: its tables.
        bodies: what the body does in the gestures of each category.

    Raises:
        ConfigError: a gesture is wrong; says which, and what would have worked.
    """
    if file.gesture and file.category is None:
        raise ConfigError(f"{path}: has gestures and no category; {', '.join(get_args(Category))} are known")
    return LexiconPart(
        tuple(_entry(table, file.category or "", path, bodies) for table in file.gesture),
        tuple((name, gesture) for gesture, names in file.synonyms.items() for name in names),
        tuple((word, table.id) for table in file.gesture for word in table.meanings),
        tuple(class_of(name, table.gesture, table.words, table.not_in) for name, table in file.classes.items()),
    )


def _entry(table: GestureTable, category: str, path: Path, bodies: Bodies) -> tuple[GestureForm, Sense]:
    try:
        keys = tuple(_key(key) for key in table.keys)
        if not keys:
            raise ValueError("has no keys, needs at least one")
        _check_paths(keys)
        tempo, fingers = _tempo(table.tempo), _fingers(table.fingers)
        body = body_form(overlay_table(table.body, bodies.get(category, PLAIN_TABLE)))
    except ValueError as error:
        raise ConfigError(f"{path}: gesture {table.id}: {error}") from None
    own_words = [word for word in table.id.split("_") if word not in table.meanings]
    form = GestureForm(
        table.id, category, keys, category == "rest", tempo, body=body, fingers=fingers, fallback=table.fallback
    )
    return form, Sense((*table.meanings, *own_words), category, table.says)


def _fingers(written: str) -> FingerMotion | None:
    known = finger_motions()
    if written and written not in known:
        raise ValueError(f"fingers is {written!r}{suggestion(written, list(known))}")
    return known.get(written)


def _tempo(written: str) -> Tempo:
    for tempo in get_args(Tempo):
        if tempo == written:
            found: Tempo = tempo
            return found
    raise ValueError(f"tempo is {written!r}; {', '.join(get_args(Tempo))} are known")


def _key(table: KeyTable) -> StrokeKey:
    hands: dict[Side, HandPose] = {}
    if table.both is not None:
        if table.left is not None or table.right is not None:
            raise ValueError("a key has both and a single hand; write left and right, or both alone")
        hands["l"] = hands["r"] = _pose(table.both, table.path)
    if table.left is not None:
        hands["l"] = _pose(table.left, table.path)
    if table.right is not None:
        hands["r"] = _pose(table.right, table.path)
    if not hands:
        raise ValueError("a key without hands; give left, right or both")
    return StrokeKey(hands)


def _check_paths(keys: tuple[StrokeKey, ...]) -> None:
    """A path needs a key that it comes from."""
    known: set[Side] = set()
    for key in keys:
        for side, pose in key.hands.items():
            if pose.path is not None and side not in known:
                kind = pose.path.kind
                raise ValueError(f"a hand's first key has a path ({kind}), from nowhere; write the key where it begins")
        known |= key.hands.keys()


def _path(table: PathTable | None) -> HandPath | None:
    if table is None:
        return None
    return shape_path(
        table.kind,
        amplitude=table.amplitude,
        frequency=table.frequency,
        shift=table.shift,
        variations=(table.amplitude_variation, table.frequency_variation),
        points=tuple(position(*point) for point in table.points),
    )


def _pose(table: HandTable, path: PathTable | None) -> HandPose:
    """The hand comes by its own path or that of its key."""
    if not 0.0 <= table.openness <= 1.0:
        raise ValueError(f"openness is {table.openness:g}, outside [0, 1]")
    if table.shape is not None and find_shape(table.shape) is None:
        raise ValueError(f"there is no hand shape {table.shape!r}{suggestion(table.shape, list(hand_shapes()))}")
    if table.tip is not None and table.touch is None:
        raise ValueError(f"tip is {table.tip!r} and touch is missing; write what it touches, such as touch = 'head'")
    forward, outward, up = (axis in table.fixed for axis in _AXES)
    return HandPose(
        position(*table.at),
        (forward, outward, up),
        _direction(table.palm),
        _direction(table.pointing),
        table.shape,
        table.openness,
        table.touch,
        _path(table.path or path),
        table.tip,
    )


def _direction(words: str | None) -> Floats | None:
    """(3,) unit, forward, outward, up: the mean of direction words."""
    if words is None:
        return None
    total = np.zeros(3)
    for word in words.split():
        if word not in _DIRECTIONS:
            raise ValueError(f"{word} is no direction{suggestion(word, list(_DIRECTIONS))}")
        total += _DIRECTIONS[word]
    length = float(np.linalg.norm(total))
    if length == 0:
        raise ValueError(f"{words!r} points nowhere; such as 'up' or 'forward in'")
    return sealed(total / length)
