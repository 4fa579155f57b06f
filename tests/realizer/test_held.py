"""Held postures: the last gaze shift and posture shift determine the end."""

import numpy as np
import pytest

from kinesic.realizer.ending import end_behaviours
from kinesic.realizer.held import HELD_POSTURE_TOLERANCE, smooth_step
from kinesic.realizer.realizer import interrupt

LOOK = '<gazeShift id="{}" target="{}" {}/>'
LEAN = '<postureShift id="p"><pose part="{}" lexeme="{}"/></postureShift>'
SPOKEN = '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech>'
ANGLE_TOLERANCE = 1e-6  # [rad] tolerance of final angles


@pytest.fixture
def end(known):
    """Return the final offsets [rad] of torso and neck from rest."""
    hinges = [*known.robot.joints("torso"), *known.robot.joints("neck")]

    def found(play, seconds=20.0):
        play.until(play.now + seconds)
        return (play.scene.motion.controls[-1] - known.robot.skeleton.rest)[hinges]

    return found


def look(target: str, id: str = "l", more: str = "") -> str:
    return LOOK.format(id, target, more)


def test_final_posture_after_six_gaze_shifts_equals_that_of_the_last_shift_alone(played, end):
    play = played()
    for number, target in enumerate(("left", "right", "left", "audience", "right", "left")):
        play.send(f"b{number}", look(target)).until(play.now + 2.5)
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ANGLE_TOLERANCE)


def test_last_of_two_gaze_shifts_in_a_block_replaces_the_gaze_of_an_earlier_block(played, end):
    play = played().send("a", look("left")).until(3.0)
    play.send("b", look("right", "k", 'start="0"') + look("left", "l", 'start="2"'))
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ANGLE_TOLERANCE)


def test_gaze_shift_is_superseded_by_a_previously_scheduled_later_one(played, end):
    play = played().send("late", look("left", "l", 'start="5"')).until(0.5).send("soon", look("right"))
    play.until(4.0)
    torsion = play.scene.setup.robot.joints("neck")[0]
    assert play.scene.motion.at(4.0).angles[torsion] < -0.5
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ANGLE_TOLERANCE)


def test_gaze_reaches_its_target_despite_a_gaze_shift_that_was_sent_after_it(played):
    asked = '<gaze id="g" target="left" start="4" ready="4.8" relax="6" end="7"/>'
    alone, play = played().send("g", asked), played().send("g", asked).until(0.5).send("soon", look("right"))
    torsion = play.scene.setup.robot.joints("neck")[0]
    expected, result = (item.until(5.5).scene.motion.at(5.5).angles[torsion] for item in (alone, play))
    assert result == pytest.approx(expected, abs=HELD_POSTURE_TOLERANCE)


def test_overlapping_gaze_shift_replaces_the_earlier_one(played, end):
    play = played().send("a", look("left", "l", 'start="0" end="1.5"')).until(0.6).send("b", look("right"))
    assert play.state("b") is not None
    np.testing.assert_allclose(end(play), end(played().send("b", look("right"))), atol=ANGLE_TOLERANCE)


def test_dropped_gaze_shift_does_not_turn_the_trunk(played, end):
    gaze = '<gaze id="g" target="left" start="0" ready="0.8" relax="8" end="9"/>'
    play = (
        played().send("a", gaze).until(1.5).send("b", SPOKEN + look("right") + '<head id="n" lexeme="NOD" start="3"/>')
    )
    assert any("left out" in text for text in play.warnings("b:l"))
    np.testing.assert_allclose(end(play), 0.0, atol=ANGLE_TOLERANCE)


def test_gaze_shift_after_a_dropped_gaze_shift_determines_the_held_posture(played, end):
    gaze = '<gaze id="g" target="left" start="0" ready="0.8" relax="3" end="4"/>'
    both = look("audience", "k", 'start="0"') + look("right", "l", 'start="5"')
    play = played().send("a", gaze).until(1.5).send("b", SPOKEN + both)
    assert any("left out" in text for text in play.warnings("b:k"))
    np.testing.assert_allclose(end(play), end(played().send("b", look("right"))), atol=ANGLE_TOLERANCE)


def test_gaze_and_posture_of_a_block_are_superseded_separately(played, end):
    lean = LEAN.format("BODY", "LEANING_FORWARD")
    play = played().send("a", look("left") + lean).until(3.0).send("b", look("right"))
    right, leaning = (end(played().send("b", item)) for item in (look("right"), lean))
    np.testing.assert_allclose(end(play), right + leaning, atol=ANGLE_TOLERANCE)
    play.send("c", LEAN.format("BODY", "upright"))
    np.testing.assert_allclose(end(play), right, atol=ANGLE_TOLERANCE)


def test_upright_posture_shift_ends_a_lean(played, end):
    play = played().send("a", LEAN.format("WHOLEBODY", "LEANING_FORWARD")).until(3.0)
    np.testing.assert_allclose(end(play.send("b", LEAN.format("BODY", "upright"))), 0.0, atol=ANGLE_TOLERANCE)


def test_interrupting_a_block_keeps_the_newer_gaze_shift_of_another_block(played, end):
    play = played().send("long", '<wait id="w" duration="8"/>' + look("left")).until(3.0)
    play.send("short", look("right")).until(7.0)
    assert play.state("short") is not None
    play.take(interrupt(play.scene, play.now, "long"))
    expected = end(played().send("b", look("right")))
    np.testing.assert_allclose(end(play), expected, atol=ANGLE_TOLERANCE)
    play.send("c", look("left"))
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ANGLE_TOLERANCE)


def test_trunk_is_upright_after_interruption_of_two_gaze_shifts(played, end):
    play = played().send("a", '<wait id="w" duration="9"/>' + look("left")).until(3.0)
    play.send("b", '<wait id="w" duration="9"/>' + look("right")).until(6.0)
    for id in ("a", "b"):
        play.take(interrupt(play.scene, play.now, id))
    np.testing.assert_allclose(end(play), 0.0, atol=ANGLE_TOLERANCE)


def test_interrupted_gaze_shift_is_removed_during_a_nod(played, end):
    play = played().send("a", look("left") + '<head id="n" lexeme="NOD" start="0.4" repetition="3"/>').until(1.2)
    running = play.scene.find("a")
    play.take(end_behaviours(play.scene, running, frozenset({"l"}), play.now))
    np.testing.assert_allclose(end(play), 0.0, atol=ANGLE_TOLERANCE)


def test_held_postures_beyond_a_joint_range_cause_a_warning(played, end, known):
    down, low = '<headDirectionShift id="l" target="down"/>', LEAN.format("HEAD", "down")
    play = played().send("a", down).until(3.0)
    play.send("b", low).until(6.0).send("c", '<gazeShift id="l" target="0.2 0 0"/>')
    texts = [text for id in ("b:p", "c:l") for text in play.warnings(id) if "off its held posture" in text]
    tilt = known.robot.joints("neck")[1]
    assert bool(texts) == bool(np.isclose(end(play)[4], known.limits.upper[tilt], atol=ANGLE_TOLERANCE))
    assert texts
    assert "skullbase_tilt would exceed its range" in texts[0]


def test_smooth_step_rises_from_0_to_1_between_begin_and_end():
    times = np.array([0.0, 1.0, 1.5, 2.0, 3.0])
    np.testing.assert_allclose(smooth_step(times, 1.0, 2.0), [0.0, 0.0, 0.5, 1.0, 1.0], atol=1e-12)
