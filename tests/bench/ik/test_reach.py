"""Reach benchmark with few targets: metrics exist and accuracy goals are met."""

import numpy as np
import pytest

from kinesic.bench.ik import reach, tasks, tracking
from kinesic.bench.ik.arms import draw_targets, random_arm
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of


@pytest.fixture
def few_targets(monkeypatch):
    monkeypatch.setattr(reach, "TARGET_COUNT", 400)
    monkeypatch.setattr(reach, "POSTURE_COUNT", 200)
    monkeypatch.setattr(reach, "RANDOM_ARMS", 6)
    monkeypatch.setattr(reach, "TARGETS_PER_ARM", 40)
    monkeypatch.setattr(reach, "BATCH_SIZE", 2000)
    monkeypatch.setattr(tasks, "POSE_COUNT", 20)
    monkeypatch.setattr(tasks, "PAIR_COUNT", 6)
    monkeypatch.setattr(tasks, "UNREACHABLE_COUNT", 6)
    monkeypatch.setattr(tasks, "ARM_COUNT", 6)
    monkeypatch.setattr(tasks, "POSES_PER_ARM", 20)


@pytest.mark.usefixtures("few_targets")
def test_ik_reach_meets_its_accuracy_goals():
    metrics = {metric.name: metric for metric in reach.bench()}
    for name in ("ik.success_mm", "ik.violations", "ik.repeatable", "ik.extraction", "ik.success_random_arms_worst"):
        assert metrics[name].ok, metrics[name]
    assert metrics["ik.batch"].value > 0.0


def test_ik_solve_time_metric_ignores_interrupted_calls(monkeypatch):
    chain, count = Robot.load().arms["l"], 50
    monkeypatch.setattr(reach, "REPEATED_TARGETS", count)
    calls = iter(range(count * reach.TIMING_PASSES))  # one pass is interrupted at every third target

    def seconds(chain, reach_targets):
        call = next(calls)
        return 1.0 if call < count and call % 3 == 0 else 5e-6

    monkeypatch.setattr(reach, "_time_solve", seconds)
    metrics = reach._measure_percentiles(chain, draw_targets(np.random.default_rng(1), chain, count))
    assert [metric.value for metric in metrics] == pytest.approx([5.0, 5.0, 5.0])


@pytest.mark.soak
@pytest.mark.usefixtures("few_targets")
def test_ik_success_rates_are_at_least_95_percent_for_poses_and_80_for_unreachable_targets():
    metrics = {metric.name: metric for metric in tasks.bench()}
    assert metrics["ik.pose"].value >= 0.95
    assert metrics["ik.pose_random_arms"].value >= 0.95
    assert metrics["ik.both_hands"].ok
    assert metrics["ik.unreachable"].value >= 0.8


@pytest.mark.soak
def test_ik_tracking_error_and_drift_meet_their_benchmark_goals():
    metrics = {metric.name: metric for metric in tracking.bench()}
    assert metrics["ik.tracking_error"].ok
    assert metrics["ik.tracking_drift"].ok


def test_random_arms_cover_one_and_two_elbow_joints_with_and_without_twist():
    rng = np.random.default_rng(3)
    arms = [random_arm(rng) for _ in range(60)]
    kinds = {(len(arm.joints[0].hinges) == 3, len(linkage_of(arm).links[-2].pivots)) for arm in arms}
    assert kinds == {(False, 1), (False, 2), (True, 2), (True, 3)}


def test_targets_of_random_arms_lie_within_the_arm_length():
    rng = np.random.default_rng(3)
    chain = random_arm(rng)
    reach_targets = draw_targets(rng, chain, 20)
    reach_of_chain = chain.lengths[:-1].sum()
    assert np.all(np.linalg.norm(reach_targets - chain.origin_in_base, axis=1) <= reach_of_chain + 1e-9)
    assert np.all(chain.lower < chain.upper)
