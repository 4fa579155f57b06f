import math
from dataclasses import asdict, fields, replace

import numpy as np
import pytest
from scipy.interpolate import BPoly

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.expressivity.style.passage import passage_of
from kinesic.expressivity.style.style import (
    EXPRESSIVITY_RANGES,
    MODALITIES,
    WEIGHT_RANGES,
    Expressivity,
    Setting,
    Style,
    style_preset,
)
from kinesic.motion.easing import EASING_INTERVALS, soften_easing
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage

FIRST_STYLES = {"angry", "calm", "joyful", "neutral", "proud", "sad", "shy"}
PRESET_NAMES = sorted(file.stem for file in (CONFIGS / "styles").glob("*.toml"))
PHASE_NAMES = ("preparation", "stroke", "hold", "retraction")


def test_style_presets_include_neutral_and_six_emotional_styles():
    assert set(PRESET_NAMES) >= FIRST_STYLES


@pytest.mark.parametrize("name", PRESET_NAMES)
def test_style_preset_loads_by_name_and_sets_all_eight_parameters(name):
    assert Style.load(name).name == style_preset(name).name == name
    text = (CONFIGS / "styles" / f"{name}.toml").read_text().partition("[")[0]
    said = [line.split()[0] for line in text.splitlines() if "=" in line]
    assert [name for name in said if name not in WEIGHT_RANGES] == list(EXPRESSIVITY_RANGES), (
        f"kinesic/configs/styles/{name}.toml: set all eight parameters in this order before the first table"
    )


def test_style_presets_differ_and_neutral_is_the_default():
    assert Style.load() == Style()
    values = [tuple(asdict(style_preset(name).gesture).values()) for name in PRESET_NAMES]
    equal = [name for name, value in zip(PRESET_NAMES, values, strict=True) if values.count(value) > 1]
    assert equal == [], "edit kinesic/configs/styles/: these styles are equal"


def test_parameters_of_style_presets_match_the_emotion_in_their_names():
    styles = {name: style_preset(name) for name in FIRST_STYLES}
    assert styles["angry"].gesture.power == max(style.gesture.power for style in styles.values())
    assert styles["shy"].gesture.spatial == min(style.gesture.spatial for style in styles.values())
    assert styles["calm"].gesture.fluidity == max(style.gesture.fluidity for style in styles.values())
    assert styles["sad"].gesture.temporal == min(style.gesture.temporal for style in styles.values())
    assert styles["sad"].head.spatial < styles["sad"].gesture.spatial
    assert styles["sad"].torso.temporal < styles["sad"].gesture.temporal


def test_angry_and_joyful_presets_have_more_body_motion_than_shy_and_sad():
    weights = {name: style_preset(name).whole_body for name in PRESET_NAMES}
    assert max(weights["shy"], weights["sad"]) < weights["neutral"] == 1.0 < min(weights["angry"], weights["joyful"])


def test_whole_body_weight_is_set_for_all_modalities_at_once_and_ranges_from_0_to_2(tmp_path):
    style = Style().changed(["whole_body=0", "head.power=0.5"])
    assert (style.whole_body, style.head.power, style.gesture) == (0.0, 0.5, Style().gesture)
    assert [str(setting) for setting in style.settings] == ["whole_body=0", "head.power=0.5"]
    with pytest.raises(ConfigError, match="no whole_body"):
        Style().changed(["head.whole_body=0"])
    with pytest.raises(ConfigError, match=r"outside \[0, 2\]"):
        Style().changed(["whole_body=2.5"])
    path = tmp_path / "own.toml"
    path.write_text((CONFIGS / "styles" / "neutral.toml").read_text() + "whole_body = -1\n")
    with pytest.raises(ConfigError, match=r"whole_body is -1, outside \[0, 2\]"):
        Style.load(path)


def test_effort_weight_ranges_from_zero_to_one(tmp_path):
    assert Style().changed(["effort=0.25"]).effort == 0.25
    assert Style().changed(["effort=0", "whole_body=2"]) == replace(
        Style(), effort=0.0, whole_body=2.0, settings=(Setting("effort", 0.0), Setting("whole_body", 2.0))
    )
    with pytest.raises(ConfigError, match=r"effort is 1.5, outside \[0, 1\]"):
        Style().changed(["effort=1.5"])
    path = tmp_path / "own.toml"
    path.write_text((CONFIGS / "styles" / "neutral.toml").read_text() + "effort = 0.5\n")
    assert Style.load(path).effort == 0.5


def test_every_expressivity_field_has_a_value_range():
    assert [field.name for field in fields(Expressivity)] == list(EXPRESSIVITY_RANGES)


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("power", 7, "power is 7, outside [-1, 1]"),
        ("openness", -0.1, "openness is -0.1, outside [0, 1]"),
        ("temporal", math.nan, "temporal is nan, outside [-1, 1]"),
    ],
)
def test_out_of_range_error_names_parameter_and_range(name, value, text):
    with pytest.raises(ValueError, match="outside") as error:
        Expressivity(**{name: value})
    assert str(error.value) == text


def test_unknown_style_error_suggests_the_nearest_style():
    with pytest.raises(ConfigError, match=r"no style joyfull; did you mean joyful\?"):
        Style.load("joyfull")


def test_style_file_of_the_user_is_loaded_and_checked(tmp_path):
    text = (CONFIGS / "styles" / "calm.toml").read_text()
    (tmp_path / "mine.toml").write_text(text)
    assert Style.load(tmp_path / "mine.toml").numbers() == style_preset("calm").numbers()
    (tmp_path / "wrong.toml").write_text(text.replace("power", "powr"))
    with pytest.raises(ConfigError, match=r"powr.*did you mean power\?"):
        Style.load(tmp_path / "wrong.toml")
    (tmp_path / "loud.toml").write_text(text.replace("power = -0.3", "power = 2"))
    with pytest.raises(ConfigError, match=r"loud\.toml: power is 2, outside \[-1, 1\]"):
        Style.load(tmp_path / "loud.toml")
    (tmp_path / "short.toml").write_text(text.replace("activation = -0.2\n", ""))
    with pytest.raises(ConfigError, match=r"short\.toml: .*activation"):
        Style.load(tmp_path / "short.toml")


def test_modality_table_of_a_style_file_overrides_single_parameters(tmp_path):
    zeros = "\n".join(f"{name} = 0.0" for name in EXPRESSIVITY_RANGES)
    (tmp_path / "mine.toml").write_text(f"{zeros}\n[face]\npower = 1.0\n")
    style = Style.load(tmp_path / "mine.toml")
    assert (style.face, style.head) == (Expressivity(power=1.0), Expressivity())
    (tmp_path / "mine.toml").write_text(f"{zeros}\n[face]\npower = 3.0\n")
    with pytest.raises(ConfigError, match=r"mine\.toml: power is 3, outside \[-1, 1\]"):
        Style.load(tmp_path / "mine.toml")
    (tmp_path / "mine.toml").write_text(f"{zeros}\n[hed]\npower = 0.3\n")
    with pytest.raises(ConfigError, match=r"hed.*did you mean head\?"):
        Style.load(tmp_path / "mine.toml")


def test_setting_changes_a_parameter_of_all_modalities_or_one():
    style = style_preset("sad").changed(["power=0.8", " head.openness = 1 "])
    assert [style.of(modality).power for modality in MODALITIES] == [0.8] * 4
    assert [style.of(modality).openness for modality in MODALITIES] == [0.0, 1.0, 0.0, 0.0]
    assert style.gesture.spatial == style_preset("sad").gesture.spatial
    assert style.settings == (Setting("power", 0.8), Setting("openness", 1.0, "head"))


def test_later_style_setting_overrides_an_earlier_one():
    style = Style().changed(["head.power=0.2", "power=0.8"]).changed(["face.power=0.4"])
    assert [style.of(modality).power for modality in MODALITIES] == [0.8, 0.8, 0.8, 0.4]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("powr=1", r"a style has no powr; did you mean power\?"),
        ("name=1", r"a style has no name"),
        ("power", r"'power' is not a style setting; write it as NAME=VALUE"),
        ("power=much", r"power is 'much', not a number"),
        ("head.power=much", r"head\.power is 'much', not a number"),
        ("power=7", r"power is 7, outside \[-1, 1\]"),
        ("head.power=7", r"head\.power is 7, outside \[-1, 1\]"),
        ("power=nan", r"power is nan, outside"),
        ("hed.power=1", r"a style has no modality 'hed'; did you mean head\?"),
        (".power=1", r"a style has no modality ''; known: face"),
    ],
)
def test_invalid_style_setting_is_refused_with_its_cause(text, message):
    with pytest.raises(ConfigError, match=message):
        Style().changed([text])


def test_uniform_style_has_equal_parameters_in_all_modalities():
    style = Style.uniform(Expressivity(power=0.5), "mine")
    assert style.name == "mine"
    assert {style.of(modality) for modality in MODALITIES} == {Expressivity(power=0.5)}


def peak(passed: KeyPassage) -> float:
    """Return the peak velocity of a unit movement in unit time."""
    curve = BPoly.from_derivatives(
        np.linspace(0.0, 1.0, EASING_INTERVALS + 1), soften_easing(passed.easing, passed.steepness).T
    )
    return float(curve(np.linspace(0.0, 1.0, 2001), nu=1).max())


@pytest.mark.parametrize("phase", PHASE_NAMES)
def test_fluidity_sets_spline_continuity_and_tension_sets_spline_tension(phase):
    for fluidity in (-1.0, 0.0, 1.0):
        passage = passage_of(Expressivity(fluidity=fluidity, tension=-0.4), phase)
        assert passage.continuity == pytest.approx((fluidity - 1.0) / 2.0)
        assert passage.tension == -0.4
    assert passage_of(Expressivity(fluidity=1.0), phase) == PLAIN_PASSAGE


def test_low_tension_turns_strokes_towards_their_next_key_and_no_other_phase():
    biases = {phase: passage_of(Expressivity(tension=-1.0), phase).bias for phase in PHASE_NAMES}
    assert biases.pop("stroke") < passage_of(Expressivity(tension=-0.5), "stroke").bias < 0.0
    assert set(biases.values()) == {0.0}


def test_low_tension_and_high_power_add_their_effects_on_the_direction_at_a_key():
    forceful, loose, both = (
        passage_of(manner, "stroke").bias
        for manner in (Expressivity(power=1.0), Expressivity(tension=-1.0), Expressivity(power=1.0, tension=-1.0))
    )
    assert both == pytest.approx(forceful + loose)


@pytest.mark.parametrize(("accent", "least"), [(0.0, 1.6), (1.0, 1.4), (1.9, 1.3)])
def test_power_raises_peak_velocity_over_its_whole_range(accent, least):
    powers = (Expressivity(power=float(power)) for power in np.linspace(-1.0, 1.0, 21))
    peaks = [peak(passage_of(manner, "stroke", accent=accent)) for manner in powers]
    assert np.all(np.diff(peaks) > 0.0)
    assert peaks[-1] > least * peaks[10]
    assert peaks[0] == pytest.approx(peak(passage_of(Expressivity(power=-1.0), "stroke")))


def test_velocity_accent_raises_the_peak_velocity_of_a_stroke():
    peaks = [peak(passage_of(Expressivity(), "stroke", accent=accent)) for accent in (0.0, 1.0, 2.0)]
    assert peaks[0] < peaks[1] < peaks[2]


@pytest.mark.parametrize("phase", ["hold", "retraction"])
def test_full_power_does_not_change_holds_and_retractions(phase):
    assert passage_of(Expressivity(power=1.0), phase) == passage_of(Expressivity(), phase)


def test_stroke_easing_overshoots_with_power_and_bounces_with_tension():
    assert passage_of(Expressivity(power=0.8), "stroke").easing == "out_back"
    assert passage_of(Expressivity(tension=0.8), "stroke").easing == "out_back"
    assert passage_of(Expressivity(power=-0.8), "stroke").easing == "linear"
    assert passage_of(Expressivity(power=0.8, tension=0.8), "stroke").easing == "out_bounce"


def test_moderate_power_sharpens_the_stroke_accent_and_high_power_overshoots():
    passages = [passage_of(Expressivity(power=power), "stroke", accent=1.9) for power in (0.0, 0.4, 0.6)]
    assert [item.easing for item in passages] == ["out_power", "out_power", "out_back"]
    assert passages[0].steepness < passages[1].steepness
