"""Tests of costs, minimum gaps and ranges of keys."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import PASSAGE_RANGES, Bond, KeyPassage, KeyPosture, Keys, flow

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
BOTH_KEYED = (True, True)  # both hinges have a key


def key(
    time: float, *syncs: tuple[str, str], keyed=BOTH_KEYED, is_exact: bool = True, angle: float = 0.0
) -> KeyPosture:
    return KeyPosture(time, sealed([angle, -angle]), keyed, syncs, is_exact=is_exact)


def at(*times: float, **options) -> Keys:
    return Keys.of([key(time, **options) for time in times], JOINT_LIMITS)


@pytest.mark.parametrize(
    ("syncs", "weight"),
    [
        ((), 0.05),
        (("start",), 0.05),
        (("strokeStart",), 5.0),
        (("stroke",), 5.0),
        (("strokeEnd",), 0.5),
        (("ready",), 0.3),
        (("relax",), 0.3),
        (("stroke:2",), 0.3),
        (("strokeStart:2",), 0.05),
        (("end", "strokeEnd", "start"), 0.5),
        (("stroke:1", "stroke"), 5.0),
    ],
)
def test_shift_weight_of_a_key_is_that_of_its_heaviest_sync_point(syncs, weight):
    marked = tuple(("b", sync) for sync in syncs)
    assert Keys.of([key(0.0, *marked), key(1.0, *marked, is_exact=False)], JOINT_LIMITS).weights.tolist() == [
        weight,
        0.0,
    ]


def test_only_numbered_stroke_sync_points_mark_repeated_strokes():
    names = ("stroke", "stroke:1", "strokeStart:1", "stroke:12", "relax")
    keys = Keys.of([key(k, ("a", "ready"), ("b", name)) for k, name in enumerate(names)], JOINT_LIMITS)
    assert keys.is_repeat.tolist() == [False, True, False, True, False]
    assert at(0.0, 1.0).is_repeat.tolist() == [False, False]


@pytest.mark.parametrize("name", PASSAGE_RANGES)
def test_key_passage_parameters_are_accepted_up_to_the_ends_of_their_ranges(name):
    expected = {"tension": (-1, 1), "continuity": (-1, 0), "bias": (-1, 1), "steepness": (1, 8), "swing": (0, 1)}
    assert PASSAGE_RANGES[name] == expected[name]
    for end, outward in zip(expected[name], (-1e-9, 1e-9), strict=True):
        assert getattr(KeyPassage(**{name: end}), name) == end
        with pytest.raises(ValueError, match=f"{name} is"):
            KeyPassage(**{name: end + outward})


@pytest.mark.parametrize(
    ("tension", "continuity", "swing", "kept"),
    [
        (0.0, 0.0, 0.0, 1.0),
        (0.25, -0.5, 0.0, 0.375),
        (-0.5, -0.2, 0.0, 1.2),
        (0.5, 0.0, 0.5, 1.0),
        (-0.5, 0.0, 0.5, 2.5),
        (1.0, -0.3, 1.0, 0.0),
    ],
)
def test_velocity_factor_at_a_key_depends_on_tension_continuity_and_swing(tension, continuity, swing, kept):
    assert flow(tension, continuity, swing) == pytest.approx(kept)
    assert KeyPassage(tension=tension, continuity=continuity, swing=swing).flow == pytest.approx(kept)


def test_key_passage_without_accent_has_at_most_the_steepness_of_full_power():
    for easing, steepness, left in (("out_back", 2.4, 2.4), ("out_bounce", 2.6, 2.5), ("late", 6.0, 6.0)):
        passage = KeyPassage(easing=easing, steepness=steepness, swing=0.5)
        assert passage.without_accent == KeyPassage(easing=easing, steepness=left)


def test_key_passage_values_list_the_parameters_of_each_hinge():
    first = KeyPassage(0.1, -0.2, 0.3, "out_back", 5.0, 0.6)
    posture = KeyPosture(0.0, sealed([0.0, 0.0]), BOTH_KEYED, passages=(first, KeyPassage()))
    np.testing.assert_array_equal(
        posture.passage_values.T, [[0.1, -0.2, 0.3, 5.0, 3, 0.6], [0.0, 0.0, 0.0, 4.0, 0, 0.0]]
    )
    np.testing.assert_array_equal(key(0.0).passage_values.T, [[0.0, 0.0, 0.0, 4.0, 0, 0.0]] * 2)
    keys = Keys.of([posture, key(1.0)], JOINT_LIMITS)
    np.testing.assert_array_equal(keys.passage_values[:, 0], posture.passage_values)
    np.testing.assert_array_equal(keys.passage_values[:, 1], key(1.0).passage_values)
    same = keys.with_passage(first)
    np.testing.assert_array_equal(same.passage_values, np.tile(posture.passage_values[:, :1, None], (1, 2, 2)))


def test_key_angles_are_clipped_to_one_milliradian_inside_the_joint_range():
    limits = replace(JOINT_LIMITS, lower=sealed([-2.0, 0.3]), upper=sealed([1.0, 0.3008]))
    rows = [KeyPosture(float(k), sealed([angle] * 2), BOTH_KEYED) for k, angle in enumerate((-9.0, 0.3, 9.0))]
    np.testing.assert_allclose(Keys.of(rows, limits).angles, [[-1.999, 0.3004], [0.3, 0.3004], [0.999, 0.3004]])
    np.testing.assert_allclose(Keys.of(rows, limits, margin=0.1).angles[:, 0], [-1.9, 0.3, 0.9])


def test_posture_of_all_hinges_has_an_exact_key_without_sync_points_for_each_hinge():
    posture = KeyPosture.whole(1.5, [0.1, 0.2, 0.3])
    assert (posture.time, posture.keyed, posture.syncs, posture.is_exact) == (1.5, (True,) * 3, (), True)
    assert posture.angles.tolist() == [0.1, 0.2, 0.3]


def test_precedence_constraints_apply_only_between_two_existing_different_keys():
    bonds = (
        Bond(("b", "start"), ("b", "end"), 0.5),
        Bond(("b", "start"), ("b", "relax"), 0.6),
        Bond(("b", "start"), ("c", "end"), 0.7),
        Bond(("c", "end"), ("b", "end"), 0.8),
    )
    keys = Keys.of([key(0.0, ("b", "start"), ("b", "relax")), key(1.0, ("b", "end"))], JOINT_LIMITS, bonds)
    assert keys.bonds == {(0, 1): 0.5}


def test_keys_of_one_behaviour_keep_a_minimum_gap_even_without_a_common_hinge():
    first, second = (True, False), (False, True)
    rows = [key(0.0), key(0.1, ("b", "a"), keyed=first), key(0.2, ("c", "a"), keyed=second)]
    rows += [key(0.3, ("b", "b"), ("b", "c"), keyed=second), key(0.4)]
    gaps = Keys.of(rows, JOINT_LIMITS).gaps
    assert gaps == dict.fromkeys([(0, 1), (1, 4), (0, 2), (2, 3), (3, 4), (1, 3)], 0.02)


@pytest.mark.parametrize(
    ("requested", "gap"), [(0.05, 0.02), (0.02, 0.02), (0.013, 0.013), (0.0021, 0.0021), (0.0015, 0.002)]
)
def test_gap_between_path_keys_of_different_hinges_is_the_requested_gap_clipped_to_2_to_20_ms(requested, gap):
    rows = [
        key(0.0),
        key(0.1, keyed=(True, False), is_exact=False),
        key(0.2, keyed=(False, True)),
        key(0.2 + requested, keyed=(True, False), is_exact=False),
        key(1.0),
    ]
    third = Limits(*(sealed([value] * 3) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
    wide = [replace(row, angles=sealed([0.0] * 3), keyed=(*row.keyed, k in (0, 4))) for k, row in enumerate(rows)]
    wide.insert(3, KeyPosture(0.2 + requested, sealed([0.0] * 3), (False, False, True)))
    assert Keys.of(wide, third).gaps[2, 3] == pytest.approx(gap)


@pytest.mark.parametrize(("missing", "is_spaced"), [(0.0, True), (0.7e-6, True), (1.6e-6, False), (0.001, False)])
def test_key_times_count_as_spaced_if_they_keep_every_minimum_gap_up_to_rounding(missing, is_spaced):
    assert at(0.0, 0.5, 0.52 - missing, 2.0).is_spaced is is_spaced
    assert at(7.0, 7.02 - missing, 8.0).is_spaced is is_spaced


def test_times_of_path_keys_move_with_the_exact_keys_around_them():
    rows = [key(0.0), key(0.25, is_exact=False), key(1.0), key(1.5, is_exact=False), key(2.0)]
    moved = Keys.of(rows, JOINT_LIMITS).interpolate_path_times(np.array([1.0, -9.0, 3.0, 9.0, 7.0]))
    np.testing.assert_allclose(moved, [1.0, 1.5, 3.0, 5.0, 7.0])


def test_common_key_passage_changes_neither_angles_nor_the_set_of_exact_keys():
    keys = Keys.of([key(0.0), key(0.5, angle=0.4, is_exact=False), key(1.0, angle=0.3)], JOINT_LIMITS)
    same = keys.with_passage(KeyPassage(bias=0.5))
    assert same.keyed.tolist() == [[True, True], [False, False], [True, True]]
    assert same.angles is keys.angles
    assert same.exact_rows == keys.exact_rows
