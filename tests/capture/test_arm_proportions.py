"""Wrist displacement that fits captured arms to the proportions of a robot's arm."""

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.capture.arm_proportions import MAX_WRIST_SHIFT, fit_proportions
from kinesic.capture.clip import ArmPath

BENT = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])  # directions of upper arm and forearm, at right angles


@pytest.fixture
def chain(known):
    return known.robot.arms["l"]


def arm(upper: float, directions=BENT) -> ArmPath:
    """Return one posture of an actor whose upper arm is a given fraction of the arm."""
    elbow = upper * directions[0]
    return ArmPath(sealed(elbow[None]), sealed((elbow + (1.0 - upper) * directions[1])[None]))


def fractions(chain) -> np.ndarray:
    return chain.lengths[-3:-1] / chain.lengths[-3:-1].sum()


def test_arm_with_the_proportions_of_the_robot_keeps_its_wrist(chain):
    upper, _ = fractions(chain)
    length = float(chain.lengths[-3:-1].sum())
    fitted = fit_proportions(arm(upper), chain, length)
    np.testing.assert_allclose(fitted.wrist, arm(upper).wrist, atol=1e-12)


def test_wrist_of_a_short_upper_arm_moves_towards_the_place_with_the_same_bone_directions(chain):
    length, short = float(chain.lengths[-3:-1].sum()), arm(0.42)
    fitted = fit_proportions(short, chain, length)
    aligned = fractions(chain) @ BENT
    shift, whole = (fitted.wrist - short.wrist)[0], aligned - short.wrist[0]
    distance = np.linalg.norm(whole)
    assert np.linalg.norm(shift) == pytest.approx(MAX_WRIST_SHIFT * distance / (MAX_WRIST_SHIFT + distance))
    np.testing.assert_allclose(np.cross(shift, whole), 0.0, atol=1e-12)
    assert shift @ whole > 0.0
    np.testing.assert_array_equal(fitted.elbow, short.elbow)


def test_wrist_of_an_actor_with_a_folded_arm_moves_by_less_than_the_bound(chain):
    folded = arm(0.3, np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))
    fitted = fit_proportions(folded, chain, float(chain.lengths[-3:-1].sum()))
    assert 0.8 * MAX_WRIST_SHIFT < np.linalg.norm(fitted.wrist - folded.wrist) < MAX_WRIST_SHIFT
