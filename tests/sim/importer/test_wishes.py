"""Joint mappings that a person requests by `--map`."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.arm import Split
from kinesic.sim.importer.hinge_names import find_segment, list_hinge_names
from kinesic.sim.importer.hinges import name_hinges
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mirror import Sides
from kinesic.sim.importer.wishes import NO_WISHES, Wishes, read_wishes
from kinesic.sim.importer.zero_pose import analyse_geometry


def mapping(path, *texts):
    figure = analyse_geometry(*read_wishes(load_robot_tree(path), texts))
    return {figure.tree.joints[hinge.joint].name: hinge.name for hinge in name_hinges(figure)}


def test_requested_joint_mapping_is_also_applied_to_the_other_side(tee_path):
    usual, requested = mapping(tee_path), mapping(tee_path, "l_wag=l_wrist_flexion")
    assert (usual["l_wag"], usual["l_nod"]) == ("l_wrist_pivot", "l_wrist_flexion")
    assert (requested["l_wag"], requested["l_nod"]) == ("l_wrist_flexion", "l_wrist_pivot")
    assert (requested["r_wag"], requested["r_nod"]) == ("r_wrist_flexion", "r_wrist_pivot")


def test_requested_hinge_name_is_used_although_no_joint_of_the_file_has_it(tee_path):
    assert mapping(tee_path, "waist=vt1_torsion")["waist"] == "vt1_torsion"


def test_joint_that_a_mapping_request_excludes_is_fixed_and_its_link_kept(tee_path):
    tree = load_robot_tree(tee_path)
    held, _ = read_wishes(tree, ["pan=none", "bow=none"])
    names = [joint.name for joint in held.joints]
    assert names == [joint.name for joint in tree.joints if joint.name not in ("pan", "bow")]
    total = sum(part.mass for part in (tree.base, *tree.parts))
    assert sum(part.mass for part in (held.base, *held.parts)) == pytest.approx(total)
    assert held.joints[names.index("nod")].parent == names.index("waist")
    assert held.left_out == (*tree.left_out, *(f"{name} is held, as requested" for name in ("bow", "pan")))
    assert {"pan", "bow"}.isdisjoint(mapping(tee_path, "pan=none", "bow=none"))


def test_requested_side_of_one_joint_exchanges_left_and_right_arm(tee_path):
    assert mapping(tee_path, "l_bend=r_elbow_flexion")["r_bend"] == "l_elbow_flexion"


def test_requested_elbow_joint_determines_the_division_of_an_imported_arm(tee_path):
    found = mapping(tee_path, "l_twist=l_elbow_flexion")
    assert found["l_twist"] == "l_elbow_flexion"
    assert found["l_bend"] != "l_elbow_flexion"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pan", "write JOINT=HINGE"),
        ("pam=none", "no joint pam; did you mean pan"),
        ("pan=skull_tilt", "no hinge skull_tilt"),
        ("l_wag=l_shoulder_flexion", "no division of the arm"),
        ("pan=vl5_torsion", "this joint moves skullbase"),
        ("l_thumb=l_wrist_pivot", "is on no path to the head or a hand"),
    ],
)
def test_impossible_joint_mapping_request_is_refused_with_the_reason(text, message, tee_path):
    with pytest.raises(ConfigError, match=message):
        mapping(tee_path, text)


def test_hinge_names_belong_to_the_segments_of_imported_robots():
    assert {find_segment(name) for name in list_hinge_names()} >= {"vl5", "skullbase", "l_wrist", "r_sternoclavicular"}
    assert np.unique(list_hinge_names()).size == len(list_hinge_names()) == 46


PAIRED = Sides({0: 10, 1: 11, 2: 12}, (0.6, -0.8), certain=False, by_names=True)


@pytest.mark.parametrize(
    ("hinges", "exchanged"),
    [
        ({}, False),
        ({0: "l_elbow_flexion"}, False),
        ({10: "r_elbow_flexion"}, False),
        ({0: "r_elbow_flexion"}, True),
        ({10: "l_elbow_flexion"}, True),
        ({0: "r_elbow_flexion", 1: "l_elbow_flexion"}, False),
        ({0: "r_elbow_flexion", 11: "l_elbow_flexion", 2: "l_wrist_pivot"}, True),
        ({5: "r_elbow_flexion"}, False),
        ({0: "vl5_torsion", 1: "skullbase_torsion"}, False),
    ],
)
def test_left_and_right_are_exchanged_if_most_requested_hinges_are_on_the_other_side(hinges, exchanged):
    found = Wishes(hinges).orient(PAIRED)
    if not exchanged:
        assert found is PAIRED
        return
    assert (found.pairs, found.left) == ({10: 0, 11: 1, 12: 2}, (-0.6, 0.8))
    assert (found.certain, found.by_names) == (True, True)


def test_requested_hinges_are_mirrored_to_joints_without_a_request():
    hinges = {0: "l_elbow_flexion", 11: "r_wrist_pivot", 2: "l_wrist_flexion", 12: "r_wrist_pivot", 7: "vl5_torsion"}
    found = Wishes(hinges | {5: "l_shoulder_flexion"}).on_both_sides(PAIRED)
    assert found.hinges == hinges | {5: "l_shoulder_flexion", 10: "r_elbow_flexion", 1: "l_wrist_pivot"}
    assert NO_WISHES.on_both_sides(PAIRED).hinges == {}


@pytest.mark.parametrize(
    ("hinge", "places"),
    [
        ("l_sternoclavicular_abduction", [0]),
        ("r_shoulder_flexion", [1, 2, 3]),
        ("l_elbow_flexion", [4]),
        ("l_elbow_pivot", [4, 5]),
        ("l_wrist_flexion", [5, 6]),
        ("skullbase_torsion", [0, 1, 2, 3, 4, 5, 6]),
    ],
)
def test_requested_hinge_of_an_arm_allows_only_divisions_with_its_joint_there(hinge, places):
    split, arm = Split(1, 3, 2), range(10, 17)
    assert [k for k in range(7) if Wishes({10 + k: hinge}).allows(split, arm)] == places


def test_one_requested_hinge_out_of_place_forbids_a_division_of_an_arm():
    wishes = Wishes({0: "l_shoulder_flexion", 1: "l_elbow_flexion", 2: "l_shoulder_twisting"})
    assert not wishes.allows(Split(0, 2, 0), (0, 1, 2))
    assert wishes.allows(Split(0, 2, 0), (0, 2, 1))


def test_last_of_several_requests_for_one_joint_is_used():
    joints = (SimpleNamespace(name="a"), SimpleNamespace(name="b=c"))
    tree = SimpleNamespace(name="r", joints=joints, without=lambda held: SimpleNamespace(joints=joints, held=held))
    kept, wishes = read_wishes(tree, ["b=c=l_wrist_pivot", "b=c=l_wrist_flexion"])
    assert (kept.held, wishes.hinges) == (set(), {1: "l_wrist_flexion"})
