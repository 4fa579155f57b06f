import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.solve import Solution, as_floats, solve, solve_path

DEFAULT_ROBOT = Robot.load()
LEFT_ARM = DEFAULT_ROBOT.arms["l"]  # chain of the left arm
RIGHT_ARM = DEFAULT_ROBOT.arms["r"]  # chain of the right arm
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])  # signs that mirror a vector in the midline plane

# gesture space in arm lengths: forward, outward, up
SECTOR_DEPTHS = {"near": 0.4, "middle": 0.65, "far": 0.95}  # [arm lengths] forward position by sector
SECTOR_OFFSETS = (0.8, 0.5, 0.25, 0.0, -0.25)  # [arm lengths] outward positions of sectors
SECTOR_HEIGHTS = (1.2, 0.9, 0.6, 0.25, 0.0, -0.3, -0.5)  # [arm lengths] heights of sectors above the elbow
# rows by height, columns by outward position; #: reached without the torso
REACHED_SECTORS = {
    "near": ("#####", "#####", "#####", "#####", "#### ", "#### ", "     "),
    "middle": ("#####", "#####", "#####", "#####", "#### ", " ##  ", "     "),
    "far": ("     ", " ### ", "#### ", " ### ", "     ", "     ", "     "),
}


def _in_base(point: Floats) -> Floats:
    frames = DEFAULT_ROBOT.skeleton.frames(np.zeros(len(DEFAULT_ROBOT.skeleton.hinges)))
    return np.subtract(point, frames.origins[DEFAULT_ROBOT.skeleton.segment(LEFT_ARM.base)])


def _check(solution: Solution, position: Floats) -> None:
    assert np.all(LEFT_ARM.lower <= solution.angles)
    assert np.all(solution.angles <= LEFT_ARM.upper)
    assert solution.residual == pytest.approx(np.linalg.norm(LEFT_ARM.hand(solution.angles) - position), abs=1e-12)
    assert solution.reached == (solution.residual <= 1e-3)


def test_over_99_percent_of_targets_of_random_postures_are_reached_from_rest() -> None:
    random, reached, precise = default_rng(12), 0, 0
    for _ in range(400):
        position = LEFT_ARM.hand(random.uniform(LEFT_ARM.lower, LEFT_ARM.upper))
        solution = solve(LEFT_ARM, Reach(position), start=LEFT_ARM.rest)
        _check(solution, position)
        reached += solution.reached
        precise += solution.residual < 1e-4
    assert reached >= 0.995 * 400
    assert precise >= 0.99 * 400


def test_ik_reaches_targets_from_straight_or_limit_start_postures() -> None:
    random = default_rng(13)
    for start in (np.zeros(8), LEFT_ARM.lower, LEFT_ARM.upper):
        for _ in range(40):
            position = LEFT_ARM.hand(random.uniform(LEFT_ARM.lower, LEFT_ARM.upper))
            assert solve(LEFT_ARM, Reach(position), start=start).reached


@pytest.mark.parametrize("depth", list(SECTOR_DEPTHS))
def test_gesture_space_sectors_marked_as_reached_are_reached_within_2_cm_without_the_torso(depth: str) -> None:
    for row, up in zip(REACHED_SECTORS[depth], SECTOR_HEIGHTS, strict=True):
        for mark, out in zip(row, SECTOR_OFFSETS, strict=True):
            point = DEFAULT_ROBOT.gesture_origin + DEFAULT_ROBOT.arm_length * np.array([SECTOR_DEPTHS[depth], out, up])
            solution = solve(LEFT_ARM, Reach(_in_base(point)), start=LEFT_ARM.rest)
            assert mark != "#" or solution.residual < 0.02, (depth, up, out)


def test_repeated_ik_calls_with_directions_give_the_same_solution() -> None:
    reach = Reach(np.array([-0.1, 0.3, 0.2]), pointing=np.array([0.0, 1.0, 0.0]), palm=np.array([0.0, 0.0, 1.0]))
    one, two = (solve(LEFT_ARM, reach, start=LEFT_ARM.rest) for _ in range(2))
    assert one.angles.tobytes() == two.angles.tobytes()
    assert one.iterations == two.iterations


def test_ik_stretches_the_arm_towards_an_unreachable_target() -> None:
    position = np.array([3.0, 1.0, 0.5])
    solution = solve(LEFT_ARM, Reach(position), start=LEFT_ARM.rest)
    _check(solution, position)
    shoulder, elbow, hand = LEFT_ARM.frames(solution.angles)[1][1:4]
    upper, fore = elbow - shoulder, hand - elbow
    aim = (position - shoulder) / np.linalg.norm(position - shoulder)
    assert not solution.reached
    assert aim @ (hand - shoulder) / np.linalg.norm(hand - shoulder) > 1 - 1e-6
    assert upper @ fore / np.linalg.norm(upper) / np.linalg.norm(fore) > 0.99
    assert np.linalg.norm(hand - solution.target) < 1e-3


@pytest.mark.parametrize("position", [[0, 0.155, -0.035], [0, 0, 0], [1e6, -1e6, 1e6], [-2, -2, 0], [0, 0.155, 0.38]])
def test_ik_returns_finite_solutions_for_degenerate_targets(position: list[float]) -> None:
    solution = solve(LEFT_ARM, Reach(np.array(position, dtype=float)), start=LEFT_ARM.rest)
    _check(solution, np.array(position))
    assert np.isfinite(solution.residual)


def test_collar_bone_stays_at_rest_for_targets_within_easy_reach() -> None:
    for out in (0.0, 0.25, 0.5):
        point = DEFAULT_ROBOT.gesture_origin + DEFAULT_ROBOT.arm_length * np.array([0.65, out, 0.25])
        assert solve(LEFT_ARM, Reach(_in_base(point)), start=LEFT_ARM.rest).angles[0] == pytest.approx(
            LEFT_ARM.rest[0], abs=1e-9
        )


def test_ik_meets_a_requested_elbow_swivel_within_the_joint_ranges() -> None:
    position, results = np.array([0.25, 0.15, -0.05]), []
    for wished in (-0.5, 0.0, 0.5, 1.0, 1.5, 3.0):
        solution = solve(LEFT_ARM, Reach(position, swivel=wished), start=LEFT_ARM.rest)
        assert solution.residual < 1e-6
        results.append(swivel(LEFT_ARM, solution.angles))
    assert results[:5] == pytest.approx([-0.5, 0.0, 0.5, 1.0, 1.5], abs=1e-6)
    assert results[5] is not None
    assert 1.5 < results[5] < 3.0


def test_ik_without_a_requested_swivel_lets_the_elbow_hang() -> None:
    for out in (0.0, 0.25, 0.5):
        point = DEFAULT_ROBOT.gesture_origin + DEFAULT_ROBOT.arm_length * np.array([0.5, out, 0.25])
        solution = solve(LEFT_ARM, Reach(_in_base(point)), start=LEFT_ARM.rest)
        shoulder, elbow, hand = LEFT_ARM.frames(solution.angles)[1][1:4]
        assert elbow[2] < min(shoulder[2], hand[2])
        assert 0.0 < (swivel(LEFT_ARM, solution.angles) or 0.0) < 0.8


def test_reported_pointing_and_palm_errors_match_the_solved_posture() -> None:
    random = default_rng(14)
    for _ in range(30):
        angles = random.uniform(LEFT_ARM.lower, LEFT_ARM.upper)
        rotations, centres = LEFT_ARM.frames(angles)
        pointing = (centres[-1] - centres[-2]) / np.linalg.norm(centres[-1] - centres[-2])
        reach = Reach(centres[-2], pointing=pointing, palm=rotations[-1] @ LEFT_ARM.palm)
        solution = solve(LEFT_ARM, reach, start=angles)
        frames, points = LEFT_ARM.frames(solution.angles)
        along = (points[-1] - points[-2]) / np.linalg.norm(points[-1] - points[-2])
        assert solution.pointing_error == pytest.approx(np.arccos(min(1.0, along @ pointing)), abs=1e-6)
        assert solution.palm_error == pytest.approx(
            np.arccos(np.clip((frames[-1] @ LEFT_ARM.palm) @ reach.palm, -1, 1)), abs=1e-6
        )


def test_ik_without_requested_directions_keeps_the_wrist_at_rest_and_reports_no_errors() -> None:
    solution = solve(LEFT_ARM, Reach(np.array([0.25, 0.15, -0.05])), start=LEFT_ARM.upper)
    assert solution.pointing_error is None
    assert solution.palm_error is None
    assert np.array_equal(solution.angles[5:], LEFT_ARM.rest[5:])


def test_close_ik_targets_give_close_postures() -> None:
    angles, laps = LEFT_ARM.rest, []
    for step in range(160):
        turn = 2 * np.pi * step / 80
        before = angles
        position = np.array([0.25, 0.1 + 0.18 * np.cos(turn), -0.05 + 0.15 * np.sin(turn)])
        angles = solve(LEFT_ARM, Reach(position), start=angles).angles
        assert step == 0 or np.abs(angles - before).max() < 0.2
        laps.append(angles)
    assert np.abs(laps[79] - laps[159]).max() < 0.01


def test_ik_solution_of_the_right_arm_mirrors_the_left() -> None:
    random = default_rng(15)
    for _ in range(60):
        position, pointing, palm = random.uniform(-0.5, 0.5, 3), random.normal(size=3), random.normal(size=3)
        left = solve(LEFT_ARM, Reach(position, pointing=pointing, palm=palm, swivel=0.5), start=LEFT_ARM.rest)
        mirrored = Reach(
            position * MIRROR_SIGNS, pointing=pointing * MIRROR_SIGNS, palm=palm * MIRROR_SIGNS, swivel=0.5
        )
        right = solve(RIGHT_ARM, mirrored, start=RIGHT_ARM.rest)
        assert np.abs(left.angles - right.angles).max() < 1e-9


def test_ik_uses_a_given_rest_posture_and_accepts_a_joint_mobility_of_zero() -> None:
    rest = LEFT_ARM.rest.copy()
    rest[5] = 0.4
    reach = Reach(np.array([0.25, 0.15, -0.05]))
    assert solve(LEFT_ARM, reach, start=LEFT_ARM.rest, rest=rest).angles[5] == 0.4
    still = np.array([0.0, *[1.0] * 7])
    far = Reach(LEFT_ARM.hand(np.array([0.4, 1.5, 0.3, 0.2, 0.01, 0, 0, 0])))
    assert np.all(np.isfinite(solve(LEFT_ARM, far, start=LEFT_ARM.rest, mobility=still).angles))


def test_invalid_ik_arguments_raise_clear_errors() -> None:
    good = np.array([0.3, 0.2, 0.0])
    with pytest.raises(ValueError, match=r"reach.position is .*nan.*finite"):
        solve(LEFT_ARM, Reach(np.array([np.nan, 0, 0])), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"reach.position has shape \(2,\).*\(3,\)"):
        solve(LEFT_ARM, Reach(np.zeros(2)), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"start has shape \(7,\).*\(8,\)"):
        solve(LEFT_ARM, Reach(good), start=np.zeros(7))
    with pytest.raises(ValueError, match=r"reach\.palm is the null vector"):
        solve(LEFT_ARM, Reach(good, palm=np.zeros(3)), start=LEFT_ARM.rest)
    with pytest.raises(ValueError, match=r"reach\.swivel is"):
        solve(LEFT_ARM, Reach(good, swivel=np.inf), start=LEFT_ARM.rest)


def test_ik_clips_and_reports_a_start_posture_outside_the_ranges() -> None:
    chain = Robot.load().arms["l"]
    start = chain.rest.copy()
    start[2] = chain.upper[2] + 0.3
    outside = solve(chain, Reach(chain.hand(chain.rest)), start=start)
    assert outside.pulled_in == pytest.approx(0.3)
    assert np.all((chain.lower <= outside.angles) & (outside.angles <= chain.upper))
    assert solve(chain, Reach(chain.hand(chain.rest)), start=chain.rest).pulled_in == 0.0


def test_integer_ik_inputs_become_float64():
    assert as_floats("place", [1, 2, 3], (3,)).dtype == np.float64


def test_ik_input_arrays_of_wrong_shape_or_value_raise_clear_errors():
    with pytest.raises(ValueError, match=r"place has shape \(2,\); it needs shape \(3,\)"):
        as_floats("place", np.zeros(2), (3,))
    with pytest.raises(ValueError, match=r"place is \[inf, 0.0\]; every number must be finite"):
        as_floats("place", np.array([np.inf, 0.0]), (2,))


def test_solved_path_equals_single_solutions_that_each_start_from_the_previous_one() -> None:
    angles = default_rng(4).uniform(RIGHT_ARM.lower, RIGHT_ARM.upper, (6, len(RIGHT_ARM.rest)))
    targets, swivels = np.array([RIGHT_ARM.hand(posture) for posture in angles]), np.linspace(-0.5, 1.0, 6)
    posture, expected = RIGHT_ARM.rest, []
    for k in (0, 0, 0, 1, 2, 3, 4, 5):  # the first target is solved three times
        posture = solve(RIGHT_ARM, Reach(targets[k], swivel=float(swivels[k])), start=posture).angles
        expected.append(posture)
    solved = solve_path(RIGHT_ARM, targets, swivels, start=RIGHT_ARM.rest, settling=2)
    np.testing.assert_array_equal(solved, expected[2:])


def test_path_with_an_infinite_target_or_missing_swivels_is_rejected() -> None:
    targets, swivels = np.tile(LEFT_ARM.hand(LEFT_ARM.rest), (3, 1)), np.zeros(3)
    with pytest.raises(ValueError, match="finite"):
        solve_path(LEFT_ARM, targets * [1.0, np.inf, 1.0], swivels, start=LEFT_ARM.rest, settling=0)
    with pytest.raises(ValueError, match="shapes are targets"):
        solve_path(LEFT_ARM, targets, swivels[:2], start=LEFT_ARM.rest, settling=0)
