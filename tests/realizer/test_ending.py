"""Early ends of blocks."""

import pytest

from kinesic.bml.composition import BlockState
from kinesic.motion.limit_check import check_limits
from kinesic.realizer.realizer import interrupt

NOD = '<head id="h" lexeme="NOD"/>'
BEAT = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>'
LEFT_BEAT = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/>'
HELLO = '<speech id="s"><text>Hello <sync id="m"/>there</text></speech>'
TICK_PERIOD = 0.01  # [s] time between two updates of the scene


def test_block_with_replace_composition_interrupts_or_revokes_all_other_blocks(play):
    play.send("a", BEAT + HELLO, sender=1).send("w", NOD, 'composition="APPEND"', sender=2).until(0.8)
    play.send("b", NOD + HELLO, 'composition="REPLACE"', sender=3)
    assert play.state("a") is BlockState.INTERRUPTED
    assert play.state("w") is BlockState.REVOKED
    assert len(play.warnings("w")) == 1
    assert [spoken.block for spoken in play.scene.speeches] == ["b"]
    play.until(6.0)
    assert play.at("a:end") == pytest.approx(0.8)
    assert not play.was_told("a:g:end")
    assert 'kinesic:state="INTERRUPTED"' in next(due.xml for due in play.told if 'id="a:end"' in due.xml)
    assert play.was_told("b:h:stroke")
    assert not play.was_told("w:start")
    assert play.scene.motion.controls[-1] == pytest.approx(play.scene.setup.robot.skeleton.rest, abs=1e-6)


def test_motion_stays_within_limits_if_a_block_is_replaced_during_a_stroke(play):
    play.send("a", BEAT).until(0.7).send("b", LEFT_BEAT, 'composition="REPLACE"')
    for name, peak in check_limits(play.scene.motion, play.scene.setup.limits).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name


def test_interrupting_one_block_leaves_others_running(play):
    play.send("a", BEAT).send("b", '<head id="h" lexeme="NOD" repetition="4"/>').until(0.7)
    play.take(interrupt(play.scene, play.now, "a")).until(5.0)
    assert play.at("a:end") == pytest.approx(0.7)
    assert not play.was_told("a:g:strokeEnd")
    assert play.was_told("b:h:end")
    assert play.scene.motion.controls[-1] == pytest.approx(play.scene.setup.robot.skeleton.rest, abs=1e-6)


def test_interrupting_all_blocks_ends_them_and_returns_the_robot_to_rest(play):
    play.send("a", BEAT).send("b", NOD).send("c", NOD, 'composition="APPEND"').until(0.5)
    play.take(interrupt(play.scene, play.now)).until(3.0)
    assert [play.state(id) for id in "abc"] == [BlockState.INTERRUPTED, BlockState.INTERRUPTED, BlockState.REVOKED]
    assert play.scene.agenda == ()
    assert play.scene.motion.controls[-1] == pytest.approx(play.scene.setup.robot.skeleton.rest, abs=1e-6)


def test_block_with_an_interrupt_attribute_interrupts_its_target_at_its_start(play):
    play.send("a", BEAT).until(0.5).send("b", NOD, 'bmla:interrupt="a"')
    assert play.state("a") is BlockState.INTERRUPTED
    assert play.state("b") is BlockState.IN_EXEC


def test_interrupt_behaviour_ends_its_target_block_at_its_own_start_time(play):
    play.send("a", '<speech id="s"><text>One two three four five six seven eight nine ten</text></speech>' + BEAT)
    play.send(
        "b", '<bmla:interrupt id="i" target="a" start="1"/><speech id="s" start="i:start"><text>No</text></speech>'
    )
    play.until(4.0)
    assert play.at("a:end") == pytest.approx(1.0, abs=2 * TICK_PERIOD)
    assert play.at("b:i:start") == pytest.approx(1.0)


def test_interrupted_block_frees_head_and_voice_for_the_interrupting_block(play):
    long = '<head id="h" lexeme="NOD" repetition="8"/><speech id="s"><text>One two three four five six</text></speech>'
    inside = '<head id="h" lexeme="SHAKE" start="i:start"/><speech id="s" start="i:start"><text>No</text></speech>'
    play.send("a", long).send("b", '<bmla:interrupt id="i" target="a" start="0.8"/>' + inside).until(5.0)
    assert play.warnings() == []
    assert play.at("b:s:start") == pytest.approx(0.8)
    assert play.was_told("b:h:stroke")
    assert play.at("a:end") == pytest.approx(0.8, abs=2 * TICK_PERIOD)


def test_interrupt_can_end_a_single_behaviour(play):
    play.send("a", BEAT + '<head id="h" lexeme="NOD" repetition="4"/>').until(0.5)
    play.send("b", '<bmla:interrupt id="i" target="a" include="g"/>').until(5.0)
    assert not play.was_told("a:g:stroke")
    assert play.was_told("a:h:end")
    assert play.state("a") is BlockState.DONE
    assert play.at("a:end") == pytest.approx(play.at("a:h:end"), abs=1e-6)


def test_bml_commands_to_missing_blocks_cause_warnings(play):
    play.send("b", '<bmla:interrupt id="i" target="nobody"/><bmla:activate id="j" target="nobody"/>').until(0.1)
    assert len(play.warnings("b:i")) == len(play.warnings("b:j")) == 1
