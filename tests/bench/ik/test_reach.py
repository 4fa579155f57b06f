"""The reach benches on few targets: the figures are there, and their accuracy goals hold."""

import numpy as np
import pytest

from kinesic.bench.ik import reach, tasks, tracking
from kinesic.bench.ik.arms import random_arm, targets
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.linkage import linkage_of


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(reach, "TARGETS", {"compiled": 400, "numpy": 60})
    monkeypatch.setattr(reach, "POSTURES", {"compiled": 200, "numpy": 60})
    monkeypatch.setattr(reach, "ARMS", 6)
    monkeypatch.setattr(reach, "TARGETS_OF_ARM", 40)
    monkeypatch.setattr(reach, "BATCH", 2000)
    monkeypatch.setattr(tasks, "POSES", 20)
    monkeypatch.setattr(tasks, "PAIRS", 6)
    monkeypatch.setattr(tasks, "BEYOND", 6)
    monkeypatch.setattr(tasks, "ARMS", 6)
    monkeypatch.setattr(tasks, "POSES_OF_ARM", 20)


@pytest.mark.usefixtures("few")
def test_reach_is_sure_and_exact():
    figures = {figure.name: figure for figure in reach.bench()}
    for name in ("ik.success_mm", "ik.violations", "ik.repeatable", "ik.extraction", "ik.success_random_arms_worst"):
        assert figures[name].ok, figures[name]
    assert (figures["ik.batch"].value is None) == (KERNEL == "numpy")


def test_what_interrupts_a_pass_is_not_the_solvers_time(monkeypatch):
    chain, count = Robot.load().arms["l"], 50
    monkeypatch.setattr(reach, "KERNEL", "compiled")
    monkeypatch.setattr(reach, "ALONE", count)
    calls = iter(range(count * reach.PASSES))  # every third target is interrupted, once

    def seconds(chain, asked):
        call = next(calls)
        return 1.0 if call < count and call % 3 == 0 else 5e-6

    monkeypatch.setattr(reach, "_seconds", seconds)
    figures = reach._percentiles(chain, targets(np.random.default_rng(1), chain, count))
    assert [figure.value for figure in figures] == pytest.approx([5.0, 5.0, 5.0])


@pytest.mark.usefixtures("few")
def test_tasks_are_met():
    figures = {figure.name: figure for figure in tasks.bench()}
    assert figures["ik.pose"].value >= 0.95
    assert figures["ik.pose_random_arms"].value >= 0.95
    assert figures["ik.both_hands"].ok
    assert figures["ik.unreachable"].value >= 0.8


def test_tracking_is_exact_and_comes_home():
    figures = {figure.name: figure for figure in tracking.bench()}
    assert figures["ik.tracking_error"].ok
    assert figures["ik.tracking_drift"].ok


def test_random_arms_swing_the_elbow_with_one_or_two_hinges_with_and_without_twist_of_the_upper_arm():
    chance = np.random.default_rng(3)
    arms = [random_arm(chance) for _ in range(60)]
    kinds = {(len(arm.joints[0].hinges) == 3, len(linkage_of(arm).links[-2].pivots)) for arm in arms}
    assert kinds == {(False, 1), (False, 2), (True, 2), (True, 3)}


def test_targets_of_random_arms_are_within_reach():
    chance = np.random.default_rng(3)
    chain = random_arm(chance)
    asked = targets(chance, chain, 20)
    reach_of_chain = chain.lengths[:-1].sum()
    assert np.all(np.linalg.norm(asked - chain.origin_in_base, axis=1) <= reach_of_chain + 1e-9)
    assert np.all(chain.lower < chain.upper)
