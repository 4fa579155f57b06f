import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.ik import KERNEL
from kinesic.ik.solve import solve
from kinesic.ik.torso import LARGEST_TURN, lean_torso

ROBOT = Robot.load()
FLIP = np.array([1.0, -1.0, 1.0])


def _sector(forward: float, outward: float, up: float) -> Floats:
    return ROBOT.gesture_origin + ROBOT.arm_length * np.array([forward, outward, up])


def _residual(turn: tuple[float, float, float], point: Floats) -> float:
    angles = np.zeros(len(ROBOT.skeleton.hinges))
    angles[list(ROBOT.joints("torso"))] = turn
    frames, arm = ROBOT.skeleton.frames(angles), ROBOT.arms["l"]
    base = ROBOT.skeleton.segment(arm.base)
    reach = Reach(frames.rotations[base].T @ (point - frames.origins[base]))
    return solve(arm, reach, start=arm.rest).residual


def test_the_torso_stays_upright_for_targets_in_easy_reach() -> None:
    hands: dict[Side, Floats] = {"l": _sector(0.65, 0.25, 0.25), "r": _sector(0.65, -0.25, 0.25)}
    assert lean_torso(ROBOT, hands) == (0.0, 0.0, 0.0)
    assert lean_torso(ROBOT, {}) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("sector", [(0.95, 0.25, 0.0), (0.65, 0.0, -0.3), (0.95, -0.25, 0.6), (0.4, 0.8, -0.5)])
def test_a_far_target_comes_into_reach(sector: tuple[float, float, float]) -> None:
    turn = lean_torso(ROBOT, {"l": _sector(*sector)})
    assert _residual((0.0, 0.0, 0.0), _sector(*sector)) > 0.005
    assert _residual(turn, _sector(*sector)) < 1e-3
    assert 0.0 < max(abs(angle) for angle in turn) < LARGEST_TURN


def test_two_hands_in_front_lean_forward_without_a_turn() -> None:
    point = _sector(0.95, 0.4, -0.1)
    torsion, tilt, roll = lean_torso(ROBOT, {"l": point, "r": point * FLIP})
    assert torsion == pytest.approx(0.0, abs=1e-9)
    assert roll == pytest.approx(0.0, abs=1e-9)
    assert tilt > 0.02


def test_the_mirror_image_turns_the_other_way() -> None:
    point = _sector(0.95, -0.1, 0.0)
    left, right = lean_torso(ROBOT, {"l": point}), lean_torso(ROBOT, {"r": point * FLIP})
    assert right == pytest.approx((-left[0], left[1], -left[2]), abs=1e-12)
    assert left[0] < -0.01


def test_a_further_target_asks_for_more_up_to_the_bound() -> None:
    leans = [lean_torso(ROBOT, {"l": _sector(forward, 0.3, 0.2)})[1] for forward in (0.9, 1.0, 1.1, 1.2)]
    assert leans == sorted(leans)
    assert max(abs(angle) for angle in lean_torso(ROBOT, {"l": _sector(9.0, 0.3, -4.0)})) == pytest.approx(LARGEST_TURN)
    assert max(abs(angle) for angle in lean_torso(ROBOT, {"l": _sector(9.0, 0.3, -4.0)}, most=0.1)) == pytest.approx(
        0.1
    )


def test_the_ranges_hold() -> None:
    joints = list(ROBOT.joints("torso"))
    turn = np.array(lean_torso(ROBOT, {"l": _sector(-5.0, 3.0, 2.0)}, most=3.0))
    assert np.all(ROBOT.skeleton.lower[joints] <= turn)
    assert np.all(turn <= ROBOT.skeleton.upper[joints])


def test_both_kernels_lean_alike() -> None:
    random, leans = np.random.default_rng(41), []
    sides: list[Side] = ["l", "r"]
    for k in range(60):
        shown = sides if k % 3 == 0 else sides[k % 2 :][:1]
        hands = {side: ROBOT.gesture_origin + 0.7 * ROBOT.arm_length * random.normal(size=3) for side in shown}
        leans.append(lean_torso(ROBOT, hands, kernel=KERNEL))
        assert leans[-1] == lean_torso(ROBOT, hands, kernel="numpy")
    assert sum(any(turn) for turn in leans) > 20


def test_a_target_that_is_no_point_is_refused() -> None:
    with pytest.raises(ValueError, match="hand l"):
        lean_torso(ROBOT, {"l": np.array([np.nan, 0.0, 0.0])})
