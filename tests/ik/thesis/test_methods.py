"""Tests of the thesis' three relaxation methods, on 3 to 32 joints."""

from functools import cache

import numpy as np
import pytest
from numpy.random import default_rng

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.direct import balance_springs
from kinesic.ik.thesis.task import Effort, Rest, Task
from kinesic.ik.thesis.verlet import draw_by_force, swing_pinned

from ...reference.ik.masses import settle_masses

# relaxation method -> function
METHOD_FUNCTIONS = {"force": draw_by_force, "position": swing_pinned, "direct": balance_springs}
REACHABLE_COUNT = 30  # number of tested targets within reach
BOUNDARY_COUNT = 6  # number of tested targets at the reach limit


def _directions(count: int, seed: int) -> Floats:
    lines = default_rng(seed).normal(size=(count, 3))
    return lines / np.linalg.norm(lines, axis=1, keepdims=True)


def _task(joints: int, target: Floats, *, effort: Effort | None = None, damping: float | None = None) -> Task:
    chain = BallChain.curved(np.full(joints, 1.0 / joints))
    return Task(chain.points, target, chain.lengths, chain.stiffness, chain.masses, damping, effort or Effort())


@cache
def _rests(way: str, joints: int, count: int = REACHABLE_COUNT, **given) -> list[tuple[Task, Rest]]:
    reaches = default_rng(joints).uniform(0.1, 0.97, count)
    tasks = [_task(joints, r * line, **given) for r, line in zip(reaches, _directions(count, joints), strict=True)]
    return [(task, METHOD_FUNCTIONS[way](task)) for task in tasks]


# median iterations on 2000 targets, by a prototype for up to 10 joints and for 3 by position; a sample may differ by a
# third
@pytest.mark.parametrize(
    ("way", "joints", "median", "least"),
    [
        ("force", 3, 17, 1.0),
        pytest.param("force", 6, 27, 1.0, marks=pytest.mark.soak),
        ("force", 10, 35, 0.97),
        pytest.param("force", 20, 71, 0.97, marks=pytest.mark.soak),
        ("force", 32, 97, 0.97),
        ("position", 3, 14, 1.0),
        pytest.param("position", 6, 19, 1.0, marks=pytest.mark.soak),
        ("position", 10, 33, 1.0),
        pytest.param("position", 20, 67, 0.97, marks=pytest.mark.soak),
        ("position", 32, 90, 0.97),
        ("direct", 3, 4, 1.0),
        pytest.param("direct", 6, 7, 1.0, marks=pytest.mark.soak),
        ("direct", 10, 15, 1.0),
        pytest.param("direct", 20, 30, 1.0, marks=pytest.mark.soak),
        ("direct", 32, 60, 0.97),
    ],
)
def test_mass_spring_methods_reach_most_targets_in_the_recorded_number_of_iterations(way, joints, median, least):
    rests = _rests(way, joints)
    assert 0.67 * median <= np.median([rest.iterations for _, rest in rests]) <= 1.34 * median
    assert np.mean([task.arrived(rest.points) for task, rest in rests]) >= least


@pytest.mark.parametrize("joints", [3, *(pytest.param(count, marks=pytest.mark.soak) for count in (6, 10)), 20])
@pytest.mark.parametrize("way", METHOD_FUNCTIONS)
def test_mass_spring_methods_approach_targets_at_the_reach_limit(way, joints):
    strict, loose = Effort(), Effort(tolerance=0.04 if joints == 20 else 0.01)
    for line in _directions(BOUNDARY_COUNT, 7):
        rest = METHOD_FUNCTIONS[way](_task(joints, line))
        assert _task(joints, line, effort=loose).arrived(rest.points)
        assert way != "direct" or _task(joints, line, effort=strict).arrived(rest.points)


@pytest.mark.parametrize("way", ["force", "position"])
def test_undamped_mass_spring_chain_does_not_settle(way):
    rests = _rests(way, 6, 6, damping=0.0)
    assert np.mean([rest.iterations == Effort().iterations for _, rest in rests]) > 0.9


def test_spring_simulation_with_a_too_large_time_step_diverges_and_is_stopped():
    rest = swing_pinned(_task(6, np.array([0.5, 0.2, 0.1]), effort=Effort(step=2.0)))
    assert rest.iterations < Effort().iterations
    assert rest.energy > 1e6


def test_mass_spring_ik_with_softer_springs_than_recommended_settles_slowly():
    tuned = np.median([rest.iterations for _, rest in _rests("position", 10)])
    soft = np.median([rest.iterations for _, rest in _rests("position", 10, effort=Effort(step=np.sqrt(0.1)))])
    assert soft > 2.0 * tuned


def test_mass_spring_chain_stops_below_the_spring_energy_threshold():
    target = np.array([0.4, 0.3, 0.2])
    coarse, fine = (swing_pinned(_task(6, target, effort=Effort(tolerance=0.0, threshold=e))) for e in (1e-2, 1e-6))
    assert 1e-6 < coarse.energy <= 1e-2
    assert fine.energy <= 1e-6
    assert coarse.iterations < fine.iterations


@pytest.mark.parametrize("way", METHOD_FUNCTIONS)
def test_springs_of_a_settled_chain_have_their_rest_lengths(way):
    task = _task(6, np.array([0.3, 0.3, 0.3]), effort=Effort(tolerance=0.0, threshold=1e-8, iterations=600))
    points = METHOD_FUNCTIONS[way](task).points
    assert np.linalg.norm(np.diff(points, axis=0), axis=1) == pytest.approx(task.rests, abs=1e-6)
    assert points[0] == pytest.approx(task.points[0])
    assert points[-1] == pytest.approx(task.target, abs=1e-6)


def test_mass_spring_ik_with_equal_masses_gives_the_joint_positions_of_the_arm_solver():
    lengths, target = (0.25, 0.35, 0.4), (0.5, 0.2, 0.3)
    chain = BallChain.curved(lengths)
    mine = swing_pinned(
        Task(
            chain.points,
            np.array(target),
            chain.lengths,
            chain.stiffness,
            chain.masses,
            None,
            Effort(tolerance=0.0, threshold=1e-9),
        )
    )
    theirs = settle_masses([tuple(point) for point in chain.points.tolist()], lengths, target)
    assert mine.points == pytest.approx(np.array(theirs.points), abs=1e-5)


def test_direct_spring_correction_moves_a_heavy_mass_less():
    chain = BallChain.curved([0.25, 0.25, 0.25, 0.25])
    target = np.array([0.2, 0.5, 0.2])

    def moved(mass: float) -> float:
        masses = np.array([1.0, 1.0, mass, 1.0, 1.0])
        effort = Effort(tolerance=1e-4, iterations=3000)
        rest = balance_springs(Task(chain.points, target, chain.lengths, chain.stiffness, masses, None, effort))
        return float(np.linalg.norm(rest.points[2] - chain.points[2]))

    assert moved(20.0) < 0.8 * moved(1.0)


def test_softest_bone_stretches_most_if_the_target_is_too_far():
    chain = BallChain.curved([0.25, 0.25, 0.25, 0.25])
    stiffness = np.array([1.0, 0.1, 1.0, 1.0])
    effort = Effort(tolerance=0.0, threshold=1e-7, iterations=3000)
    far = np.array([1.2, 0.1, 0.2])
    rest = swing_pinned(Task(chain.points, far, chain.lengths, stiffness, chain.masses, None, effort))
    stretches = np.linalg.norm(np.diff(rest.points, axis=0), axis=1) - 0.25
    assert stretches[1] / stretches[0] == pytest.approx(10.0, rel=0.05)


@pytest.mark.parametrize(
    ("given", "lesson"),
    [({"step": 0.0}, "step is 0.0"), ({"rounds": 0}, "rounds"), ({"tolerance": -1.0}, "tolerance=-1.0.*at least 0")],
)
def test_invalid_solver_step_rounds_or_tolerance_raises_an_error(given, lesson):
    with pytest.raises(ValueError, match=lesson):
        Effort(**given)
