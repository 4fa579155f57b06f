"""Starts of blocks: concurrent, appended or activated."""

import pytest

from kinesic.bml.composition import BlockState
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.realizer.realizer import begin

NOD = '<head id="h" lexeme="NOD"/>'
BEAT = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>'
RIGHT_BEAT_WITH_HOLD = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" relax="1.4"/>'
LEFT_BEAT = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/>'
BEAT_OF_ANY_HAND = '<gesture id="g" lexeme="BEAT"/>'
HELLO = '<speech id="s"><text>Hello <sync id="m"/>there</text></speech>'
TICK_PERIOD = 0.01  # [s] time between two updates of the scene


def test_block_with_merge_composition_plays_together_with_a_running_block(play):
    play.send("a", BEAT).until(0.3).send("b", NOD).until(5.0)
    assert play.warnings() == []
    assert play.at("a:start") < play.at("b:start") < play.at("b:h:stroke") < play.at("a:end")


def test_merge_composition_drops_behaviours_of_busy_body_parts(play):
    play.send("a", RIGHT_BEAT_WITH_HOLD).until(0.5).send("b", BEAT + NOD).until(5.0)
    assert len(play.warnings("b:g")) == 1
    assert "a:g" in play.warnings("b:g")[0]
    assert play.was_told("b:h:stroke")
    assert not play.was_told("b:g:stroke")
    assert play.at("a:g:stroke") < play.at("a:end")


def test_block_that_requires_a_gesture_of_a_busy_hand_is_not_performed(play):
    play.send("a", RIGHT_BEAT_WITH_HOLD).until(0.5)
    play.send("b", f"<required>{BEAT}</required>{NOD}").until(5.0)
    assert play.state("b") is BlockState.FAILED
    assert "requires g" in play.warnings("b")[-1]
    assert not play.was_told("b:start")
    assert not play.was_told("b:h:stroke")
    assert play.at("a:g:stroke") < play.at("a:end")
    play.send("c", "<required><head id='h' lexeme='NOD'/></required>").until(9.0)
    assert play.was_told("c:h:stroke")


def test_gesture_of_a_new_block_moves_to_the_free_hand_with_a_warning(play):
    alone = play.ready("b", BEAT_OF_ANY_HAND).plan
    play.send("a", RIGHT_BEAT_WITH_HOLD).until(0.5).send("b", BEAT_OF_ANY_HAND).until(5.0)
    (text,) = play.warnings()
    assert 'id="b:g" type="CANNOT_CREATE_BEHAVIOR"' in text
    assert "moved to the left hand: its stroke begins at 0.49 s, the right hand is busy with a:g until 0.90 s" in text
    assert play.at("b:start") == pytest.approx(0.5, abs=KNOT_INTERVAL)
    late = play.at("b:g:stroke") - play.at("b:start")
    assert late == pytest.approx(next(s.planned for s in alone.syncs if s.sync == "stroke"), abs=0.01)
    assert play.at("a:g:stroke") < play.at("a:end")


def test_two_handed_gesture_is_reduced_to_the_free_hand(play):
    play.send("a", RIGHT_BEAT_WITH_HOLD).until(0.5).send("b", '<gesture id="g" lexeme="WELCOME"/>')
    assert [need.roles for need in play.scene.find("b").occupancy] == [{"l_hand"}]
    (text,) = play.until(6.0).warnings()
    assert "done by the left hand alone: its stroke begins at" in text
    assert "the right hand is busy with a:g until" in text
    assert play.at("b:start") == pytest.approx(0.5, abs=KNOT_INTERVAL)
    assert play.was_told("b:g:stroke")


def test_gesture_requested_for_both_hands_is_not_reduced_to_the_free_hand(play):
    play.send("a", RIGHT_BEAT_WITH_HOLD).until(0.5).send(
        "b", '<gesture id="g" lexeme="WELCOME" mode="BOTH_HANDS"/>'
    ).until(6.0)
    assert not any("alone" in text for text in play.warnings())


def test_gesture_moved_to_the_other_hand_occupies_that_hand(play):
    play.send("a", RIGHT_BEAT_WITH_HOLD).until(0.5).send("b", BEAT_OF_ANY_HAND)
    assert [need.roles for need in play.scene.find("b").occupancy] == [{"l_hand"}]
    assert play.scene.find("b").prepared.plan.keyframes.outcomes["g"].kind == "substituted"


def test_required_gesture_may_use_the_other_hand(play):
    play.send("a", BEAT).until(0.5).send("b", f"<required>{BEAT_OF_ANY_HAND}</required>").until(5.0)
    assert play.was_told("b:g:stroke")


def test_pointing_of_a_new_block_uses_the_free_hand_unless_its_hand_is_given(play):
    point = '<pointing id="p" target="audience"{}/>'
    play.send("a", BEAT).until(0.5).send("b", point.format("")).until(6.0)
    assert "moved to the left hand" in play.warnings("b:p")[0]
    play.send("c", BEAT).until(6.5).send("d", point.format(' mode="RIGHT_HAND"')).until(12.0)
    assert not any("moved to" in text for text in play.warnings("d:p"))


def test_gesture_is_dropped_if_both_hands_are_busy(play):
    both = RIGHT_BEAT_WITH_HOLD + RIGHT_BEAT_WITH_HOLD.replace('"g"', '"h"').replace("RIGHT", "LEFT")
    play.send("a", both).until(0.5).send("b", BEAT_OF_ANY_HAND + NOD).until(5.0)
    assert len(play.warnings("b:g")) == 1
    assert "left out: r_hand busy with a:g" in play.warnings("b:g")[0]


@pytest.mark.parametrize(
    "how",
    [
        'composition="APPEND"',
        'composition="REPLACE"',
        'bmla:interrupt="a"',
        'bmla:chunkAfter="a"',
        'bmla:preplan="true"',
    ],
)
def test_hands_are_not_busy_for_a_block_that_waits_for_or_stops_the_running_block(play, how):
    play.send("a", BEAT).until(0.5)
    assert play.ready("b", BEAT_OF_ANY_HAND, how).request.busy_hands == ()


def test_interrupting_gesture_uses_the_freed_hand(play):
    both = '<bmla:interrupt id="i" target="a" start="0"/>' + BEAT_OF_ANY_HAND
    play.send("a", BEAT).until(0.5).send("b", both).until(6.0)
    assert not any("moved to" in text for text in play.warnings("b:g"))
    assert play.was_told("b:g:stroke")


def test_appended_block_starts_after_all_blocks(play):
    play.send("a", BEAT).send("n", NOD).send("b", NOD, 'composition="APPEND"').send("c", "", 'composition="APPEND"')
    assert play.scene.states == {
        "a": BlockState.IN_EXEC,
        "n": BlockState.IN_EXEC,
        "b": BlockState.LURKING,
        "c": BlockState.LURKING,
    }
    play.until(8.0)
    assert play.at("b:start") == pytest.approx(play.at("a:end"), abs=2 * KNOT_INTERVAL)
    assert play.at("c:start") == pytest.approx(play.at("b:end"), abs=2 * KNOT_INTERVAL)
    assert play.at("n:end") < play.at("b:start")
    assert play.warnings() == []


def test_block_composed_append_after_waits_for_the_named_blocks(play):
    play.send("a", BEAT).send("n", NOD).send("b", LEFT_BEAT, 'composition="APPEND-AFTER(n,gone)"').until(6.0)
    assert play.at("n:end") <= play.at("b:start") + KNOT_INTERVAL < play.at("a:end")


def test_block_composed_chunk_after_starts_during_the_previous_retraction(play):
    play.send("a", BEAT).send("b", BEAT, 'bmla:chunkAfter="a"').until(8.0)
    assert play.at("b:start") == pytest.approx(play.at("a:relax"), abs=2 * KNOT_INTERVAL)
    assert play.at("b:start") < play.at("a:end")
    assert play.was_told("b:g:stroke")
    assert play.warnings() == []


def test_chunk_before_composition_delays_a_waiting_block(play):
    play.send("a", NOD).send("c", LEFT_BEAT, 'composition="APPEND"').send(
        "b", RIGHT_BEAT_WITH_HOLD, 'bmla:chunkBefore="c"'
    ).until(8.0)
    assert play.at("c:start") == pytest.approx(play.at("b:relax"), abs=2 * KNOT_INTERVAL)


def test_chunk_before_composition_that_would_cause_a_waiting_cycle_is_ignored(play):
    play.send("a", NOD).send("b", LEFT_BEAT, 'composition="APPEND-AFTER(a)"')
    play.send("c", BEAT, 'composition="APPEND-AFTER(b)" bmla:chunkBefore="b"').until(10.0)
    assert play.at("b:end") <= play.at("c:start") + KNOT_INTERVAL


def test_overlapping_speech_is_dropped_with_a_warning_that_names_the_running_speech(play):
    play.send("a", HELLO).until(0.1).send("b", HELLO + NOD).until(3.0)
    assert len(play.warnings("b:s")) == 1
    assert "a:s" in play.warnings("b:s")[0]
    assert not play.was_told("b:s:start")
    assert play.was_told("b:h:stroke")


def test_appended_speech_waits_for_running_speech(play):
    play.send("a", HELLO).send("b", HELLO, 'composition="APPEND"').until(4.0)
    assert play.warnings() == []
    assert play.at("b:s:start") == pytest.approx(play.at("a:s:end"), abs=2 * KNOT_INTERVAL)
    assert play.at("a:s:start") < play.at("a:s:m") < play.at("a:s:end")


def test_block_can_interrupt_one_block_and_activate_another_at_the_same_time(play):
    talk = '<speech id="s"><text>One two <sync id="m"/>three four five six</text></speech>'
    play.send("a", talk).send("c", HELLO, 'bmla:preplan="true"')
    play.send("b", '<bmla:activate id="a" target="c" start="a:s:m"/><bmla:interrupt id="i" target="a" start="a:s:m"/>')
    play.until(5.0)
    assert play.warnings() == []
    assert play.at("c:s:start") == pytest.approx(play.at("a:s:m"), abs=2 * TICK_PERIOD)


def test_sync_point_that_refers_to_a_past_one_is_reported_immediately(play):
    play.send("a", HELLO).until(0.5)
    play.send("b", '<wait id="w" start="a:s:start" end="a:s:end"/>').until(3.0)
    assert 0.5 <= play.at("b:w:start") < 0.5 + TICK_PERIOD
    assert play.at("b:w:end") == pytest.approx(play.at("a:s:end"), abs=1e-6)


def test_preplanned_block_waits_for_activation(play):
    play.send("a", NOD, 'bmla:preplan="true"').until(3.0)
    assert play.state("a") is BlockState.PENDING
    assert not play.was_told("a:start")
    play.send("b", '<bmla:activate id="x" target="a" start="0.5"/>').until(6.0)
    assert play.at("a:start") == pytest.approx(3.5, abs=2 * TICK_PERIOD)
    assert play.state("a") is BlockState.DONE


def test_appended_block_does_not_wait_for_the_block_that_it_activates(play):
    play.send("a", NOD, 'bmla:preplan="true"').send("b", LEFT_BEAT, 'composition="APPEND" bmla:onStart="a"')
    assert play.scene.states == {"a": BlockState.IN_EXEC, "b": BlockState.IN_EXEC}


def test_reference_to_another_block_sets_the_start_and_a_missing_block_causes_a_warning(play):
    play.send("a", BEAT).until(0.2)
    play.send("b", '<head id="h" lexeme="NOD" start="a:g:stroke + 0.2"/>').until(6.0)
    assert play.at("b:h:start") == pytest.approx(play.at("a:g:stroke") + 0.2, abs=0.011)
    play.send("c", '<head id="h" lexeme="NOD" start="gone:g:stroke"/>').until(6.5)
    assert len(play.warnings("c:h")) == 1


def test_block_that_references_a_past_sync_point_causes_a_warning(play):
    play.send("a", BEAT)
    coming = play.ready("b", '<head id="h" lexeme="NOD" start="a:g:end"/>')
    play.until(1.0).take(begin(play.scene, coming, play.now))
    assert any("too late" in text for text in play.warnings("b"))


def test_block_starts_0_3_s_after_its_request_if_commands_are_sent_0_3_s_ahead(played):
    play = played(ahead=0.3).send("a", BEAT)
    play.until(4.0)
    assert play.at("a:start") == pytest.approx(0.3, abs=KNOT_INTERVAL)
