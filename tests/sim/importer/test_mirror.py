import numpy as np
import pytest

from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mirror import sides


def names(tree, pairs):
    return {tree.joints[a].name: tree.joints[b].name for a, b in pairs.items()}


def test_mirror_pairs_of_imported_hinges_are_found_by_geometry(tee):
    result = sides(tee)
    assert len(result.pairs) == 9 + 3
    assert names(tee, result.pairs)["l_bend"] == "r_bend"
    assert result.certain
    assert not result.by_names


@pytest.mark.parametrize(("turned", "left"), [(0, (0, 1)), (90, (-1, 0)), (180, (0, -1)), (270, (1, 0))])
def test_forward_direction_of_an_imported_robot_is_found_for_any_world_orientation(written, puppets, turned, left):
    tree = load_robot_tree(written("turned.xml", puppets.puppet(turned=turned)))
    result = sides(tree)
    assert result.left == pytest.approx(left, abs=1e-9)
    forward = result.upright @ np.array([np.cos(np.radians(turned)), np.sin(np.radians(turned)), 0])
    assert forward == pytest.approx([1, 0, 0], abs=1e-9)


def test_forward_direction_is_found_from_feet_and_head_if_joint_names_have_no_side(written, puppets):
    tree = load_robot_tree(written("unnamed.xml", puppets.puppet(left="one_", right="two_", turned=180)))
    result = sides(tree)
    assert result.certain
    assert set(names(tree, result.pairs)) == {name for name in names(tree, result.pairs) if name.startswith("one_")}


def test_left_and_right_joints_in_an_asymmetric_pose_are_paired_by_names(hanging):
    crooked = hanging.turned({k: 0.5 for k, joint in enumerate(hanging.joints) if joint.name.startswith("left_")})
    result = sides(crooked)
    assert result.by_names
    assert names(crooked, result.pairs)["left_elbow_joint"] == "right_elbow_joint"


@pytest.mark.parametrize(("left", "right"), [("L_", "R_"), ("left_", "right_"), ("Left", "Right"), ("l_", "r_")])
def test_side_words_in_joint_names_overrule_the_geometry_of_an_imported_robot(written, puppets, left, right):
    tree = load_robot_tree(
        written("worded.xml", puppets.puppet(left=right, right=left))
    )  # names contradict the geometry and take precedence
    assert sides(tree).left == pytest.approx((0, -1))
