import math
from dataclasses import asdict

import pytest

from kinesic.bml.block import Manner
from kinesic.body.config import CONFIGS, ConfigError
from kinesic.expressivity.style import RANGES, Style

PRESETS = sorted(file.stem for file in (CONFIGS / "styles").glob("*.toml"))


def test_the_presets_are_complete():
    assert PRESETS == ["angry", "calm", "joyful", "neutral", "proud", "sad", "shy"]


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_loads_under_its_name(name):
    assert Style.load(name).name == name


def test_presets_differ_and_neutral_is_the_default():
    assert Style.load() == Style()
    assert len({tuple(asdict(Style.load(name)).values())[1:] for name in PRESETS}) == len(PRESETS)


def test_presets_say_what_their_names_say():
    styles = {name: Style.load(name) for name in PRESETS}
    assert styles["angry"].power == max(style.power for style in styles.values())
    assert styles["shy"].spatial == min(style.spatial for style in styles.values())
    assert styles["calm"].fluidity == max(style.fluidity for style in styles.values())
    assert styles["sad"].temporal == min(style.temporal for style in styles.values())


def test_the_parameters_are_the_fields():
    assert ["name", *sorted(RANGES)] == ["name", *sorted(set(asdict(Style())) - {"name"})]


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("power", 7, "power is 7, outside [-1, 1]"),
        ("openness", -0.1, "openness is -0.1, outside [0, 1]"),
        ("temporal", math.nan, "temporal is nan, outside [-1, 1]"),
    ],
)
def test_a_value_out_of_range_names_itself_and_the_range(name, value, text):
    with pytest.raises(ValueError, match="outside") as error:
        Style(**{name: value})
    assert str(error.value) == text


def test_an_unknown_style_suggests_the_nearest():
    with pytest.raises(ConfigError, match=r"no style joyfull; did you mean joyful\?"):
        Style.load("joyfull")


def test_a_style_of_the_user(tmp_path):
    text = (CONFIGS / "styles" / "calm.toml").read_text()
    (tmp_path / "mine.toml").write_text(text)
    assert asdict(Style.load(tmp_path / "mine.toml")) == {**asdict(Style.load("calm")), "name": "mine"}
    (tmp_path / "wrong.toml").write_text(text.replace("power", "powr"))
    with pytest.raises(ConfigError, match=r"powr.*did you mean power\?"):
        Style.load(tmp_path / "wrong.toml")
    (tmp_path / "loud.toml").write_text(text.replace("power = -0.3", "power = 2"))
    with pytest.raises(ConfigError, match=r"loud\.toml: power is 2, outside \[-1, 1\]"):
        Style.load(tmp_path / "loud.toml")


def test_settings_change_single_parameters():
    style = Style.load("sad").changed(["power=0.8", " openness = 1 "])
    assert (style.power, style.openness) == (0.8, 1.0)
    assert style.spatial == Style.load("sad").spatial


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("powr=1", r"a style has no powr; did you mean power\?"),
        ("name=1", r"a style has no name"),
        ("power", r"'power' is no setting of a style; write it as NAME=VALUE"),
        ("power=much", r"power is 'much', not a number"),
        ("power=7", r"power is 7, outside \[-1, 1\]"),
        ("power=nan", r"power is nan, outside"),
    ],
)
def test_a_wrong_setting_teaches(text, message):
    with pytest.raises(ConfigError, match=message):
        Style().changed([text])


def test_a_document_overrides_what_it_says_and_no_more():
    style = Style.load("joyful").under(Manner(spatial=-0.5, power=0.0, intensity=0.3))
    assert (style.spatial, style.power) == (-0.5, 0.0)
    assert style.temporal == Style.load("joyful").temporal
    assert Style.load("joyful").under(Manner()) == Style.load("joyful")


def test_a_document_with_ranges_of_its_own_is_clipped():
    style = Style().under(Manner(openness=5.0, power=-3.0, spatial=1.5))
    assert (style.openness, style.power, style.spatial) == (1.0, -1.0, 1.0)
