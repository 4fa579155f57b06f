from dataclasses import asdict, fields
from math import radians

import msgspec
import pytest

from kinesic.body.config import CONFIGS, names_of, read_toml
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.parameters import PARAMETER_EFFECTS, TURN_EFFECTS, WEIGHT_EFFECTS, list_parameters
from kinesic.expressivity.style.standing import GazeHabit, Standing
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, MODALITIES, WEIGHT_RANGES, Style, StyleTable


def flat(table: dict[str, object], prefix: str = "") -> dict[str, object]:
    """Return the leaves of nested tables by dotted key."""
    leaves: dict[str, object] = {}
    for key, value in table.items():
        leaves |= flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return leaves


def test_effect_descriptions_cover_every_expressivity_parameter_and_weight():
    assert list(PARAMETER_EFFECTS) == list(EXPRESSIVITY_RANGES)
    assert {name: text for name, (text, _) in WEIGHT_EFFECTS.items()} == {
        name: f"{low:g} .. {high:g}" for name, (low, high) in WEIGHT_RANGES.items()
    }
    assert set(TURN_EFFECTS) == {field.name for field in fields(Turn)}


@pytest.mark.parametrize("name", names_of("style"))
def test_style_preset_lists_all_non_default_values_of_its_file(name):
    written = flat(msgspec.to_builtins(read_toml(CONFIGS / "styles" / f"{name}.toml", StyleTable)))
    expected = {
        key: value
        for key, value in written.items()
        if value not in (None, 0.0, "", False)
        and key.partition(".")[0] not in MODALITIES
        and key not in ("standing.mirrored",)
    }
    listed = {parameter.key: parameter.value for parameter in Style.load(name).parameters}
    assert {key: listed.get(key) for key in expected} == expected


def test_style_lists_modality_values_only_if_they_differ_from_gesture_values():
    style = Style.load("proud").changed(["head.power=0.9", "torso.spatial=0.6"])
    listed = {parameter.key: parameter.value for parameter in style.parameters}
    assert listed["head.power"] == 0.9
    assert "torso.spatial" not in listed
    assert listed["spatial"] == asdict(style.gesture)["spatial"] == 0.6


def test_text_of_a_mirrored_rest_gesture_says_that_the_other_hand_performs_it():
    rest = next(parameter for parameter in Style.load("proud").parameters if parameter.key == "standing.rest")
    assert str(rest) == "standing.rest = hand_on_hip: gesture in which the hands rest, by the other hand"


def test_style_value_prints_key_value_unit_and_effect():
    lines = [str(parameter) for parameter in Style.load("sad").parameters]
    assert lines[0] == "spatial = -0.5 (-1 .. 1): size of movements: tight .. wide"
    assert "standing.gaze_down = 32 deg: averted gaze: angle down" in lines


def test_angles_of_a_standing_posture_are_listed_with_a_tenth_of_a_degree():
    standing = Standing(
        head=Turn(torsion=radians(1.25), tilt=radians(-2.34)),
        arms=(("flexion", radians(3.46)),),
        gaze=GazeHabit(down=radians(12.34), averted=0.5),
    )
    listed = list_parameters({"gesture": {}}, dict.fromkeys(WEIGHT_EFFECTS, 1.0), standing, ())
    values = {parameter.key: parameter.value for parameter in listed if parameter.key.startswith("standing.")}
    assert values == {
        "standing.head.torsion": pytest.approx(1.2, abs=0.051),
        "standing.head.tilt": -2.3,
        "standing.arms.flexion": 3.5,
        "standing.gaze_down": 12.3,
        "standing.averted": 0.5,
    }
