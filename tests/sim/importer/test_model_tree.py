import numpy as np
import pytest

from kinesic.sim.importer.model_tree import BASE_INDEX


def index(tree, name):
    return [joint.name for joint in tree.joints].index(name)


def test_tree_of_robot_hinges_lists_paths_descendants_and_children(tee):
    hand = index(tee, "l_wag")
    assert [tee.joints[k].name for k in tee.path_from_base(hand)][:3] == ["waist", "bow", "l_pitch"]
    assert {tee.joints[k].name for k in tee.below(hand)} == {"l_wag", "l_thumb", "l_finger"}
    assert tee.joints[tee.children[BASE_INDEX][0]].name == "waist"


def test_merged_part_has_the_mass_of_its_parts(tee):
    rows = [index(tee, "l_twist"), index(tee, "r_twist")]
    both = tee.merge_parts(rows)
    assert both.mass == pytest.approx(2.4)
    assert both.centre[1] == pytest.approx(0.0, abs=1e-9)
    assert len(both.shapes) == 2


def test_hinge_rotation_moves_only_its_descendants(tee):
    roll, bend = index(tee, "l_roll"), index(tee, "l_bend")
    turned = tee.turned({roll: -np.pi / 2})
    assert turned.joints[roll].zero == pytest.approx(-np.pi / 2)
    assert turned.joints[roll].anchor == pytest.approx(tee.joints[roll].anchor)
    assert turned.joints[bend].anchor - turned.joints[roll].anchor == pytest.approx([0.01, 0, -0.28])
    other = index(tee, "r_bend")
    assert turned.joints[other].anchor == pytest.approx(tee.joints[other].anchor)


def test_rigid_motion_of_a_hinge_tree_keeps_distances(tee):
    moved = tee.moved(np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]), np.array([1.0, 2, 3]))
    before, after = (np.array([joint.anchor for joint in tree.joints]) for tree in (tee, moved))
    assert np.linalg.norm(np.diff(after, axis=0), axis=1) == pytest.approx(
        np.linalg.norm(np.diff(before, axis=0), axis=1)
    )
