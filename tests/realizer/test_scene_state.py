"""Queries and updates of a scene, on blocks made by hand."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from kinesic.bml.composition import BlockState
from kinesic.bml.timing.constraints import Point
from kinesic.body.utterance import Utterance
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.realizer.running_block import EndedBlock
from kinesic.realizer.scene import Scene, forget_past

from .small_blocks import HINGE_COUNT, small_block, small_motion, use

SPEECH = '<speech id="s"><text>Yes</text></speech>'
TIMES = {"h": {"start": -0.5, "relax": 1.5, "end": 2.0}}


@pytest.fixture
def scene(known) -> Scene:
    return Scene.of(known, 3.0, ahead=0.25)


def test_new_scene_stays_in_the_rest_posture_from_its_start_time(known, scene):
    assert scene.motion.start == 3.0
    assert (scene.motion.controls == known.robot.skeleton.rest).all()
    assert (scene.ahead, scene.blocks, scene.runs, Scene.of(known).ahead) == (0.25, (), 0, 0.0)
    assert Scene.of(known).motion.start == 0.0
    assert scene.setup is known
    named = Scene.of(known, character="Anna").setup
    assert (named.character, known.character) == ("Anna", None)


def test_context_of_a_request_contains_active_and_ended_blocks(scene):
    gone = {Point("z", "g", "stroke"): 1.0, Point("a", "h", "end"): 0.5, Point("a", "old", "end"): 0.7}
    before = replace(scene, ended=(EndedBlock("z", BlockState.DONE, gone),))
    context = before.with_block(small_block("a", TIMES, zero=10.0)).context(4.0)
    assert context.now == 4.0
    assert context.states == {"a": BlockState.IN_EXEC}
    assert (context.relaxes, context.ends) == ({"a": 11.5}, {"a": 12.0})
    assert context.times == {
        Point("z", "g", "stroke"): 1.0,
        Point("a", "old", "end"): 0.7,
        Point("a", "h", "start"): 9.5,
        Point("a", "h", "relax"): 11.5,
        Point("a", "h", "end"): 12.0,
        Point("a", "bml", "start"): 10.0,
        Point("a", "bml", "end"): 12.0,
    }


def test_blocks_are_found_by_id_and_listed_in_order_of_arrival(scene):
    waiting = small_block("w", state=BlockState.LURKING)
    subsiding = small_block("a", state=BlockState.SUBSIDING)
    both = scene.with_block(waiting).with_block(subsiding)
    assert both.find("a") is subsiding
    assert both.find("b") is None
    assert list(both.states.items()) == [("w", BlockState.LURKING), ("a", BlockState.SUBSIDING)]
    assert both.playing == (subsiding,)


def test_new_version_of_a_block_replaces_it_at_the_same_position(scene):
    first, second, later = small_block("a"), small_block("b"), small_block("a", zero=9.0)
    assert scene.with_block(first).with_block(second).with_block(later).blocks == (later, second)


def test_occupancies_of_a_new_block_follow_the_lasting_ones_and_name_their_block(scene):
    held = use("old:z", "look", offset=np.zeros(HINGE_COUNT))
    blocks = [small_block(id, motion=small_motion(), occupancy=[use("g", "l_hand")]) for id in "ab"]
    busy = replace(scene, lasting=(held,), blocks=tuple(blocks))
    assert [entry.behaviour for entry in busy.occupancy] == ["old:z", "a:g", "b:g"]
    assert [entry.behaviour for entry in busy.occupancy_without("a")] == ["old:z", "b:g"]
    assert busy.occupancy[1].relax == 4.0


def test_scene_lists_only_speech_of_running_blocks(scene):
    said = {"s": Utterance(2.0)}
    blocks = [
        small_block(id, {"s": {"start": 0.5}}, inside=SPEECH, utterances=said, zero=4.0, state=state)
        for id, state in (("a", BlockState.IN_EXEC), ("w", BlockState.LURKING))
    ]
    (speech,) = replace(scene, blocks=tuple(blocks)).speeches
    assert (speech.block, speech.behaviour, speech.begin, speech.end) == ("a", "s", 4.5, 6.5)


@pytest.mark.parametrize(
    ("waits", "earliest"),
    [
        ({}, -inf),
        ({"gone": "end"}, -inf),
        ({"a": "relax"}, 11.5),
        ({"a": "end"}, 12.0),
        ({"a": "end", "b": "end"}, 12.0),
        ({"b": "end", "a": "relax"}, 11.5),
    ],
)
def test_waiting_block_starts_after_the_last_of_its_dependencies(scene, waits, earliest):
    busy = scene.with_block(small_block("a", TIMES, zero=10.0)).with_block(small_block("b", TIMES, zero=5.0))
    assert busy.earliest_start(small_block("w", waits=waits)) == earliest


def test_waiting_block_may_start_50_ms_before_the_commands_of_its_start_are_sent(scene):
    waiting = small_block("w", state=BlockState.LURKING, waits={"a": "end"})
    busy = scene.with_block(small_block("a", TIMES, zero=10.0)).with_block(waiting)
    assert busy.next_time == pytest.approx(12.0 - 0.25 - 0.05)
    assert busy.may_start(waiting, busy.next_time)
    assert not busy.may_start(waiting, busy.next_time - 0.001)


@pytest.mark.parametrize("state", [BlockState.PENDING, BlockState.IN_EXEC])
def test_only_blocks_in_the_waiting_state_may_start(scene, state):
    assert not scene.may_start(small_block("w", state=state), 1e9)
    assert scene.may_start(small_block("w", state=BlockState.LURKING), 0.0)


def test_block_that_waits_for_a_waiting_block_may_not_start(scene):
    waiting = small_block("w", state=BlockState.LURKING, waits={"a": "end"})
    first = small_block("a", TIMES, state=BlockState.LURKING, waits={"b": "end"})
    assert not scene.with_block(first).may_start(waiting, 1e9)
    assert scene.may_start(waiting, 0.0)


def test_next_event_of_a_scene_is_its_first_scheduled_message_or_block_start(scene):
    assert scene.next_time == inf
    message = ScheduledFeedback(7.0, "text")
    told = replace(scene, agenda=(message, ScheduledFeedback(8.0, "later")))
    assert told.next_time == 7.0
    assert told.with_block(small_block("w", state=BlockState.LURKING)).next_time == -inf


def test_earliest_motion_change_is_after_the_sent_commands_and_the_motion_start(scene):
    assert scene.first_change(2.0) == 3.0
    assert scene.first_change(5.0) == 5.25


def test_new_outgoing_feedback_of_a_scene_is_appended_to_earlier_feedback(scene):
    first, second, third = (ScheduledFeedback(time, "text") for time in (1.0, 2.0, 3.0))
    assert scene.with_feedback(first).with_feedback(second, third).outgoing_feedback == (first, second, third)


@pytest.mark.parametrize("state", [BlockState.DONE, BlockState.INTERRUPTED])
def test_only_blocks_that_end_as_done_leave_a_held_posture(scene, state):
    held, old = (use("z", "look", end=end, offset=np.zeros(HINGE_COUNT)) for end in (5.0, 1.0))
    block = small_block("a", TIMES, zero=10.0, motion=small_motion(), occupancy=[held, use("g", "l_hand")])
    busy = replace(scene, lasting=(old,), blocks=(block, small_block("b")))
    after = busy.without_block(block, state)
    assert after.lasting == ((held,) if state is BlockState.DONE else (old,))
    assert [active.id for active in after.blocks] == ["b"]
    (ended,) = after.ended
    assert (ended.id, ended.state, ended.points) == ("a", state, block.points)


def test_replanning_request_of_an_ended_block_is_removed(scene):
    requests = tuple(small_block(id).prepared.request for id in "ab")
    after = replace(scene, replans=requests).without_block(small_block("a"), BlockState.DONE)
    assert after.replans == requests[1:]


def test_last_32_ended_blocks_are_remembered_once_per_id(scene):
    for number in range(34):
        scene = scene.without_block(small_block(f"b{number}"), BlockState.DONE)
    assert [ended.id for ended in scene.ended] == [f"b{number}" for number in range(2, 34)]
    again = scene.without_block(small_block("b5"), BlockState.FAILED)
    assert len(again.ended) == 32
    assert [(ended.id, ended.state) for ended in again.ended if ended.id == "b5"] == [("b5", BlockState.FAILED)]
    assert again.ended[-1].id == "b5"


def test_occupied_hinges_are_the_union_over_all_occupancies(scene):
    assert not scene.hinges_of([]).any()
    assert np.flatnonzero(scene.hinges_of([use(hinges=[1, 4]), use(hinges=[4, 6])])).tolist() == [1, 4, 6]


@pytest.mark.parametrize("is_idle", [True, False])
def test_motion_older_than_half_a_second_is_forgotten_after_two_seconds(scene, is_idle):
    block = small_block("a", motion=small_motion())
    moving = replace(scene, motion=small_motion(), blocks=(block,), idle=block if is_idle else None)
    assert forget_past(moving, 1.999) is moving
    after = forget_past(moving, 2.0)
    assert after.motion.start == after.blocks[0].merged.trajectory.start == pytest.approx(1.5)
    assert len(after.motion.controls) == 250
    assert (after.idle is not None) == is_idle
    if is_idle:
        assert after.idle.merged.layer.start == pytest.approx(1.5)
