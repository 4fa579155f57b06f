import pytest

from kinesic.body.action_units import ACTION_UNITS, FACE_CHANNELS, describe_unknown_unit, face_keys, unit_channels


def test_action_units_with_sides_have_two_channels_and_others_one():
    assert unit_channels(12) == ("L12", "R12")
    assert unit_channels(12, "left") == ("L12",)
    assert unit_channels(26, "right") == ("26",)
    assert len(FACE_CHANNELS) == len(set(FACE_CHANNELS)) == sum(1 + unit.sided for unit in ACTION_UNITS.values())


def test_action_units_used_by_bml_and_visemes_exist():
    wanted = {1, 2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20, 22, 23, 24, 25, 26, 43, 45}
    assert wanted <= ACTION_UNITS.keys()
    assert all(number == unit.number for number, unit in ACTION_UNITS.items())


@pytest.mark.parametrize("unit", ["", "L", "3", "99", "L26", "twelve", "-1", "1.0", "L 12", "²", "9" * 5000])
def test_unknown_action_unit_has_no_face_channels(unit: str):
    assert face_keys(unit) == ()


def test_action_unit_may_be_written_with_or_without_side():
    assert face_keys("12") == ("L12", "R12")
    assert face_keys("R12") == ("R12",)
    assert face_keys("26") == ("26",)


def test_unknown_unit_error_lists_valid_units():
    assert describe_unknown_unit("L26") == "no action unit L26: jaw drop has no sides; write 26"
    message = describe_unknown_unit("3")
    assert message.startswith("no action unit 3; known: 1, 2, 4, 5")
    assert "26" in message


def test_action_units_without_sides_are_chin_lip_tongue_jaw_cheek_and_gaze_units():
    whole = {number for number, unit in ACTION_UNITS.items() if not unit.sided}
    assert whole == {17, 18, 19, *range(22, 30), 32, 34, *range(61, 65), 66}
