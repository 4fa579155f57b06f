import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.ik.solve import solve
from kinesic.ik.torso import MAX_TURN, lean_torso

DEFAULT_ROBOT = Robot.load()
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])  # signs that mirror a vector in the midline plane


def _sector(forward: float, outward: float, up: float) -> Floats:
    return DEFAULT_ROBOT.gesture_origin + DEFAULT_ROBOT.arm_length * np.array([forward, outward, up])


def _residual(turn: tuple[float, float, float], point: Floats) -> float:
    angles = np.zeros(len(DEFAULT_ROBOT.skeleton.hinges))
    angles[list(DEFAULT_ROBOT.joints("torso"))] = turn
    frames, arm = DEFAULT_ROBOT.skeleton.frames(angles), DEFAULT_ROBOT.arms["l"]
    base = DEFAULT_ROBOT.skeleton.segment(arm.base)
    reach = Reach(frames.rotations[base].T @ (point - frames.origins[base]))
    return solve(arm, reach, start=arm.rest).residual


def test_torso_stays_upright_for_targets_in_easy_reach() -> None:
    hands: dict[Side, Floats] = {"l": _sector(0.65, 0.25, 0.25), "r": _sector(0.65, -0.25, 0.25)}
    assert lean_torso(DEFAULT_ROBOT, hands) == (0.0, 0.0, 0.0)
    assert lean_torso(DEFAULT_ROBOT, {}) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("sector", [(0.95, 0.25, 0.0), (0.65, 0.0, -0.3), (0.95, -0.25, 0.6), (0.4, 0.8, -0.5)])
def test_torso_lean_brings_a_far_target_into_reach(sector: tuple[float, float, float]) -> None:
    turn = lean_torso(DEFAULT_ROBOT, {"l": _sector(*sector)})
    assert _residual((0.0, 0.0, 0.0), _sector(*sector)) > 0.005
    assert _residual(turn, _sector(*sector)) < 1e-3
    assert 0.0 < max(abs(angle) for angle in turn) < MAX_TURN


def test_two_hands_in_front_cause_lean_without_torsion() -> None:
    point = _sector(0.95, 0.4, -0.1)
    torsion, tilt, roll = lean_torso(DEFAULT_ROBOT, {"l": point, "r": point * MIRROR_SIGNS})
    assert torsion == pytest.approx(0.0, abs=1e-9)
    assert roll == pytest.approx(0.0, abs=1e-9)
    assert tilt > 0.02


def test_mirrored_hand_targets_mirror_the_torso_rotation() -> None:
    point = _sector(0.95, -0.1, 0.0)
    left, right = lean_torso(DEFAULT_ROBOT, {"l": point}), lean_torso(DEFAULT_ROBOT, {"r": point * MIRROR_SIGNS})
    assert right == pytest.approx((-left[0], left[1], -left[2]), abs=1e-12)
    assert left[0] < -0.01


def test_torso_rotation_grows_with_distance_up_to_its_bound() -> None:
    leans = [lean_torso(DEFAULT_ROBOT, {"l": _sector(forward, 0.3, 0.2)})[1] for forward in (0.9, 1.0, 1.1, 1.2)]
    assert leans == sorted(leans)
    assert max(abs(angle) for angle in lean_torso(DEFAULT_ROBOT, {"l": _sector(9.0, 0.3, -4.0)})) == pytest.approx(
        MAX_TURN
    )
    assert max(
        abs(angle) for angle in lean_torso(DEFAULT_ROBOT, {"l": _sector(9.0, 0.3, -4.0)}, max_turn=0.1)
    ) == pytest.approx(0.1)


def test_torso_angles_of_a_reach_stay_within_joint_ranges() -> None:
    joints = list(DEFAULT_ROBOT.joints("torso"))
    turn = np.array(lean_torso(DEFAULT_ROBOT, {"l": _sector(-5.0, 3.0, 2.0)}, max_turn=3.0))
    assert np.all(DEFAULT_ROBOT.skeleton.lower[joints] <= turn)
    assert np.all(turn <= DEFAULT_ROBOT.skeleton.upper[joints])


def test_nan_hand_target_of_the_torso_lean_raises_an_error() -> None:
    with pytest.raises(ValueError, match="hand l"):
        lean_torso(DEFAULT_ROBOT, {"l": np.array([np.nan, 0.0, 0.0])})
