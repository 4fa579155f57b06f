"""Left-right pairs and left direction of synthetic hinge trees."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.sim.importer.mirror import (
    Sides,
    _axis,
    _find_side,
    _list_images,
    _list_planes,
    _measure_forward_extent,
    _measure_mirror_offset,
    _pair_by_name,
    _pair_by_symmetry,
    sides,
)
from kinesic.sim.importer.model_tree import BASE_INDEX, Joint, ModelPart, Tree

X, Y, Z = np.eye(3)


def make_tree(*rows, base=0 * X):
    """Return a tree from rows (name, parent, anchor, axis, optional part centre)."""
    joints = tuple(
        Joint(name, parent, np.asarray(anchor), np.asarray(axis), 0.0, *(None,) * 8)
        for name, parent, anchor, axis, *_ in rows
    )
    parts = tuple(ModelPart(1.0, np.asarray(row[4] if len(row) > 4 else row[2]), ()) for row in rows)
    return Tree("hand-made", joints, parts, ModelPart(1.0, base, ()))


def arms(left="l", right="r", count=3, spread=0.2):
    """Return table rows of two hanging arms, each a chain of `count` hinges."""
    rows = []
    for side, name in ((1, left), (-1, right)):
        first = len(rows)
        for k in range(count):
            parent = BASE_INDEX if k == 0 else first + k - 1
            rows.append((f"{name}_{k}", parent, side * spread * Y - 0.1 * k * Z, X))
    return rows


def test_upright_frame_of_an_imported_robot_has_x_forward_and_y_left():
    upright = Sides({}, (-1.0, 0.0), certain=True, by_names=False).upright
    np.testing.assert_array_equal(upright, (Y, -X, Z))


@pytest.mark.parametrize(
    ("anchor", "axis", "offset"),
    [
        (X, Z, 0.0),
        (X, -Z, 0.0),
        (X + 0.3 * Z, Z, 0.03),
        (X + 0.3 * Y, Z, 0.33),
        (X, np.array([0.0, np.sqrt(1 - 0.981**2), 0.981]), 0.0),
        (X, np.array([0.0, np.sqrt(1 - 0.979**2), 0.979]), np.inf),
        (X, Y, np.inf),
    ],
)
def test_offset_of_a_mirrored_hinge_weighs_distance_along_its_axis_by_a_tenth(anchor, axis, offset):
    joint = SimpleNamespace(anchor=anchor, axis=axis)
    assert _measure_mirror_offset(joint, X, Z) == pytest.approx(offset)


def test_mirror_planes_across_y_and_x_are_tried_at_the_origin_the_base_and_the_median_hinge():
    rows = [("a", BASE_INDEX, (1.0, 2.0, 0.0), Z), ("b", 0, (3.0, 6.0, 0.0), Z), ("c", 1, (9.0, 7.0, 0.0), Z)]
    tree = make_tree(*rows, base=np.array([0.1, 0.2, 0.3]))
    assert _list_planes(tree) == [(1, 0.0), (1, 0.2), (1, 6.0), (0, 0.0), (0, 0.1), (0, 3.0)]


def test_symmetric_hinges_are_paired_from_left_to_right():
    rows = arms()
    assert _pair_by_symmetry(make_tree(*rows), 1, 0.0) == {0: 3, 1: 4, 2: 5}
    mirrored = [(name, parent, anchor * (1, -1, 1), axis) for name, parent, anchor, axis in rows]
    assert _pair_by_symmetry(make_tree(*mirrored), 1, 0.0) == {3: 0, 4: 1, 5: 2}


def test_hinges_are_paired_across_a_plane_off_the_origin():
    shifted = [(name, parent, anchor + 0.5 * Y, axis) for name, parent, anchor, axis in arms()]
    assert _pair_by_symmetry(make_tree(*shifted), 1, 0.0) == {}
    assert _pair_by_symmetry(make_tree(*shifted), 1, 0.5) == {0: 3, 1: 4, 2: 5}
    across_x = [(name, parent, anchor[[1, 0, 2]] + 0.5 * X, Y) for name, parent, anchor, axis in arms()]
    assert _pair_by_symmetry(make_tree(*across_x), 0, 0.5) == {0: 3, 1: 4, 2: 5}


def test_midline_hinges_are_unpaired_and_may_carry_mirror_pairs():
    waist = ("waist", BASE_INDEX, 0 * X, Z)
    moved = [(name, parent + 1, anchor, axis) for name, parent, anchor, axis in arms()]
    assert _pair_by_symmetry(make_tree(waist, *moved), 1, 0.0) == {1: 4, 2: 5, 3: 6}
    assert _pair_by_symmetry(make_tree(("waist", BASE_INDEX, 0.3 * Y, Z), *moved), 1, 0.0) == {}


@pytest.mark.parametrize(("off", "paired"), [(0.019, True), (0.021, False)])
def test_hinges_more_than_2_cm_from_mirror_symmetry_are_not_paired(off, paired):
    rows = arms(count=1)
    rows[1] = ("r_0", BASE_INDEX, -0.2 * Y + off / 1.1 * Z, X)
    assert _pair_by_symmetry(make_tree(*rows), 1, 0.0) == ({0: 1} if paired else {})
    waist = ("waist", BASE_INDEX, off / 2.2 * Y, X)
    children = [(name, 0, anchor, axis) for name, _, anchor, axis in arms(count=1)]
    assert _pair_by_symmetry(make_tree(waist, *children), 1, 0.0) == ({1: 2} if paired else {})


def test_nearest_of_several_candidates_becomes_the_mirror_partner():
    rows = [("a", BASE_INDEX, 0.2 * Y, X), ("b", BASE_INDEX, -0.2 * Y + 0.01 * Z, X), ("c", BASE_INDEX, -0.2 * Y, X)]
    assert _pair_by_symmetry(make_tree(*rows), 1, 0.0) == {0: 2}


@pytest.mark.parametrize(
    ("name", "images"),
    [
        ("left_arm", ["right_arm"]),
        ("armLeft", ["armRight"]),
        ("ARMLEFT", ["ARMRIGHT"]),
        ("l_arm", ["r_arm"]),
        ("arm_l", ["arm_r"]),
        ("arm_L_1", ["arm_R_1"]),
        ("LArm", ["RArm"]),
        ("arml", []),
        ("larm", []),
        ("right_arm", []),
    ],
)
def test_mirror_image_of_a_joint_name_exchanges_side_words_or_side_letters(name, images):
    assert _list_images(name) == images


def test_body_side_is_found_from_a_pair_of_mirrored_names():
    assert (_find_side("l_arm", "r_arm"), _find_side("r_arm", "l_arm"), _find_side("a", "b")) == (1, -1, 0)


def test_joints_are_paired_by_names_only_if_both_names_exist():
    tree = make_tree(*((name, BASE_INDEX, X, Y) for name in ("r_arm", "l_arm", "l_leg", "waist")))
    assert _pair_by_name(tree) == {1: 0}


@pytest.mark.parametrize(
    ("total", "left"),
    [
        ((0.1, 0.3), (0.0, 1.0)),
        ((0.1, -0.3), (0.0, -1.0)),
        ((0.4, -0.3), (1.0, 0.0)),
        ((-0.4, 0.3), (-1.0, 0.0)),
        ((0.0, 0.0), (1.0, 0.0)),
    ],
)
def test_left_direction_is_rounded_to_the_nearest_world_axis(total, left):
    assert _axis(np.array(total)) == left


FEET_ROWS = [
    ("a", BASE_INDEX, 0.1 * Y - Z, X, 0.1 * Y - Z + 0.07 * X),
    ("b", BASE_INDEX, -0.1 * Y - Z, X, -0.1 * Y - Z + 0.06 * X),
]
HEAD_ROW = ("head", BASE_INDEX, Z, Z, Z + 0.04 * X)
HAND_ROW = ("hand", BASE_INDEX, 2 * Z, Z, 2 * Z + 0.5 * X)


@pytest.mark.parametrize(
    ("rows", "pairs", "extent"),
    [
        ((*FEET_ROWS, HEAD_ROW), {0: 1}, 0.17),
        (FEET_ROWS, {0: 1}, 0.13),
        ((HEAD_ROW,), {}, 0.12),
        ((*FEET_ROWS, HAND_ROW, HAND_ROW), {0: 1, 2: 3}, 0.13),
        ((), {}, 0.0),
    ],
)
def test_forward_extent_is_measured_from_feet_and_head(rows, pairs, extent):
    tree = make_tree(*rows)
    assert _measure_forward_extent(tree, pairs, (0.0, 1.0)) == pytest.approx(extent)
    assert _measure_forward_extent(tree, pairs, (0.0, -1.0)) == pytest.approx(-extent)
    assert _measure_forward_extent(tree, pairs, (1.0, 0.0)) == pytest.approx(0.0)


@pytest.mark.parametrize(("reach", "extent"), [(0.0101, 0.0101), (0.0099, 0.0), (-0.0101, -0.0101), (-0.0099, 0.0)])
def test_forward_extent_below_1_cm_counts_as_zero(reach, extent):
    foot = ("foot", BASE_INDEX, -Z, X, -Z + reach / 3 * X)
    assert _measure_forward_extent(make_tree(foot), {}, (0.0, 1.0)) == pytest.approx(extent)


def crooked(count):
    """Return rows of symmetric arms, and of asymmetric legs paired by name."""
    return [*arms(count=count), ("l_leg", BASE_INDEX, 0.1 * Y - 2 * Z, X), ("r_leg", BASE_INDEX, -0.1 * Y - 3 * Z, X)]


def test_imported_hinges_are_paired_by_names_if_symmetry_finds_fewer_than_six_pairs():
    found = sides(make_tree(*crooked(5)))
    assert (found.by_names, found.pairs) == (True, {k: k + 5 for k in range(5)} | {10: 11})
    found = sides(make_tree(*crooked(6)))
    assert (found.by_names, found.pairs) == (False, {k: k + 6 for k in range(6)})
    assert not sides(make_tree(*arms(count=5))).by_names


def test_joint_names_decide_which_side_is_left():
    found = sides(make_tree(*arms(), *FEET_ROWS))
    assert (found.left, found.certain, found.pairs) == ((0.0, 1.0), True, {0: 3, 1: 4, 2: 5, 6: 7})
    found = sides(make_tree(*arms("r", "l"), *FEET_ROWS))
    assert (found.left, found.certain, found.pairs) == ((0.0, -1.0), True, {3: 0, 4: 1, 5: 2, 7: 6})


def test_direction_of_the_toes_decides_which_side_is_left_if_joint_names_do_not():
    found = sides(make_tree(*arms("a", "b"), *FEET_ROWS))
    assert (found.left, found.certain, found.pairs) == ((0.0, 1.0), True, {0: 3, 1: 4, 2: 5, 6: 7})
    backward = [(name, parent, anchor, axis, 2 * anchor - centre) for name, parent, anchor, axis, centre in FEET_ROWS]
    found = sides(make_tree(*arms("a", "b"), *backward))
    assert (found.left, found.certain, found.pairs) == ((0.0, -1.0), True, {3: 0, 4: 1, 5: 2, 7: 6})


def test_left_side_of_an_imported_robot_is_a_guess_without_side_names_and_toes():
    found = sides(make_tree(*arms("a", "b")))
    assert (found.left, found.certain, found.pairs) == ((0.0, 1.0), False, {0: 3, 1: 4, 2: 5})


def test_left_side_of_a_robot_with_arms_along_x_is_at_positive_x():
    turned = [(name, parent, anchor[[1, 0, 2]], Y) for name, parent, anchor, _ in arms()]
    assert sides(make_tree(*turned)).left == (1.0, 0.0)
