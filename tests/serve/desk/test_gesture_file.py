"""Which files of gestures may be kept."""

import pytest

from kinesic.planning.setup import Setup
from kinesic.serve.desk.gesture_file import MOST_BYTES, find_fault

GESTURE = '[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, 0.3, 0.5] }} }}]\n'
FILE = 'category = "beat"\n\n' + GESTURE.format("mine")


@pytest.mark.parametrize("present", [None, FILE, 'category = "beat"\n' + GESTURE.format("other")])
def test_gestures_may_be_new_or_replace_gestures(upper22_setup: Setup, present: str | None):
    assert find_fault(FILE, present, upper22_setup) == ""


@pytest.mark.parametrize(
    "present",
    ["", "not = toml =", '[robot]\nname = "mine"\n', 'category = "beat"\n', FILE + '[synonyms]\nbeat = ["x"]\n'],
)
def test_nothing_else_is_replaced(upper22_setup: Setup, present: str):
    assert "holds something else than gestures" in find_fault(FILE, present, upper22_setup)


@pytest.mark.parametrize("more", ["[synonyms]\nmine = ['yes']\n", "[robot]\n", "[bodies.mine]\nnod = 1\n"])
def test_a_file_with_more_than_gestures_is_refused_by_the_name_of_that(upper22_setup: Setup, more: str):
    fault = find_fault(FILE + more, None, upper22_setup)
    assert fault.startswith(f"it has {more[1:].partition(']')[0].partition('.')[0]},")


def test_a_file_may_have_so_many_bytes(upper22_setup: Setup):
    comment = "#" + "\N{SNOWMAN}"
    room = MOST_BYTES - len((FILE + comment).encode())
    assert find_fault(FILE + comment + "x" * room, None, upper22_setup) == ""
    fault = find_fault(FILE + comment + "x" * (room + 1), None, upper22_setup)
    assert fault == f"it has {MOST_BYTES + 1} bytes, at most {MOST_BYTES} are kept in a file of gestures; split it"


def test_what_is_no_toml_is_refused_without_the_name_of_a_file(upper22_setup: Setup):
    fault = find_fault("keys = [", None, upper22_setup)
    assert fault
    assert not fault.startswith("the file: ")
    assert "no gesture" in find_fault("# nothing\n", None, upper22_setup)


def test_every_gesture_of_the_file_is_tried(upper22_setup: Setup):
    far = GESTURE.format("far").replace("0.3", "1e308")
    assert find_fault(FILE + far, None, upper22_setup) != ""
