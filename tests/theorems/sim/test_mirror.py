"""Mirror postures have equal gravity torques and distances."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kinesic.body.robot import Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics

from ...examples import examples

DEFAULT_ROBOT = Robot.load()
ROBOT_SKELETON = DEFAULT_ROBOT.skeleton
DYNAMICS, DISTANCES = MujocoDynamics(DEFAULT_ROBOT), CapsuleDistances(DEFAULT_ROBOT)
OTHER_SIDES = {"l": "r", "r": "l"}


def image(name):
    return f"{OTHER_SIDES[name[0]]}{name[1:]}" if name[:2] in ("l_", "r_") else name


# index of each hinge's mirror image
MIRROR_HINGES = [ROBOT_SKELETON.names.index(image(name)) for name in ROBOT_SKELETON.names]
# The mirror reverses midline hinges except those about the mirror normal
MIRROR_SIGNS = np.array(
    [-1.0 if MIRROR_HINGES[k] == k and not hinge.axis[1] else 1.0 for k, hinge in enumerate(ROBOT_SKELETON.hinges)]
)
RANGE_FRACTIONS = arrays(np.float64, 22, elements=st.floats(0.0, 1.0))  # joint angles as fractions of their ranges


def posture(shares):
    return ROBOT_SKELETON.lower + shares * (ROBOT_SKELETON.upper - ROBOT_SKELETON.lower)


@given(RANGE_FRACTIONS)
@examples(100)
def test_mirror_postures_have_mirrored_torques_and_equal_distances(shares):
    angles = posture(shares)
    mirrored = MIRROR_SIGNS * angles[MIRROR_HINGES]
    held = DYNAMICS.holding(np.array([angles, mirrored]))
    assert held[1] == pytest.approx(MIRROR_SIGNS * held[0][MIRROR_HINGES], abs=1e-9)
    distances = DISTANCES.clearance(np.array([angles, mirrored])).distances
    assert distances[0] == pytest.approx(distances[1], abs=1e-12)


@given(RANGE_FRACTIONS, RANGE_FRACTIONS)
@examples(100)
def test_clearance_changes_by_at_most_twice_the_largest_motion_of_a_segment(one, other):
    """Bound the approach of each pair by the motion of both segments."""
    a, b = posture(one), posture(one + 0.05 * (other - one))
    distances = DISTANCES.clearance(np.array([a, b])).distances
    moved = 0.0
    frames = [ROBOT_SKELETON.frames(a), ROBOT_SKELETON.frames(b)]
    for k, segment in enumerate(ROBOT_SKELETON.segments):
        for capsule in segment.capsules:
            for end in (capsule.start, capsule.end):
                points = [frame.origins[k] + frame.rotations[k] @ end for frame in frames]
                moved = max(moved, float(np.linalg.norm(points[1] - points[0])))
    assert abs(distances[1] - distances[0]) <= 2 * moved + 1e-12


@given(RANGE_FRACTIONS, RANGE_FRACTIONS, RANGE_FRACTIONS)
@examples(50)
def test_inertia_matrix_is_positive_semidefinite(shares, speeds, accelerations):
    """Test that the torque of an acceleration does positive work along it."""
    angles = posture(shares)[None]
    rates, pushes = 4 * (speeds - 0.5)[None], 20 * (accelerations - 0.5)[None]
    more = DYNAMICS.torques(angles, rates, pushes) - DYNAMICS.torques(angles, rates, np.zeros((1, 22)))
    assert float((more * pushes).sum()) >= 0.0
