"""`kinesic study analyse`: what the answers of participants say, whichever study they are of."""

from pathlib import Path

from kinesic.cli.study.face import analyse_faces
from kinesic.cli.study.gestures import analyse_gestures
from kinesic.studies.gesture_perception.answers import are_of_gestures


def analyse_study(files: tuple[Path, ...], as_json: bool) -> int:
    """Prints what is in the answers of all participants; the first file says which study they are of."""
    return (analyse_gestures if are_of_gestures(files[0]) else analyse_faces)(files, as_json)
