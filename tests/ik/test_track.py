from collections.abc import Callable

import numpy as np
import pytest

from kinesic.bench.ik.tracking import damped_least_squares, jerk
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.track import Tracker

from ..reference.ik import track as reference
from ..reference.ik.track import SOFT_FRACTION

DEFAULT_ROBOT = Robot.load()
LEFT_ARM = DEFAULT_ROBOT.arms["l"]  # chain of the left arm
RIGHT_ARM = DEFAULT_ROBOT.arms["r"]  # chain of the right arm
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])  # signs that mirror a vector in the midline plane
LAP_DURATION = 2.5  # [s] duration of one lap of the path
Path = Callable[[float], Floats]


def _ellipse(turn: float) -> Floats:
    """Return an elliptical path of 0.24 x 0.36 m, before the robot."""
    return np.array([0.28, 0.1 + 0.12 * np.cos(turn), -0.05 + 0.18 * np.sin(turn)])


def _radial(turn: float) -> Floats:
    """Return a straight path to the side, beyond reach, and back."""
    return np.array([0.1, 0.155 + 0.45 - 0.2 * np.cos(turn), 0.05])


def _laps(
    path: Path,
    rate: int,
    *,
    laps: int = 2,
    chain: Chain = LEFT_ARM,
    posture_seconds: float = 0.25,
    follow: type[Tracker] = Tracker,
) -> Floats:
    """Return the angles [rad], (laps, steps of one lap, k)."""
    tracker = follow(chain, period=1 / rate, posture_seconds=posture_seconds)
    steps = round(LAP_DURATION * rate)
    turns = 2 * np.pi * np.arange(steps) / steps
    return np.array([[tracker.step(path(turn)) for turn in turns] for _ in range(laps)])


def test_tracker_follows_a_closed_path_and_returns_to_the_same_posture() -> None:
    first, second = _laps(_ellipse, 100)
    for step, row in enumerate(second):
        target = _ellipse(2 * np.pi * step / len(second))
        assert np.linalg.norm(LEFT_ARM.hand(row) - target) < 1e-4
        assert np.all((LEFT_ARM.lower <= row) & (row <= LEFT_ARM.upper))
    assert np.abs(first[-1] - second[-1]).max() < 0.01


@pytest.mark.parametrize("rate", [50, 1000])
def test_tracked_path_at_50_and_1000_hz_matches_that_at_200_hz_within_1_percent(rate: int) -> None:
    reference = _laps(_ellipse, 200)[1][::4]
    other = _laps(_ellipse, rate)[1][:: rate // 50]
    assert np.abs(other - reference).max() < 0.01 * np.ptp(reference, axis=0).max()


def test_tracked_posture_drifts_from_lap_to_lap_without_attraction_to_rest() -> None:
    first, second = _laps(_ellipse, 100, posture_seconds=np.inf)
    assert np.abs(first[-1] - second[-1]).max() > 0.05


def test_tracking_is_smoother_than_damped_least_squares() -> None:
    assert (
        jerk(_laps(_ellipse, 200), 200)
        <= jerk(damped_least_squares(LEFT_ARM, _ellipse, round(LAP_DURATION * 200), 2), 200) / 50
    )


def test_tracker_posture_is_continuous_beyond_full_arm_stretch() -> None:
    laps = _laps(_radial, 200, laps=1)[0]
    steps = np.abs(np.diff(laps[100:], axis=0)).max()
    assert steps < 0.06
    assert np.all((LEFT_ARM.lower <= laps) & (laps <= LEFT_ARM.upper))


def test_tracker_residual_grows_only_beyond_the_easy_reach() -> None:
    linkage = linkage_of(LEFT_ARM)
    tracker = Tracker(LEFT_ARM, period=0.02)
    for share in np.linspace(0.5, 1.1, 100):
        target = np.array(linkage.walk(LEFT_ARM.rest.tolist(), 1)[1][-1]) + share * linkage.farthest * np.array(
            [1, 0, 0]
        )
        angles = tracker.step(target)
        assert tracker.residual == pytest.approx(np.linalg.norm(LEFT_ARM.hand(angles) - target), abs=1e-9)
        assert share > 1 - SOFT_FRACTION or tracker.residual < 1e-6
    assert tracker.residual > 0.05 * linkage.farthest


def test_tracker_starts_with_low_joint_velocities() -> None:
    start = LEFT_ARM.rest + 0.3
    tracker, target = (
        Tracker(LEFT_ARM, period=0.005, start=start),
        LEFT_ARM.hand(np.clip(LEFT_ARM.rest + 0.3, LEFT_ARM.lower, LEFT_ARM.upper)),
    )
    rows = np.array([np.clip(start, LEFT_ARM.lower, LEFT_ARM.upper), *(tracker.step(target) for _ in range(400))])
    speeds = np.abs(np.diff(rows, axis=0)).max(axis=1) / 0.005
    assert speeds[0] < 0.01
    assert speeds.max() < 1.5


def test_tracked_motion_of_the_right_arm_mirrors_the_left() -> None:
    left = _laps(_ellipse, 50, laps=1)
    right = _laps(lambda turn: _ellipse(turn) * MIRROR_SIGNS, 50, laps=1, chain=RIGHT_ARM)
    assert left == pytest.approx(right, abs=1e-9)


@pytest.mark.parametrize("path", [_ellipse, _radial])
def test_compiled_arm_tracker_steps_equal_the_python_reference(path: Path) -> None:
    for chain in (LEFT_ARM, RIGHT_ARM):
        specified, compiled = (
            _laps(path, 50, laps=1, chain=chain, follow=follow) for follow in (reference.Tracker, Tracker)
        )
        assert compiled == pytest.approx(specified, abs=1e-9)


def test_each_tracker_step_returns_a_new_array() -> None:
    tracker = Tracker(LEFT_ARM, period=0.01)
    one = tracker.step(_ellipse(0.0))
    kept = one.copy()
    one[:] = 0.0
    assert np.abs(tracker.step(_ellipse(0.0)) - kept).max() < 0.1


def test_invalid_tracker_arguments_raise_clear_errors() -> None:
    with pytest.raises(ValueError, match="period is 0"):
        Tracker(LEFT_ARM, period=0.0)
    with pytest.raises(ValueError, match="8 finite numbers"):
        Tracker(LEFT_ARM, period=0.01, start=np.zeros(3))
    with pytest.raises(ValueError, match="three finite numbers"):
        Tracker(LEFT_ARM, period=0.01).step(np.array([np.nan, 0.0, 0.0]))
