"""Detection of legs and arms without informative joint names.

Words in joint names are tested, too.
"""

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.branches import branches
from kinesic.sim.importer.feet import Feet, find_bottom, rate_limb
from kinesic.sim.importer.joint_words import count_leg_words, is_contradiction, list_parts
from kinesic.sim.importer.mesh_file import Triangles
from kinesic.sim.importer.mirror import find_named_side, sides
from kinesic.sim.importer.model_tree import Joint, ModelPart, Surface, Tree

X, Y, Z = np.eye(3)


def joint(name, parent, anchor, axis=X, lower=None, upper=None):
    return Joint(name, parent, np.array(anchor, float), axis, 0.0, lower, upper, *(None,) * 6)


def box(centre, size):
    """Return a part of 1 kg with corner spheres of a box."""
    centre, half = np.array(centre, float), np.array(size) / 2
    ends = (Capsule(centre - half, centre + half, 0.005), Capsule(centre - half * [1, -1, 1], centre + half, 0.005))
    return ModelPart(1.0, centre, ends)


def robot(*, root=0.5, end=0.0, sole=(0.2, 0.08, 0.03), knee=None, name="j", mass=10.0, load=0.8):
    """Return a robot with a mirrored pair of hanging limbs.

    Each limb has three hinges and hangs from a trunk.
    """
    joints, parts = [], []
    for side, y in (("l", 0.1), ("r", -0.1)):
        first = len(joints)
        heights = (root, (root + end) / 2, end + 0.08)
        lower, upper = (None, None) if knee is None else knee
        joints += [
            joint(f"{side}_{name}0", -1, (0, y, heights[0])),
            joint(f"{side}_{name}1", first, (0, y, heights[1]), Y, lower, upper),
            joint(f"{side}_{name}2", first + 1, (0, y, heights[2])),
        ]
        parts += [box((0, y, height), (0.04, 0.04, 0.04)) for height in heights[:2]]
        parts.append(box((0.03, y, end + sole[2] / 2), sole))
    return Tree("r", tuple(joints), tuple(parts), ModelPart(mass, load * Z, ()))


def verdict(tree):
    return rate_limb(tree, (0, 1, 2), [])


def test_limbs_with_soles_on_the_ground_below_the_trunk_are_legs():
    assert verdict(robot()).is_leg
    with pytest.raises(ConfigError, match="no movable arms; the mirrored limbs end in feet"):
        branches(robot(), sides(robot()))


def test_knee_that_bends_backward_marks_a_leg_and_an_elbow_an_arm():
    hand = (0.03, 0.03, 0.1)
    assert verdict(robot(sole=hand, knee=(0.0, 2.0))).is_leg
    assert not verdict(robot(sole=hand, knee=(-2.0, 0.0))).is_leg
    assert verdict(robot(sole=hand, knee=(-2.0, 2.0))).is_doubtful


def test_limbs_that_end_above_the_ground_or_begin_above_the_trunk_are_arms():
    tree = robot(end=0.3)
    raised = Tree("r", tree.joints, tree.parts, ModelPart(10.0, 0.2 * Z, (Capsule(0 * Z, 0.4 * Z, 0.01),)))
    assert not verdict(raised).is_leg
    low_trunk = verdict(robot(load=0.3))
    assert not low_trunk.is_leg
    assert low_trunk.is_doubtful


def test_names_of_arm_or_leg_joints_overrule_the_geometry():
    assert not verdict(robot(name="arm_joint")).is_leg
    assert verdict(robot(name="hip", sole=(0.03, 0.03, 0.1), load=0.3)).is_leg


def test_two_pairs_of_limbs_at_equal_height_are_the_legs_of_a_quadruped():
    tree = robot(sole=(0.03, 0.03, 0.1), load=0.5)
    assert not verdict(tree).is_leg
    assert rate_limb(tree, (0, 1, 2), [(3, 4, 5)]).is_leg


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("LHipYawPitch", ["leg"]),
        ("lleg_joint3", ["leg"]),
        ("left_shoulder_pitch", ["shoulder"]),
        ("l_upper_arm_roll", ["arm"]),
        ("head_lidar_spindle", ["neck", "sensor", "sensor"]),
        ("j1", []),
        ("charm_joint", []),
        ("rarm_lhand", ["arm", "wrist"]),
        ("legs_Waist", ["trunk"]),
        ("LElbowYaw", ["elbow"]),
        ("lidar_r", ["sensor"]),
    ],
)
def test_joint_names_are_split_into_words_of_body_parts(name, parts):
    assert list_parts(name) == parts


def test_leg_word_count_of_joint_names_subtracts_arm_words():
    assert count_leg_words(["l_hip", "l_knee", "l_arm_x"]) == 1
    assert count_leg_words(["a", "elbow", "wrist_roll"]) == -2


@pytest.mark.parametrize(
    ("hinge", "joint_name", "contradicts"),
    [
        ("l_elbow_flexion", "left_elbow", False),
        ("l_elbow_flexion", "left_wrist_pitch", False),
        ("l_elbow_flexion", "left_shoulder_yaw", True),
        ("l_shoulder_twisting", "Left_Elbow_Pitch", False),
        ("l_shoulder_flexion", "left_wrist", True),
        ("skullbase_torsion", "waist", True),
        ("skullbase_torsion", "neck_yaw", False),
        ("vl5_torsion", "head_pan", True),
        ("l_wrist_pivot", "motor7", False),
        ("l_wrist_pivot", "left_arm_3", False),
        ("l_wrist_pivot", "left_shoulder_3", True),
        ("l_sternoclavicular_abduction", "l_shoulder_pitch", False),
        ("l_sternoclavicular_abduction", "l_elbow", True),
        ("vc4_torsion", "head_pan", False),
        ("vc4_torsion", "torso", True),
        ("vt1_torsion", "torso_yaw", False),
        ("r_elbow_flexion", "head_elbow_wrist", False),
        ("r_elbow_flexion", "elbow_head", True),
    ],
)
def test_joint_name_contradicts_a_hinge_of_another_body_part(hinge, joint_name, contradicts):
    assert is_contradiction(hinge, joint_name) == contradicts


@pytest.mark.parametrize(("name", "side"), [("left_arm", 1), ("r_arm", -1), ("RElbowYaw", -1), ("arm", 0), ("roll", 0)])
def test_side_of_a_joint_is_recognised_from_its_name(name, side):
    assert find_named_side(name) == side


def single_arm(y, name="arm"):
    """Return a robot with a waist and one arm.

    The arm has a lateral position `y`.
    """
    joints = (
        joint("waist", -1, (0, 0, 0.1), Z),
        *(joint(f"{name}{k}", k, (0, y, 0.5 - 0.1 * k)) for k in range(4)),
    )
    parts = tuple(ModelPart(1.0, each.anchor - 0.05 * Z, ()) for each in joints)
    return Tree("r", joints, parts, ModelPart(5.0, 0 * Z, ()))


@pytest.mark.parametrize(
    ("tree", "side"),
    [(single_arm(0.2), "l"), (single_arm(-0.2), "r"), (single_arm(-0.2, "right_arm"), "r")],
)
def test_single_arm_is_on_the_side_of_its_name_or_position(tree, side):
    found = branches(tree, sides(tree))
    assert dict(found.arms) == {side: (1, 2, 3, 4)}
    assert (found.trunk, found.legs) == ((0,), ())


def test_single_limb_on_the_midline_does_not_count_as_an_arm():
    with pytest.raises(ConfigError, match="no single arm"):
        branches(single_arm(0.0), sides(single_arm(0.0)))


def test_single_right_arm_at_positive_y_means_that_the_robot_faces_backward():
    assert sides(single_arm(0.2, "right_arm")).left == (0.0, -1.0)
    assert sides(single_arm(0.2)).left == (0.0, 1.0)


LEG, ARM = Feet(is_leg=True, is_doubtful=False), Feet(is_leg=False, is_doubtful=False)
UNSURE = Feet(is_leg=False, is_doubtful=True)


def stand(*, bottom=0.0, load=2.0, sole=(0.0, 0.0, 0.0), knee=(None, None), axis=Y, zero=0.0, surfaces=()):
    """Return a robot with a vertical limb 1 m long, and a base on the ground.

    The limb has hinges 1.05, 0.55 and 0.05 m above its lowest point, and ends in a box of a given size.
    """
    heights = [bottom + height for height in (1.05, 0.55, 0.05)]
    joints = [joint(f"j{k}", k - 1, (0, 0, height)) for k, height in enumerate(heights)]
    joints[1] = Joint("j1", 0, heights[1] * Z, axis, zero, *knee, *(None,) * 6)
    half = np.array([sole[0], sole[1], 0.0]) / 2
    bound = [Capsule(bottom * Z - half, bottom * Z + half + sole[2] * Z, 0.0)]
    parts = [ModelPart(1.0, height * Z, ()) for height in heights[:2]]
    parts.append(ModelPart(1.0, (bottom + 0.05) * Z, tuple(bound), surfaces))
    return Tree("r", tuple(joints), tuple(parts), ModelPart(5.0, load * Z, (Capsule(0 * Z, Z, 0.0),)))


SOLE, STICK = (0.2, 0.1, 0.1), (0.1, 0.1, 0.1)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"sole": SOLE}, LEG),
        ({"sole": SOLE, "bottom": 0.059}, LEG),
        ({"sole": SOLE, "bottom": 0.061}, ARM),
        ({"sole": SOLE, "load": 1.11}, LEG),
        ({"sole": SOLE, "load": 1.09}, UNSURE),
        ({"sole": (0.141, 0.1, 0.1)}, LEG),
        ({"sole": (0.1, 0.141, 0.1)}, LEG),
        ({"sole": (0.139, 0.139, 0.1)}, UNSURE),
        ({"sole": STICK}, UNSURE),
        ({"sole": STICK, "load": 1.0}, ARM),
        ({"sole": STICK, "knee": (0.0, 2.0)}, LEG),
        ({"sole": STICK, "knee": (0.0, 2.0), "axis": -Y}, UNSURE),
        ({"sole": STICK, "knee": (-2.0, 0.0), "axis": -Y}, LEG),
        ({"sole": STICK, "knee": (-0.49, 2.0)}, LEG),
        ({"sole": STICK, "knee": (-0.51, 2.0)}, UNSURE),
        ({"sole": STICK, "knee": (-1.0, 1.0), "zero": -0.7}, LEG),
        ({"sole": STICK, "knee": (-1.0, 1.0), "zero": -0.5}, UNSURE),
        ({"sole": STICK, "knee": (0.0, 2.0), "axis": np.array([0.7, 0.71, 0])}, LEG),
        ({"sole": STICK, "knee": (0.0, 2.0), "axis": np.array([0.72, 0.69, 0])}, UNSURE),
        ({"sole": STICK, "knee": (None, 2.0)}, UNSURE),
        ({"sole": STICK, "knee": (0.0, None)}, UNSURE),
        ({"sole": STICK, "knee": (0.5, 0.5)}, UNSURE),
        ({"sole": SOLE, "knee": (-2.0, 0.0)}, UNSURE),
    ],
)
def test_leg_reaches_the_ground_under_its_load_and_has_a_sole_or_a_knee(options, expected):
    assert rate_limb(stand(**options), (0, 1, 2), []) == expected


def test_first_and_last_hinges_of_a_limb_are_no_knees():
    tree = stand(sole=STICK)
    bent = [Joint("j", k - 1, j.anchor, Y, 0.0, 0.0, 2.0, *(None,) * 6) for k, j in enumerate(tree.joints)]
    ends = Tree("r", (bent[0], tree.joints[1], bent[2]), tree.parts, tree.base)
    assert rate_limb(ends, (0, 1, 2), []) == UNSURE


@pytest.mark.parametrize(("height", "bottom", "is_leg"), [(0.05, 0.0, True), (0.07, 0.0, False), (0.05, 0.1, False)])
def test_second_limb_at_the_same_height_on_the_ground_shows_legs(height, bottom, is_leg):
    tree = stand(sole=STICK)
    other = tuple(joint(f"o{k}", (-1, 3, 4)[k], j.anchor + height * Z) for k, j in enumerate(tree.joints))
    parts = [*tree.parts[:2], ModelPart(1.0, bottom * Z, (Capsule(bottom * Z, bottom * Z, 0.0),))]
    pair = Tree("r", (*tree.joints, *other), (*tree.parts, *parts), tree.base)
    assert rate_limb(pair, (0, 1, 2), [(3, 4, 5)]).is_leg == is_leg


def test_load_of_a_leg_excludes_all_links_of_the_limbs():
    tree = stand(sole=SOLE, load=1.09)
    high = [ModelPart(50.0, 9 * Z, part.shapes) for part in tree.parts]
    length_kept = Tree("r", tree.joints, (*high[:2], tree.parts[2]), tree.base)
    assert rate_limb(length_kept, (0, 1, 2), []) == UNSURE


def test_bottom_of_a_part_is_the_lowest_point_of_its_shapes_and_meshes():
    capsule = Capsule(np.array([0, 0, 0.5]), np.array([0, 0, 0.3]), 0.1)
    mesh = Surface(Triangles(np.array([[0, 0, 0.25], [0, 0, 0.15]]), np.zeros((0, 3), int)), dark=False)
    assert find_bottom(ModelPart(1.0, 0.7 * Z, ())) == 0.7
    assert find_bottom(ModelPart(1.0, 0 * Z, (capsule,))) == pytest.approx(0.2)
    assert find_bottom(ModelPart(1.0, 0 * Z, (capsule,), (mesh,))) == 0.15


def test_foot_may_be_a_mesh_instead_of_a_shape():
    corners = np.array([[x, y, z] for x in (0, 0.2) for y in (0, 0.1) for z in (0, 0.1)])
    mesh = Surface(Triangles(corners, np.zeros((0, 3), int)), dark=False)
    bare = stand(sole=STICK)
    footed = stand(sole=STICK, surfaces=(mesh,))
    empty = Tree("r", bare.joints, (*bare.parts[:2], ModelPart(1.0, 0 * Z, ())), bare.base)
    found = [rate_limb(tree, (0, 1, 2), []) for tree in (footed, bare, empty)]
    assert found == [LEG, UNSURE, UNSURE]
