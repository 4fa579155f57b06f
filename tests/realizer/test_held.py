"""What is held at the end: by the last gaze shift and the last posture, whatever came before or between."""

import numpy as np
import pytest

from kinesic.realizer.ending import leave_out
from kinesic.realizer.held import END_TOLERANCE, rise
from kinesic.realizer.realizer import interrupt

LOOK = '<gazeShift id="{}" target="{}" {}/>'
LEAN = '<postureShift id="p"><pose part="{}" lexeme="{}"/></postureShift>'
SPOKEN = '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech>'
ALIKE = 1e-6  # [rad]


@pytest.fixture
def end(known):
    """Angles of torso and neck [rad] from rest at the end of a play."""
    hinges = [*known.robot.joints("torso"), *known.robot.joints("neck")]

    def found(play, seconds=20.0):
        play.until(play.now + seconds)
        return (play.scene.motion.controls[-1] - known.robot.skeleton.rest)[hinges]

    return found


def look(target: str, id: str = "l", more: str = "") -> str:
    return LOOK.format(id, target, more)


def test_six_gaze_shifts_end_where_the_last_one_ends_alone(played, end):
    play = played()
    for number, target in enumerate(("left", "right", "left", "audience", "right", "left")):
        play.send(f"b{number}", look(target)).until(play.now + 2.5)
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ALIKE)


def test_a_block_of_two_gaze_shifts_replaces_an_earlier_one_once(played, end):
    play = played().send("a", look("left")).until(3.0)
    play.send("b", look("right", "k", 'start="0"') + look("left", "l", 'start="2"'))
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ALIKE)


def test_a_gaze_shift_before_one_that_is_still_to_come_gives_way_to_it(played, end):
    play = played().send("late", look("left", "l", 'start="5"')).until(0.5).send("soon", look("right"))
    play.until(4.0)
    torsion = play.scene.setup.robot.joints("neck")[0]
    assert play.scene.motion.at(4.0).angles[torsion] < -0.5
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ALIKE)


def test_a_gaze_during_a_later_shift_looks_where_it_is_asked_to(played):
    asked = '<gaze id="g" target="left" start="4" ready="4.8" relax="6" end="7"/>'
    alone, play = played().send("g", asked), played().send("g", asked).until(0.5).send("soon", look("right"))
    torsion = play.scene.setup.robot.joints("neck")[0]
    expected, found = (each.until(5.5).scene.motion.at(5.5).angles[torsion] for each in (alone, play))
    assert found == pytest.approx(expected, abs=END_TOLERANCE)


def test_a_gaze_shift_that_begins_before_another_has_ended_takes_over_from_it(played, end):
    play = played().send("a", look("left", "l", 'start="0" end="1.5"')).until(0.6).send("b", look("right"))
    assert play.state("b") is not None
    np.testing.assert_allclose(end(play), end(played().send("b", look("right"))), atol=ALIKE)


def test_a_gaze_shift_that_is_left_out_holds_nothing(played, end):
    gaze = '<gaze id="g" target="left" start="0" ready="0.8" relax="8" end="9"/>'
    play = (
        played().send("a", gaze).until(1.5).send("b", SPOKEN + look("right") + '<head id="n" lexeme="NOD" start="3"/>')
    )
    assert any("left out" in text for text in play.warnings("b:l"))
    np.testing.assert_allclose(end(play), 0.0, atol=ALIKE)


def test_of_a_left_out_shift_and_a_later_one_the_later_one_holds(played, end):
    gaze = '<gaze id="g" target="left" start="0" ready="0.8" relax="3" end="4"/>'
    both = look("audience", "k", 'start="0"') + look("right", "l", 'start="5"')
    play = played().send("a", gaze).until(1.5).send("b", SPOKEN + both)
    assert any("left out" in text for text in play.warnings("b:k"))
    np.testing.assert_allclose(end(play), end(played().send("b", look("right"))), atol=ALIKE)


def test_gaze_and_posture_of_one_block_are_replaced_one_by_one(played, end):
    lean = LEAN.format("BODY", "LEANING_FORWARD")
    play = played().send("a", look("left") + lean).until(3.0).send("b", look("right"))
    right, leaning = (end(played().send("b", each)) for each in (look("right"), lean))
    np.testing.assert_allclose(end(play), right + leaning, atol=ALIKE)
    play.send("c", LEAN.format("BODY", "upright"))
    np.testing.assert_allclose(end(play), right, atol=ALIKE)


def test_an_upright_posture_ends_a_lean(played, end):
    play = played().send("a", LEAN.format("WHOLEBODY", "LEANING_FORWARD")).until(3.0)
    np.testing.assert_allclose(end(play.send("b", LEAN.format("BODY", "upright"))), 0.0, atol=ALIKE)


def test_an_older_gaze_shift_of_a_longer_block_does_not_come_back(played, end):
    play = played().send("long", '<wait id="w" duration="8"/>' + look("left")).until(3.0)
    play.send("short", look("right")).until(7.0)
    assert play.state("short") is not None
    play.take(interrupt(play.scene, play.now, "long"))
    expected = end(played().send("b", look("right")))
    np.testing.assert_allclose(end(play), expected, atol=ALIKE)
    play.send("c", look("left"))
    np.testing.assert_allclose(end(play), end(played().send("b", look("left"))), atol=ALIKE)


def test_after_both_gaze_shifts_are_interrupted_nothing_is_held(played, end):
    play = played().send("a", '<wait id="w" duration="9"/>' + look("left")).until(3.0)
    play.send("b", '<wait id="w" duration="9"/>' + look("right")).until(6.0)
    for id in ("a", "b"):
        play.take(interrupt(play.scene, play.now, id))
    np.testing.assert_allclose(end(play), 0.0, atol=ALIKE)


def test_a_gaze_shift_is_taken_back_though_a_nod_shares_its_neck(played, end):
    play = played().send("a", look("left") + '<head id="n" lexeme="NOD" start="0.4" repetition="3"/>').until(1.2)
    running = play.scene.find("a")
    play.take(leave_out(play.scene, running, frozenset({"l"}), play.now))
    np.testing.assert_allclose(end(play), 0.0, atol=ALIKE)


def test_a_warning_says_that_two_held_postures_together_exceed_a_range(played, end, known):
    down, low = '<headDirectionShift id="l" target="down"/>', LEAN.format("HEAD", "down")
    play = played().send("a", down).until(3.0)
    play.send("b", low).until(6.0).send("c", '<gazeShift id="l" target="0.2 0 0"/>')
    texts = [text for id in ("b:p", "c:l") for text in play.warnings(id) if "from where it would end alone" in text]
    tilt = known.robot.joints("neck")[1]
    assert bool(texts) == bool(np.isclose(end(play)[4], known.limits.upper[tilt], atol=ALIKE))
    assert texts
    assert "skullbase_tilt is beyond its range" in texts[0]


def test_a_step_rises_between_its_times():
    times = np.array([0.0, 1.0, 1.5, 2.0, 3.0])
    np.testing.assert_allclose(rise(times, 1.0, 2.0), [0.0, 0.0, 0.5, 1.0, 1.0], atol=1e-12)
