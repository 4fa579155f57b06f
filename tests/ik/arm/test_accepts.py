from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.config import ConfigError
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Hinge
from kinesic.ik.arm.accepts import accept_chain
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.solve import solve

LEFT_ARM = Robot.load().arms["l"]  # chain of the left arm
# unit vector by letter
AXIS_VECTORS: Mapping[str, Floats] = {
    "x": np.array([1.0, 0, 0]),
    "y": np.array([0, 1.0, 0]),
    "z": np.array([0, 0, 1.0]),
}


def _hinge(name: str, axis: str, lower: float = -1.5, upper: float = 1.5) -> Hinge:
    return Hinge(name, name, sealed(AXIS_VECTORS[axis]), lower, upper, 0.0)


def _arm(shoulder: str, elbow: str, wrist: str) -> Chain:
    """Make an arm with bones along z and hinges about named axes."""
    parts = (("s", shoulder, -0.3), ("e", elbow, -0.25), ("w", wrist, -0.08))
    joints = tuple(
        ChainJoint(name, tuple(_hinge(f"{name}{k}", a) for k, a in enumerate(axes)), sealed([0.0, 0.0, length]))
        for name, axes, length in parts
    )
    count = len(shoulder + elbow + wrist)
    return Chain("arm", "trunk", sealed([0.0, 0.1, 0.0]), joints, tuple(range(count)), sealed([0.0, -1.0, 0.0]))


def _with(chain: Chain, joint: int, **changes: object) -> Chain:
    joints = list(chain.joints)
    joints[joint] = replace(joints[joint], **changes)
    return replace(chain, joints=tuple(joints))


@pytest.mark.parametrize("side", ["l", "r"])
def test_conversion_of_the_default_arm_chain_does_not_change_its_links(side):
    chain = Robot.load().arms[side]
    assert linkage_of(accept_chain(chain)).links == linkage_of(chain).links


def test_joint_axis_along_the_parent_bone_moves_to_the_parent_without_kinematic_change():
    chain = _arm("yx", "zy", "zyx")
    taken = accept_chain(chain)
    assert [[hinge.name for hinge in joint.hinges] for joint in taken.joints] == [
        ["s0", "s1", "e0"],
        ["e1", "w0"],
        ["w1", "w2"],
    ]
    random = np.random.default_rng(71)
    for _ in range(20):
        angles = random.uniform(chain.lower, chain.upper)
        assert np.allclose(chain.frames(angles)[1], taken.frames(angles)[1], atol=1e-12)
        assert np.allclose(chain.frames(angles)[0][-1], taken.frames(angles)[0][-1], atol=1e-12)
    assert all(np.array_equal(getattr(chain, name), getattr(taken, name)) for name in ("lower", "upper", "rest"))


@pytest.mark.parametrize("arm", [("yxz", "y", "yx"), ("xyz", "xz", "xy"), ("zxz", "yz", "yx"), ("yx", "yz", "yx")])
def test_common_arm_joint_layouts_are_accepted_and_solved_by_ik(arm):
    chain = accept_chain(_arm(*arm))
    random = np.random.default_rng(72)
    for _ in range(15):
        position = chain.hand(random.uniform(chain.lower, chain.upper))
        assert solve(chain, Reach(position), start=chain.rest).reached


def test_ik_solves_arms_with_oblique_hinge_axes():
    random = np.random.default_rng(73)
    for _ in range(4):
        chain = LEFT_ARM
        for joint, part in enumerate(LEFT_ARM.joints):
            hinges = tuple(
                hinge if abs(hinge.axis[2]) > 0.9 else replace(hinge, axis=_tilted(hinge.axis, random, 0.15))
                for hinge in part.hinges
            )
            chain = _with(chain, joint, hinges=hinges)
        chain = accept_chain(chain)
        for _ in range(15):
            position = chain.hand(random.uniform(chain.lower, chain.upper))
            assert solve(chain, Reach(position), start=chain.rest).residual < 1e-4


def _tilted(axis: Floats, random: np.random.Generator, by: float) -> Floats:
    aside = axis + by * random.normal(size=3) / np.sqrt(3)
    return sealed(aside / np.linalg.norm(aside))


def test_ik_arm_with_three_swing_hinges_at_one_bone_raises_an_error():
    with pytest.raises(ConfigError, match=r"chain arm: joint s: hinges s0, s1, s2 all swing .* at most two may"):
        accept_chain(_arm("xyx", "y", "zyx"))
    with pytest.raises(ConfigError, match=r"joint w: hinges w1, w2, w3 all swing"):
        accept_chain(_arm("yxz", "y", "zyxy"))


def test_ik_arm_with_two_parallel_hinges_in_one_joint_raises_an_error():
    with pytest.raises(ConfigError, match=r"joint s: hinges s2 and e0 turn about the same line"):
        accept_chain(_arm("yxz", "zy", "yx"))


def test_zero_length_bone_of_an_arm_chain_raises_an_error():
    with pytest.raises(ConfigError, match=r"chain l_arm: joint l_elbow: its bone is 0 m long; put hinges"):
        accept_chain(_with(LEFT_ARM, 2, bone=sealed([0.0, 0.0, 0.0])))
    assert accept_chain(_with(LEFT_ARM, 3, bone=sealed([0.0, 0.0, 0.0]))).lengths[-1] == 0.0


def test_invalid_arm_chain_raises_an_error_with_its_fault():
    with pytest.raises(ConfigError, match=r"has 2 joints; an arm has at least shoulder, elbow, wrist"):
        accept_chain(replace(LEFT_ARM, joints=LEFT_ARM.joints[:2]))
    with pytest.raises(ConfigError, match=r"bone of joint l_elbow is .*nan.*three finite numbers"):
        accept_chain(_with(LEFT_ARM, 2, bone=sealed([np.nan, 0.0, -0.2])))
    with pytest.raises(ConfigError, match=r"hinge a: range \[1, -1\] rad is empty; write the lower limit first"):
        accept_chain(_with(LEFT_ARM, 0, hinges=(_hinge("a", "x", 1.0, -1.0),)))
    with pytest.raises(ConfigError, match=r"hinge a: range \[-inf, 1.0\].*must be finite"):
        accept_chain(_with(LEFT_ARM, 0, hinges=(_hinge("a", "x", -np.inf, 1.0),)))
    with pytest.raises(ConfigError, match=r"hinge a: axis \[2.0, 0.0, 0.0\] has length 2; divide"):
        accept_chain(_with(LEFT_ARM, 0, hinges=(replace(_hinge("a", "x"), axis=sealed([2.0, 0.0, 0.0])),)))
