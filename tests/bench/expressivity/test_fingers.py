"""What the bench of fingers finds in a few gestures, and how it sums up."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.expressivity.fingers import COMPLETE, FingerResult, finger_figures, judge_fingers
from kinesic.controller.perform import set_up
from kinesic.expressivity.style.style import Style


@pytest.fixture(scope="module")
def known():
    return set_up("upper36")


def test_a_shape_is_there_when_the_stroke_begins_and_lips_are_near(known):
    found = judge_fingers(known.lexicon.forms_by_id["hush"], known)
    assert not found.dropped
    assert len(found.lacks) == 1
    assert found.lacks[0] <= COMPLETE
    assert 0.010 <= found.clearance <= 0.020


def test_both_hands_are_looked_at(known):
    lacks = judge_fingers(known.lexicon.forms_by_id["arms_hanging"], known).lacks
    assert len(lacks) == 2
    assert max(lacks) < 1e-6


@pytest.mark.parametrize(
    ("gesture", "style"),
    [
        ("relief", "neutral"),
        ("vase", "neutral"),
        ("vase", "calm"),
        ("house", "calm"),
        ("scratch_arm", "joyful"),
        ("crossed_out", "shy"),
    ],
)
def test_hands_that_pass_near_one_another_have_room_for_their_fingers(known, gesture, style):
    found = judge_fingers(known.lexicon.forms_by_id[gesture], replace(known, style=Style.load(style)))
    assert not found.dropped
    assert found.clearance >= known.robot.least_clearance


def test_figures_name_what_is_late_or_left_out():
    results = [
        FingerResult("a", False, (0.0, 0.01), 0.02),
        FingerResult("b", False, (0.5,), np.inf),
        FingerResult("c", True, (), 0.012),
    ]
    figures = {figure.name.rpartition(".")[2]: figure for figure in finger_figures(results)}
    assert figures["shapes"].value == 3
    assert figures["complete"].value == pytest.approx(200 / 3)
    assert (figures["complete"].why, figures["complete"].ok) == ("b", False)
    assert figures["clearance"].value == pytest.approx(12.0)
    assert (figures["dropped"].value, figures["dropped"].why) == (1.0, "c")
