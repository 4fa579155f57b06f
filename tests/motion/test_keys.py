import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times
from kinesic.motion.keys import FORCED, LEAST_GAP, SWUNG, KeyPassage, KeyPosture, Keys

LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
BOTH, FIRST, SECOND = (True, True), (True, False), (False, True)
PATH = ((BOTH, True), (FIRST, True), (FIRST, False), (SECOND, True), (FIRST, False), (FIRST, True), (BOTH, True))


def keys(*rows):
    postures = [KeyPosture(0.1 * k, sealed([0.1 * k] * 2), keyed, firm=firm) for k, (keyed, firm) in enumerate(rows)]
    return Keys.of(tuple(postures), LIMITS)


def test_a_hinge_has_to_pass_only_firm_keys():
    found = keys((BOTH, True), (FIRST, False), (SECOND, True), (FIRST, False), (BOTH, True))
    assert found.own == ([0, 4], [0, 2, 4])
    assert [found.led(hinge).tolist() for hinge in (0, 1)] == [[True], [False, False]]


def test_keys_beside_a_path_stay_between_its_ends():
    found = keys(*PATH)
    assert {(1, 3), (3, 5), (1, 5)} <= found.gaps.keys()


def test_keys_on_a_path_keep_their_order_when_others_move():
    found = keys(*PATH)
    for gap in ({(0, 1): 0.5}, {(1, 3): 0.4}, {(3, 5): 0.6}, {(1, 5): 0.9}, {(0, 3): 0.8}):
        times = relax_key_times(KeyTimeProblem(found, {**found.gaps, **gap}, 0.0))
        assert np.all(np.diff(times) > 0.0)
        assert times[5] - times[1] >= 2 * LEAST_GAP - 1e-9


def test_keys_with_only_the_path_of_another_hinge_in_common_may_stay_as_near_as_asked():
    near = 0.004
    times = (0.0, 0.1, 0.2, 0.2 + near, 0.3, 0.4)
    rows = (([1, 1, 1], 1), ([1, 0, 0], 0), ([0, 1, 0], 1), ([0, 0, 1], 1), ([1, 0, 0], 0), ([1, 1, 1], 1))
    limits = Limits(*(sealed([value] * 3) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
    found = Keys.of(
        [
            KeyPosture(time, sealed([0.1] * 3), tuple(map(bool, keyed)), firm=bool(firm))
            for time, (keyed, firm) in zip(times, rows, strict=True)
        ],
        limits,
    )
    assert found.spaced
    assert found.gaps[2, 3] == pytest.approx(near)
    assert {gap for pair, gap in found.gaps.items() if pair != (2, 3)} == {LEAST_GAP}


def test_a_key_on_a_path_costs_nothing():
    assert keys((BOTH, True), (BOTH, False), (BOTH, True)).weights[1] == 0.0


def test_a_part_has_its_keys_of_its_hinges():
    whole = keys(*PATH)
    rows, hinges = np.array([0, 2, 6]), np.array([1])
    part = whole.part(rows, hinges)
    np.testing.assert_array_equal(part.asked, whole.asked[rows])
    np.testing.assert_array_equal(part.angles, whole.angles[rows][:, hinges])
    np.testing.assert_array_equal(part.keyed, whole.keyed[rows][:, hinges])
    np.testing.assert_array_equal(part.manner, whole.manner[:, rows][:, :, hinges])
    assert part.limits.lower.shape == (1,)


def test_keys_may_all_be_passed_in_one_way():
    found = keys(*PATH).passed(KeyPassage(tension=1.0))
    assert np.all(found.manner[0] == 1.0)
    assert not found.keyed[[2, 4]].any()


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
def test_numbers_out_of_range_are_refused_with_the_range(name, value):
    with pytest.raises(ValueError, match=rf"{name} is {value:g}, outside \[.*\]"):
        KeyPassage(**{name: value})


def test_a_calm_passage_has_neither_swing_nor_accent_and_keeps_the_rest():
    accented = KeyPassage(tension=0.3, continuity=-0.2, easing="out_power", steepness=3.0, swing=0.7)
    assert accented.calm == KeyPassage(tension=0.3, continuity=-0.2, steepness=3.0)
    forced = KeyPassage(bias=0.2, easing="out_back", steepness=4.0, swing=0.7)
    assert forced.calm == KeyPassage(bias=0.2, easing="out_back", steepness=FORCED)
    for plain in (
        KeyPassage(),
        KeyPassage(easing="linear", steepness=8.0),
        KeyPassage(easing="out_bounce", steepness=2.0),
    ):
        assert plain.calm == plain


@pytest.mark.parametrize("swing", [0.0, 0.5, 1.0])
def test_swing_adds_to_the_flow_and_full_tension_takes_all(swing):
    flows = [KeyPassage(tension=tension, swing=swing).flow for tension in (-1.0, 0.0, 0.5, 1.0)]
    assert flows == sorted(flows, reverse=True)
    assert flows[-1] == 0.0
    assert flows[1] == pytest.approx(1.0 + SWUNG * swing)


def test_the_same_postures_are_joined_once_and_again_where_anything_else_is_asked():
    postures = tuple(KeyPosture.whole(0.5 * k, [0.1 * k] * 2) for k in range(3))
    first = Keys.of(postures, LIMITS)
    assert Keys.of(postures, LIMITS) is first
    alike = tuple(KeyPosture.whole(0.5 * k, [0.1 * k] * 2) for k in range(3))
    for other in (Keys.of(alike, LIMITS), Keys.of(postures, LIMITS, room=0.0), Keys.of(postures, LIMITS.times(0.5))):
        assert other is not first
