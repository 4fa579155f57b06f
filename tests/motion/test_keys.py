import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.key_time_lp import KeyTimeProblem, solve_key_times
from kinesic.motion.keys import MIN_GAP, POWER_STEEPNESS, SWING_GAIN, KeyPassage, KeyPosture, Keys

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
BOTH_HINGES = (True, True)  # whether each of two hinges has a key
FIRST_HINGE = (True, False)
SECOND_HINGE = (False, True)
# hinges with a key, and whether it is exact; the second hinge has keys within the path of the first
PATH_ROWS = (
    (BOTH_HINGES, True),
    (FIRST_HINGE, True),
    (FIRST_HINGE, False),
    (SECOND_HINGE, True),
    (FIRST_HINGE, False),
    (FIRST_HINGE, True),
    (BOTH_HINGES, True),
)


def keys(*rows):
    postures = [
        KeyPosture(0.1 * k, sealed([0.1 * k] * 2), keyed, is_exact=is_exact) for k, (keyed, is_exact) in enumerate(rows)
    ]
    return Keys.of(tuple(postures), JOINT_LIMITS)


def test_only_exact_keys_constrain_the_motion():
    result = keys(
        (BOTH_HINGES, True), (FIRST_HINGE, False), (SECOND_HINGE, True), (FIRST_HINGE, False), (BOTH_HINGES, True)
    )
    assert result.exact_rows == ([0, 4], [0, 2, 4])
    assert [result.has_path(hinge).tolist() for hinge in (0, 1)] == [[True], [False, False]]


def test_minimum_gaps_link_a_key_of_another_hinge_to_both_ends_of_a_path():
    result = keys(*PATH_ROWS)
    assert {(1, 3), (3, 5), (1, 5)} <= result.gaps.keys()


def test_keys_on_a_path_keep_their_order():
    result = keys(*PATH_ROWS)
    for gap in ({(0, 1): 0.5}, {(1, 3): 0.4}, {(3, 5): 0.6}, {(1, 5): 0.9}, {(0, 3): 0.8}):
        times = solve_key_times(KeyTimeProblem(result, {**result.gaps, **gap}, 0.0))
        assert np.all(np.diff(times) > 0.0)
        assert times[5] - times[1] >= 2 * MIN_GAP - 1e-9


def test_close_keys_of_different_hinges_within_a_path_keep_their_small_gap():
    near = 0.004
    times = (0.0, 0.1, 0.2, 0.2 + near, 0.3, 0.4)
    rows = (([1, 1, 1], 1), ([1, 0, 0], 0), ([0, 1, 0], 1), ([0, 0, 1], 1), ([1, 0, 0], 0), ([1, 1, 1], 1))
    limits = Limits(*(sealed([value] * 3) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
    result = Keys.of(
        [
            KeyPosture(time, sealed([0.1] * 3), tuple(map(bool, keyed)), is_exact=bool(is_exact))
            for time, (keyed, is_exact) in zip(times, rows, strict=True)
        ],
        limits,
    )
    assert result.is_spaced
    assert result.gaps[2, 3] == pytest.approx(near)
    assert {gap for pair, gap in result.gaps.items() if pair != (2, 3)} == {MIN_GAP}


def test_path_key_has_zero_weight():
    assert keys((BOTH_HINGES, True), (BOTH_HINGES, False), (BOTH_HINGES, True)).weights[1] == 0.0


def test_part_of_the_keys_contains_only_the_selected_times_and_hinges():
    whole = keys(*PATH_ROWS)
    rows, hinges = np.array([0, 2, 6]), np.array([1])
    part = whole.part(rows, hinges)
    np.testing.assert_array_equal(part.requested_times, whole.requested_times[rows])
    np.testing.assert_array_equal(part.angles, whole.angles[rows][:, hinges])
    np.testing.assert_array_equal(part.keyed, whole.keyed[rows][:, hinges])
    np.testing.assert_array_equal(part.passage_values, whole.passage_values[:, rows][:, :, hinges])
    assert part.limits.lower.shape == (1,)


def test_common_key_passage_sets_one_tension_and_drops_inexact_keys():
    result = keys(*PATH_ROWS).with_passage(KeyPassage(tension=1.0))
    assert np.all(result.passage_values[0] == 1.0)
    assert not result.keyed[[2, 4]].any()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("tension", 1.2),
        ("continuity", 0.1),
        ("continuity", -1.1),
        ("bias", -2.0),
        ("steepness", 9.0),
        ("swing", 1.1),
        ("swing", -0.1),
    ],
)
def test_key_passage_parameter_out_of_range_raises_an_error_with_the_range(name, value):
    with pytest.raises(ValueError, match=rf"{name} is {value:g}, outside \[.*\]"):
        KeyPassage(**{name: value})


def test_removing_the_accent_of_a_key_passage_keeps_tension_continuity_and_bias():
    accented = KeyPassage(tension=0.3, continuity=-0.2, easing="out_power", steepness=3.0, swing=0.7)
    assert accented.without_accent == KeyPassage(tension=0.3, continuity=-0.2, steepness=3.0)
    forced = KeyPassage(bias=0.2, easing="out_back", steepness=4.0, swing=0.7)
    assert forced.without_accent == KeyPassage(bias=0.2, easing="out_back", steepness=POWER_STEEPNESS)
    for plain in (
        KeyPassage(),
        KeyPassage(easing="linear", steepness=8.0),
        KeyPassage(easing="out_bounce", steepness=2.0),
    ):
        assert plain.without_accent == plain


@pytest.mark.parametrize("swing", [0.0, 0.5, 1.0])
def test_swing_parameter_raises_the_velocity_at_a_key_unless_tension_is_full(swing):
    flows = [KeyPassage(tension=tension, swing=swing).flow for tension in (-1.0, 0.0, 0.5, 1.0)]
    assert flows == sorted(flows, reverse=True)
    assert flows[-1] == 0.0
    assert flows[1] == pytest.approx(1.0 + SWING_GAIN * swing)


def test_key_arrays_of_postures_are_cached_by_all_arguments():
    postures = tuple(KeyPosture.whole(0.5 * k, [0.1 * k] * 2) for k in range(3))
    first = Keys.of(postures, JOINT_LIMITS)
    assert Keys.of(postures, JOINT_LIMITS) is first
    alike = tuple(KeyPosture.whole(0.5 * k, [0.1 * k] * 2) for k in range(3))
    for other in (
        Keys.of(alike, JOINT_LIMITS),
        Keys.of(postures, JOINT_LIMITS, margin=0.0),
        Keys.of(postures, JOINT_LIMITS.scaled(0.5)),
    ):
        assert other is not first
