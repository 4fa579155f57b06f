"""Removal of single behaviours from a running block."""

import numpy as np
import pytest

from kinesic.planning.reduced_plan import plan_without
from kinesic.realizer.ending import end_behaviours
from kinesic.realizer.realizer import change_style, improve_block, prepare_block, take_replans

from .conftest import Play

HELD_OFFER = '<gesture id="g" lexeme="offer" mode="LEFT_HAND" start="0" stroke="1.5" relax="9" end="10"/>'
NODS = '<head id="h" lexeme="NOD" start="4" end="8" repetition="4"/>'


def posture(play: Play, time: float, chain: str) -> np.ndarray:
    return play.scene.motion.angles(np.array([time]))[0][list(play.scene.setup.robot.joints(chain))]


def test_interrupted_hand_returns_while_the_head_continues(play: Play):
    play.send("a", HELD_OFFER + NODS).until(3.0)
    robot = play.scene.setup.robot
    rest = robot.skeleton.rest[list(robot.joints("l_arm"))]
    head = [posture(play, time, "neck") for time in np.arange(4.5, 7.5, 0.1)]
    assert np.abs(posture(play, 6.0, "l_arm") - rest).max() > 0.2
    running = play.scene.find("a")
    assert running is not None
    play.take(end_behaviours(play.scene, running, frozenset({"g"}), play.now))
    assert np.abs(posture(play, 6.0, "l_arm") - rest).max() < 0.02
    assert np.allclose([posture(play, time, "neck") for time in np.arange(4.5, 7.5, 0.1)], head, atol=1e-6)
    play.until(12.0)
    assert not play.was_told("a:g:relax")
    assert play.at("a:h:end") > 7.0


def test_ending_a_left_hand_gesture_keeps_the_right_hand_gesture_of_another_block(play: Play):
    """Both blocks move the trunk, so the trunk motion must remain."""
    play.send("a", HELD_OFFER + NODS).until(3.0)
    other = HELD_OFFER.replace("LEFT_HAND", "RIGHT_HAND")
    play.send("b", other).until(6.0)
    before = posture(play, 7.5, "r_arm")
    running = play.scene.find("a")
    assert running is not None
    play.take(end_behaviours(play.scene, running, frozenset({"g"}), play.now))
    assert posture(play, 7.5, "r_arm") == pytest.approx(before, abs=0.05)


def test_block_ends_when_all_its_behaviours_were_interrupted(play: Play):
    play.send("a", HELD_OFFER).until(3.0)
    running = play.scene.find("a")
    assert running is not None
    play.take(end_behaviours(play.scene, running, frozenset({"g"}), play.now))
    assert play.scene.find("a") is None
    assert play.at("a:end") == pytest.approx(3.0, abs=0.02)


def test_ending_a_speech_leaves_the_motion_unchanged(play: Play):
    play.send("a", '<speech id="s"><text>One two three four</text></speech>' + NODS).until(0.5)
    before, running = play.scene.motion, play.scene.find("a")
    assert running is not None
    play.take(end_behaviours(play.scene, running, frozenset({"s"}), play.now))
    assert play.scene.motion is before
    play.until(9.0)
    assert play.was_told("a:h:end")


def test_ended_gaze_is_not_resumed_when_the_style_changes(play: Play):
    """The block continues with a new plan, which leaves the gaze out."""
    play.send("a", '<gaze id="z" target="left" start="4" end="8"/>' + NODS).until(1.0)
    running = play.scene.find("a")
    assert running is not None
    play.take(end_behaviours(play.scene, running, frozenset({"z"}), play.now))
    scene, (request,) = take_replans(change_style(play.scene, play.now, style="joyful", block="a"))
    improved = improve_block(play.take(scene).scene, "a", prepare_block(request, scene.setup).plan, play.now)
    assert improved is not None
    play.take(improved)
    assert np.abs(posture(play, 6.0, "neck")[0]) < 0.1
    assert not play.until(12.0).was_told("a:z:ready")


def test_head_returns_from_an_ended_gaze_while_the_block_continues_to_nod(play: Play):
    """Gaze and nod move the neck together."""
    look = '<gaze id="z" target="left" start="0" ready="1" relax="9" end="10"/>'
    play.send("a", look + '<head id="h" lexeme="NOD" start="1" end="9" repetition="6"/>').until(2.0)
    assert posture(play, 5.0, "neck")[0] > 0.5
    running = play.scene.find("a")
    assert running is not None
    play.take(end_behaviours(play.scene, running, frozenset({"z"}), play.now))
    rest = plan_without(running.prepared.plan, {"z"}).trajectory
    for time in np.arange(2.9, 9.0, 0.05):
        expected = rest.at(time + rest.zero).angles[list(play.scene.setup.robot.joints("neck"))]
        np.testing.assert_allclose(posture(play, time + running.zero, "neck"), expected, atol=0.02)
    assert play.until(12.0).at("a:h:end") == pytest.approx(9.0, abs=0.1)
