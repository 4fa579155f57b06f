import math

import numpy as np
import pytest

from kinesic.body.robot import Robot, Side
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.swivel import hanging_direction, measure_swivels, swivel, swivel_of
from kinesic.ik.scalar3 import Vector, distance, dot, unit, vector

from ...reference.ik.swivel import elbow_at

DEFAULT_ROBOT = Robot.load()
ARM_LINKAGE = linkage_of(DEFAULT_ROBOT.arms["l"])  # linkage of the left arm


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0)),
        ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
        ((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0)),
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    ],
)
def test_zero_swivel_direction_is_below_a_raised_and_behind_a_hanging_arm(line: Vector, expected: Vector) -> None:
    assert hanging_direction(line) == pytest.approx(expected)


def test_zero_swivel_direction_is_perpendicular_to_the_arm_and_continuous() -> None:
    before = None
    for angle in np.linspace(0.0, 2.0, 100):
        line = unit((math.cos(angle), math.sin(angle), 0.3 * math.sin(3 * angle)))
        zero = hanging_direction(line)
        assert dot(zero, line) == pytest.approx(0.0, abs=1e-12)
        assert dot(zero, zero) == pytest.approx(1.0)
        assert before is None or distance(before, zero) < 0.1
        before = zero


def test_elbow_position_keeps_bone_lengths_and_swivel() -> None:
    shoulder, hand = (0.0, 0.155, -0.035), (0.25, 0.2, -0.1)
    for wished in (-2.0, -0.5, 0.0, 1.0, 3.0):
        elbow = elbow_at(ARM_LINKAGE, shoulder, hand, wished)
        assert distance(shoulder, elbow) == pytest.approx(0.22)
        assert distance(elbow, hand) == pytest.approx(0.20)
        assert swivel_of(ARM_LINKAGE, (shoulder, elbow, hand)) == pytest.approx(wished)


def test_positive_swivel_moves_the_elbow_away_from_the_body() -> None:
    hand = (0.3, 0.0, 0.0)
    left = elbow_at(ARM_LINKAGE, (0.0, 0.0, 0.0), hand, 1.0)
    right = elbow_at(linkage_of(DEFAULT_ROBOT.arms["r"]), (0.0, 0.0, 0.0), hand, 1.0)
    assert left[1] > 0.05
    assert right == pytest.approx((left[0], -left[1], left[2]))


def test_straight_arm_has_no_swivel() -> None:
    chain = DEFAULT_ROBOT.arms["l"]
    assert swivel(chain, np.zeros(8)) is None
    assert swivel(chain, chain.rest) is not None


def test_elbow_lies_on_the_shoulder_target_line_if_the_target_is_beyond_reach() -> None:
    assert elbow_at(ARM_LINKAGE, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.3) == pytest.approx((0.22, 0.0, 0.0))
    assert all(math.isfinite(x) for x in elbow_at(ARM_LINKAGE, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.3))


@pytest.mark.parametrize("side", ["l", "r"])
def test_swivels_of_many_arms_equal_those_of_single_arms(side: Side) -> None:
    """Include an arm that reaches straight backward, whose elbow hangs upward."""
    rng = np.random.default_rng(4)
    elbows, hands = rng.normal(size=(2, 40, 3))
    hands[-1] = -1.0, 0.0, 0.0
    found = measure_swivels(DEFAULT_ROBOT.arms[side], elbows, hands)
    mirrored = np.array([1.0, 1.0 if side == "l" else -1.0, 1.0])
    for k, angle in enumerate(found):
        points = [vector(place * mirrored) for place in (np.zeros(3), elbows[k], hands[k])]
        assert angle == pytest.approx(swivel_of(ARM_LINKAGE, points), abs=1e-9)
