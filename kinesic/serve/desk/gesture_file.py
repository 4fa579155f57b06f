"""Validation of gesture and style files before they are saved.

A valid gesture file contains only gestures, all of which can be planned.
"""

from dataclasses import replace
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError, fit_schema, parse_tables
from kinesic.expressivity.lexicon.toml_file import GestureFile
from kinesic.planning.setup import Setup
from kinesic.serve.desk.gesture import plan_alone, read_gesture_file
from kinesic.serve.desk.style_file import find_style_fault, is_style

UNNAMED_PATH = Path("the file")  # path that stands for the client's file in error messages
ALLOWED_KEYS = {"category", "gesture"}  # top-level keys that a gesture file may have
MAX_GESTURE_FILE_SIZE = 200_000  # [bytes] largest gesture file; about the size of all built-in gestures


def find_fault(text: str, present: str | None, setup: Setup) -> str:
    """Return why a gesture or style file cannot be saved, or "".

    Args:
        text: text of the file.
        present: text of the file that would be overwritten, or None.
        setup: setup for planning its gestures.
    """
    if is_style(text):
        return find_style_fault(text, present)
    if present is not None and not _holds_gestures(present):
        return "a file of this name exists and contains other data than gestures; choose another name"
    if (size := len(text.encode("utf-8", "surrogatepass"))) > MAX_GESTURE_FILE_SIZE:
        return f"it has {size} bytes, at most {MAX_GESTURE_FILE_SIZE} are allowed in a gesture file; split it"
    try:
        if other_keys := _other_tables(text):
            return f"it has {other_keys[0]}, but gesture files may contain only a category and tables [[gesture]]"
        forms, lexicon = read_gesture_file(text, setup)
        new_setup = replace(setup, lexicon=lexicon)
        for form in forms:
            plan_alone(form, new_setup)
    except (BmlError, ConfigError) as error:
        return str(error).removeprefix(f"{UNNAMED_PATH}: ")
    return ""


def _holds_gestures(text: str) -> bool:
    try:
        return bool(
            fit_schema(parse_tables(text, UNNAMED_PATH), GestureFile, UNNAMED_PATH).gesture
        ) and not _other_tables(text)
    except ConfigError:
        return False


def _other_tables(text: str) -> tuple[str, ...]:
    """Return names of top-level keys that gesture files must not have.

    Raises:
        ConfigError: the text is not valid TOML.
    """
    return tuple(parse_tables(text, UNNAMED_PATH).keys() - ALLOWED_KEYS)
