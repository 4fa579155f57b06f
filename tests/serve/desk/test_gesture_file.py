"""Validation of gesture files."""

import pytest

from kinesic.planning.setup import Setup
from kinesic.serve.desk.gesture_file import MAX_GESTURE_FILE_SIZE, find_fault

GESTURE = '[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, 0.3, 0.5] }} }}]\n'
GESTURE_FILE = 'category = "beat"\n\n' + GESTURE.format("mine")


@pytest.mark.parametrize("present", [None, GESTURE_FILE, 'category = "beat"\n' + GESTURE.format("other")])
def test_gesture_file_may_be_saved_as_new_or_over_another_gesture_file(upper22_setup: Setup, present: str | None):
    assert find_fault(GESTURE_FILE, present, upper22_setup) == ""


@pytest.mark.parametrize(
    "present",
    [
        "",
        "not = toml =",
        '[robot]\nname = "mine"\n',
        'category = "beat"\n',
        GESTURE_FILE + '[synonyms]\nbeat = ["x"]\n',
    ],
)
def test_saving_a_gesture_file_over_a_file_with_other_data_is_refused(upper22_setup: Setup, present: str):
    assert "contains other data than gestures" in find_fault(GESTURE_FILE, present, upper22_setup)


@pytest.mark.parametrize("more", ["[synonyms]\nmine = ['yes']\n", "[robot]\n", "[bodies.mine]\nnod = 1\n"])
def test_gesture_file_error_names_an_unexpected_key(upper22_setup: Setup, more: str):
    fault = find_fault(GESTURE_FILE + more, None, upper22_setup)
    assert fault.startswith(f"it has {more[1:].partition(']')[0].partition('.')[0]},")


def test_gesture_file_size_is_limited(upper22_setup: Setup):
    comment = "#" + "\N{SNOWMAN}"
    room = MAX_GESTURE_FILE_SIZE - len((GESTURE_FILE + comment).encode())
    assert find_fault(GESTURE_FILE + comment + "x" * room, None, upper22_setup) == ""
    fault = find_fault(GESTURE_FILE + comment + "x" * (room + 1), None, upper22_setup)
    limit = MAX_GESTURE_FILE_SIZE
    assert fault == f"it has {limit + 1} bytes, at most {limit} are allowed in a gesture file; split it"


def test_error_for_an_invalid_gesture_toml_text_contains_no_file_name(upper22_setup: Setup):
    fault = find_fault("keys = [", None, upper22_setup)
    assert fault
    assert not fault.startswith("the file: ")
    assert "no gesture" in find_fault("# nothing\n", None, upper22_setup)


def test_gesture_file_with_an_unreachable_second_gesture_is_refused(upper22_setup: Setup):
    far = GESTURE.format("far").replace("0.3", "1e308")
    assert find_fault(GESTURE_FILE + far, None, upper22_setup) != ""
