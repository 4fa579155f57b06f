"""Trunk, neck and single arms of synthetic hinge trees, at the thresholds of their rules."""

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.branches import Branches, branches
from kinesic.sim.importer.mirror import Sides
from kinesic.sim.importer.model_tree import Joint, ModelPart, Tree

X, Y, Z = np.eye(3)


def hinge(name, parent, place, axis=X, limits=(-1.0, 1.0)):
    return Joint(name, parent, np.array(place, float), np.array(axis, float), 0.0, *limits, *(None,) * 6)


BASE = ModelPart(1.0, np.zeros(3), ())


def make_tree(joints, masses, base):
    """Return a tree of hinges; each part has its centre at the hinge."""
    parts = [ModelPart((masses or {}).get(j.name, 1.0), j.anchor, ()) for j in joints]
    return Tree("r", tuple(joints), tuple(parts), base)


def arms(parent=-1, *, first=0, height=1.0, count=3, y=0.3, name="arm"):
    """Return the hinges and pairs of two limbs at a height."""
    joints = [
        hinge(f"{side}_{name}{k}", parent if k == 0 else first + n * count + k - 1, (0, s * y, height - 0.1 * k))
        for n, (side, s) in enumerate((("l", 1), ("r", -1)))
        for k in range(count)
    ]
    return joints, {first + k: first + count + k for k in range(count)}


def find(joints, pairs, masses=None, arm_joints=(), base=BASE):
    tree = make_tree(joints, masses, base)
    return branches(tree, Sides(pairs, (0.0, 1.0), certain=True, by_names=False), arm_joints)


def test_sides_without_an_arm_have_no_hinges():
    one = Branches((), (), {"l": (1, 2)})
    assert (one.left, one.right) == ((1, 2), ())
    assert (Branches((), (), {"r": (3,)}).left, one.legs, one.is_doubtful) == ((), (), False)


def test_names_of_all_leg_roots_are_in_the_error_for_a_robot_without_arms():
    legs, pairs = arms(name="hip")
    more, others = arms(first=6, height=0.9, name="thigh")
    with pytest.raises(ConfigError, match=r"end in feet \(they begin at l_hip0, l_thigh0\)"):
        find([*legs, *more], pairs | others)


def test_robot_without_hinges_is_refused():
    with pytest.raises(ConfigError, match="robot r: no movable joint"):
        find([], {})


def test_legs_are_all_hinges_below_the_roots_of_both_legs():
    joints, pairs = arms()
    legs, others = arms(first=6, height=0.5, name="leg")
    toes = [hinge("l_toe", 8, (0, 0.3, 0.1)), hinge("r_toe", 11, (0, -0.3, 0.1))]
    found = find([*joints, *legs, *toes], pairs | others)
    assert (found.legs, found.left) == ((6, 7, 8, 12, 9, 10, 11, 13), (0, 1, 2))


@pytest.mark.parametrize("requested", [6, 8, 9, 11])
def test_limb_of_which_one_hinge_is_requested_as_an_arm_is_the_arm(requested):
    joints, pairs = arms()
    low, others = arms(first=6, height=0.5, name="leg")
    found = find([*joints, *low], pairs | others, arm_joints=[requested])
    assert (found.left, found.right, found.legs) == ((6, 7, 8), (9, 10, 11), ())


def test_arms_with_explicitly_given_joints_are_not_marked_as_doubtful():
    joints, pairs = arms(name="j")
    base = ModelPart(9.0, 2 * Z, ())
    assert find(joints, pairs, base=base).is_doubtful
    assert not find(joints, pairs, arm_joints=[0], base=base).is_doubtful


def neck_of(rows, masses=None):
    """Return the names of neck hinges on a waist that carries arms."""
    limbs, pairs = arms(0, first=1)
    joints = [hinge("waist", -1, (0, 0, 0.5), Z), *limbs]
    for name, parent, *rest in rows:
        joints.append(hinge(name, [j.name for j in joints].index(parent), *rest))
    return tuple(joints[k].name for k in find(joints, pairs, masses).neck)


UNLIMITED, HALF_LIMITED = (None, None), (-1.0, None)


@pytest.mark.parametrize(
    ("limits", "mass", "neck"),
    [
        ((-1.0, 1.0), 0.051, ("pan", "tip")),
        ((-1.0, 1.0), 0.049, ("pan",)),
        (UNLIMITED, 0.51, ("pan", "tip")),
        (UNLIMITED, 0.49, ("pan",)),
        (HALF_LIMITED, 0.49, ("pan",)),
        ((None, 1.0), 0.49, ("pan",)),
    ],
)
def test_light_hinge_at_the_end_of_the_neck_is_a_sensor(limits, mass, neck):
    rows = [("pan", "waist", (0, 0, 1.1)), ("tip", "pan", (0, 0, 1.2), X, limits)]
    assert neck_of(rows, {"tip": mass}) == neck


@pytest.mark.parametrize(
    ("limits", "mass", "neck"),
    [((-1.0, 1.0), 0.01, ("pan",)), (UNLIMITED, 0.051, ("pan",)), (UNLIMITED, 0.049, ())],
)
def test_only_hinge_of_a_neck_is_a_sensor_if_it_is_light_and_unlimited(limits, mass, neck):
    assert neck_of([("pan", "waist", (0, 0, 1.1), X, limits)], {"pan": mass}) == neck


def test_neck_ends_before_a_hinge_named_after_a_sensor():
    rows = [("pan", "waist", (0, 0, 1.1)), ("head_lidar", "pan", (0, 0, 1.2)), ("mouth_2", "head_lidar", (0, 0, 1.3))]
    assert neck_of(rows) == ("pan",)
    assert neck_of([("lidar_neck", "waist", (0, 0, 1.1))]) == ("lidar_neck",)


def test_light_hinge_on_a_massless_carrier_belongs_to_the_neck():
    rows = [("pan", "waist", (0, 0, 1.1)), ("tip", "pan", (0, 0, 1.2))]
    assert neck_of(rows, {"pan": 0.0, "tip": 1e-9}) == ("pan", "tip")


def test_neck_on_the_base_is_compared_with_the_mass_of_the_base():
    joints, pairs = arms()
    joints.append(hinge("pan", -1, (0, 0, 1.1), X, UNLIMITED))
    heavy, light = (ModelPart(mass, 0 * X, ()) for mass in (21.0, 19.0))
    assert find(joints, pairs, base=heavy).neck == ()
    assert find(joints, pairs, base=light).neck == (6,)


def test_trunk_and_neck_keep_at_most_four_hinges_about_one_axis():
    chain = [hinge(f"t{k}", k - 1, (0, 0, 0.1 * k), X if k != 2 else -Y) for k in range(7)]
    limbs, pairs = arms(6, first=7)
    necks = [hinge(f"n{k}", 6 if k == 0 else 12 + k, (0, 0, 1.1 + 0.1 * k), Z) for k in range(6)]
    found = find([*chain, *limbs, *necks], pairs)
    assert found.trunk == (0, 1, 2, 3, 4)
    assert found.neck == (13, 14, 15, 16)


def single(y=0.2, count=3, name="j", waist=(0.0, Z, "w"), base_y=0.0):
    """Return the hinges of a waist and one limb at a lateral place."""
    offset, axis, waist_name = waist
    joints = [hinge(waist_name, -1, (0, base_y + offset, 0.1), axis)]
    joints += [hinge(f"{name}{k}", k, (0, base_y + y, 0.5 - 0.05 * k)) for k in range(count)]
    return joints, ModelPart(9.0, base_y * Y, ())


@pytest.mark.parametrize(
    ("options", "arm"),
    [
        ({}, {"l": (1, 2, 3)}),
        ({"y": -0.2}, {"r": (1, 2, 3)}),
        ({"y": 0.06}, {"l": (1, 2, 3)}),
        ({"y": -0.06, "base_y": 0.5}, {"r": (1, 2, 3)}),
        ({"y": 0.2, "name": "r_j"}, {"r": (1, 2, 3)}),
        ({"y": -0.2, "name": "l_j"}, {"l": (1, 2, 3)}),
        ({"waist": (0.0, X, "waist")}, {"l": (1, 2, 3)}),
        ({"waist": (0.0, np.array([0, 0.4, -0.91]), "w")}, {"l": (1, 2, 3)}),
        ({"waist": (0.0, np.array([0, 0.44, 0.89]), "w")}, {"l": (0, 1, 2, 3)}),
        ({"waist": (0.06, Z, "w")}, {"l": (0, 1, 2, 3)}),
        ({"waist": (0.04, Z, "w")}, {"l": (1, 2, 3)}),
        ({"waist": (0.0, Z, "arm_1_joint")}, {"l": (0, 1, 2, 3)}),
        ({"waist": (0.0, Z, "arm_waist")}, {"l": (1, 2, 3)}),
    ],
)
def test_single_arm_begins_beside_the_midline_after_the_trunk(options, arm):
    joints, base = single(**options)
    assert dict(find(joints, {}, base=base).arms) == arm


@pytest.mark.parametrize("options", [{"y": 0.04}, {"count": 2}, {"name": "l_knee"}])
def test_limb_on_the_midline_or_with_two_hinges_or_a_leg_is_no_single_arm(options):
    joints, base = single(**options)
    with pytest.raises(ConfigError, match="no single arm"):
        find(joints, {}, base=base)


def test_longest_of_several_unpaired_limbs_is_the_single_arm():
    joints, base = single()
    joints += [hinge(f"k{k}", 0 if k == 0 else 3 + k, (0, -0.2, 0.5 - 0.05 * k)) for k in range(4)]
    assert dict(find(joints, {}, base=base).arms) == {"r": (4, 5, 6, 7)}


def test_midline_of_a_robot_with_one_arm_is_that_of_its_mirrored_hinges():
    joints, base = single(y=0.2, waist=(0.3, Z, "w"))
    pair = [hinge("a", -1, (0, 0.5, 0.3)), hinge("b", -1, (0, 0.1, 0.3))]
    found = find([*joints, *pair], {4: 5}, base=base)
    assert dict(found.arms) == {"r": (1, 2, 3)}
    assert found.trunk == (0,)
