import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Hinge
from kinesic.ik.arm.linkage import linkage_of

from ...reference.ik.hinges import extract

AXIS_VECTORS = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}  # unit vector by letter


def _arm(shoulder: str, elbow: str, two_sided: bool) -> Chain:
    def hinges(segment: str, axes: str, lower: float, upper: float) -> tuple[Hinge, ...]:
        return tuple(
            Hinge(f"{segment}{k}", segment, sealed(AXIS_VECTORS[a]), lower, upper, 0.0) for k, a in enumerate(axes)
        )

    joints = (
        ChainJoint("shoulder", hinges("shoulder", shoulder, -1.9, 1.9), sealed([0, 0, -0.3])),
        ChainJoint("elbow", hinges("elbow", elbow, -2.3 if two_sided else 0.0, 2.3), sealed([0, 0, -0.25])),
        ChainJoint("wrist", hinges("wrist", "zyx", -1.0, 1.0), sealed([0, 0, -0.08])),
    )
    count = sum(len(joint.hinges) for joint in joints)
    return Chain("arm", "trunk", sealed([0, 0.2, 0]), joints, tuple(range(count)), sealed([0, -1, 0]))


def _round_trips(chain: Chain, count: int) -> float:
    """Return the fraction of random postures recovered from their joint positions."""
    random, linkage = default_rng(4), linkage_of(chain)
    met = 0
    for _ in range(count):
        points = linkage.walk(random.uniform(chain.lower, chain.upper).tolist(), len(linkage.links) - 1)[1]
        extracted = extract(linkage, points[1:], chain.rest.tolist())
        back = linkage.walk(extracted.angles, len(linkage.links) - 1)[1]
        assert all(p.lower <= a <= p.upper for p, a in zip(linkage.pivots, extracted.angles, strict=False))
        miss = sum(np.linalg.norm(np.subtract(a, b)) for a, b in zip(points, back, strict=True))
        assert extracted.miss == pytest.approx(miss, abs=1e-12)
        met += int(miss < 1e-6)
    return met / count


def test_angles_of_99_percent_of_arm_postures_are_recovered_from_joint_positions() -> None:
    assert _round_trips(Robot.load().arms["l"], 500) >= 0.99


@pytest.mark.parametrize("shoulder", ["yxz", "xyz", "zxz", "yx"])
@pytest.mark.parametrize(("elbow", "two_sided"), [("y", False), ("x", True)])
def test_angles_of_98_percent_of_postures_of_several_arm_layouts_are_recovered(
    shoulder: str, elbow: str, two_sided: bool
) -> None:
    assert _round_trips(_arm(shoulder, elbow, two_sided), 60) >= 0.98


def test_undetermined_twist_of_a_straight_elbow_keeps_its_current_angle() -> None:
    chain = Robot.load().arms["l"]
    linkage = linkage_of(chain)
    near = [0.0, 0.4, 0.3, 0.7, 0.0, 0.0, 0.0, 0.0]
    points = linkage.walk(near, 3)[1]
    assert extract(linkage, points[1:], near).angles == pytest.approx(near[:5], abs=1e-9)


def test_ik_chooses_the_solution_nearest_to_the_current_joint_angles() -> None:
    chain = _arm("yxz", "x", two_sided=True)
    linkage = linkage_of(chain)
    for elbow in (-1.0, 1.0):
        near = [0.2, 0.3, 0.1, elbow, 0.0, 0.0, 0.0]
        assert extract(linkage, linkage.walk(near, 2)[1][1:], near).angles == pytest.approx(near[:4], abs=1e-9)


def test_infeasible_joint_positions_give_angles_in_range_and_a_large_error() -> None:
    chain = Robot.load().arms["l"]
    linkage = linkage_of(chain)
    extracted = extract(linkage, [(0.0, 0.1, 0.09), (-0.3, 0.2, 0.2), (-0.3, 0.3, 0.3)], chain.rest.tolist())
    assert extracted.miss > 0.05
    assert all(p.lower <= a <= p.upper for p, a in zip(linkage.pivots, extracted.angles, strict=False))
