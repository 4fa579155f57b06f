import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.arm import Split
from kinesic.sim.importer.branches import branches
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mirror import sides


def test_hanging_arms_of_an_imported_robot_are_mirror_images(tee_figure):
    assert tee_figure.split == Split(0, 3, 3)
    assert tee_figure.asymmetry < 1e-3
    assert max(arm.off for arm in tee_figure.arms.values()) < np.radians(1)
    assert tee_figure.likeness > 3.0


def test_shoulders_of_an_imported_robot_are_symmetric_about_y_0(tee_figure):
    left, right = (tee_figure.arms[side].centres.shoulder for side in "lr")
    assert left[1] == pytest.approx(0.2, abs=1e-3)
    assert left[1] + right[1] == pytest.approx(0, abs=1e-9)


def test_arm_length_of_an_imported_robot_is_from_shoulder_to_wrist(tee_figure):
    assert tee_figure.arm_length == pytest.approx(0.52, abs=0.005)


def names(tree, row):
    return [tree.joints[k].name for k in row]


def test_arms_trunk_and_head_of_an_imported_robot_are_found(tee):
    result = branches(tee, sides(tee))
    assert names(tee, result.trunk) == ["waist", "bow"]
    assert names(tee, result.neck) == ["pan", "nod"]
    assert names(tee, result.left) == [f"l_{part}" for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag")]
    assert names(tee, result.right) == [name.replace("l_", "r_", 1) for name in names(tee, result.left)]


def test_gripper_of_an_imported_robot_is_not_part_of_the_wrist(hanging):
    assert names(hanging, branches(hanging, sides(hanging)).left)[-1] == "left_turn_joint"


def test_imported_robot_without_neck_and_trunk_is_accepted(written, puppets):
    tree = load_robot_tree(written("plain.xml", puppets.puppet(neck=False, trunk=False)))
    result = branches(tree, sides(tree))
    assert (result.trunk, result.neck) == ((), ())


@pytest.mark.parametrize("joints", ["", "<joint/>"])
def test_imported_robot_without_arms_is_rejected(written, joints: str):
    one = f'<mujoco model="one"><worldbody><body>{joints}<geom size="0.1"/></body></worldbody></mujoco>'
    tree = load_robot_tree(written("one.xml", one))
    message = "robot one: no arms found: among 1 hinges" if joints else "robot one: no movable joint"
    with pytest.raises(ConfigError, match=message):
        branches(tree, sides(tree))
