from typing import get_args

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.lexicon.paths import PathKind, shape_path

START_POSITION, END_POSITION = sealed([0.6, 0.3, 0.45]), sealed([0.5, 0.5, 0.3])
VIA_POINTS = (sealed([0.5, 0.4, 0.1]), sealed([0.6, 0.5, 0.25]))


def path(kind, **given):
    return shape_path(kind, **given, **({"points": VIA_POINTS} if kind == "points" else {}))


@pytest.mark.parametrize("kind", get_args(PathKind))
def test_hand_path_begins_and_ends_exactly_at_its_key_positions(kind):
    ends = path(kind).at(START_POSITION, END_POSITION, np.array([0.0, 1.0]))
    np.testing.assert_allclose(ends, [START_POSITION, END_POSITION], atol=1e-12)


def test_straight_hand_path_needs_no_intermediate_samples():
    line = path("line")
    np.testing.assert_allclose(
        line.at(START_POSITION, END_POSITION, np.array([0.25])),
        [START_POSITION + 0.25 * (END_POSITION - START_POSITION)],
    )
    assert line.samples(START_POSITION, END_POSITION, 1e-9).size == 0
    assert line.length(START_POSITION, END_POSITION) == pytest.approx(np.linalg.norm(END_POSITION - START_POSITION))


def test_circular_hand_path_has_constant_radius():
    circle = path("circle", amplitude=0.2)
    points = circle.at(START_POSITION, START_POSITION, np.linspace(0, 1, 101))
    centre = START_POSITION - [0, 0, 0.2]
    np.testing.assert_allclose(np.linalg.norm(points - centre, axis=1), 0.2, atol=1e-12)
    assert circle.length(START_POSITION, START_POSITION) == pytest.approx(2 * np.pi * 0.2, rel=1e-3)
    assert circle.swings(START_POSITION, START_POSITION) == 2
    assert points[10, 1] > START_POSITION[1]  # outward first


def test_circular_hand_path_may_lie_in_another_plane():
    circle = path("circle", amplitude=(0.0, 0.1, 0.1))  # up and forward
    points = circle.at(START_POSITION, START_POSITION, np.linspace(0, 1, 101))
    assert np.ptp(points[:, 1]) == 0
    np.testing.assert_allclose(np.ptp(points[:, [0, 2]], axis=0), 0.2, atol=1e-3)


def test_arc_shaped_hand_path_peaks_in_the_middle():
    middle = path("arc").at(START_POSITION, END_POSITION, np.array([0.5]))[0]
    np.testing.assert_allclose(middle, (START_POSITION + END_POSITION) / 2 + [0, 0, 0.12])


def test_wave_shaped_hand_path_alternates_outward_and_inward():
    out = (
        path("wave", frequency=3.0).at(START_POSITION, START_POSITION, np.array([1, 3, 5]) / 12)[:, 1]
        - START_POSITION[1]
    )
    np.testing.assert_allclose(out, [0.12, -0.12, 0.12], atol=1e-12)


def test_radius_of_a_spiral_path_grows():
    away = np.abs(path("spiral").at(START_POSITION, START_POSITION, np.array([1, 9]) / 16)[:, 1] - START_POSITION[1])
    assert away[1] > 5 * away[0] > 0


@pytest.mark.parametrize(
    ("kind", "amplitude", "frequency", "shift", "variation"),
    [
        ("arc", (0.0, 0.12, 0.0), 0.5, (0.0, 0.0, 0.0), "none"),
        ("circle", (0.12, 0.12, 0.0), 1.0, (0.0, 0.25, 0.0), "none"),
        ("wave", (0.12, 0.0, 0.0), 2.0, (0.0, 0.0, 0.0), "none"),
        ("spiral", (0.15, 0.15, 0.0), 2.0, (0.0, 0.25, 0.0), "grows"),
    ],
)
def test_hand_path_without_parameters_has_the_documented_defaults(kind, amplitude, frequency, shift, variation):
    explicit = path(kind, amplitude=amplitude, frequency=frequency, shift=shift, variations=(variation, "none"))
    times = np.linspace(0, 1, 33)
    np.testing.assert_array_equal(
        path(kind).at(START_POSITION, END_POSITION, times), explicit.at(START_POSITION, END_POSITION, times)
    )


@pytest.mark.parametrize(("kind", "radius"), [("circle", 0.12), ("spiral", 0.15)])
def test_circle_and_spiral_paths_are_as_wide_as_high(kind, radius):
    turn = path(kind, variations=("none", "none")).at(START_POSITION, START_POSITION, np.linspace(0, 1, 801))
    np.testing.assert_allclose(np.ptp(turn, axis=0), [0.0, 2 * radius, 2 * radius], atol=1e-4)


@pytest.mark.parametrize("variation", ["grows", "shrinks"])
def test_varying_wave_frequency_of_a_hand_path_is_at_most_doubled(variation):
    wave = path("wave", frequency=4.0, variations=(None, variation))
    times = np.linspace(0, 1, 4001)
    out = wave.at(START_POSITION, START_POSITION, times)[:, 1] - START_POSITION[1]
    swings = [int(np.sum(np.diff(np.sign(half[np.abs(half) > 1e-6])) != 0)) for half in (out[:2000], out[2000:])]
    assert (swings[0] < swings[1]) == (variation == "grows")
    assert np.abs(np.gradient(out, times)).max() <= 0.12 * 2 * np.pi * 2 * 4.0


def test_path_of_via_points_passes_all_of_them_at_constant_speed():
    free = path("points")
    curve = free.at(START_POSITION, END_POSITION, np.linspace(0, 1, 1001))
    for point in VIA_POINTS:
        assert np.linalg.norm(curve - point, axis=1).min() < 1e-3
    steps = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    assert steps.max() < 1.05 * steps.min()


def test_zigzag_path_of_six_points_has_5_to_7_swings():
    zigzag = tuple(sealed([0.5, 0.3 + 0.1 * (k % 2), 0.4]) for k in range(6))
    assert shape_path("points", points=zigzag).swings(START_POSITION, END_POSITION) in (5, 6, 7)


@pytest.mark.parametrize("kind", get_args(PathKind))
def test_hand_path_deviates_from_chords_between_its_samples_by_at_most_the_tolerance(kind):
    made = path(kind)
    coarse, fine = (made.samples(START_POSITION, END_POSITION, tolerance) for tolerance in (0.02, 0.001))
    assert len(fine) >= len(coarse)
    assert np.all(np.diff([0.0, *fine, 1.0]) > 0)
    knots = np.array([0.0, *fine, 1.0])
    shares = np.linspace(0, 1, 2001)
    chords = np.column_stack(
        [np.interp(shares, knots, column) for column in made.at(START_POSITION, END_POSITION, knots).T]
    )
    assert np.linalg.norm(made.at(START_POSITION, END_POSITION, shares) - chords, axis=1).max() < 0.0015


def test_extrema_of_a_wave_path_are_sampled_even_if_its_amplitude_is_below_the_tolerance():
    small = path("wave", amplitude=0.01, frequency=5.0)
    shares = small.samples(START_POSITION, START_POSITION, 0.5)
    assert len(shares) == 4 * 5 - 1
    np.testing.assert_allclose(
        np.abs(small.at(START_POSITION, START_POSITION, shares[::2])[:, 1] - START_POSITION[1]), 0.01, rtol=1e-4
    )


def test_slowed_wave_path_has_fewer_periods_and_the_same_amplitude():
    wave = path("wave", frequency=6.0)
    assert wave.slowed(2.0).turns == 2.0
    assert wave.slowed(8.0) is wave
    np.testing.assert_array_equal(wave.slowed(2.0).amplitude, wave.amplitude)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kind": "line", "amplitude": 0.1}, "a line path has no amplitude"),
        ({"kind": "points"}, "has no points, give at least one as \\[outward, up, forward\\]"),
        ({"kind": "wave", "points": VIA_POINTS}, "kind = 'points' goes through points"),
        ({"kind": "circle", "amplitude": 1.5}, "outside \\[-1, 1\\] arm lengths"),
        ({"kind": "wave", "frequency": 30.0}, "outside \\[0, 12\\] turns"),
        ({"kind": "wave", "frequency": -1.0}, "outside \\[0, 12\\] turns"),
        ({"kind": "wave", "amplitude": (0.0, 0.0, 0.0)}, "write kind = 'line'"),
        ({"kind": "arc", "amplitude": float("nan")}, "amplitude is"),
    ],
)
def test_invalid_hand_path_parameters_are_refused(given, said):
    with pytest.raises(ValueError, match=said):
        shape_path(**given)
