import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.branches import branches
from kinesic.sim.importer.load import load_model
from kinesic.sim.importer.mirror import sides


def names(tree, row):
    return [tree.joints[k].name for k in row]


def test_arms_trunk_and_head(tee):
    found = branches(tee, sides(tee))
    assert names(tee, found.trunk) == ["waist", "bow"]
    assert names(tee, found.neck) == ["pan", "nod"]
    assert names(tee, found.left) == [f"l_{part}" for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag")]
    assert names(tee, found.right) == [name.replace("l_", "r_", 1) for name in names(tee, found.left)]


def test_a_gripper_is_no_wrist(hanging):
    assert names(hanging, branches(hanging, sides(hanging)).left)[-1] == "left_turn_joint"


def test_a_robot_without_neck_and_trunk(written, puppets):
    tree = load_model(written("plain.xml", puppets.puppet(neck=False, trunk=False)))
    found = branches(tree, sides(tree))
    assert (found.trunk, found.neck) == ((), ())


def test_a_robot_without_arms_is_refused(written):
    one = '<mujoco model="one"><worldbody><body><joint/><geom size="0.1"/></body></worldbody></mujoco>'
    tree = load_model(written("one.xml", one))
    with pytest.raises(ConfigError, match="robot one: no arms found: among 1 hinges there are 0 mirror pairs"):
        branches(tree, sides(tree))
