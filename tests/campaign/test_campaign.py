from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.tasks.processes import WorkerCrash
from tests.campaign import groups
from tests.campaign.groups import GroupResult, run_group
from tests.campaign.judge import MAX_RATIO, QUANTITIES, deepest_penetration, judge, limit_ratios
from tests.campaign.totals import Task, Totals, run_campaign

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" repetition="3"/></bml>'


class Inline:
    """Task engine that runs tasks in this process and crashes on one of them."""

    place = "here"

    def __init__(self, crash: Task | None = None) -> None:
        self.done, self._crash = list[Task](), crash

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], GroupResult]], *, preload: str = ""
    ) -> Iterator[tuple[Task, GroupResult | WorkerCrash]]:
        """Run each task in turn."""
        for task in tasks:
            self.done.append(task)
            yield task, WorkerCrash("ValueError", "") if task == self._crash else prepare()(task)


@pytest.fixture(scope="module")
def setup() -> Setup:
    return set_up()


def test_random_blocks_of_a_small_campaign_keep_limits_without_self_contact(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(groups, "PLANS_PER_GROUP", 2)
    result = run_group((1, 0))
    assert (result.blocks, result.violations, result.penetrations, result.failures) == (2, 0, 0, [])
    assert result.merges > 0
    assert all(0.0 <= ratio <= MAX_RATIO for ratio in result.largest.values())
    assert min(result.largest[name] for name in QUANTITIES) > 0.0


def test_independent_judge_detects_each_exceeded_limit_and_nan_values(setup: Setup):
    planned = plan(NOD, setup)
    limits, controls = setup.limits, planned.trajectory.controls
    first = judge(controls, setup)
    assert first.violated == []
    for name, field in (("velocity", "speed"), ("acceleration", "acceleration"), ("jerk", "jerk")):
        tight = replace(limits, **{field: sealed(getattr(limits, field) * 0.9 * first.ratios[name])})
        assert judge(controls, replace(setup, shared_limits=tight)).violated == [name]
    tight = replace(limits, upper=sealed(limits.upper - 1.0), lower=sealed(limits.lower + 1.0))
    assert "position" in judge(controls, replace(setup, shared_limits=tight)).violated
    broken = controls.copy()
    broken[5, 3] = np.nan
    assert "jerk" in judge(broken, setup).violated


def test_independent_judge_detects_contact_forces_beyond_the_limits_near_people(setup: Setup):
    beat = NOD.replace('<head id="h" lexeme="NOD" repetition="3"/>', '<gesture id="g" lexeme="beat_strong"/>')
    unlimited, near = plan(beat, setup), set_up(near="child")
    kept = judge(plan(beat, near).trajectory.controls, near)
    assert 0.5 < kept.ratios["contact"] <= MAX_RATIO
    assert judge(unlimited.trajectory.controls, near).violated == ["contact"]


def test_independent_judge_finds_the_largest_limit_ratios_between_samples(setup: Setup):
    rng = np.random.default_rng(0)
    controls = rng.normal(size=(12, len(setup.limits.lower)))
    u = np.linspace(0.0, 1.0, 2001)[:, None, None]
    windows = np.lib.stride_tricks.sliding_window_view(controls, 4, axis=0)
    weights = [(1 - u) ** 3 / 6, (3 * u**3 - 6 * u**2 + 4) / 6, (1 + 3 * u + 3 * u**2 - 3 * u**3) / 6, u**3 / 6]
    angles = sum(weight * windows[None, :, :, k] for k, weight in enumerate(weights))
    velocities = np.diff(angles, axis=0) * 2000 / 0.01
    beyond = np.maximum(angles - setup.limits.upper, setup.limits.lower - angles).max()
    position, velocity, *_ = limit_ratios(controls, setup.limits)
    assert position - 1.0 == pytest.approx(beyond, abs=1e-5)
    assert velocity == pytest.approx((np.abs(velocities) / setup.limits.speed).max(), rel=1e-3)


def test_independent_judge_finds_self_contact_in_the_same_postures_as_the_distance_code(setup: Setup):
    rng = np.random.default_rng(1)
    postures = rng.uniform(setup.limits.lower, setup.limits.upper, size=(40, len(setup.limits.lower)))
    distances = setup.distances.clearance(postures).distances.reshape(len(postures), -1).min(axis=1)
    for posture, distance in zip(postures, distances.tolist(), strict=True):
        assert (deepest_penetration(posture[None], setup.robot) > 0.0) == (distance < 0.0), distance
    assert 0 < np.count_nonzero(distances < 0.0) < len(postures)


def test_interrupted_campaign_repeats_only_missing_groups_and_counts_a_crash(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(groups, "PLANS_PER_GROUP", 0)
    tasks, path, counts = [(3, number) for number in range(4)], tmp_path / "journal.jsonl", list[int]()
    first = Inline(crash=(3, 2))
    totals = run_campaign(tasks, first, path, lambda totals: counts.append(totals.groups))
    assert (totals.exceptions, totals.failed, counts) == (1, 1, [1, 2, 3, 4])
    assert totals.failures == ["--seed 3 --only 2: ValueError"]
    second = Inline()
    assert run_campaign(tasks, second, path, lambda _: None).failed == 0
    assert second.done == [(3, 2)]


def test_campaign_totals_add_the_counts_of_groups_and_keep_the_largest_ratio():
    totals = Totals()
    for ratio in (0.5, 1.2):
        largest = {"position": 1.0, "velocity": ratio, "acceleration": 0.1, "jerk": 0.1, "contact": 0.0}
        totals.add((1, 4), GroupResult("upper22", blocks=20, merges=80, largest=largest, violations=1, failures=["f"]))
    assert (totals.groups, totals.blocks, totals.merges, totals.failed) == (2, 40, 160, 2)
    assert totals.failures == ["--seed 1 --only 4: f"] * 2
    assert "| planned blocks | 40 (40 upper22) |" in list(totals.lines())
    assert any("velocity 1.2000" in line for line in totals.lines())
