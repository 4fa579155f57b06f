from itertools import pairwise

import numpy as np
import pytest

from kinesic.studies.sweep.geometry import count_visits, hull_volume, length, mean_curvature, peak_speed, rms_jerk

SAMPLE_PERIOD = 0.01  # [s] sample period of the paths
TIMES = np.arange(0.0, 2.0 + SAMPLE_PERIOD / 2, SAMPLE_PERIOD)


def curvature(path: np.ndarray) -> float | None:
    return mean_curvature(path, step=0.01)


def circle(radius: float, turns: float = 1.0) -> np.ndarray:
    angles = 2 * np.pi * turns * TIMES / TIMES[-1]
    return radius * np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)


def along(*places: tuple[float, float, float], count: int = 100) -> np.ndarray:
    """Sample straight lines between positions in equal steps."""
    legs = [np.linspace(a, b, count, endpoint=False) for a, b in pairwise(places)]
    return np.concatenate([*legs, [places[-1]]])


def test_peak_speed_and_length_of_a_straight_path_are_exact():
    path = along((0, 0, 0), (0.5, 0, 0))
    assert peak_speed(path, period=SAMPLE_PERIOD) == pytest.approx(0.5)
    assert length(path) == pytest.approx(0.5)
    assert peak_speed(path[:1], period=SAMPLE_PERIOD) == 0.0


def test_hull_volume_of_cube_corners_is_the_volume_of_the_cube():
    corners = np.array([[x, y, z] for x in (0, 0.2) for y in (0, 0.2) for z in (0, 0.2)])
    assert hull_volume(corners) == pytest.approx(0.008)
    inside = np.concatenate([corners, [[0.1, 0.1, 0.1]] * 5])
    assert hull_volume(inside) == pytest.approx(0.008)


@pytest.mark.parametrize(
    "path",
    [
        np.zeros((50, 3)),
        along((0, 0, 0), (1, 1, 1)),
        circle(0.2),
        np.zeros((3, 3)),
        circle(0.2) + 1e-7 * TIMES[:, None],
    ],
    ids=["point", "line", "plane", "three points", "nearly a plane"],
)
def test_hand_paths_in_a_plane_have_no_volume(path):
    assert hull_volume(path) == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("radius", [0.1, 0.2, 0.4])
def test_mean_curvature_of_a_circular_path_is_one_over_its_radius(radius):
    assert curvature(circle(radius, 3)) == pytest.approx(1 / radius, rel=0.03)


def test_curvature_of_a_hand_path_is_independent_of_speed_and_stops():
    path = circle(0.2)
    waiting = np.concatenate([path[:70], np.repeat(path[70:71], 300, axis=0), path[70:]])
    uneven = circle(0.2)[np.unique((np.linspace(0, 1, 200) ** 2 * (len(TIMES) - 1)).astype(int))]
    assert curvature(waiting) == pytest.approx(curvature(path), rel=1e-6)
    assert curvature(uneven) == pytest.approx(curvature(path), rel=0.02)


def test_straight_hand_path_has_no_curvature_and_each_reversal_adds_pi():
    assert curvature(along((0, 0, 0), (0.5, 0, 0))) == pytest.approx(0.0, abs=1e-6)
    assert curvature(along((0, 0, 0), (0.5, 0, 0), (0, 0, 0))) == pytest.approx(np.pi, rel=0.05)  # over 1 m
    assert curvature(along((0, 0, 0), (0.5, 0, 0), (0.5, 0.5, 0))) == pytest.approx(np.pi / 2, rel=0.05)


def test_curvature_of_short_reversals_of_a_hand_path_hardly_depends_on_the_path_start():
    results = [
        curvature(along((-offset, 0, 0), (0.2, 0, 0), (0.193, 0, 0), (0.193, 0.1, 0)))
        for offset in np.arange(0.0, 0.01, 0.001)
    ]
    assert min(results) > 0.0
    assert max(results) - min(results) < 0.1 * max(results)


def test_hand_motion_below_the_minimum_size_has_no_curvature():
    assert curvature(np.zeros((10, 3))) is None
    assert curvature(along((0, 0, 0), (0.03, 0, 0))) is None


def test_sinusoidal_path_has_its_analytic_jerk():
    """Compare the jerk of a sine with its formula, also with 40 Hz vibration."""
    swing = 0.1 * np.stack([np.sin(2 * np.pi * TIMES), 0 * TIMES, 0 * TIMES], axis=1)
    wanted = 0.1 * (2 * np.pi) ** 3 / np.sqrt(2)
    assert rms_jerk(swing, period=SAMPLE_PERIOD) == pytest.approx(wanted, rel=0.05)
    ticks = 1e-4 * np.sin(2 * np.pi * 40 * TIMES)[:, None]
    raw = np.diff(swing + ticks, n=3, axis=0) / SAMPLE_PERIOD**3
    assert np.sqrt((raw**2).sum(axis=1).mean()) > 10 * wanted
    assert rms_jerk(swing + ticks, period=SAMPLE_PERIOD) == pytest.approx(wanted, rel=0.15)


def test_rms_jerk_of_a_path_with_too_few_samples_is_zero():
    assert rms_jerk(np.zeros((5, 3)), period=SAMPLE_PERIOD) == 0.0


def test_visits_of_the_hand_to_a_position_count_only_after_leaving_the_position():
    far, place = (0.2, 0, 0), (0, 0, 0)
    path = along(far, place, far, place, far)
    assert count_visits(path, np.zeros(3), near=0.05, far=0.1) == 2
    trembling = along(far, place, (0.06, 0, 0), place, (0.06, 0, 0), place)
    assert count_visits(trembling, np.zeros(3), near=0.05, far=0.1) == 1
    assert count_visits(along(far, (0.1, 0, 0)), np.zeros(3), near=0.05, far=0.1) == 0
