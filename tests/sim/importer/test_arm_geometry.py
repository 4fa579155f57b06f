"""Divisions, joint centres, likeness and hinge axes of synthetic arms."""

from dataclasses import replace
from math import cos, sin, sqrt
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.arm import Centres, Split, _find_twist, centres, likeness, splits
from kinesic.sim.importer.hinge_row import (
    HingeRow,
    distances,
    find_common_point,
    find_nearest_on_line,
    foot,
    unit_vector,
)
from kinesic.sim.importer.model_tree import ModelPart

X, Y, Z = np.eye(3)
SHOULDER = np.array([0.02, 0.2, 1.4])
ELBOW = SHOULDER - 0.3 * Z
WRIST = SHOULDER - 0.5 * Z
CENTRE = SHOULDER - 0.6 * Z


def limb(*hinges, centre=CENTRE):
    anchors, axes = zip(*hinges, strict=True)
    return HingeRow(np.array(anchors), np.array(axes), centre)


GIRDLE = (SHOULDER - 0.1 * Y, X)
BALL = ((SHOULDER, Y), (SHOULDER, X), (SHOULDER, Z))
HINGE = (ELBOW, Y)
HAND = ((WRIST, X), (WRIST, Y))
FINGER = (np.ones(3), Z)


def test_arm_division_gives_elbow_index_and_hinge_count():
    split = Split(girdle=1, shoulder=3, wrist=2)
    assert (split.elbow, split.hinges) == (4, 7)


@pytest.mark.parametrize(
    ("count", "expected"),
    [
        (2, []),
        (3, [(0, 2, 0)]),
        (4, [(0, 2, 1), (0, 3, 0), (1, 2, 0)]),
        (6, [(0, 2, 3), (0, 3, 2), (0, 4, 1), (1, 2, 2), (1, 3, 1), (1, 4, 0), (2, 2, 1), (2, 3, 0), (3, 2, 0)]),
    ],
)
def test_arm_divisions_have_two_to_four_shoulder_hinges_and_up_to_three_before_and_after(count, expected):
    assert splits(count) == [Split(*numbers) for numbers in expected]


def test_arm_of_twenty_hinges_has_twelve_divisions_with_three_wrist_hinges():
    found = splits(20)
    assert [(split.girdle, split.shoulder) for split in found] == [(g, s) for g in range(4) for s in (2, 3, 4)]
    assert {split.wrist for split in found} == {3}


def test_bones_of_an_imported_arm_run_between_joint_centres():
    anchors = np.array([[0, 0.1, 0], [0, 0, 0.3]])
    at = Centres(np.zeros(3), -0.3 * Z, -0.3 * Z + 0.2 * X, anchors, np.array([X, X]))
    np.testing.assert_allclose((at.upper, at.fore), (-Z, X))
    assert at.lengths == pytest.approx((0.3, 0.2))
    assert at.miss == pytest.approx(0.2)


def test_joint_centres_of_an_imported_arm_exclude_collar_bone_and_fingers():
    row = limb(
        GIRDLE,
        (SHOULDER + 0.3 * Y, Y),
        (SHOULDER + 0.3 * X, X),
        (SHOULDER, Z),
        (ELBOW + 0.01 * X + 0.1 * Y, Y),
        (WRIST + 0.1 * X, X),
        (WRIST, Y),
        FINGER,
    )
    at = centres(row, Split(1, 3, 2))
    np.testing.assert_allclose(at.shoulder, SHOULDER, atol=1e-3)
    np.testing.assert_allclose(at.elbow, ELBOW + 0.01 * X, atol=1e-9)
    np.testing.assert_allclose(at.wrist, WRIST, atol=1e-3)
    np.testing.assert_array_equal(at.anchors, row.anchors[1:4])
    np.testing.assert_array_equal(at.axes, row.axes[1:4])


def test_shoulder_centre_of_parallel_hinges_is_at_the_last_shoulder_hinge():
    row = limb((SHOULDER + 0.2 * Y, Y), (SHOULDER + 0.1 * Y, Y), HINGE, *HAND)
    np.testing.assert_allclose(centres(row, Split(0, 2, 2)).shoulder, SHOULDER + 0.1 * Y)


def test_wrist_centre_of_parallel_hinges_is_at_the_last_wrist_hinge():
    row = limb(*BALL, HINGE, (WRIST, Z), (WRIST - 0.1 * Z, Z), FINGER)
    np.testing.assert_allclose(centres(row, Split(0, 3, 2)).wrist, WRIST - 0.1 * Z)


def test_elbow_centre_is_nearest_to_the_upper_arm_twist_axis_or_else_to_the_shoulder():
    slanted = (ELBOW, (Y + Z) / sqrt(2))
    assert centres(limb(*BALL, slanted, *HAND), Split(0, 3, 2)).elbow == pytest.approx(ELBOW)
    expected = ELBOW + 0.15 * (Y + Z)
    assert centres(limb(*BALL[:2], slanted, *HAND), Split(0, 2, 2)).elbow == pytest.approx(expected)


def test_arm_without_wrist_hinges_ends_at_twice_the_distance_of_its_centre_of_mass():
    at = centres(limb(*BALL, HINGE, FINGER, centre=ELBOW - 0.1 * Z + 0.03 * X), Split(0, 3, 0))
    np.testing.assert_allclose(at.wrist, ELBOW - 0.2 * Z + 0.06 * X)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("cosine", "is_twist"), [(0.69, False), (0.71, True)])
def test_wrist_centre_is_at_a_single_wrist_hinge_unless_it_twists_the_forearm(sign, cosine, is_twist):
    axis = sign * (cosine * Z + sqrt(1 - cosine**2) * X)
    row = limb(*BALL, HINGE, (WRIST, axis))
    tip = 2 * CENTRE - ELBOW
    expected = foot(tip, WRIST, axis) if is_twist else WRIST
    np.testing.assert_allclose(centres(row, Split(0, 3, 1)).wrist, expected, atol=1e-3)


def test_wrist_centre_is_where_two_hinges_meet_even_if_the_first_twists_the_forearm():
    row = limb(*BALL, HINGE, (WRIST + 0.1 * Z, Z), (WRIST, X))
    np.testing.assert_allclose(centres(row, Split(0, 3, 2)).wrist, WRIST, atol=1e-3)


@pytest.mark.parametrize(
    ("axes", "twist"),
    [
        ((Z, Y, X, -Z, Z), 3),
        ((Z, Y, Z, X, Z), 2),
        ((Z, Y, X, Y, Z), None),
        ((Z, Y, 0.69 * Z + sqrt(1 - 0.69**2) * X, X, Z), None),
        ((Z, Y, 0.71 * Z + sqrt(1 - 0.71**2) * X, X, Z), 2),
    ],
)
def test_upper_arm_twist_is_the_last_shoulder_hinge_along_the_upper_arm(axes, twist):
    row = limb(*zip([SHOULDER] * 4 + [ELBOW], axes, strict=True))
    assert _find_twist(row, Split(1, 3, 0), SHOULDER) == twist


@pytest.mark.parametrize(
    ("hinges", "split", "score"),
    [
        ((*BALL, HINGE), (0, 3, 2), 0.6 + 0.4 + 0.4),
        ((GIRDLE, *BALL, HINGE), (1, 3, 2), 0.6 + 0.4 + 0.4 - 0.6),
        ((GIRDLE, GIRDLE, *BALL, HINGE), (2, 3, 2), 0.6 + 0.4 + 0.4 - 1.2),
        ((BALL[1], *BALL, HINGE), (0, 4, 2), 0.6 + 0.4 + 0.4 - 0.3),
        ((*BALL[:2], HINGE), (0, 2, 2), 0.4),
        ((*BALL[1:], HINGE), (0, 2, 2), 0.4),
        (((SHOULDER, 0.6 * X - 0.8 * Y), BALL[1], HINGE), (0, 2, 2), 0.4 * 0.8),
        ((*BALL, (ELBOW, 0.8 * Y + 0.6 * Z)), (0, 3, 2), 0.6 + 0.4 + 0.4 - 1.5 * 0.6),
        ((*BALL, (ELBOW, 0.8 * Y - 0.6 * Z)), (0, 3, 2), 0.6 + 0.4 + 0.4 - 1.5 * 0.6),
    ],
)
def test_likeness_of_an_arm_depends_on_its_hinge_counts_and_axes(hinges, split, score):
    row = limb(*hinges, *HAND)
    assert likeness(row, Split(*split)) == pytest.approx(1.5 + 2 / 3 + score)


def test_likeness_of_an_arm_falls_with_unequal_bones_and_shoulder_offsets():
    split = Split(0, 3, 2)
    long_forearm = limb(*BALL, HINGE, (ELBOW - 0.6 * Z, X), (ELBOW - 0.6 * Z, Y))
    assert likeness(long_forearm, split) == pytest.approx(1.5 + 0.5 + 1.4)
    offset = limb(*BALL[:2], (SHOULDER + 0.05 * X, Z), (ELBOW + 0.05 * X, Y), *HAND)
    at = centres(offset, split)
    upper, fore = at.lengths
    expected = -6.0 * at.miss / (upper + fore) + 1.5 + min(upper / fore, fore / upper) + 1.4
    assert at.miss > 0.01
    assert likeness(offset, split) == pytest.approx(expected)


@pytest.mark.parametrize(("upper", "fore"), [(0.3, 0.019), (0.019, 0.3)])
def test_likeness_of_an_arm_with_a_bone_shorter_than_2_cm_is_minus_infinity(upper, fore):
    def stretched(upper, fore):
        elbow = SHOULDER - upper * Z
        return limb(*BALL, (elbow, Y), (elbow - fore * Z, X), (elbow - fore * Z, Y))

    assert likeness(stretched(upper, fore), Split(0, 3, 2)) == -np.inf
    assert likeness(stretched(max(upper, 0.021), max(fore, 0.021)), Split(0, 3, 2)) > 2.0


def test_hinge_row_contains_hinge_axes_and_the_centre_of_mass_of_parts_beyond_the_last_hinge():
    joints = [SimpleNamespace(anchor=k * X, axis=axis) for k, axis in enumerate((X, Y, Z))]
    tree = SimpleNamespace(
        joints=joints,
        below=lambda k: {1: (1, 5), 2: (2, 6)}[k],
        merge_parts=lambda parts: ModelPart(1.0, np.array([*parts, 0.0]), (Capsule(X, 4 * X, 0.5),)),
    )
    row = HingeRow.of(tree, (2, 1))
    np.testing.assert_array_equal(row.anchors, (2 * X, X))
    np.testing.assert_array_equal(row.axes, (Z, Y))
    assert row.centre.tolist() == [1, 5, 0]
    np.testing.assert_allclose(row.tip, X + 0.5 * Y)


def test_rotation_of_an_imported_hinge_moves_the_axes_of_all_later_hinges():
    row = HingeRow(np.array([X, 2 * X, 3 * X]), np.array([Z, X, Y]), np.array([4.0, 0.0, 0.0]))
    turned = row.turned(np.array([np.pi / 2, np.pi / 2, np.pi / 2]))
    np.testing.assert_allclose(turned.anchors, (X, X + Y, X + 2 * Y), atol=1e-12)
    np.testing.assert_allclose(turned.axes, (Z, Y, Z), atol=1e-12)
    np.testing.assert_allclose(turned.centre, 2 * Y, atol=1e-12)
    rotation, shift = row.motion(np.array([np.pi / 2, 0.0, 0.0]))[0]
    np.testing.assert_allclose(rotation @ X, Y, atol=1e-12)
    np.testing.assert_allclose(shift, X - Y, atol=1e-12)


def test_common_point_of_lines_is_pulled_weakly_to_the_preferred_point():
    line = (np.array([0.4 * Y]), np.array([X]))
    np.testing.assert_allclose(find_common_point(*line, 3 * X + Z, pull=0.25), 3 * X + 0.32 * Y + 0.2 * Z)
    np.testing.assert_allclose(find_common_point(*line, 1001 * Z), 0.4 / 1.001 * Y + Z)


def test_distance_of_a_point_from_a_line_is_measured_perpendicular_to_the_line():
    anchors, axes = np.array([[7.0, 0, 0], [1.0, 2, 0]]), np.array([X, Z])
    np.testing.assert_allclose(distances(np.array([2.0, 3.0, 4.0]), anchors, axes), (5.0, sqrt(2)))


def test_point_is_projected_onto_a_line_off_the_origin():
    np.testing.assert_allclose(foot(np.array([5.0, 6, 7]), np.array([1.0, 2, 3]), Y), (1, 6, 3))


def test_nearest_point_of_two_slanted_lines_is_at_their_common_perpendicular():
    direction = (X + Y) / sqrt(2)
    found = find_nearest_on_line(np.array([0.5, 1.0, 0.0]), X, np.array([2.0, 3.0, 9.0]), direction)
    np.testing.assert_allclose(found, (0.0, 1.0, 0.0), atol=1e-12)


@pytest.mark.parametrize(("angle", "at"), [(0.0009, 0.7), (0.0011, 0.7 - 0.1 / np.tan(0.0011))])
def test_nearly_parallel_lines_count_as_parallel(angle, at):
    found = find_nearest_on_line(0.5 * X, X, np.array([0.7, 0.1, 5.0]), cos(angle) * X + sin(angle) * Y)
    np.testing.assert_allclose(found, at * X)


def test_normalised_vector_has_length_1_unless_it_is_zero():
    np.testing.assert_allclose(unit_vector(np.array([3.0, 0, -4])), (0.6, 0, -0.8))
    assert unit_vector(np.zeros(3)).tolist() == [0, 0, 0]


def test_hinges_beyond_the_wrist_do_not_change_the_likeness_of_an_arm():
    row = limb(*BALL, HINGE, *HAND)
    longer = replace(limb(*BALL, HINGE, *HAND, FINGER), centre=row.centre)
    assert likeness(longer, Split(0, 3, 2)) == likeness(row, Split(0, 3, 2))
