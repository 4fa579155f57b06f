from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.ik.hinge_chain import strand_to

SKELETON = Robot.load().skeleton


def test_the_end_and_its_motion_are_those_of_the_skeleton():
    random = default_rng(61)
    for name in ("l_wrist", "r_wrist", "skullbase"):
        strand = strand_to(SKELETON, name)
        angles = random.uniform(SKELETON.lower, SKELETON.upper)
        end, columns = strand.end(angles.tolist())
        assert np.allclose(end, SKELETON.frames(angles).origins[SKELETON.segment(name)], atol=1e-12)
        for joint, column in zip(strand.joints, columns, strict=True):
            moved = angles.copy()
            moved[joint] += 1e-6
            assert np.allclose((np.array(strand.end(moved.tolist())[0]) - end) / 1e-6, column, atol=1e-5)


def test_the_own_hinges_of_the_end_are_left_out():
    strand = strand_to(SKELETON, "l_wrist")
    assert set(strand.joints).isdisjoint(SKELETON.joints_of(("l_wrist",)))
    assert len(strand.joints) == 3 + 1 + 3 + 2


def test_hinges_that_miss_their_centre_move_it():
    random = default_rng(62)
    hinges = [replace(hinge, at=sealed(random.uniform(-0.03, 0.03, 3))) for hinge in SKELETON.hinges]
    skeleton = replace(SKELETON, hinges=tuple(hinges))
    strand = strand_to(skeleton, "l_wrist")
    angles = random.uniform(skeleton.lower, skeleton.upper)
    end, columns = strand.end(angles.tolist())
    assert np.allclose(end, skeleton.frames(angles).origins[skeleton.segment("l_wrist")], atol=1e-12)
    assert set(skeleton.joints_of(("l_wrist",))) <= set(strand.joints)
    for joint, column in zip(strand.joints, columns, strict=True):
        moved = angles.copy()
        moved[joint] += 1e-6
        assert np.allclose((np.array(strand.end(moved.tolist())[0]) - end) / 1e-6, column, atol=1e-5)
