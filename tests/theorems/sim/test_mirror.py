"""Left mirrors right: equal angles on both sides are mirror postures, in weight and in room to itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kinesic.body.robot import Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics

from ...examples import examples

ROBOT = Robot.load()
SKELETON = ROBOT.skeleton
DYNAMICS, DISTANCES = MujocoDynamics(ROBOT), CapsuleDistances(ROBOT)
SIDES = {"l": "r", "r": "l"}


def image(name):
    return f"{SIDES[name[0]]}{name[1:]}" if name[:2] in ("l_", "r_") else name


PARTNERS = [SKELETON.names.index(image(name)) for name in SKELETON.names]
# a hinge in the midline turns the other way in the mirror unless its axis is the mirror's normal
SIGNS = np.array([-1.0 if PARTNERS[k] == k and not hinge.axis[1] else 1.0 for k, hinge in enumerate(SKELETON.hinges)])
SHARES = arrays(np.float64, 22, elements=st.floats(0.0, 1.0))


def posture(shares):
    return SKELETON.lower + shares * (SKELETON.upper - SKELETON.lower)


@given(SHARES)
@examples(100)
def test_mirror_postures_have_equal_torques_and_distances(shares):
    angles = posture(shares)
    mirrored = SIGNS * angles[PARTNERS]
    held = DYNAMICS.holding(np.array([angles, mirrored]))
    assert held[1] == pytest.approx(SIGNS * held[0][PARTNERS], abs=1e-9)
    found = DISTANCES.clearance(np.array([angles, mirrored])).distances
    assert found[0] == pytest.approx(found[1], abs=1e-12)


@given(SHARES, SHARES)
@examples(100)
def test_distance_changes_no_faster_than_points_move(one, other):
    """No pair comes closer than both its segments moved: what makes sampled clearance trustworthy."""
    a, b = posture(one), posture(one + 0.05 * (other - one))
    found = DISTANCES.clearance(np.array([a, b])).distances
    moved = 0.0
    frames = [SKELETON.frames(a), SKELETON.frames(b)]
    for k, segment in enumerate(SKELETON.segments):
        for capsule in segment.capsules:
            for end in (capsule.start, capsule.end):
                points = [frame.origins[k] + frame.rotations[k] @ end for frame in frames]
                moved = max(moved, float(np.linalg.norm(points[1] - points[0])))
    assert abs(found[1] - found[0]) <= 2 * moved + 1e-12


@given(SHARES, SHARES, SHARES)
@examples(50)
def test_inertia_is_positive_along_every_motion(shares, speeds, accelerations):
    """Torque for an acceleration, beyond what the same motion needs without it, does positive work along it."""
    angles = posture(shares)[None]
    rates, pushes = 4 * (speeds - 0.5)[None], 20 * (accelerations - 0.5)[None]
    more = DYNAMICS.torques(angles, rates, pushes) - DYNAMICS.torques(angles, rates, np.zeros((1, 22)))
    assert float((more * pushes).sum()) >= 0.0
