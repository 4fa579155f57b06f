"""Captured pointing gestures that are turned towards their targets."""

import numpy as np
import pytest

from kinesic.expressivity.hands.captured_aim import aim_captured, is_captured
from kinesic.expressivity.lexicon.lexicon import in_mode
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

from ..lexicon.captured_clips import write_gesture

TARGETS = {"near": (1.0, -0.4, 0.2), "left": (1.5, 0.9, -0.2), "high": (1.2, -1.0, 0.9)}
DOCUMENT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="a">'
    '<gesture id="g" lexeme="swing" target="{}" stroke="2.5"/></bml>'
)


@pytest.fixture
def setup(tmp_path):
    """Set up a captured deictic gesture of the right hand, and targets."""
    return set_up("upper22", lexicon=write_gesture(tmp_path, category="deictic"), targets=TARGETS)


@pytest.mark.parametrize("name", TARGETS)
def test_captured_pointing_gesture_points_within_two_degrees_of_its_target_at_the_stroke(setup, name):
    planned = plan(DOCUMENT.format(name), setup)
    assert planned.keyframes.outcomes["g"].kind == "realised"
    stroke = planned.syncs["g:stroke"].planned
    assert stroke == pytest.approx(2.5, abs=0.01)
    side = "l" if TARGETS[name][1] > 0 else "r"
    frames = setup.robot.skeleton.frames(planned.trajectory.angles(np.array([planned.trajectory.zero + stroke]))[0])
    arm = setup.robot.arm(side)
    shoulder, wrist = frames.origins[arm.shoulder], frames.origins[arm.wrist]
    line, aim = wrist - shoulder, np.array(TARGETS[name]) - shoulder
    angle = np.arctan2(np.linalg.norm(np.cross(line, aim)), line @ aim)
    assert np.degrees(angle) < 2.0


@pytest.mark.parametrize("name", TARGETS)
def test_path_of_an_aimed_captured_gesture_is_displaced_at_most_3_percent_more_than_its_stroke(setup, name):
    side = "l" if TARGETS[name][1] > 0 else "r"
    form = in_mode(setup.lexicon.forms_by_id["swing"], "left" if side == "l" else "right")
    aimed, angle = aim_captured(form, side, np.array(TARGETS[name]), setup.robot)
    assert 0.0 < angle < 1.5
    before, after = (np.array([key.hands[side].position for key in each.keys]) for each in (form, aimed))
    np.testing.assert_allclose(before[[0, 2]], after[[0, 2]], atol=1e-12)
    displacement = np.linalg.norm(after[1] - before[1])
    assert displacement > 0.05
    for k in (1, 2):
        shifts = np.linalg.norm(aimed.keys[k].hands[side].path.points - form.keys[k].hands[side].path.points, axis=1)
        assert shifts.max() <= 1.03 * displacement  # points that are farther from the shoulder move a little more
        assert min(shifts[0], shifts[-1]) < 0.05 * displacement


def test_only_lexicon_gestures_with_a_motion_file_count_as_captured(setup):
    assert not is_captured(setup.lexicon.forms_by_id["this_index"])
    assert is_captured(setup.lexicon.forms_by_id["swing"])
