"""Import of folders of captured clips as gestures of the lexicon."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.capture.clip import BodyClip
from kinesic.capture.gesture_clip import gesture_motion
from kinesic.capture.gesture_markers import gesture_markers
from kinesic.capture.read import FORMAT_NAMES, read_clip
from kinesic.capture.reading.text import CaptureError
from kinesic.expressivity.lexicon.captured_form import moving_sides
from kinesic.expressivity.lexicon.captured_gesture import CARD_FILE, HAND_SIDES
from kinesic.expressivity.lexicon.gesture_card import UNKNOWN_LICENCE, GestureCard, card_text, quote
from kinesic.expressivity.lexicon.gesture_motion import GestureMotion, pack_motion
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.names import split_words
from kinesic.files.plain_name import plain_stem

CLIP_SUFFIXES = frozenset(FORMAT_NAMES) - {".csv", ".json", ".mcap", ".parquet"}  # formats of human motion
MAX_CLIPS = 2000  # largest number of clips in one folder
UNNAMED_CATEGORY = "adaptor"  # category of clips whose names resemble no gesture of kinesic
MIN_BODY_ANGLE = 1.0  # [deg] smallest rotation of head or trunk that is written
MAX_BODY_ANGLE = 30.0  # [deg] largest rotation of head or trunk that counts as part of the gesture
MARKER_DIGITS = 3  # decimal places of markers in seconds

_LICENCE_NAME = re.compile(r"licen[cs]e(\.\w+)?|copying", re.IGNORECASE)  # name of a licence file
_IDLE_PREFIX = re.compile(r"^(?:[a-z]*idle[a-z]*\d*_)+", re.IGNORECASE)  # part of a file name: initial idle posture
_ID_LETTERS = re.compile(r"[^A-Za-z0-9]+")  # characters that a gesture's name cannot contain


@dataclass(frozen=True, eq=False)
class ImportedClip:
    """Captured clip as the text and motion files of a gesture."""

    id: str  # name of the gesture
    category: str  # lexicon category of the gesture
    text: str  # text of the gesture's TOML file
    motion: bytes  # content of the gesture's .npz file


@dataclass(frozen=True, eq=False)
class ImportedFolder:
    """Result of importing a folder of clips."""

    clips: tuple[ImportedClip, ...]
    problems: tuple[str, ...]  # reasons for each clip left out, as sentences
    card: GestureCard  # description of the collection: origin and licence


def import_folder(
    folder: Path,
    robot: Robot,
    *,
    licence: str = "",
    source: str = "",
    progress: Callable[[float], None] = lambda fraction: None,
) -> ImportedFolder:
    """Convert all clips of a folder to gestures.

    Clips that cannot be read are left out and reported.

    Args:
        folder: of the clips, with subfolders.
        robot: defines the elbow swivel.
        licence: of the clips; empty: first line of a licence file in the folder or above.
        source: origin of the clips; empty: name of the folder.
        progress: called with the fraction of clips that are done.

    Raises:
        ConfigError: the folder is missing, or has no readable clip or too many.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: there is no such folder of clips")
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in CLIP_SUFFIXES and path.is_file())
    if not 0 < len(paths) <= MAX_CLIPS:
        raise ConfigError(
            f"{folder}: it has {len(paths)} clips ({', '.join(sorted(CLIP_SUFFIXES))}), must have 1 to {MAX_CLIPS}"
        )
    lexicon, clips, problems, taken = Lexicon.load(), list[ImportedClip](), list[str](), set[str]()
    for k, path in enumerate(paths):
        progress(k / len(paths))
        terms = licence or _find_licence(path.parent, folder), source or str(path.relative_to(folder.parent))
        try:
            clip = _import_clip(path, robot, lexicon, taken, terms)
        except CaptureError as error:
            problems.append(str(error))
            continue
        clips.append(clip)
        taken.add(clip.id)
    if not clips:
        raise ConfigError(f"{folder}: no clip can be read; first problem: {problems[0]}")
    licences = sorted({licence or _find_licence(path.parent, folder) for path in paths})
    card = GestureCard(
        folder.name or "gestures", "; ".join(licences), source or folder.name, f"{len(clips)} captured gestures"
    )
    return ImportedFolder(tuple(clips), tuple(problems), card)


def write_folder(imported: ImportedFolder, out: Path) -> None:
    """Write the gestures of an import, and their card, into a folder."""
    for clip in imported.clips:
        (out / f"{clip.id}.toml").write_text(clip.text, encoding="utf-8")
        (out / f"{clip.id}.npz").write_bytes(clip.motion)
    (out / CARD_FILE).write_text(card_text(imported.card), encoding="utf-8")


def _import_clip(path: Path, robot: Robot, lexicon: Lexicon, taken: set[str], terms: tuple[str, str]) -> ImportedClip:
    clip = read_clip(path)
    if not isinstance(clip, BodyClip):
        raise CaptureError(f"{path}: joint angles of one robot are no gesture; `kinesic certify` takes them")
    markers, is_found = gesture_markers(clip)
    motion = gesture_motion(clip, robot, str(path))
    name = _IDLE_PREFIX.sub("", path.stem.rpartition("@")[2]) or path.stem
    match = lexicon.find(name)
    like, category = (match.form.id, match.form.category) if match and not match.form.rest else ("", UNNAMED_CATEGORY)
    id = _free_id(path.stem.rpartition("@")[2], taken)
    licence, source = terms
    sides = moving_sides(motion, markers)
    hand = next(name for name, names in HAND_SIDES.items() if names == sides)
    rounded = {name: round(time, MARKER_DIGITS) for name, time in markers.items()}
    lines = [
        f"category = {quote(category)}",
        "",
        "[[gesture]]",
        f"id = {quote(id)}",
        f"says = {quote(f'captured: {_describe(name)}')}",
        "",
        "[gesture.motion]",
        f"file = {quote(f'{id}.npz')}",
        f"hand = {quote(hand)}",
        f"markers = {{ {', '.join(f'{name} = {time}' for name, time in rounded.items())} }}",
        f"found = {'true' if is_found else 'false'}",
        f"like = {quote(like)}",
        f"source = {quote(source)}",
        f"licence = {quote(licence)}",
        *_body_lines(motion, markers),
    ]
    return ImportedClip(id, category, "\n".join(lines) + "\n", pack_motion(motion))


def _body_lines(motion: GestureMotion, markers: Mapping[str, float]) -> Sequence[str]:
    """Return TOML lines of head and trunk rotation, start to stroke."""
    first, stroke = motion.at(markers["start"]), motion.at(markers["stroke"])
    lines = []
    for part, angles in (("head", motion.head), ("trunk", motion.trunk)):
        roll, tilt, turn = np.degrees(angles[stroke] - angles[first])
        values = {"turn": turn, "tilt": tilt, "roll": roll}
        if MIN_BODY_ANGLE <= max(map(abs, values.values())) <= MAX_BODY_ANGLE:
            lines.append(f"{part} = {{ {', '.join(f'{axis} = {value:.1f}' for axis, value in values.items())} }}")
    return ["", "[gesture.body]", *lines, "nod = 0.0"] if lines else []


def _describe(name: str) -> str:
    return " ".join(split_words(name)) or name


def _free_id(stem: str, taken: set[str]) -> str:
    """Return an unused gesture name that resembles a file name."""
    words = "_".join(split_words(_ID_LETTERS.sub("_", stem))) or "gesture"
    id = plain_stem(words if words[0].isalpha() else f"g_{words}", fallback="gesture").replace("-", "_")
    count = 2
    while id in taken:
        id, count = f"{id.rstrip('0123456789')}{count}", count + 1
    return id


def _find_licence(folder: Path, top: Path) -> str:
    """Return the nearest licence file's first line, in a folder or above.

    The folder above the upper one is searched too.
    """
    for place in [folder, *folder.parents]:
        files = sorted(path for path in place.iterdir() if _LICENCE_NAME.fullmatch(path.name) and path.is_file())
        for path in files:
            lines = path.read_text(encoding="utf-8", errors="replace").split("\n", 20)
            line = next((line.strip() for line in lines if line.strip()), "")
            if line:
                return line
        if place == top.parent:
            break
    return UNKNOWN_LICENCE
