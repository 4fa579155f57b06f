"""Limbs, neck, joint ranges and mirrored arm angles of synthetic hinge trees."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import zero_pose
from kinesic.sim.importer.arm import Split
from kinesic.sim.importer.branches import _find_limb, _find_neck, branches
from kinesic.sim.importer.mirror import Sides
from kinesic.sim.importer.model_tree import Follow, Joint, ModelPart, Tree
from kinesic.sim.importer.zero_pose import (
    HANGING_ARM,
    HumanoidGeometry,
    _choose_split,
    _find_ranges,
    hang_arm,
    mirror_angles,
)

X, Y, Z = np.eye(3)


def make_tree(*rows):
    """Return a tree of hinges from rows (name, parent, height, mass)."""
    joints = tuple(
        Joint(name, parent, height * Z, X, 0.0, *(None,) * 8, follows=Follow("l0", 1, 0) if "mimic" in name else None)
        for name, parent, height, _ in rows
    )
    return Tree("r", joints, tuple(ModelPart(mass, 0 * X, ()) for *_, mass in rows), ModelPart(1.0, 0 * X, ()))


def make_sides(**pairs):
    return Sides(pairs["pairs"], (0.0, 1.0), certain=True, by_names=False)


def limb_tree(*rows):
    """Return a tree of left hinges and their pairs without right hinges."""
    return make_tree(*rows), make_sides(pairs={k: 100 + k for k in range(len(rows))})


def test_limb_of_an_imported_robot_ends_where_it_branches():
    tree, pairs = limb_tree(("a", -1, 1, 1.0), ("b", 0, 1, 1.0), ("c", 1, 1, 1.0), ("d", 1, 1, 1.0))
    assert _find_limb(tree, pairs, 0) == (0, 1)
    assert _find_limb(tree, pairs, 2) == (2,)


@pytest.mark.parametrize(("mass", "limb"), [(0.29, (0,)), (0.31, (0, 1, 2))])
def test_limb_of_an_imported_robot_ends_where_the_rest_is_lighter_than_15_percent_of_its_link(mass, limb):
    tree, pairs = limb_tree(("a", -1, 1, 2.0), ("b", 0, 1, mass / 2), ("c", 1, 1, mass / 2))
    assert _find_limb(tree, pairs, 0) == limb


def test_limb_of_an_imported_robot_omits_unpaired_and_coupled_hinges():
    tree, pairs = limb_tree(("a", -1, 1, 1.0), ("mimic", 0, 1, 1.0), ("b", 0, 1, 1.0), ("c", 2, 1, 1.0))
    assert _find_limb(tree, pairs, 0) == (0, 2, 3)
    del pairs.pairs[3]
    assert _find_limb(tree, pairs, 0) == (0, 2)


def limbs(hinges=3, arm_height=5.0, leg_height=1.0):
    """Return rows and pairs of a waist with arms, and of legs."""
    rows, pairs = [("waist", -1, 2.0, 1.0)], {}
    for name, parent, height, count in (("arm", 0, arm_height, hinges), ("leg", -1, leg_height, 3)):
        first = len(rows)
        for side in (0, 1):
            for k in range(count):
                rows.append((f"{'lr'[side]}_{name}{k}", parent if k == 0 else len(rows) - 1, height - 0.1 * k, 1.0))
        pairs |= {first + k: first + count + k for k in range(count)}
    return rows, pairs


def test_arms_of_an_imported_robot_are_the_highest_limbs_with_three_hinges():
    rows, pairs = limbs()
    found = branches(make_tree(*rows), make_sides(pairs=pairs))
    assert (found.left, found.right, found.trunk, found.neck) == ((1, 2, 3), (4, 5, 6), (0,), ())
    rows, pairs = limbs(leg_height=6.0)
    found = branches(make_tree(*rows), make_sides(pairs=pairs))
    assert (found.left, found.right, found.trunk) == ((1, 2, 3), (4, 5, 6), (0,))
    rows, pairs = limbs(hinges=2)
    with pytest.raises(ConfigError, match="no movable arms; the mirrored limbs end in feet"):
        branches(make_tree(*rows), make_sides(pairs=pairs))


def test_error_for_a_robot_without_limbs_of_three_hinges_states_its_hinge_and_mirror_pair_counts():
    rows, pairs = limbs(hinges=2)
    short = {left: right for left, right in pairs.items() if left < 5}
    message = "robot r: no arms found: among 11 hinges there are 2 mirror pairs, but no pair of limbs, and no single"
    with pytest.raises(ConfigError, match=message):
        branches(make_tree(*rows), make_sides(pairs=short))


@pytest.mark.parametrize(
    ("rows", "neck"),
    [
        ([("pan", 0, 6.0, 1.0), ("nod", "pan", 6.1, 1.0)], ("pan", "nod")),
        ([("pan", 0, 4.0, 1.0), ("nod", "pan", 6.0, 1.0)], ("pan", "nod")),
        ([("pan", 0, 6.0, 1.0), ("nod", "pan", 5.0, 1.0)], ()),
        ([("pan", 0, 6.0, 1.0), ("low", "pan", 6.1, 1.0), ("high", "pan", 6.2, 1.0)], ("pan", "high")),
        ([("pan", 0, 6.0, 1.0), ("Left_Eye", "pan", 6.2, 1.0)], ("pan",)),
        ([("eye", 0, 6.0, 1.0)], ()),
        ([("horn", 0, 5.5, 1.0), ("pan", 0, 6.0, 1.0), ("tail", 0, 5.4, 1.0)], ("pan",)),
        ([("mast", -1, 6.0, 1.0)], ()),
    ],
)
def test_neck_is_the_unpaired_branch_that_ends_highest_above_the_shoulders(rows, neck):
    limb_rows, pairs = limbs()
    names = [name for name, *_ in (*limb_rows, *rows)]
    extra = [(name, names.index(parent) if isinstance(parent, str) else parent, *rest) for name, parent, *rest in rows]
    tree = make_tree(*limb_rows, *extra)
    found = _find_neck(tree, {*pairs, *pairs.values()}, (0,), (1, 2, 3))
    assert tuple(names[k] for k in found) == neck


def test_neck_is_on_the_base_of_a_robot_without_a_trunk():
    limb_rows, pairs = limbs()
    tree = make_tree(*limb_rows, ("mast", -1, 6.0, 1.0))
    assert _find_neck(tree, {*pairs, *pairs.values()}, (), (1, 2, 3)) == (13,)


@pytest.mark.parametrize(
    ("left", "right", "sign"), [(X, X, -1), (X, -X, 1), (Y, Y, 1), (Y, -Y, -1), (Z, Z, -1), (Z, -Z, 1), (X, Y, 1)]
)
def test_mirrored_arm_angle_has_the_sign_that_mirrors_the_rotation_for_each_axis_direction(left, right, sign):
    tree = SimpleNamespace(joints=[SimpleNamespace(axis=left), SimpleNamespace(axis=right)])
    assert mirror_angles(tree, (0,), (1,), np.array([0.5])).tolist() == [0.5 * sign]


def test_joint_ranges_of_a_limb_are_relative_to_the_pose_of_the_tree():
    joints = [
        SimpleNamespace(lower=-1.0, upper=2.0, zero=0.5),
        SimpleNamespace(lower=None, upper=2.0, zero=0.5),
        SimpleNamespace(lower=-1.0, upper=None, zero=0.5),
    ]
    ranges = _find_ranges(SimpleNamespace(joints=joints), (2, 1, 0), strict=True)
    assert ranges.lower.tolist() == [-1.5, -np.inf, -1.5]
    assert ranges.upper.tolist() == [np.inf, 1.5, 1.5]
    assert ranges.strict
    assert not _find_ranges(SimpleNamespace(joints=joints), (0,), strict=False).strict


def arm_at(shoulder, elbow, wrist, lengths=(0.3, 0.2)):
    joint_centres = SimpleNamespace(
        shoulder=np.array(shoulder), elbow=np.array(elbow), wrist=np.array(wrist), lengths=lengths
    )
    return SimpleNamespace(centres=joint_centres)


def test_asymmetry_is_the_largest_distance_of_mirrored_joint_centres_in_arm_lengths():
    left = arm_at((0, 0.2, 1), (0, 0.2, 0.7), (0, 0.2, 0.5))
    right = arm_at((0, -0.2, 1), (0.03, -0.2, 0.74), (0, -0.21, 0.5), (9, 9))
    figure = HumanoidGeometry(None, None, (), (), None, 3.0, {"l": left, "r": right})
    assert figure.arm_length == 0.5
    assert figure.asymmetry == pytest.approx(0.1)


def test_arms_hang_straight_down_with_elbows_that_bend_forward():
    directions = (HANGING_ARM.upper, HANGING_ARM.fore, HANGING_ARM.hinge)
    np.testing.assert_array_equal(directions, (-Z, -Z, -Y))


@pytest.mark.parametrize("first", [None, np.array([0.1, 0.2, 0.3])])
def test_arm_pose_search_gets_the_given_start_angles_and_strict_ranges(monkeypatch, first):
    calls = []
    monkeypatch.setattr(zero_pose, "pose_arm", lambda *arguments: calls.append(arguments) or "posed")
    rows, _ = limbs()
    assert hang_arm(make_tree(*rows), (1, 2, 3), "split", "target", strict=True, first=first) == "posed"
    ((limb, split, target, ranges, starts),) = calls
    np.testing.assert_allclose(limb.anchors[:, 2], (5.0, 4.9, 4.8))
    assert (split, target, ranges.strict) == ("split", "target", True)
    assert [start.tolist() for start in starts] == ([] if first is None else [[0.1, 0.2, 0.3]])


@pytest.mark.parametrize(
    ("in_file", "hanging", "tried", "best"),
    [((3.0, 2.3, 2.1), (1.0, 2.0, 3.0), [0, 1], 1), ((1.0, 3.0, 2.0), (9.0, 2.0, 3.0), [1], 1)],
)
def test_best_arm_divisions_of_the_file_pose_are_compared_again_in_the_hanging_pose(
    monkeypatch, in_file, hanging, tried, best
):
    divisions = (Split(0, 2, 1), Split(0, 3, 0), Split(1, 2, 0))
    posed = []

    def likeness(limb, split):
        return (hanging if limb.centre is None else in_file)[divisions.index(split)]

    def pose(tree, row, split, target, *, strict):
        posed.append(divisions.index(split))
        assert (row, target, strict) == ((1, 2, 3, 4)[: split.hinges], HANGING_ARM, False)
        return SimpleNamespace(angles=posed[-1])

    row = SimpleNamespace(centre=X, turned=lambda angles: SimpleNamespace(centre=None))
    monkeypatch.setattr(zero_pose, "likeness", likeness)
    monkeypatch.setattr(zero_pose, "hang_arm", pose)
    monkeypatch.setattr(zero_pose.HingeRow, "of", lambda tree, joints: row)
    split, chosen = _choose_split(None, (1, 2, 3, 4, 5), divisions)
    assert posed == tried
    assert (divisions.index(split), chosen.angles) == (best, best)
