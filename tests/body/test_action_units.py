import pytest

from kinesic.body.action_units import CHANNELS, UNITS, channels, face_keys, unknown_unit


def test_units_with_sides_move_on_each_and_the_others_as_a_whole():
    assert channels(12) == ("L12", "R12")
    assert channels(12, "left") == ("L12",)
    assert channels(26, "right") == ("26",)
    assert len(CHANNELS) == len(set(CHANNELS)) == sum(1 + unit.sided for unit in UNITS.values())


def test_the_units_that_faces_need_are_there():
    wanted = {1, 2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20, 22, 23, 24, 25, 26, 43, 45}
    assert wanted <= UNITS.keys()
    assert all(number == unit.number for number, unit in UNITS.items())


@pytest.mark.parametrize("unit", ["", "L", "3", "99", "L26", "twelve", "-1", "1.0", "L 12", "²", "9" * 5000])
def test_what_is_no_unit_has_no_keys(unit: str):
    assert face_keys(unit) == ()


def test_a_unit_is_written_with_or_without_its_side():
    assert face_keys("12") == ("L12", "R12")
    assert face_keys("R12") == ("R12",)
    assert face_keys("26") == ("26",)


def test_an_unknown_unit_is_told_what_would_have_worked():
    assert unknown_unit("L26") == "no action unit L26: jaw drop has no sides; write 26"
    told = unknown_unit("3")
    assert told.startswith("no action unit 3; known: 1, 2, 4, 5")
    assert "26" in told
