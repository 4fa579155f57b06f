"""Life cycle of a block in a scene, with its feedback."""

import re
from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import BmlError
from kinesic.bml.composition import BlockState
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request

HELLO = '<speech id="s"><text>Hello <sync id="m"/>there</text></speech>'
NOD = '<head id="h" lexeme="NOD"/>'
BEAT = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>'


def test_empty_block_reports_its_start_and_end(play):
    play.send("b").until(0.02)
    assert play.at("b:start") == play.at("b:end") == 0.0
    assert play.warnings() == []
    assert play.state("b") is BlockState.DONE


def test_block_without_id_gets_a_warning_and_a_free_id(play, known: Setup):
    text = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0">{NOD}</bml>'
    for _ in range(2):
        coming = prepare_block(read_request(Message(text), known, context=play.scene.context(play.now)), known)
        play.take(begin(play.scene, coming, play.now))
    assert list(play.scene.states) == ["block", "block.2"]
    for id in play.scene.states:
        assert len([text for text in play.warnings() if f'id="{id}"' in text]) == 1
    play.until(3.0)
    assert play.was_told("block:end")
    assert play.was_told("block.2:end")


def test_each_sync_point_is_reported_once_in_order(play):
    play.until(2.0).send("b", NOD + BEAT, sender=7).until(6.0)
    for behaviour in ("h", "g"):
        points = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")
        times = [play.at(f"b:{behaviour}:{point}") for point in points]
        assert times == sorted(times)
    since = re.search(r'id="b:g:stroke" time="([^"]*)"', "".join(due.xml for due in play.told))
    assert since is not None
    assert play.at("b:g:stroke") == pytest.approx(2.0 + float(since[1]), abs=1e-5)
    assert play.at("b:start") <= play.at("b:relax") <= play.at("b:end")
    assert play.at("b:end") == pytest.approx(play.at("b:g:end"), abs=1e-6)
    assert {due.sender for due in play.told} == {7}
    assert [due.time for due in play.told] == sorted(due.time for due in play.told)


def test_prediction_feedback_is_sent_first_and_has_the_end_time_of_the_block(play):
    play.send("b", BEAT)
    assert "<predictionFeedback" in play.told[0].xml
    end = re.search(r'globalEnd="([^"]*)"', play.told[0].xml)
    assert end is not None
    play.until(4.0)
    assert float(end[1]) == pytest.approx(play.at("b:end"), abs=1e-5)
    assert len(play.predictions("b")) == 1


def test_block_with_a_running_id_is_refused(play):
    play.send("a", BEAT).until(0.3)
    before = play.scene
    play.send("a", NOD)
    assert play.scene.motion is before.motion
    assert play.scene.agenda == before.agenda
    assert "plays already" in play.warnings("a")[-1]
    play.until(5.0).send("a", NOD).until(7.0)
    assert play.state("a") is BlockState.DONE


def test_block_for_another_character_is_refused(played):
    play = played(character="Anna").send("a", NOD, 'characterId="Bert"').send("b", NOD, 'characterId="Anna"')
    play.send("c", "").until(3.0)
    assert "Bert" in play.warnings("a")[0]
    assert not play.was_told("a:start")
    assert all('characterId="Anna"' in due.xml for due in play.told if "b:" in due.xml)
    assert play.was_told("c:end")


def test_new_blocks_are_refused_while_256_blocks_run_or_wait(play):
    waiting = play.ready("w", "", 'composition="APPEND"')
    play.send("a", '<wait id="w" duration="9"/>')
    for number in range(300):
        play.take(begin(play.scene, play.renamed(waiting, f"w{number}"), play.now))
    assert len(play.scene.blocks) == 256
    assert len(play.warnings()) == 300 - 255


def test_invalid_block_does_not_disturb_running_blocks(play):
    play.send("a", BEAT)
    before = play.scene
    with pytest.raises(BmlError):
        play.send("b", '<head id="h" lexeme="NOD" start="nobody:end"/>')
    assert play.scene is before


def test_ended_blocks_and_past_motion_are_removed(play):
    nod, said, empty = play.ready("n", NOD), play.ready("s", HELLO), play.ready("e")
    sizes = []
    for number in range(300):
        made = nod if number % 5 == 0 else said if number % 5 == 2 else empty
        play.take(begin(play.scene, play.renamed(made, f"n{number}"), play.now))
        play.now += 0.5
        play.take(advance(play.scene, play.now))
        scene = play.scene
        sizes.append((len(scene.motion.controls), len(scene.blocks), len(scene.agenda), len(scene.ended)))
    assert np.max(sizes[200:], axis=0).tolist() == np.max(sizes[100:200], axis=0).tolist()
    assert play.scene.motion.start > 140.0
    assert sum(':end" globalTime' in due.xml and "blockProgress" in due.xml for due in play.told) >= 298


def test_each_character_performs_its_part_of_a_block(played):
    both = NOD + '<head id="other" lexeme="NOD" agent="Bert" start="h:end"/>'
    play = played(character="Bert").send("a", both, 'characterId="Anna"').until(4.0)
    assert play.was_told("a:other:stroke")
    assert not any("a:h:" in due.xml for due in play.told if "syncPoint" in due.xml)
    assert any("Anna performs it" in text for text in play.warnings("a:h"))
    nobody = played(character="Cleo").send("a", both, 'characterId="Anna"')
    assert "it is for Anna and Bert, and Cleo performs here" in nobody.warnings("a")[0]


def test_block_scheduled_with_the_same_setup_keeps_its_timeline(known: Setup):
    request = read_request(Message(f'<bml id="b">{HELLO}{BEAT}{NOD}</bml>'), known)
    fresh, reused = prepare_block(request, known).plan, prepare_block(request, known, is_scheduled=True).plan
    assert reused.timeline is request.timeline
    assert fresh.timeline is not request.timeline
    times = np.arange(0.0, fresh.trajectory.duration, 0.05)
    assert np.array_equal(fresh.trajectory.sample(times)[0], reused.trajectory.sample(times)[0])


def test_block_is_scheduled_again_if_its_preferred_hand_is_busy(known: Setup):
    request = read_request(Message('<bml id="b"><gesture id="g" lexeme="BEAT" stroke="1"/></bml>'), known)
    busy = replace(request, busy_hands=(BusyHand("r", -1.0, 9.0, "other:g"),))
    assert prepare_block(busy, known, is_scheduled=True).plan.timeline is not request.timeline
