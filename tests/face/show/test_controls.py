import pytest

from kinesic.body.action_units import ACTION_UNITS
from kinesic.face.render.presets import QUALITY_PRESETS
from kinesic.face.show.controls import KEY_HELP, UNIT_NUMBERS, Controls
from kinesic.face.show.window import KEY_NAMES


def after(*keys: str) -> Controls:
    controls = Controls()
    for key in keys:
        controls = controls.press(key)
    return controls


def test_digit_keys_of_the_face_window_select_rendering_presets():
    assert [after(str(k)).preset for k in (1, 2, 3)] == list(QUALITY_PRESETS)
    assert after("9") == after()


def test_arrow_keys_select_an_action_unit_and_its_intensity():
    assert after("right").unit == UNIT_NUMBERS[UNIT_NUMBERS.index(12) + 1]
    assert after(*["left"] * len(UNIT_NUMBERS)).unit == 12
    assert after("up", "up", "up").units == {12: 0.3}
    assert after(*["up"] * 20).units == {12: 1.0}
    assert after("down").units == {12: 0.0}
    assert after("up", "right", "up", "0").units == {}


def test_face_window_shows_the_larger_of_manual_and_performed_intensity():
    given_values = after(*["up"] * 5)
    assert given_values.merge_units({"L12": 0.2, "R12": 0.9, "26": 0.4}) == {"L12": 0.5, "R12": 0.9, "26": 0.4}


def test_keys_of_the_face_window_change_wrinkles_and_variant_and_camera_or_close_the_window():
    assert after("w").gain == 0.0
    assert after("w", "w") == after()
    assert after("v").variant == "male"
    assert after("v", "v") == after()
    assert after("comma", "comma", "period").yaw_deg == 15.0
    assert after("escape").is_closing
    assert after("q").is_closing
    assert after("x") == after()


@pytest.mark.parametrize("key", KEY_NAMES)
def test_every_listed_key_of_the_face_window_changes_a_setting(key: str):
    given_values = Controls(preset="full", yaw_deg=3.0, units={12: 0.5, 4: 0.5})
    assert given_values.press(key) != given_values or key == "3"


def test_title_of_the_face_window_shows_its_settings():
    assert ACTION_UNITS[12].name in after("up").title
    assert "0.1" in after("up").title
    assert "preset" in KEY_HELP
