from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.offset_hinges import nominal, solve_offset
from kinesic.ik.solve import solve

LEFT_ARM = Robot.load().arms["l"]  # chain of the left arm


def _split(chain: Chain, name: str, after: int, offset: tuple[float, float, float]) -> Chain:
    """Split a joint into two joints with a short bone between them."""
    joints: list[ChainJoint] = []
    for joint in chain.joints:
        if joint.name == name:
            joints.append(ChainJoint(f"{name}_first", joint.hinges[:after], sealed(offset)))
            joint = replace(joint, hinges=joint.hinges[after:])  # noqa: PLW2901 - the rest of the joint
        joints.append(joint)
    return replace(chain, joints=tuple(joints))


def _apart(offset: float) -> Chain:
    """Return an arm whose shoulder, elbow and wrist hinges do not intersect."""
    chain = _split(LEFT_ARM, "l_shoulder", 1, (offset, offset, 0.0))
    chain = _split(chain, "l_elbow", 1, (offset, 0.0, 0.0))
    return _split(chain, "l_wrist", 1, (0.0, offset, -offset))


@pytest.mark.parametrize("offset", [0.01, 0.02, 0.03])
def test_arms_with_offset_joint_axes_reach_targets_of_random_postures(offset):
    chain, random = _apart(offset), default_rng(81)
    for _ in range(50):
        position = chain.hand(random.uniform(chain.lower, chain.upper))
        solution = solve_offset(chain, Reach(position), start=chain.rest)
        assert np.all((chain.lower <= solution.angles) & (solution.angles <= chain.upper))
        assert solution.residual == pytest.approx(np.linalg.norm(chain.hand(solution.angles) - position), abs=1e-12)
        assert solution.residual < 1e-4


def test_idealised_arm_merges_joints_that_are_split_by_axis_offsets():
    ideal = nominal(_apart(0.02))
    assert [joint.name for joint in ideal.joints] == [joint.name for joint in LEFT_ARM.joints]
    assert [h.name for j in ideal.joints for h in j.hinges] == [h.name for j in LEFT_ARM.joints for h in j.hinges]
    assert nominal(LEFT_ARM) is LEFT_ARM


def test_joint_offset_along_a_bone_lengthens_the_ideal_bone():
    ideal = nominal(_split(LEFT_ARM, "l_shoulder", 2, (0.02, 0.0, -0.02)))
    assert ideal.joints[1].bone == pytest.approx([0.0, 0.0, -0.24])


def test_arm_without_offsets_is_solved_like_an_ideal_arm():
    reach = Reach(np.array([0.25, 0.15, -0.05]), pointing=np.array([1.0, 0.0, 0.0]))
    plain, solution = solve(LEFT_ARM, reach, start=LEFT_ARM.rest), solve_offset(LEFT_ARM, reach, start=LEFT_ARM.rest)
    assert np.abs(plain.angles - solution.angles).max() < 1e-6
    assert solution.pointing_error == pytest.approx(plain.pointing_error, abs=1e-6)


def test_pointing_and_palm_errors_are_measured_on_the_arm_with_axis_offsets():
    chain = _apart(0.02)
    posture = np.array([0.1, 0.6, 0.4, -0.3, 1.2, 0.2, 0.1, -0.1])
    rotations, centres = chain.frames(posture)
    pointing = (centres[-1] - centres[-2]) / np.linalg.norm(centres[-1] - centres[-2])
    solution = solve_offset(chain, Reach(centres[-2], pointing, rotations[-1] @ chain.palm), start=posture)
    points = chain.frames(solution.angles)[1]
    along = (points[-1] - points[-2]) / np.linalg.norm(points[-1] - points[-2])
    assert solution.pointing_error == pytest.approx(np.arccos(np.clip(along @ pointing, -1, 1)), abs=1e-6)
    assert solution.palm_error is not None
