"""Says whether a client's file of gestures may be kept: it holds gestures alone, and each of them can be planned."""

from dataclasses import replace
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError, fit_schema, parse_tables
from kinesic.expressivity.lexicon.toml_file import GestureFile
from kinesic.planning.setup import Setup
from kinesic.serve.desk.gesture import plan_alone, read_gesture_file

NAMELESS = Path("the file")
OWN = {"category", "gesture"}  # keys of a file that holds gestures alone
MOST_BYTES = 200_000  # of a file of gestures; all of our own have as many


def find_fault(text: str, present: str | None, setup: Setup) -> str:
    """Finds out why a file may not be kept; nothing where it may.

    Args:
        text: the file.
        present: what it would replace; None: nothing.
        setup: what its gestures are planned with.
    """
    if present is not None and not _holds_gestures(present):
        return "a file of this name is there and holds something else than gestures; give another name"
    if (size := len(text.encode("utf-8", "surrogatepass"))) > MOST_BYTES:
        return f"it has {size} bytes, at most {MOST_BYTES} are kept in a file of gestures; split it"
    try:
        if others := _other_tables(text):
            return f"it has {others[0]}, and files of gestures have a category and tables [[gesture]] here"
        forms, lexicon = read_gesture_file(text, setup)
        known = replace(setup, lexicon=lexicon)
        for form in forms:
            plan_alone(form, known)
    except (BmlError, ConfigError) as error:
        return str(error).removeprefix(f"{NAMELESS}: ")
    return ""


def _holds_gestures(text: str) -> bool:
    try:
        return bool(fit_schema(parse_tables(text, NAMELESS), GestureFile, NAMELESS).gesture) and not _other_tables(text)
    except ConfigError:
        return False


def _other_tables(text: str) -> tuple[str, ...]:
    """Names of tables that change more than the gestures of the file itself.

    Raises:
        ConfigError: it is not TOML.
    """
    return tuple(parse_tables(text, NAMELESS).keys() - OWN)
