"""Verb `kinesic study analyse`: evaluate the answers of a perception study."""

from pathlib import Path

from kinesic.cli.study.face import analyse_faces
from kinesic.cli.study.gestures import analyse_gestures
from kinesic.studies.gesture_perception.answers import are_of_gestures


def analyse_study(files: tuple[Path, ...], as_json: bool) -> int:
    """Print the evaluation of all answers to one study.

    The first file determines the kind of study.
    """
    return (analyse_gestures if are_of_gestures(files[0]) else analyse_faces)(files, as_json)
