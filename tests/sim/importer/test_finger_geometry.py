"""Names, directions, ranges and couplings of synthetic finger hinges."""

from itertools import pairwise
from math import pi, radians
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.sim.importer import hand
from kinesic.sim.importer.hand import (
    _Axes,
    _find_axes,
    _find_driver,
    _find_range_sign,
    _find_sense,
    _find_thumb,
    _list_chains,
    _make_row,
    _map_finger,
    _map_turn,
    _name_hinges,
    _Row,
    _score_apartness,
    find_hand,
)

X, Y, Z = np.eye(3)
AXES = _Axes(along=X, across=Y, palm=-Z)  # fingers forward, thumb to the left, palm down
FLEXION_AXIS = Y  # axis of a hinge that moves a finger along x towards -z


def joint(axis=FLEXION_AXIS, anchor=(0.0, 0.0, 0.0), name="j", lower=0.0, upper=1.0, zero=0.0, follows=None):
    return SimpleNamespace(
        axis=np.asarray(axis, float),
        anchor=np.array(anchor, float),
        name=name,
        lower=lower,
        upper=upper,
        zero=zero,
        follows=follows,
    )


def tree_of(*joints, children=None, parts=None):
    return SimpleNamespace(joints=joints, children=children or {}, parts=parts or {})


def row(base, tip, joints=(0,)):
    return _Row(joints, np.array(base, float), np.array(tip, float))


def test_each_unbranched_chain_of_hinges_is_a_finger():
    children = {0: [1, 4], 1: [2], 2: [3], 3: [], 4: [5, 6], 5: [], 6: [7], 7: []}
    assert list(_list_chains(tree_of(children=children), 0)) == [(1, 2, 3), (5,), (6, 7)]
    assert list(_list_chains(tree_of(children=children), 3)) == []


def test_tip_of_a_finger_is_the_shape_end_farthest_from_its_last_hinge():
    joints = (joint(anchor=(1, 0, 0)), joint(anchor=(2, 0, 0)))
    shapes = [SimpleNamespace(start=np.array([9.0, 0, 0]), end=X), SimpleNamespace(start=2.5 * X, end=Y)]
    found = _make_row(tree_of(*joints, parts={1: SimpleNamespace(shapes=shapes, centre=3 * X)}), (0, 1))
    assert (found.base.tolist(), found.tip.tolist()) == ([1, 0, 0], [9, 0, 0])
    bare = _make_row(tree_of(*joints, parts={1: SimpleNamespace(shapes=[], centre=3 * X)}), (0, 1))
    assert bare.tip.tolist() == [4, 0, 0]
    assert bare.along.tolist() == [1, 0, 0]
    assert row((1, 1, 1), (1, 1, 1)).along.tolist() == [0, 0, 0]


def test_thumb_score_is_the_angle_plus_the_relative_distance_to_the_other_fingers():
    others = [row((0, 0, 0), (0.1, 0, 0)), row((0, 0.02, 0), (0.3, 0.02, 0))]
    thumb = row((-0.05, 0, 0), (-0.05, 0.1, 0))
    assert _score_apartness(thumb, [thumb, *others]) == pytest.approx(pi / 2 + 0.25)


@pytest.mark.parametrize(("names", "thumb"), [(("a", "Left_Thumb1", "c"), 1), (("thumb", "thumb2", "c"), 2)])
def test_thumb_is_the_only_finger_with_that_name_or_else_the_most_separate_finger(names, thumb):
    rows = [row((0, 0, 0), (1, 0, 0), (0,)), row((0, 1, 0), (1, 1, 0), (1,)), row((-1, 2, 0), (-1, 3, 0), (2,))]
    tree = tree_of(*(joint(name=name) for name in names))
    assert _find_thumb(tree, rows) is rows[thumb]


@pytest.mark.parametrize(
    ("lower", "upper", "zero", "sign"),
    [(0, 1, 0, 1), (-1, 0, 0, -1), (-1, 1, 0, 0), (0, 1, 0.5, 0), (0, 1, 0.6, -1), (None, 1, 0, 0), (0, None, 0, 0)],
)
def test_sign_of_a_joint_range_is_that_of_the_larger_side_or_zero_if_both_sides_are_similar(lower, upper, zero, sign):
    assert _find_range_sign(joint(lower=lower, upper=upper, zero=zero)) == sign


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("bend", [1.0, -1.0, 0.0])
def test_palm_is_on_the_side_to_which_the_fingers_bend(side, bend):
    others = [row((0.01 * k, 0.02 * k, 0), (0.1 + 0.01 * k, 0.02 * k, 0), (k,)) for k in range(3)]
    thumb = row((-0.02, 0.02 + 0.02 * side, 0), (0, 0.02 + 0.06 * side, 0), (3,))
    limits = {1.0: (0.0, 1.5), -1.0: (-1.5, 0.0), 0.0: (-1.0, 1.0)}[bend]
    tree = tree_of(*(joint(lower=limits[0], upper=limits[1]) for _ in range(4)))
    axes = _find_axes(tree, thumb, others)
    np.testing.assert_allclose(axes.along, X, atol=1e-9)
    np.testing.assert_allclose(axes.across, side * Y, atol=1e-9)
    np.testing.assert_allclose(axes.palm, (-bend or side) * Z, atol=1e-9)


@pytest.mark.parametrize(
    ("finger", "axes", "names"),
    [
        ("index", (Z, Y, Y), ["index_abduct", "index_flexion1", "index_flexion2"]),
        ("middle", (-Z, Y), ["middle_pivot", "middle_flexion1"]),
        ("ring", (Y, Z, Z), ["ring_flexion1", "ring_abduct", "ring_turn3"]),
        ("pinky", (X, Y), ["pinky_turn1", "pinky_flexion1"]),
        ("index", (Y + Z,), ["index_flexion1"]),
        ("thumb", (X, Z, Z), ["thumb_abduct", "thumb_flexion1", "thumb_flexion2"]),
        ("thumb", (Z, Z), ["thumb_flexion1", "thumb_flexion2"]),
        ("thumb", (Z,), ["thumb_flexion1"]),
    ],
)
def test_finger_hinges_are_named_by_their_axes(finger, axes, names):
    tree = tree_of(*(joint(axis=np.asarray(axis) / np.linalg.norm(axis)) for axis in axes))
    tip = (0.05, 0.05, 0) if finger == "thumb" else (0.1, 0, 0)
    assert list(_name_hinges(tree, finger, row((0, 0, 0), tip, tuple(range(len(axes)))), AXES)) == names


@pytest.mark.parametrize(
    ("name", "axis", "sense"),
    [
        ("index_flexion1", Y, 1.0),
        ("ring_flexion2", -Y, -1.0),
        ("index_abduct", Z, 1.0),
        ("ring_abduct", Z, -1.0),
        ("middle_pivot", -Z, 1.0),
        ("ring_turn2", X, 1.0),
        ("thumb_abduct", Y, 1.0),
        ("thumb_flexion1", -Z, 1.0),
        ("thumb_flexion1", Y, 1.0),
        ("thumb_flexion1", Z, -1.0),
    ],
)
def test_positive_angles_flex_towards_the_palm_and_abduct_from_the_middle_finger(name, axis, sense):
    assert _find_sense(joint(axis=axis), name, row((0, 0, 0), (0.1, 0, 0)), AXES) == sense


@pytest.mark.parametrize(
    ("name", "limits", "sign", "expected"),
    [
        ("index_flexion1", (0.1, 1.2), 1.0, (0.0, 1.1, False)),
        ("index_flexion1", (0.1, 1.2), -1.0, (-1.1, 0.0, False)),
        ("index_flexion1", (-4.0, 1.2), 1.0, (-pi, 1.1, False)),
        ("index_flexion1", (-1.0, 4.0), 1.0, (-1.1, pi, False)),
        ("index_flexion1", (None, 1.2), 1.0, (0.0, radians(80), True)),
        ("index_flexion1", (0.1, None), 1.0, (0.0, radians(80), True)),
        ("index_flexion1", (0.0, radians(351)), 1.0, (0.0, radians(80), True)),
        ("index_abduct", (None, None), 1.0, (radians(-10), radians(15), True)),
        ("middle_pivot", (None, None), 1.0, (radians(-10), radians(15), True)),
    ],
)
def test_range_of_a_finger_hinge_comes_from_the_file_or_a_default(name, limits, sign, expected):
    turn = _map_turn(joint(lower=limits[0], upper=limits[1], zero=0.1), 7, "l", "index2", name, sign)
    assert (turn.lower, turn.upper, turn.assumed) == pytest.approx(expected)
    assert (turn.name, turn.segment, turn.joint, turn.sign, turn.zero) == (f"l_{name}", "l_index2", 7, sign, 0.1)
    assert turn.axis.tolist() == (sign * FLEXION_AXIS).tolist()


def follow(driver, ratio, offset):
    return SimpleNamespace(driver=driver, ratio=ratio, offset=offset)


def turns_of(*signs_and_zeros):
    return {
        k: SimpleNamespace(name=f"turn{k}", joint=k, sign=sign, zero=zero)
        for k, (sign, zero) in enumerate(signs_and_zeros)
    }


def test_coupled_hinge_follows_the_motor_at_the_end_of_its_chain():
    tree = tree_of(
        joint(name="a"), joint(name="b", follows=follow("a", 0.5, 0.1)), joint(name="c", follows=follow("b", 3.0, 0.2))
    )
    turns = turns_of((-1.0, 0.3), (1.0, 0.0), (1.0, 0.4))
    assert _find_driver(tree, turns[0], turns) is None
    assert _find_driver(tree, turns[1], turns) == ("turn0", pytest.approx(-0.5), pytest.approx(0.1 + 0.5 * 0.3))
    driver, ratio, offset = _find_driver(tree, turns[2], turns)
    assert (driver, ratio) == ("turn0", pytest.approx(-1.5))
    assert offset == pytest.approx(0.2 + 3.0 * 0.1 + 1.5 * 0.3 - 0.4)
    mirrored = SimpleNamespace(name="turn2", joint=2, sign=-1.0, zero=0.4)
    assert _find_driver(tree, mirrored, turns) == ("turn0", pytest.approx(1.5), pytest.approx(-offset))


def test_hinge_coupled_in_a_cycle_or_to_an_unknown_hinge_has_no_driver():
    tree = tree_of(joint(name="a", follows=follow("b", 1, 0)), joint(name="b", follows=follow("a", 1, 0)))
    turns = turns_of((1, 0), (1, 0))
    assert _find_driver(tree, turns[0], turns) is None
    stranger = tree_of(joint(name="a", follows=follow("wrist", 1, 0)))
    assert _find_driver(stranger, turns[0], {0: turns[0]}) is None


@pytest.mark.parametrize(("links", "is_found"), [(10, True), (11, False)])
def test_motor_is_found_through_at_most_ten_couplings(links, is_found):
    names = [str(k) for k in range(links + 1)]
    joints = [joint(name=name, follows=follow(before, 1, 0)) for before, name in pairwise(names)]
    tree = tree_of(joint(name="0"), *joints)
    turns = turns_of(*[(1.0, 0.0)] * (links + 1))
    assert (_find_driver(tree, turns[links], turns) is not None) is is_found


@pytest.mark.parametrize(("length", "radius"), [(0.1, 0.009), (0.02, 0.004), (0.2, 0.011)])
def test_finger_radius_grows_with_finger_length_between_4_and_11_mm(length, radius):
    tree = tree_of(joint(name="a"), joint(name="b", follows=follow("a", 0.5, 0.0)))
    turns = turns_of((1.0, 0.0), (1.0, 0.0))
    mapped = _map_finger(tree, "index", row((0, 0, 0), (length, 0, 0), (0, 1)), turns)
    assert mapped.radius == pytest.approx(radius)
    assert (mapped.name, mapped.turns, mapped.hinges) == ("index", (turns[0], turns[1]), (turns[0],))
    assert mapped.follows == {"turn1": ("turn0", 0.5, 0.0)}
    assert mapped.tip.tolist() == [length, 0, 0]


def figure(count, length=0.1):
    """Return a robot with a hand of one-hinge fingers, the thumb last."""
    joints, parts, children = [joint(name="wrist")], {}, {0: list(range(1, count + 1))}
    for k in range(1, count + 1):
        is_thumb = k == count
        base = np.array([-0.05, 0.08, 0.0]) if is_thumb else np.array([0.0, 0.02 * k, 0.0])
        joints.append(joint(name=f"f{k}", anchor=base, axis=-Z if is_thumb else Y))
        tip = base + length * (np.array([0.5, 0.8, 0]) if is_thumb else X)
        parts[k] = SimpleNamespace(shapes=[SimpleNamespace(start=base, end=tip)], centre=base)
        children[k] = []
    arms = {"l": SimpleNamespace(joints=(0,))}
    return SimpleNamespace(tree=tree_of(*joints, children=children, parts=parts), arms=arms)


def test_fingers_of_a_hand_are_named_from_the_thumb_outwards():
    found = find_hand(figure(4), "l")
    assert [(finger.name, finger.turns[0].joint) for finger in found.fingers] == [
        ("thumb", 4),
        ("index", 3),
        ("middle", 2),
        ("ring", 1),
    ]
    assert [turn.name for finger in found.fingers for turn in finger.turns][1:] == [
        f"l_{name}_flexion1" for name in ("index", "middle", "ring")
    ]
    assert [finger.turns[0].segment for finger in found.fingers][:2] == ["l_thumb1", "l_index1"]
    np.testing.assert_allclose(found.knuckles, (0.0, 0.04, 0.0), atol=1e-12)
    np.testing.assert_allclose(found.facing, -Z, atol=1e-9)


@pytest.mark.parametrize(
    ("count", "length", "is_hand"), [(3, 0.1, True), (2, 0.1, False), (4, 0.0039, False), (4, 0.0045, True)]
)
def test_hand_needs_at_least_three_fingers_longer_than_four_millimetres(count, length, is_hand):
    assert (find_hand(figure(count, length), "l") is not None) is is_hand
    assert hand.MIN_FINGER_RADIUS == 0.004
