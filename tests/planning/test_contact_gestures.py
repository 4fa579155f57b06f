"""Tests of gestures near face and shoulder in three styles."""

from dataclasses import replace

import pytest

from kinesic.bench.plan import count_violations
from kinesic.expressivity.style.style import Style
from kinesic.studies.gestures.isolated import BEHAVIOUR_ID, plan_gesture, stroke_error

MIN_CLEARANCE = 0.010  # [m] smallest accepted clearance of planned gestures


@pytest.mark.parametrize("style", ["neutral", "joyful", "sad"])
@pytest.mark.parametrize("gesture", ["palm_to_forehead", "own_shoulder", "up_to_here"])
def test_gesture_that_touches_the_body_keeps_clearance_and_stroke_time(known, gesture, style):
    planned = plan_gesture(known.lexicon.forms_by_id[gesture], replace(known, style=Style.load(style)))
    assert planned.keyframes.outcomes[BEHAVIOUR_ID].kind == "realised"
    assert count_violations(planned) == 0
    assert planned.clearance.distances.min() >= MIN_CLEARANCE
    assert abs(stroke_error(planned)) < 0.02  # [s]
