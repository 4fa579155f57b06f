"""Reader of answer files and its errors."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.studies.gesture_perception.answers import (
    ANSWER_COLUMNS,
    Preference,
    Recognition,
    are_of_gestures,
    read_gesture_answers,
)

HEADER_LINE = ",".join(ANSWER_COLUMNS)
RECOGNITION_LINE = "p,1,recognition,stop,,a|b|stop|c|d|e,b,1.0"
COMPARISON_LINE = "p,2,comparison,stop,whole_body=0,changed|standard,standard,1.0"


def download_answers(path: Path, *lines: str) -> Path:
    path.write_text("\n".join((HEADER_LINE, *lines)) + "\n")
    return path


def test_recognition_and_preference_answers_are_read(tmp_path: Path):
    file = download_answers(tmp_path / "answers.csv", RECOGNITION_LINE, COMPARISON_LINE)
    assert are_of_gestures(file)
    answers = read_gesture_answers([file])
    assert answers.recognitions == (Recognition("p", "stop", ("a", "b", "stop", "c", "d", "e"), "b"),)
    assert answers.preferences == (Preference("p", "stop", ("changed", "standard"), "standard", "whole_body=0"),)
    assert not answers.recognitions[0].right
    assert (answers.recognitions[0].place, answers.preferences[0].place) == (1, 1)


@pytest.mark.parametrize(
    ("lines", "what"),
    [
        ((), "no answers"),
        (
            (RECOGNITION_LINE.replace("recognition", "recognise"),),
            "task is 'recognise'.*must be one of recognition, comparison",
        ),
        ((RECOGNITION_LINE.replace("|e", ""),), "must be 6 gestures, stop among them"),
        ((RECOGNITION_LINE.replace("|e", "|a"),), "must be 6 gestures"),
        ((RECOGNITION_LINE.replace("|stop|", "|x|"),), "must be 6 gestures, stop among them"),
        ((RECOGNITION_LINE.replace(",b,1.0", ",z,1.0"),), "chosen is 'z', must be one of a, b, stop"),
        ((COMPARISON_LINE.replace("changed|", "other|"),), "must be standard|changed in any order"),
        ((COMPARISON_LINE.replace("whole_body=0", ""),), "no condition"),
        (
            (RECOGNITION_LINE, RECOGNITION_LINE),
            "answers.csv:3: participant 'p' already answered at place '1', in .*answers.csv:2",
        ),
        ((RECOGNITION_LINE.replace("p,1", f"{'p' * 5000},1"),), "participant has 5000 characters"),
        ((RECOGNITION_LINE + ",1",), "must have 8 values, like the first line"),
        ((RECOGNITION_LINE.replace("p,1", f"{'p' * 200_000},1"),), "is not CSV: field larger"),
    ],
)
def test_invalid_study_answers_are_refused(tmp_path: Path, lines: tuple[str, ...], what: str):
    with pytest.raises(ConfigError, match=what):
        read_gesture_answers([download_answers(tmp_path / "answers.csv", *lines)])


def test_answer_file_with_a_missing_column_is_refused(tmp_path: Path):
    path = tmp_path / "answers.csv"
    path.write_text(HEADER_LINE.replace("chosen", "choosen") + "\n" + RECOGNITION_LINE)
    with pytest.raises(ConfigError, match="no column chosen"):
        read_gesture_answers([path])


def test_duplicate_answer_files_are_refused(tmp_path: Path):
    file = download_answers(tmp_path / "answers.csv", RECOGNITION_LINE)
    again = download_answers(tmp_path / "again.csv", RECOGNITION_LINE)
    with pytest.raises(ConfigError, match="give each file once"):
        read_gesture_answers([file, again])


def test_face_study_or_empty_answer_file_is_not_of_the_gesture_study(tmp_path: Path):
    path = tmp_path / "answers.csv"
    path.write_text("participant,place,action\np,1,4\n")
    assert not are_of_gestures(path)
    path.write_text("")
    assert not are_of_gestures(path)
    with pytest.raises(ConfigError, match="No such file"):
        are_of_gestures(tmp_path / "nowhere.csv")
