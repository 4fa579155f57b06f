import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.comparison import (
    MAX_AUC,
    compare_body,
    compare_sets,
    measure_rest_spread,
    split_sets,
)
from kinesic.bench.naturalness.whole_body.features import measure_set

from .bodies import ARM, make_body


def make_set(name, *, trunks, free=0.02, bends=(10.0, 20.0, 30.0)):
    """Measure a set of one gesture for each trunk rotation [deg]."""
    clips = [
        make_body(trunk=trunk, swing=(free, 0.2), bend=(bends[k % len(bends)],) * 2, performance=str(k % 6))
        for k, trunk in enumerate(trunks)
    ]
    return measure_set(name, clips)


@pytest.fixture(scope="module")
def captured():
    return [
        make_set("Gestures", trunks=np.linspace(2.0, 12.0, 12)),
        make_set("MaleGestures", trunks=np.linspace(3.0, 13.0, 12)),
        make_set("PNGestures", trunks=np.linspace(2.5, 12.5, 12)),
    ]


def by_name(metrics):
    return {metric.name.removeprefix("naturalness.people."): metric for metric in metrics}


def test_robot_with_motionless_trunk_and_free_arm_misses_the_likeness_goals(captured):
    ours = make_set("robot", trunks=[0.2] * 6 + [1.0] * 6, free=0.001)
    metrics = by_name(compare_body(ours, captured))
    assert metrics["robot.trunk_still"].value == 0.5
    assert metrics["robot.free_arm_still"].value == 1.0
    assert not metrics["robot.trunk"].ok
    assert not metrics["robot.free_arm_still"].ok
    assert metrics["robot.ks_unseen_trunk"].value == metrics["robot.ks_tuned_trunk"].value == 1.0
    assert metrics["robot.motion_auc_unseen"].value == 1.0
    assert metrics["robot.motion_auc_left_out"].goal == MAX_AUC
    assert "tuned sets 7.48" in metrics["robot.trunk"].why
    assert "unseen sets 7.48" in metrics["robot.trunk"].why


def test_robot_that_moves_like_captured_people_meets_the_likeness_goals(captured):
    ours = make_set("robot", trunks=np.linspace(2.2, 12.2, 12))
    metrics = by_name(compare_body(ours, captured))
    assert metrics["robot.trunk"].ok
    assert metrics["robot.free_arm_still"].ok
    assert metrics["robot.ks_unseen_trunk"].ok
    assert metrics["robot.motion_auc_unseen"].ok
    assert metrics["robot.first_frame_accuracy_unseen"].ok


def test_classifier_separates_a_constant_rest_posture_from_varied_ones(captured):
    ours = make_set("robot", trunks=np.linspace(2.2, 12.2, 12), bends=(60.0,))
    assert measure_rest_spread(ours) == pytest.approx(0.0, abs=1e-9)
    metrics = by_name(compare_body(ours, captured))
    assert metrics["robot.first_frame_accuracy_unseen"].value == 1.0
    assert metrics["robot.first_frame_accuracy_left_out"].value > 0.9


def test_spread_of_rest_postures_is_the_standard_deviation_of_wrist_positions():
    measured = make_set("robot", trunks=[1.0] * 4, bends=(0.0, 90.0))
    forward, down = 0.25 / ARM / 2, 0.25 / ARM / 2
    assert measure_rest_spread(measured) == pytest.approx(np.hypot(forward, down))


def test_capture_sets_are_labelled_as_tuned_or_unseen_and_compared_with_each_other(captured):
    metrics = by_name(compare_sets(captured, captured))
    assert metrics["PNGestures.gestures"].why == "unseen"
    assert metrics["Gestures.gestures"].why == "tuned on"
    assert metrics["Gestures.auc_from.MaleGestures"].value < 0.8
    assert metrics["Gestures.motion_auc_unseen"].goal is metrics["Gestures.ks_unseen_trunk"].goal is None
    assert metrics["Gestures.ks_unseen_trunk"].value == pytest.approx(1 / 12)
    assert "PNGestures.ks_unseen_trunk" not in metrics
    assert [[measured.name for measured in part] for part in split_sets(captured)] == [
        ["Gestures", "MaleGestures"],
        ["PNGestures"],
    ]
