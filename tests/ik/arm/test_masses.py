import numpy as np
import pytest
from numpy.random import Generator, default_rng

from kinesic.ik.scalar3 import Vector, across, clamp_to_reach, cross, distance, dot, minus, norm, plus, scaled, unit

from ...reference.ik.masses import MAX_ITERATIONS, SWIVEL_ITERATIONS, TOLERANCE, settle_masses

BONE_LENGTHS = (0.115, 0.22, 0.20)  # [m]
# [m] positions of the masses at the start
CHAIN_POINTS: tuple[Vector, ...] = ((0.0, 0.0, 0.0), (0.0, 0.115, 0.0), (0.05, 0.15, -0.2), (0.2, 0.15, -0.3))


def _stretch(points: tuple[Vector, ...], lengths: tuple[float, ...]) -> float:
    return max(abs(distance(a, b) / c - 1.0) for a, b, c in zip(points, points[1:], lengths, strict=False))


def unit_vector(random: Generator) -> np.ndarray:
    line = random.normal(size=3)
    return np.asarray(line / np.linalg.norm(line))


def test_settled_mass_chain_keeps_bone_lengths_and_both_ends() -> None:
    random = default_rng(1)
    for _ in range(40):
        line = unit(tuple(random.normal(size=3).tolist()))
        target = scaled(line, random.uniform(0.3, 0.9) * sum(BONE_LENGTHS))
        settled = settle_masses(CHAIN_POINTS, BONE_LENGTHS, target)
        assert settled.points[0] == CHAIN_POINTS[0]
        assert distance(settled.points[-1], target) < 1e-12
        assert settled.energy < TOLERANCE
        assert _stretch(settled.points, BONE_LENGTHS) < 1e-4
        assert 0 < settled.iterations <= MAX_ITERATIONS


def test_mass_chain_that_is_already_settled_needs_no_iterations() -> None:
    settled = settle_masses(CHAIN_POINTS, BONE_LENGTHS, (0.3, 0.1, 0.1))
    assert settle_masses(settled.points, BONE_LENGTHS, (0.3, 0.1, 0.1)).iterations == 0


def test_mass_chain_points_straight_at_an_unreachable_target() -> None:
    settled = settle_masses(CHAIN_POINTS, BONE_LENGTHS, (3.0, 2.0, 1.0))
    line = unit((3.0, 2.0, 1.0))
    assert settled.iterations <= MAX_ITERATIONS
    assert distance(settled.points[-1], scaled(line, sum(BONE_LENGTHS))) < 1e-9
    assert all(norm(cross(line, point)) < 0.05 * sum(BONE_LENGTHS) for point in settled.points)


def test_only_targets_beyond_the_arm_length_are_moved_towards_the_base() -> None:
    assert clamp_to_reach((0.0, 0.0, 3.0), (0.0, 0.0, 1.0), 0.5) == (0.0, 0.0, 1.5)
    assert clamp_to_reach((0.0, 0.0, 1.2), (0.0, 0.0, 1.0), 0.5) == (0.0, 0.0, 1.2)


def test_settled_mass_chain_has_the_same_shape_at_a_scale_of_1000() -> None:
    target = (0.25, 0.1, 0.1)
    small = settle_masses(CHAIN_POINTS, BONE_LENGTHS, target)
    scale = 1000.0
    big = settle_masses(
        [scaled(p, scale) for p in CHAIN_POINTS], [scale * length for length in BONE_LENGTHS], scaled(target, scale)
    )
    assert big.iterations == small.iterations
    assert big.energy == pytest.approx(small.energy, abs=1e-9)
    for a, b in zip(small.points, big.points, strict=True):
        assert distance(scaled(a, scale), b) < 1e-9 * scale


@pytest.mark.parametrize("line", [(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)])
def test_straight_mass_chain_bends_sideways_to_reach_a_near_target(line: Vector) -> None:
    ends = [scaled(line, length) for length in (0.0, 0.115, 0.335, 0.535)]
    settled = settle_masses(ends, BONE_LENGTHS, scaled(line, 0.3))
    assert _stretch(settled.points, BONE_LENGTHS) < 1e-4
    assert max(norm(cross(line, point)) for point in settled.points) > 0.05


def test_settled_mass_chain_keeps_bone_lengths_for_a_target_at_its_base() -> None:
    settled = settle_masses(CHAIN_POINTS, BONE_LENGTHS, CHAIN_POINTS[0])
    assert _stretch(settled.points, BONE_LENGTHS) < 1e-4


def test_settled_mass_chain_has_the_same_shape_at_another_base_position() -> None:
    shift = (0.3, -0.2, 1.0)
    here = settle_masses(CHAIN_POINTS, BONE_LENGTHS, (0.3, 0.1, 0.1))
    there = settle_masses([plus(point, shift) for point in CHAIN_POINTS], BONE_LENGTHS, plus((0.3, 0.1, 0.1), shift))
    for a, b in zip(here.points, there.points, strict=True):
        assert distance(a, minus(b, shift)) < 1e-9


def test_single_elbow_mass_stays_on_its_side_of_the_shoulder_hand_line() -> None:
    random = default_rng(3)
    for case in range(60):
        upper = random.uniform(0.2, 0.8)
        span = random.uniform(0.3, 1.0) if case % 2 else 1.0 - 10.0 ** random.uniform(-4, -1)  # half are taut
        elbow = tuple((random.uniform(0.0, 1.2) * unit_vector(random)).tolist())
        points, target = ((0.0, 0.0, 0.0), elbow, (1.0, 0.0, 0.0)), (span, 0.0, 0.0)
        early, late = (
            unit(across(settle_masses(points, (upper, 1.0 - upper), target, rounds=rounds).points[1], (1.0, 0.0, 0.0)))
            for rounds in (SWIVEL_ITERATIONS, MAX_ITERATIONS)
        )
        assert dot(early, late) > 1.0 - 1e-12
        assert distance(early, late) < 1e-9
