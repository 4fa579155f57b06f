import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.shapes import BETWEEN, bone, own, trunk


def test_a_bone_spares_its_start():
    capsule = bone(np.zeros(3), np.array([0.0, 0, -1]), 0.1, spared=0.2)
    assert capsule.start == pytest.approx((0, 0, -0.2))
    assert capsule.end == (0, 0, -1)


def test_own_shapes_move_into_the_segment():
    (capsule,) = own([Capsule(np.array([1.0, 0, 0]), np.array([1.0, 0, 1]), 0.1)], np.array([1.0, 0, 0.5]))
    assert (capsule.start, capsule.end, capsule.radius) == ((0, 0, -0.5), (0, 0, 0.5), 0.1)


@pytest.mark.parametrize("tall", [0.1, 0.3, 0.6])
def test_a_trunk_leaves_room_for_hanging_arms(tall):
    capsules = trunk(np.zeros(3), np.array([0.0, 0, tall]), 0.2, 0.04)
    widest = max(abs(capsule.end[1]) + capsule.radius for capsule in capsules)
    assert widest <= 0.2 - 0.04 - BETWEEN + 1e-6
    assert all(capsule.end[2] < tall for capsule in capsules)
