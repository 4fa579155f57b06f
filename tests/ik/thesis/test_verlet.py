import numpy as np
import pytest

from kinesic.ik.thesis.springs import DAMPING_FRACTIONS, Springs
from kinesic.ik.thesis.task import Effort
from kinesic.ik.thesis.verlet import swing_to_rest

# positions of the masses [chain lengths]
CHAIN_POINTS = np.array([[0.0, 0.0, 0.0], [0.4, 0.3, 0.0], [0.7, 0.0, 0.2], [1.0, 0.0, 0.0]])
POINT_MASSES = np.array([1.0, 2.0, 5.0, 1.0])


def _springs() -> Springs:
    pairs = [(0, 1), (1, 2), (2, 3)]
    return Springs.between(pairs, rests=np.full(3, 0.3), stiffness=np.ones(3), masses=POINT_MASSES, pinned={0, 3})


def _after(iterations: int, **given):
    effort = Effort(threshold=0.0, iterations=iterations, step=0.4)
    return swing_to_rest(_springs(), CHAIN_POINTS, effort=effort, arrived=lambda points: False, **given)


def test_first_verlet_step_is_force_over_mass():
    moved = _after(1, damping=0.2).points - CHAIN_POINTS
    assert moved == pytest.approx(0.4**2 * _springs().forces(CHAIN_POINTS) / POINT_MASSES[:, None])


def test_second_verlet_step_adds_damped_displacement_and_acceleration():
    first, second = _after(1, damping=0.2).points, _after(2, damping=0.2).points
    pull = 0.4**2 * _springs().forces(first) / POINT_MASSES[:, None]
    assert second == pytest.approx(first + (1.0 - 0.2) * (first - CHAIN_POINTS) + pull)


def test_default_verlet_damping_is_a_fraction_of_the_theoretical_value():
    loss = _springs().pace[1]
    assert _after(5, damping=None).points == pytest.approx(_after(5, damping=DAMPING_FRACTIONS[0] * loss).points)


def test_undamped_spring_masses_keep_oscillating():
    assert _after(2000, damping=0.0).energy > 0.1 * _springs().energy(_springs().forces(CHAIN_POINTS))


def test_verlet_relaxation_ends_at_its_criterion_without_changing_the_input():
    before = CHAIN_POINTS.copy()
    results: list[float] = []

    def arrived(points) -> bool:
        results.append(float(points[1, 0]))
        return len(results) == 4

    rest = swing_to_rest(_springs(), CHAIN_POINTS, damping=None, effort=Effort(threshold=0.0), arrived=arrived)
    assert rest.iterations == 3
    assert before.tolist() == CHAIN_POINTS.tolist()
