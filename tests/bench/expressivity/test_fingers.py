"""Benchmark of fingers with a few gestures, and its metrics."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.expressivity.fingers import MAX_SHAPE_ERROR, FingerResult, finger_metrics, judge_fingers
from kinesic.expressivity.style.style import Style
from kinesic.session.setup import set_up


@pytest.fixture(scope="module")
def setup():
    return set_up("upper36")


def test_finger_shape_of_the_hush_gesture_is_complete_at_its_stroke_start(setup):
    result = judge_fingers(setup.lexicon.forms_by_id["hush"], setup)
    assert not result.dropped
    assert len(result.shape_errors) == 1
    assert result.shape_errors[0] <= MAX_SHAPE_ERROR
    assert 0.010 <= result.clearance <= 0.020


def test_finger_shape_errors_of_both_hands_are_measured(setup):
    shape_errors = judge_fingers(setup.lexicon.forms_by_id["arms_hanging"], setup).shape_errors
    assert len(shape_errors) == 2
    assert max(shape_errors) < 1e-6


@pytest.mark.parametrize(
    ("gesture", "style"),
    [
        ("relief", "neutral"),
        ("vase", "neutral"),
        ("vase", "calm"),
        ("house", "calm"),
        pytest.param("scratch_arm", "joyful", marks=pytest.mark.soak),
        ("crossed_out", "shy"),
    ],
)
def test_hands_that_pass_each_other_keep_finger_clearance(setup, gesture, style):
    result = judge_fingers(setup.lexicon.forms_by_id[gesture], replace(setup, style=Style.load(style)))
    assert not result.dropped
    assert result.clearance >= setup.robot.min_clearance


def test_finger_metrics_name_late_and_dropped_gestures():
    results = [
        FingerResult("a", False, (0.0, 0.01), 0.02),
        FingerResult("b", False, (0.5,), np.inf),
        FingerResult("c", True, (), 0.012),
    ]
    metrics = {metric.name.rpartition(".")[2]: metric for metric in finger_metrics(results)}
    assert metrics["shapes"].value == 3
    assert metrics["complete"].value == pytest.approx(200 / 3)
    assert (metrics["complete"].why, metrics["complete"].ok) == ("b", False)
    assert metrics["clearance"].value == pytest.approx(12.0)
    assert (metrics["dropped"].value, metrics["dropped"].why) == (1.0, "c")
