"""Blocks that begin beside others, after them, or when they are told to."""

import pytest

from kinesic.bml.composition import BlockState
from kinesic.motion.trajectory import STEP
from kinesic.realizer.realizer import begin

NOD = '<head id="h" lexeme="NOD"/>'
BEAT = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>'
HELD = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" relax="1.4"/>'
LEFT = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/>'
OPEN = '<gesture id="g" lexeme="BEAT"/>'
HELLO = '<speech id="s"><text>Hello <sync id="m"/>there</text></speech>'
TICK = 0.01  # [s]


def test_merge_adds_to_what_plays(play):
    play.send("a", BEAT).until(0.3).send("b", NOD).until(5.0)
    assert play.warnings() == []
    assert play.at("a:start") < play.at("b:start") < play.at("b:h:stroke") < play.at("a:end")


def test_merge_leaves_out_what_meets_a_part_that_plays(play):
    play.send("a", HELD).until(0.5).send("b", BEAT + NOD).until(5.0)
    assert len(play.warnings("b:g")) == 1
    assert "a:g" in play.warnings("b:g")[0]
    assert play.was_told("b:h:stroke")
    assert not play.was_told("b:g:stroke")
    assert play.at("a:g:stroke") < play.at("a:end")


def test_a_block_whose_required_part_is_busy_is_not_performed(play):
    play.send("a", HELD).until(0.5)
    play.send("b", f"<required>{BEAT}</required>{NOD}").until(5.0)
    assert play.state("b") is BlockState.FAILED
    assert "requires g" in play.warnings("b")[-1]
    assert not play.was_told("b:start")
    assert not play.was_told("b:h:stroke")
    assert play.at("a:g:stroke") < play.at("a:end")
    play.send("c", "<required><head id='h' lexeme='NOD'/></required>").until(9.0)
    assert play.was_told("c:h:stroke")


def test_a_gesture_whose_hand_is_busy_takes_the_other(play):
    alone = play.ready("b", OPEN).plan
    play.send("a", HELD).until(0.5).send("b", OPEN).until(5.0)
    (text,) = play.warnings()
    assert 'id="b:g" type="CANNOT_CREATE_BEHAVIOR"' in text
    assert "moved to the left hand: its stroke begins at 0.47 s, the right hand is busy with a:g until 0.90 s" in text
    assert play.at("b:start") == pytest.approx(0.5, abs=STEP)
    late = play.at("b:g:stroke") - play.at("b:start")
    assert late == pytest.approx(next(s.planned for s in alone.syncs if s.sync == "stroke"), abs=0.01)
    assert play.at("a:g:stroke") < play.at("a:end")


def test_a_gesture_of_two_hands_is_done_by_the_free_one(play):
    play.send("a", HELD).until(0.5).send("b", '<gesture id="g" lexeme="WELCOME"/>')
    assert [need.roles for need in play.scene.find("b").occupancy] == [{"l_hand"}]
    (text,) = play.until(6.0).warnings()
    assert "done by the left hand alone: its stroke begins at" in text
    assert "the right hand is busy with a:g until" in text
    assert play.at("b:start") == pytest.approx(0.5, abs=STEP)
    assert play.was_told("b:g:stroke")


def test_a_gesture_that_is_to_be_of_two_hands_waits_or_is_left_out(play):
    play.send("a", HELD).until(0.5).send("b", '<gesture id="g" lexeme="WELCOME" mode="BOTH_HANDS"/>').until(6.0)
    assert not any("alone" in text for text in play.warnings())


def test_it_is_the_other_hand_that_moves(play):
    play.send("a", HELD).until(0.5).send("b", OPEN)
    assert [need.roles for need in play.scene.find("b").occupancy] == [{"l_hand"}]
    assert play.scene.find("b").prepared.plan.keyframes.outcomes["g"].kind == "substituted"


def test_what_is_required_may_take_the_other_hand(play):
    play.send("a", BEAT).until(0.5).send("b", f"<required>{OPEN}</required>").until(5.0)
    assert play.was_told("b:g:stroke")


def test_a_pointing_hand_that_is_busy_leaves_it_to_the_other(play):
    point = '<pointing id="p" target="audience"{}/>'
    play.send("a", BEAT).until(0.5).send("b", point.format("")).until(6.0)
    assert "moved to the left hand" in play.warnings("b:p")[0]
    play.send("c", BEAT).until(6.5).send("d", point.format(' mode="RIGHT_HAND"')).until(12.0)
    assert not any("moved to" in text for text in play.warnings("d:p"))


def test_a_gesture_for_which_both_hands_are_busy_is_left_out(play):
    play.send("a", HELD + HELD.replace('"g"', '"h"').replace("RIGHT", "LEFT")).until(0.5).send("b", OPEN + NOD).until(
        5.0
    )
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
def test_a_hand_that_will_be_free_by_then_is_taken(play, how):
    play.send("a", BEAT).until(0.5)
    assert play.ready("b", OPEN, how).request.engaged == ()


def test_a_gesture_that_interrupts_another_takes_its_hand(play):
    both = '<bmla:interrupt id="i" target="a" start="0"/>' + OPEN
    play.send("a", BEAT).until(0.5).send("b", both).until(6.0)
    assert not any("moved to" in text for text in play.warnings("b:g"))
    assert play.was_told("b:g:stroke")


def test_append_begins_when_all_have_ended(play):
    play.send("a", BEAT).send("n", NOD).send("b", NOD, 'composition="APPEND"').send("c", "", 'composition="APPEND"')
    assert play.scene.states == {
        "a": BlockState.IN_EXEC,
        "n": BlockState.IN_EXEC,
        "b": BlockState.LURKING,
        "c": BlockState.LURKING,
    }
    play.until(8.0)
    assert play.at("b:start") == pytest.approx(play.at("a:end"), abs=2 * STEP)
    assert play.at("c:start") == pytest.approx(play.at("b:end"), abs=2 * STEP)
    assert play.at("n:end") < play.at("b:start")
    assert play.warnings() == []


def test_append_after_waits_for_those_it_names(play):
    play.send("a", BEAT).send("n", NOD).send("b", LEFT, 'composition="APPEND-AFTER(n,gone)"').until(6.0)
    assert play.at("n:end") <= play.at("b:start") + STEP < play.at("a:end")


def test_chunk_after_overlaps_the_retraction(play):
    play.send("a", BEAT).send("b", BEAT, 'bmla:chunkAfter="a"').until(8.0)
    assert play.at("b:start") == pytest.approx(play.at("a:relax"), abs=2 * STEP)
    assert play.at("b:start") < play.at("a:end")
    assert play.was_told("b:g:stroke")
    assert play.warnings() == []


def test_chunk_before_holds_back_a_block_that_waits(play):
    play.send("a", NOD).send("c", LEFT, 'composition="APPEND"').send("b", HELD, 'bmla:chunkBefore="c"').until(8.0)
    assert play.at("c:start") == pytest.approx(play.at("b:relax"), abs=2 * STEP)


def test_a_block_that_would_wait_for_itself_does_not(play):
    play.send("a", NOD).send("b", LEFT, 'composition="APPEND-AFTER(a)"')
    play.send("c", BEAT, 'composition="APPEND-AFTER(b)" bmla:chunkBefore="b"').until(10.0)
    assert play.at("b:end") <= play.at("c:start") + STEP


def test_a_speech_while_another_speaks_is_left_out_by_name(play):
    play.send("a", HELLO).until(0.1).send("b", HELLO + NOD).until(3.0)
    assert len(play.warnings("b:s")) == 1
    assert "a:s" in play.warnings("b:s")[0]
    assert not play.was_told("b:s:start")
    assert play.was_told("b:h:stroke")


def test_appended_speech_waits(play):
    play.send("a", HELLO).send("b", HELLO, 'composition="APPEND"').until(4.0)
    assert play.warnings() == []
    assert play.at("b:s:start") == pytest.approx(play.at("a:s:end"), abs=2 * STEP)
    assert play.at("a:s:start") < play.at("a:s:m") < play.at("a:s:end")


def test_an_interrupt_and_what_it_activates_at_the_same_time(play):
    talk = '<speech id="s"><text>One two <sync id="m"/>three four five six</text></speech>'
    play.send("a", talk).send("c", HELLO, 'bmla:preplan="true"')
    play.send("b", '<bmla:activate id="a" target="c" start="a:s:m"/><bmla:interrupt id="i" target="a" start="a:s:m"/>')
    play.until(5.0)
    assert play.warnings() == []
    assert play.at("c:s:start") == pytest.approx(play.at("a:s:m"), abs=2 * TICK)


def test_what_refers_to_the_past_is_told_at_once(play):
    play.send("a", HELLO).until(0.5)
    play.send("b", '<wait id="w" start="a:s:start" end="a:s:end"/>').until(3.0)
    assert 0.5 <= play.at("b:w:start") < 0.5 + TICK
    assert play.at("b:w:end") == pytest.approx(play.at("a:s:end"), abs=1e-6)


def test_a_preplanned_block_waits_until_it_is_activated(play):
    play.send("a", NOD, 'bmla:preplan="true"').until(3.0)
    assert play.state("a") is BlockState.PENDING
    assert not play.was_told("a:start")
    play.send("b", '<bmla:activate id="x" target="a" start="0.5"/>').until(6.0)
    assert play.at("a:start") == pytest.approx(3.5, abs=2 * TICK)
    assert play.state("a") is BlockState.DONE


def test_a_block_activates_others_when_it_begins_and_append_does_not_wait_for_those(play):
    play.send("a", NOD, 'bmla:preplan="true"').send("b", LEFT, 'composition="APPEND" bmla:onStart="a"')
    assert play.scene.states == {"a": BlockState.IN_EXEC, "b": BlockState.IN_EXEC}


def test_references_to_other_blocks_are_met(play):
    play.send("a", BEAT).until(0.2)
    play.send("b", '<head id="h" lexeme="NOD" start="a:g:stroke + 0.2"/>').until(6.0)
    assert play.at("b:h:start") == pytest.approx(play.at("a:g:stroke") + 0.2, abs=0.011)
    play.send("c", '<head id="h" lexeme="NOD" start="gone:g:stroke"/>').until(6.5)
    assert len(play.warnings("c:h")) == 1


def test_a_block_that_comes_too_late_for_others_says_so(play):
    play.send("a", BEAT)
    coming = play.ready("b", '<head id="h" lexeme="NOD" start="a:g:end"/>')
    play.until(1.0).take(begin(play.scene, coming, play.now))
    assert any("too late" in text for text in play.warnings("b"))


def test_what_is_handed_over_early_changes_later(played):
    play = played(ahead=0.3).send("a", BEAT)
    play.until(4.0)
    assert play.at("a:start") == pytest.approx(0.3, abs=STEP)
