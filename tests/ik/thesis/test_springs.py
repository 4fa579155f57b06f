import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.ik.thesis.springs import Springs


def _row(bones: int, **given) -> Springs:
    defaults = {"rests": np.ones(bones) / bones, "stiffness": np.ones(bones), "masses": np.ones(bones + 1)}
    return Springs.between([(k, k + 1) for k in range(bones)], pinned={0, bones}, **(defaults | given))


@pytest.mark.parametrize("bones", [3, 6, 10, 20])
def test_time_step_and_damping_of_equal_springs_match_the_closed_formula(bones: int):
    slow, fast = (np.sqrt(2.0 - 2.0 * np.cos(np.pi * k / bones)) for k in (1, bones - 1))
    step, loss = _row(bones).pace
    assert step**2 == pytest.approx(4.0 / (fast + slow) ** 2)
    assert loss == pytest.approx(1.0 - ((fast - slow) / (fast + slow)) ** 2)


def test_stiffer_springs_and_lighter_masses_need_shorter_time_steps():
    step, loss = _row(6).pace
    assert _row(6, stiffness=np.full(6, 4.0)).pace == pytest.approx((step / 2.0, loss))
    assert _row(6, masses=np.full(7, 4.0)).pace == pytest.approx((step * 2.0, loss))


def test_spring_forces_are_the_negative_gradient_of_spring_energy():
    random = default_rng(2)
    springs = _row(5, stiffness=random.uniform(0.5, 2.0, 5), rests=random.uniform(0.1, 0.3, 5))
    points = random.normal(size=(6, 3))

    def work(at):
        lengths = np.linalg.norm(springs.incidence @ at, axis=1)
        return 0.5 * (springs.stiffness * (lengths - springs.rests) ** 2).sum()

    forces = springs.forces(points)
    for mass, axis in np.ndindex(4, 3):
        step = np.zeros_like(points)
        step[mass + 1, axis] = 1e-6
        slope = (work(points + step) - work(points - step)) / 2e-6
        assert forces[mass + 1, axis] == pytest.approx(-slope, abs=1e-8)
    assert forces[0].tolist() == forces[-1].tolist() == [0.0, 0.0, 0.0]


def test_spring_energy_is_zero_at_rest_and_forces_are_finite_at_zero_length():
    springs = _row(2)
    rest = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0]])
    assert springs.energy(springs.forces(rest)) == pytest.approx(0.0, abs=1e-12)
    assert np.isfinite(springs.forces(np.zeros((3, 3)))).all()


def test_spring_network_without_free_masses_has_unit_time_step_and_damping():
    assert _row(1).pace == (1.0, 1.0)
