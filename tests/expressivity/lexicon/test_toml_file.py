from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.toml_file import read_gestures

POSE_FIELDS = 'at = [0.3, 0.45, 0.6], palm = "forward", pointing = "up"'


@pytest.fixture
def read(tmp_path):
    def from_keys(*keys):
        path = tmp_path / "own.toml"
        path.write_text(f'category = "iconic"\n[[gesture]]\nid = "own"\nkeys = [{", ".join(keys)}]\n')
        return read_gestures(path).entries[0][0]

    return from_keys


def first(hand="right"):
    return f"{{ {hand} = {{ {POSE_FIELDS} }} }}"


def with_path(path, hand="right"):
    return f"{{ {hand} = {{ {POSE_FIELDS} }}, path = {{ {path} }} }}"


def test_path_of_a_stroke_key_applies_to_both_hands(read):
    key = read(first("both"), with_path('kind = "circle"', "both")).keys[1]
    assert key.hands["l"].path is not None
    assert key.hands["l"].path.kind == key.hands["r"].path.kind == "circle"


def test_path_of_one_hand_overrides_the_path_of_the_stroke_key(read):
    own = f'left = {{ {POSE_FIELDS}, path = {{ kind = "arc" }} }}, right = {{ {POSE_FIELDS} }}'
    key = read(first("both"), f'{{ {own}, path = {{ kind = "wave" }} }}').keys[1]
    assert (key.hands["l"].path.kind, key.hands["r"].path.kind) == ("arc", "wave")


def test_path_parameters_in_lexicon_files_have_the_axis_order_of_positions(read):
    numbers = "amplitude = [0.1, 0.2, 0.3], frequency = [1, 2, 3], shift = [0.1, 0.2, 0.3]"
    path = read(first(), with_path(f'kind = "wave", {numbers}')).keys[1].hands["r"].path
    np.testing.assert_allclose(path.amplitude, [0.3, 0.1, 0.2])
    np.testing.assert_allclose(path.frequency, [3, 1, 2])
    np.testing.assert_allclose(path.shift, [0.3, 0.1, 0.2])


def test_points_of_a_hand_path_may_be_names_of_gesture_space_sectors(read):
    path = read(first(), with_path('kind = "points", points = [["XP", "YCC", "ZFar"], [0.1, 0.2, 0.3]]')).keys[1]
    np.testing.assert_allclose(path.hands["r"].path.points, [[0.95, 0.5, 0.25], [0.3, 0.1, 0.2]])


def test_single_amplitude_of_a_hand_path_applies_to_all_moving_axes(read):
    path = read(first(), with_path('kind = "circle", amplitude = 0.2, frequency = 3')).keys[1].hands["r"].path
    np.testing.assert_allclose(path.amplitude, [0, 0.2, 0.2])
    assert path.turns == 3


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ([with_path('kind = "wave"')], r"own: a hand's first key has a path \(wave\), from nowhere"),
        ([first("left"), with_path('kind = "arc"')], r"first key has a path \(arc\)"),
        ([first(), with_path('kind = "loop"')], "loop"),
        ([first(), with_path('kind = "line", amplitude = 0.2')], "own: a line path has no amplitude"),
        ([first(), with_path('kind = "wave", frequncy = 2')], "frequncy"),
        ([first(), with_path('kind = "points", points = [["XX", 0, 0]]')], "XX is no sector of x"),
        ([first(), with_path('kind = "wave", frequency = 99')], r"frequency is \[99, 99, 99\], outside"),
        ([first(), with_path('kind = "wave", amplitude_variation = "swells"')], "swells"),
    ],
)
def test_invalid_hand_path_of_a_gesture_is_refused_with_its_cause(read, keys, said):
    with pytest.raises(ConfigError, match=said):
        read(*keys)


@pytest.mark.parametrize("tempo", ["sudden", "neutral", "sustained", None])
def test_tempo_of_a_gesture_is_read_from_its_file_and_is_neutral_by_default(tmp_path, tempo):
    path = tmp_path / "own.toml"
    line = f'tempo = "{tempo}"' if tempo else ""
    path.write_text(f'category = "iconic"\n[[gesture]]\nid = "own"\n{line}\nkeys = [{first()}]\n')
    assert read_gestures(path).entries[0][0].tempo == (tempo or "neutral")


def test_invalid_tempo_error_lists_valid_values(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(f'category = "iconic"\n[[gesture]]\nid = "own"\ntempo = "quick"\nkeys = [{first()}]\n')
    with pytest.raises(ConfigError, match="gesture own: tempo is 'quick'; sudden, neutral, sustained are known"):
        read_gestures(path)


@pytest.mark.parametrize("wrong", ["nod = -1", "look = 2", "face = { smile = 3 }", "face = { nowhere = 1 }"])
def test_invalid_body_motion_of_a_category_is_refused_when_the_file_is_read(tmp_path: Path, wrong: str):
    path = tmp_path / "own.toml"
    path.write_text(f"[bodies.beat]\n{wrong}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"own.toml: \[bodies.beat\]: body: "):
        Lexicon.load(path).read_all()
