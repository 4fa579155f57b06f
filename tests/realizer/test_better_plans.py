"""Better plans for blocks that play and wait."""

import pytest

from kinesic.realizer.realizer import begin, improve_block, ready, take_replans

BEAT = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>'


HURRIED = "".join(f'<gesture id="g{k}" lexeme="BEAT" mode="RIGHT_HAND" stroke="{1.2 + 0.5 * k}"/>' for k in range(5))


def test_a_large_block_is_improved_while_it_plays(play):
    play.send("a", HURRIED)
    assert play.warnings() == []
    play.scene, (wish,) = take_replans(play.scene)
    better = ready(wish, play.scene.setup).plan
    play.until(0.2)
    after = improve_block(play.scene, "a", better, play.now)
    assert after is not None
    assert take_replans(after)[1] == ()
    play.scene = after
    play.until(8.0)
    strokes = {sync.behaviour: sync.planned for sync in better.syncs if sync.sync == "stroke"}
    assert {id: play.at(f"a:{id}:stroke") for id in strokes} == pytest.approx(strokes, abs=0.011)
    assert len(play.predictions("a")) == 2
    assert len(play.warnings()) == len(better.notices)
    assert improve_block(play.scene, "a", better, play.now) is None


def test_a_better_plan_keeps_to_the_hand_that_others_leave_free(play):
    play.send("a", '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>').until(0.3)
    open_ = "".join(f'<gesture id="g{k}" lexeme="BEAT" stroke="{0.8 + 1.2 * k}"/>' for k in range(5))
    play.send("b", open_)
    play.scene, (wish,) = take_replans(play.scene)
    better = ready(wish, play.scene.setup).plan
    before = play.scene.find("b").ready.plan
    assert better.keyframes.uses == before.keyframes.uses
    assert before.keyframes.uses["g0"] == {"l_hand"}
    assert before.keyframes.uses["g4"] == {"r_hand"}
    assert improve_block(play.scene, "b", better, play.now) is not None


def test_what_no_better_plan_mends_is_warned(play):
    coming = play.ready("a", HURRIED)
    play.take(begin(play.scene, coming, play.now)).until(8.0)
    assert len(play.warnings()) == len(coming.plan.notices) > 0


def test_a_block_that_waits_gets_a_better_plan(play):
    play.send("w", '<wait id="w" duration="1"/>').send("a", HURRIED, 'composition="APPEND"')
    play.scene, (wish,) = take_replans(play.scene)
    after = improve_block(play.scene, "a", ready(wish, play.scene.setup).plan, play.now)
    assert after is not None
    play.scene = after
    play.until(9.0)
    assert play.at("a:g4:stroke") == pytest.approx(1.0 + 1.2 + 0.5 * 4, abs=0.03)
