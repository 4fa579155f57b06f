import numpy as np
import pytest

from kinesic.ik.thesis.boxes import EulerBoxes
from kinesic.ik.thesis.chain import BallChain, perpendicular

CHAIN_POINTS = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.3, 0.0, 0.2)]  # [m] joint positions at rest


def test_ball_joint_chain_derives_bone_lengths_and_frames_from_points():
    chain = BallChain.of(CHAIN_POINTS)
    assert chain.lengths == pytest.approx([0.3, 0.2])
    assert chain.size == pytest.approx(0.5)
    for frame in chain.frames:
        assert frame.T @ frame == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(frame) == pytest.approx(1.0)
    assert chain.frames[:, :, 0] == pytest.approx(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))


def test_up_vector_parallel_to_its_bone_is_replaced():
    ups = perpendicular(np.array([0.0, 0.0, 1.0]), np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]))
    assert (ups * np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])).sum(axis=1) == pytest.approx([0.0, 0.0])
    assert np.linalg.norm(ups, axis=1) == pytest.approx([1.0, 1.0])
    assert ups[1] == pytest.approx([0.0, 0.0, 1.0])


def test_curved_chain_has_the_requested_lengths_and_bend():
    chain = BallChain.curved([0.2, 0.3, 0.1], bend=0.2, base=(1.0, 2.0, 3.0))
    assert chain.lengths == pytest.approx([0.2, 0.3, 0.1])
    along = chain.frames[:, :, 0]
    assert np.arccos((along[:-1] * along[1:]).sum(axis=1)) == pytest.approx([0.2, 0.2])
    assert chain.points[0].tolist() == [1.0, 2.0, 3.0]


def test_outer_part_of_a_ball_joint_chain_keeps_its_masses_stiffness_and_limits():
    boxes = EulerBoxes.of([-0.1, -0.2, -0.3], [0.1, 0.2, 0.3], joints=2)
    chain = BallChain.of(CHAIN_POINTS, masses=[1.0, 2.0, 3.0], stiffness=[4.0, 5.0], damping=0.1, limits=boxes)
    outer = chain.beyond(1)
    assert outer.points.tolist() == chain.points[1:].tolist()
    assert outer.masses.tolist() == [2.0, 3.0]
    assert outer.stiffness.tolist() == [5.0]
    assert outer.damping == 0.1
    assert outer.limits is not None
    assert len(outer.limits.lower) == 1


def test_ball_chain_arrays_are_read_only():
    chain = BallChain.of(CHAIN_POINTS)
    for array in (chain.points, chain.ups, chain.masses, chain.stiffness, chain.lengths, chain.frames):
        assert not array.flags.writeable


@pytest.mark.parametrize(
    ("change", "lesson"),
    [
        ({"points": [CHAIN_POINTS[0], CHAIN_POINTS[1], CHAIN_POINTS[1]]}, "bone 1, from point 1 to 2, is 0 m long"),
        ({"points": CHAIN_POINTS[:1]}, r"shape \(1, 3\); a chain needs"),
        ({"points": [(0.0, 0.0, 0.0), (np.nan, 0.0, 0.0)]}, "points are .*nan.* must be finite"),
        ({"masses": [1.0, 0.0, 1.0]}, r"masses are \[1.0, 0.0, 1.0\]; each must be above zero"),
        ({"stiffness": -2.0}, "stiffness are .* above zero"),
        ({"damping": 1.0}, r"damping is 1.0, outside \[0, 1\)"),
        ({"limits": EulerBoxes.of(-1.0, 1.0, joints=3)}, "limits are given for 3 joints; the chain has 2"),
    ],
)
def test_invalid_ball_joint_chains_raise_clear_errors(change, lesson):
    with pytest.raises(ValueError, match=lesson):
        BallChain.of(**({"points": CHAIN_POINTS} | change))
