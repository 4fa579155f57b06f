import pytest

from kinesic.body.action_units import UNITS
from kinesic.face.render.presets import PRESETS
from kinesic.face.show.controls import HELP, NUMBERS, Controls
from kinesic.face.show.window import KEYS


def after(*keys: str) -> Controls:
    controls = Controls()
    for key in keys:
        controls = controls.pressed(key)
    return controls


def test_digits_choose_presets():
    assert [after(str(k)).preset for k in (1, 2, 3)] == list(PRESETS)
    assert after("9") == after()


def test_arrows_choose_a_unit_and_its_intensity():
    assert after("right").unit == NUMBERS[NUMBERS.index(12) + 1]
    assert after(*["left"] * len(NUMBERS)).unit == 12
    assert after("up", "up", "up").units == {12: 0.3}
    assert after(*["up"] * 20).units == {12: 1.0}
    assert after("down").units == {12: 0.0}
    assert after("up", "right", "up", "0").units == {}


def test_the_stronger_of_hand_and_performance_is_shown():
    told = after(*["up"] * 5)
    assert told.over({"L12": 0.2, "R12": 0.9, "26": 0.4}) == {"L12": 0.5, "R12": 0.9, "26": 0.4}


def test_other_keys():
    assert after("w").gain == 0.0
    assert after("w", "w") == after()
    assert after("v").variant == "male"
    assert after("v", "v") == after()
    assert after("comma", "comma", "period").yaw_deg == 15.0
    assert after("escape").shut
    assert after("q").shut
    assert after("x") == after()


@pytest.mark.parametrize("key", KEYS)
def test_every_key_of_the_window_does_something(key: str):
    told = Controls(preset="full", yaw_deg=3.0, units={12: 0.5, 4: 0.5})
    assert told.pressed(key) != told or key == "3"


def test_the_title_says_what_is_set():
    assert UNITS[12].name in after("up").title
    assert "0.1" in after("up").title
    assert "preset" in HELP
