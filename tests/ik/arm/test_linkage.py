import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.bench.ik.arms import random_arm
from kinesic.body.arrays import sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import Pivot, linkage_of


@pytest.fixture(scope="module")
def arm() -> Chain:
    return Robot.load().arms["l"]


def test_twist_hinges_are_grouped_with_the_next_bone(arm: Chain) -> None:
    assert [len(link.pivots) for link in linkage_of(arm).links] == [1, 2, 2, 3]
    assert [link.first for link in linkage_of(arm).links] == [0, 1, 3, 5]


def test_arm_linkage_kinematics_match_the_chain_kinematics(arm: Chain) -> None:
    random = default_rng(2)
    linkage = linkage_of(arm)
    for _ in range(20):
        angles = random.uniform(arm.lower, arm.upper)
        rotations, centres = arm.frames(angles)
        frame, points = linkage.walk(angles.tolist(), len(linkage.links))
        assert np.allclose(points, centres, atol=1e-14)
        assert np.allclose(np.reshape(frame, (3, 3)), rotations[-1], atol=1e-14)
        assert np.allclose(linkage.hand(angles.tolist()), arm.hand(angles), atol=1e-14)


def test_arm_side_and_reach_are_derived_from_the_chain(arm: Chain) -> None:
    robot = Robot.load()
    assert linkage_of(arm).side == 1.0
    assert linkage_of(robot.arms["r"]).side == -1.0
    assert linkage_of(arm).farthest == pytest.approx(0.42)


def test_arm_reach_covers_the_extremes_of_all_elbow_hinges() -> None:
    random, kinds = default_rng(7), set()
    for _ in range(24):
        chain = random_arm(random)
        fore = linkage_of(chain).links[-2]
        grid = product(*(np.linspace(pivot.lower, pivot.upper, 13) for pivot in fore.pivots[-2:]))
        longest, shortest = 0.0, np.inf
        for turns in grid:
            angles = chain.rest.copy()
            angles[fore.first + len(fore.pivots) - len(turns) : fore.first + len(fore.pivots)] = turns
            shoulder, _, hand = chain.frames(angles)[1][-4:-1]
            longest = max(longest, float(np.linalg.norm(hand - shoulder)))
            shortest = min(shortest, float(np.linalg.norm(hand - shoulder)))
        kinds.add(len(fore.pivots))
        assert longest - 1e-12 <= linkage_of(chain).farthest <= 1.03 * longest, chain.name
        assert 0.97 * shortest - 0.02 * longest <= linkage_of(chain).closest <= shortest + 1e-12, chain.name
    assert kinds == {1, 2, 3}


def test_joint_angle_out_of_range_becomes_its_equivalent_in_range_or_the_nearest_limit() -> None:
    pivot = Pivot((0.0, 0.0, 1.0), math.radians(-50), math.radians(190), 0.0)
    assert math.degrees(pivot.bring_into_range(math.radians(-175), 0.0)) == pytest.approx(185)
    assert math.degrees(pivot.bring_into_range(math.radians(20), 0.0)) == pytest.approx(20)
    assert pivot.bring_into_range(math.radians(-60), 0.0) == pivot.lower
    assert pivot.bring_into_range(math.radians(-160), 0.0) == pivot.upper


def test_arm_chain_without_elbow_raises_an_error(arm: Chain) -> None:
    joints: tuple[ChainJoint, ...] = arm.joints[:2]
    with pytest.raises(ValueError, match="2 joints"):
        linkage_of(Chain("stub", arm.base, arm.origin_in_base, joints, arm.indices[:4], arm.palm))


def test_zero_length_bone_of_an_arm_linkage_raises_an_error(arm: Chain) -> None:
    joints = (arm.joints[0], replace(arm.joints[1], bone=sealed([0, 0, 0])), *arm.joints[2:])
    with pytest.raises(ValueError, match=f"joint {arm.joints[1].name}: its bone is 0 m long"):
        linkage_of(replace(arm, joints=joints))


@pytest.mark.parametrize(("lower", "upper"), [(1.0, -1.0), (math.nan, 1.0), (0.0, math.inf)])
def test_hinge_with_an_empty_or_non_finite_range_raises_an_error(arm: Chain, lower: float, upper: float) -> None:
    first, *others = arm.joints[1].hinges
    joint = replace(arm.joints[1], hinges=(replace(first, lower=lower, upper=upper), *others))
    with pytest.raises(ValueError, match=f"hinge {first.name}: range"):
        linkage_of(replace(arm, joints=(arm.joints[0], joint, *arm.joints[2:])))


def test_arm_joint_may_be_fixed_by_equal_limits(arm: Chain) -> None:
    first, *others = arm.joints[0].hinges
    joint = replace(arm.joints[0], hinges=(replace(first, lower=0.1, upper=0.1), *others))
    assert linkage_of(replace(arm, joints=(joint, *arm.joints[1:]))).pivots[0].bring_into_range(1.0, 0.1) == 0.1
