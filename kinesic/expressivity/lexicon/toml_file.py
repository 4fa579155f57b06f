"""Reading of `configs/gestures/*.toml` into gestures, names and body motion."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Literal, get_args

import msgspec

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError, check_inside, read_toml, suggestion
from kinesic.body.robot import Side
from kinesic.expressivity.keyframes import Touch
from kinesic.expressivity.lexicon.body_table import PLAIN_TABLE, Bodies, BodyFormTable, body_form, overlay_table
from kinesic.expressivity.lexicon.captured_gesture import CARD_FILE, GestureCapture, MotionTable, read_captured
from kinesic.expressivity.lexicon.categories import Category
from kinesic.expressivity.lexicon.directions import read_direction
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.hand_shapes import FingerMotion, Surface, find_shape, finger_motions, hand_shapes
from kinesic.expressivity.lexicon.paths import HandPath, PathKind, SizeTrend, shape_path
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.lexicon.space import position
from kinesic.expressivity.lexicon.synonyms import GestureClass, class_of
from kinesic.expressivity.style.effort import Tempo

AxisName = Literal["outward", "up", "forward"]

NO_BODIES: Bodies = MappingProxyType({})  # default: no category has body motion
_AXIS_NAMES: tuple[AxisName, ...] = ("forward", "outward", "up")


class StrictTable(msgspec.Struct, forbid_unknown_fields=True):
    """TOML table that rejects unknown keys."""


class PathTable(StrictTable):
    """TOML table of a hand path from the previous key.

    Three numbers apply to the directions outward, up and forward, as in `at`.
    """

    kind: PathKind  # shape of the path
    amplitude: float | tuple[float, float, float] | None = None  # [arm lengths] along each axis, or one for all
    frequency: float | tuple[float, float, float] | None = None  # periods over the whole path
    shift: float | tuple[float, float, float] | None = None  # phase in periods
    amplitude_variation: SizeTrend | None = None  # change of the amplitude along the path
    frequency_variation: SizeTrend = "none"  # change of the frequency along the path
    points: list[tuple[str | float, str | float, str | float]] = []  # via points of the kind `points`, each as in `at`


class HandTable(StrictTable):
    """TOML table of one hand's pose in a stroke key."""

    at: tuple[str | float, str | float, str | float]  # outward, up, forward: sectors or [arm lengths]
    palm: str | None = None  # direction of the palm in words, such as "up" or "forward in"
    pointing: str | None = None  # direction of the fingers in words
    shape: str | None = None  # name or alias in `configs/hands.toml`
    openness: float = 0.0  # 0..1: elbow away from the body
    fixed: list[AxisName] = []  # axes that spatial extent does not scale
    touch: Touch | None = None  # touched body part
    tip: Surface | None = None  # touching part: palm, or finger whose tip touches
    path: PathTable | None = None  # overrides the path of the key


class KeyTable(StrictTable):
    """TOML table of a stroke key for one or both hands."""

    path: PathTable | None = None  # path of each hand without one of its own

    left: HandTable | None = None  # left hand
    right: HandTable | None = None  # right hand
    both: HandTable | None = None  # both hands, mirrored


class GestureTable(StrictTable):
    """TOML table of one gesture, with keys or a captured motion."""

    id: str  # name for BML's `lexeme`
    keys: list[KeyTable] = []  # poses of the stroke; the last one is held
    motion: MotionTable | None = None  # captured motion instead of keys
    meanings: list[str] = []  # words that describe the gesture, the most characteristic first
    says: str = ""  # movement and meaning in one line
    tempo: str = "neutral"  # `neutral`, `sudden` or `sustained`
    body: BodyFormTable = PLAIN_TABLE  # overrides the table of the category
    fingers: str = ""  # finger motion during the stroke, from `configs/hands.toml`
    fallback: str = ""  # id of the gesture for hands that cannot make its shapes


class ClassTable(StrictTable):
    """TOML table of a gesture class with its representative gesture."""

    gesture: str  # id of the typical gesture
    words: list[str]  # phrases that name the class, of one or more words
    not_in: list[str] = []  # excluded phrases, in which these words have another meaning


class GestureFile(StrictTable):
    """TOML file of gestures of one category, with names and body motion."""

    category: Category | None = None  # category of all gestures of the file
    gesture: list[GestureTable] = []  # gestures, one `[[gesture]]` each
    synonyms: dict[str, list[str]] = {}  # additional names of a gesture
    classes: dict[str, ClassTable] = {}  # words that name a class of gestures
    bodies: dict[Category, BodyFormTable] = {}  # body motion of all gestures of a category


@dataclass(frozen=True, eq=False)
class LexiconPart:
    """Gestures, names, classes and body motion from one or more files."""

    entries: tuple[tuple[GestureForm, Sense], ...] = ()
    synonyms: tuple[tuple[str, str], ...] = ()  # (synonym, name of the gesture)
    meanings: tuple[tuple[str, str], ...] = ()  # (descriptive word, name of the gesture), looser than synonyms
    classes: tuple[GestureClass, ...] = ()
    bodies: Bodies = field(default_factory=dict)
    captured: tuple[GestureCapture, ...] = ()  # captured gestures among the entries


def read_gestures(path: Path, bodies: Bodies = NO_BODIES) -> LexiconPart:
    """Read gestures and names from a TOML file or folder.

    The files of a folder are read in the order of their names.

    Args:
        path: of the file or folder.
        bodies: default body motion by category.

    Raises:
        ConfigError: a file is missing or invalid, or a folder has no TOML file.
    """
    paths = sorted(file for file in path.glob("*.toml") if file.name != CARD_FILE) if path.is_dir() else [path]
    if not paths:
        raise ConfigError(f"{path}: a folder without .toml files")
    if path.is_dir():
        for file_path in paths:
            check_inside(path, file_path)
    files = [(file_path, read_toml(file_path, GestureFile)) for file_path in paths]
    all_bodies: dict[str, BodyFormTable] = {**bodies}
    for file_path, file in files:
        _check_bodies(file_path, file)
        all_bodies |= {str(category): table for category, table in file.bodies.items()}
    return join_parts(
        [make_part(file_path, file, all_bodies, folder=file_path.parent) for file_path, file in files], all_bodies
    )


def _check_bodies(path: Path, file: GestureFile) -> None:
    """Reject invalid angles, amounts or expressions in the categories' body motion.

    Raises:
        ConfigError: an angle or amount is out of range.
    """
    for category, table in file.bodies.items():
        try:
            body_form(table)
        except ValueError as error:
            raise ConfigError(f"{path}: [bodies.{category}]: {error}") from None


def join_parts(parts: Sequence[LexiconPart], bodies: Bodies) -> LexiconPart:
    """Concatenate lexicon parts.

    The first of equal names counts.
    """
    return LexiconPart(
        tuple(entry for part in parts for entry in part.entries),
        tuple(pair for part in parts for pair in part.synonyms),
        tuple(pair for part in parts for pair in part.meanings),
        tuple(gesture_class for part in parts for gesture_class in part.classes),
        bodies,
        tuple(gesture for part in parts for gesture in part.captured),
    )


def make_part(path: Path, file: GestureFile, bodies: Bodies, folder: Path | None = None) -> LexiconPart:
    """Convert the tables of one file to a lexicon part.

    Args:
        path: of the file, for messages.
        file: its tables.
        bodies: body motion by category.
        folder: of captured motions; None: they are refused, as in the text of a client.

    Raises:
        ConfigError: a gesture is invalid; the message names it and valid values.
    """
    if file.gesture and file.category is None:
        raise ConfigError(f"{path}: has gestures and no category; {', '.join(get_args(Category))} are known")
    captured = {
        table.id: _read_captured(table, table.motion, path, folder)
        for table in file.gesture
        if table.motion is not None
    }
    return LexiconPart(
        tuple(_entry(table, file.category or "", path, bodies, captured.get(table.id)) for table in file.gesture),
        tuple((name, gesture) for gesture, names in file.synonyms.items() for name in names),
        tuple((word, table.id) for table in file.gesture for word in table.meanings),
        tuple(class_of(name, table.gesture, table.words, table.not_in) for name, table in file.classes.items()),
        captured=tuple(captured.values()),
    )


def _read_captured(table: GestureTable, motion: MotionTable, path: Path, folder: Path | None) -> GestureCapture:
    try:
        if folder is None or table.keys:
            raise ValueError(
                "has keys and a motion; write one of them" if table.keys else "has a motion of another file"
            )
        return read_captured(table.id, motion, folder)
    except ValueError as error:
        raise ConfigError(f"{path}: gesture {table.id}: {error}") from None


def _entry(
    table: GestureTable, category: str, path: Path, bodies: Bodies, captured: GestureCapture | None
) -> tuple[GestureForm, Sense]:
    try:
        keys = tuple(_key(key) for key in table.keys) if captured is None else captured.keys
        if not keys:
            raise ValueError("has no keys, needs at least one")
        _check_paths(keys)
        tempo, fingers = _tempo(table.tempo), _fingers(table.fingers)
        body = body_form(overlay_table(table.body, bodies.get(category, PLAIN_TABLE)))
    except ValueError as error:
        raise ConfigError(f"{path}: gesture {table.id}: {error}") from None
    id_words = [word for word in table.id.split("_") if word not in table.meanings]
    form = GestureForm(
        table.id, category, keys, category == "rest", tempo, body=body, fingers=fingers, fallback=table.fallback
    )
    return form, Sense((*table.meanings, *id_words), category, table.says)


def _fingers(name: str) -> FingerMotion | None:
    motions = finger_motions()
    if name and name not in motions:
        raise ValueError(f"fingers is {name!r}{suggestion(name, list(motions))}")
    return motions.get(name)


def _tempo(name: str) -> Tempo:
    for tempo in get_args(Tempo):
        if tempo == name:
            valid_tempo: Tempo = tempo
            return valid_tempo
    raise ValueError(f"tempo is {name!r}; {', '.join(get_args(Tempo))} are known")


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
    """Reject a path without a preceding key of the same hand."""
    sides_with_key: set[Side] = set()
    for key in keys:
        for side, pose in key.hands.items():
            if pose.path is not None and side not in sides_with_key:
                kind = pose.path.kind
                raise ValueError(f"a hand's first key has a path ({kind}), from nowhere; write the key where it begins")
        sides_with_key |= key.hands.keys()


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
    """Convert the TOML table of a hand pose, and check its values.

    Its own path overrides that of the key.

    Raises:
        ValueError: a value is invalid.
    """
    if not 0.0 <= table.openness <= 1.0:
        raise ValueError(f"openness is {table.openness:g}, outside [0, 1]")
    if table.shape is not None and find_shape(table.shape) is None:
        raise ValueError(f"there is no hand shape {table.shape!r}{suggestion(table.shape, list(hand_shapes()))}")
    if table.tip is not None and table.touch is None:
        raise ValueError(f"tip is {table.tip!r} and touch is missing; write what it touches, such as touch = 'head'")
    forward, outward, up = (axis in table.fixed for axis in _AXIS_NAMES)
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
    """Return the unit vector (3,) that direction words name, or None."""
    return None if words is None else read_direction(words)
