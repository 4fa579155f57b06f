from typing import get_args

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.lexicon.paths import PathKind, shape_path

START, END = sealed([0.6, 0.3, 0.45]), sealed([0.5, 0.5, 0.3])
POINTS = (sealed([0.5, 0.4, 0.1]), sealed([0.6, 0.5, 0.25]))


def path(kind, **given):
    return shape_path(kind, **given, **({"points": POINTS} if kind == "points" else {}))


@pytest.mark.parametrize("kind", get_args(PathKind))
def test_a_path_begins_and_ends_exactly_at_its_keys(kind):
    ends = path(kind).at(START, END, np.array([0.0, 1.0]))
    np.testing.assert_allclose(ends, [START, END], atol=1e-12)


def test_a_line_is_straight_and_needs_no_samples():
    line = path("line")
    np.testing.assert_allclose(line.at(START, END, np.array([0.25])), [START + 0.25 * (END - START)])
    assert line.samples(START, END, 1e-9).size == 0
    assert line.length(START, END) == pytest.approx(np.linalg.norm(END - START))


def test_a_circle_is_a_circle():
    circle = path("circle", amplitude=0.2)
    points = circle.at(START, START, np.linspace(0, 1, 101))
    centre = START - [0, 0, 0.2]
    np.testing.assert_allclose(np.linalg.norm(points - centre, axis=1), 0.2, atol=1e-12)
    assert circle.length(START, START) == pytest.approx(2 * np.pi * 0.2, rel=1e-3)
    assert circle.swings(START, START) == 2
    assert points[10, 1] > START[1]  # outward first


def test_a_circle_in_another_plane_is_one_too():
    circle = path("circle", amplitude=(0.0, 0.1, 0.1))  # up and forward
    points = circle.at(START, START, np.linspace(0, 1, 101))
    assert np.ptp(points[:, 1]) == 0
    np.testing.assert_allclose(np.ptp(points[:, [0, 2]], axis=0), 0.2, atol=1e-3)


def test_an_arc_goes_up_and_comes_down():
    middle = path("arc").at(START, END, np.array([0.5]))[0]
    np.testing.assert_allclose(middle, (START + END) / 2 + [0, 0, 0.12])


def test_a_wave_swings_outward_and_inward():
    out = path("wave", frequency=3.0).at(START, START, np.array([1, 3, 5]) / 12)[:, 1] - START[1]
    np.testing.assert_allclose(out, [0.12, -0.12, 0.12], atol=1e-12)


def test_a_spiral_grows():
    away = np.abs(path("spiral").at(START, START, np.array([1, 9]) / 16)[:, 1] - START[1])
    assert away[1] > 5 * away[0] > 0


@pytest.mark.parametrize("variation", ["grows", "shrinks"])
def test_frequency_varies_along_the_way_and_is_never_more_than_twice_as_high(variation):
    wave = path("wave", frequency=4.0, variations=(None, variation))
    times = np.linspace(0, 1, 4001)
    out = wave.at(START, START, times)[:, 1] - START[1]
    swings = [int(np.sum(np.diff(np.sign(half[np.abs(half) > 1e-6])) != 0)) for half in (out[:2000], out[2000:])]
    assert (swings[0] < swings[1]) == (variation == "grows")
    assert np.abs(np.gradient(out, times)).max() <= 0.12 * 2 * np.pi * 2 * 4.0


def test_free_points_are_passed_and_at_even_speed():
    free = path("points")
    curve = free.at(START, END, np.linspace(0, 1, 1001))
    for point in POINTS:
        assert np.linalg.norm(curve - point, axis=1).min() < 1e-3
    steps = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    assert steps.max() < 1.05 * steps.min()


def test_a_zigzag_turns_as_often_as_it_does():
    zigzag = tuple(sealed([0.5, 0.3 + 0.1 * (k % 2), 0.4]) for k in range(6))
    assert shape_path("points", points=zigzag).swings(START, END) in (5, 6, 7)


@pytest.mark.parametrize("kind", get_args(PathKind))
def test_samples_are_as_close_as_the_curve_needs(kind):
    made = path(kind)
    coarse, fine = (made.samples(START, END, tolerance) for tolerance in (0.02, 0.001))
    assert len(fine) >= len(coarse)
    assert np.all(np.diff([0.0, *fine, 1.0]) > 0)
    knots = np.array([0.0, *fine, 1.0])
    shares = np.linspace(0, 1, 2001)
    chords = np.column_stack([np.interp(shares, knots, column) for column in made.at(START, END, knots).T])
    assert np.linalg.norm(made.at(START, END, shares) - chords, axis=1).max() < 0.0015


def test_every_turn_is_sampled_where_it_is_farthest_out_however_small():
    small = path("wave", amplitude=0.01, frequency=5.0)
    shares = small.samples(START, START, 0.5)
    assert len(shares) == 4 * 5 - 1
    np.testing.assert_allclose(np.abs(small.at(START, START, shares[::2])[:, 1] - START[1]), 0.01, rtol=1e-4)


def test_slowed_is_the_same_with_fewer_turns():
    wave = path("wave", frequency=6.0)
    assert wave.slowed(2.0).turns == 2.0
    assert wave.slowed(8.0) is wave
    np.testing.assert_array_equal(wave.slowed(2.0).amplitude, wave.amplitude)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kind": "line", "amplitude": 0.1}, "a line path has no amplitude"),
        ({"kind": "points"}, "has no points, give at least one as \\[outward, up, forward\\]"),
        ({"kind": "wave", "points": POINTS}, "kind = 'points' goes through points"),
        ({"kind": "circle", "amplitude": 1.5}, "outside \\[-1, 1\\] arm lengths"),
        ({"kind": "wave", "frequency": 30.0}, "outside \\[0, 12\\] turns"),
        ({"kind": "wave", "frequency": -1.0}, "outside \\[0, 12\\] turns"),
        ({"kind": "wave", "amplitude": (0.0, 0.0, 0.0)}, "write kind = 'line'"),
        ({"kind": "arc", "amplitude": float("nan")}, "amplitude is"),
    ],
)
def test_what_makes_no_path_is_refused(given, said):
    with pytest.raises(ValueError, match=said):
        shape_path(**given)
