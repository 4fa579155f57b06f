"""Times, speech and messages of a running block made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.bml.timing.constraints import Point
from kinesic.body.utterance import Utterance
from kinesic.realizer.running_block import RunningBlock

from .small_blocks import small_block, small_motion, use

SPEECHES = "".join(f'<speech id="{id}"><text>Yes</text></speech>' for id in "stu") + '<head id="h" lexeme="NOD"/>'
TIMES = {"h": {"start": -0.5, "relax": 1.5, "end": 2.0}}


def notice(text: str) -> Notice:
    return Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "b", text)


def test_new_block_has_the_times_of_its_plan_and_its_request():
    prepared = small_block("b", TIMES, zero=4.0).prepared
    made = RunningBlock.of(prepared, BlockState.LURKING, {"a": "end"}, run=3)
    assert (made.zero, made.times, made.waits, made.run) == (4.0, TIMES, {"a": "end"}, 3)
    assert (made.state, made.merged, made.predicted) == (BlockState.LURKING, None, None)
    assert RunningBlock.of(prepared, BlockState.LURKING, {}).run == 0


def test_start_relax_and_end_of_a_running_block_are_clock_times():
    block = small_block("b", TIMES, zero=10.0)
    assert (block.lead_in, block.relax, block.end) == (0.5, 11.5, 12.0)
    assert block.points == {
        Point("b", "h", "start"): 9.5,
        Point("b", "h", "relax"): 11.5,
        Point("b", "h", "end"): 12.0,
        Point("b", "bml", "start"): 10.0,
        Point("b", "bml", "end"): 12.0,
    }


def test_block_moves_if_it_has_more_than_one_posture():
    assert small_block("b", moves=True).prepared.moves
    assert not small_block("b", moves=False).prepared.moves


def test_replanning_keeps_the_speech_that_was_synthesised():
    said = {"s": Utterance(1.0)}
    prepared = small_block("b", utterances=said).prepared
    request = prepared.replan_request
    assert (request.utterances, request.is_decided) == (said, True)
    assert request.block is prepared.plan.timeline.block
    assert not prepared.request.is_decided


def test_running_block_lists_only_speech_that_is_synthesised_and_not_dropped():
    at = {"s": {"start": 0.5}, "u": {"start": 0.7}, "h": {"start": 0.1}}
    said = {"s": Utterance(2.0), "t": Utterance(2.0), "h": Utterance(2.0)}
    (speech,) = small_block("b", at, inside=SPEECHES, utterances=said, zero=4.0).speeches
    assert (speech.block, speech.behaviour, speech.begin, speech.end) == ("b", "s", 4.5, 6.5)


def test_feedback_of_a_block_names_its_run_sender_and_character():
    block = small_block("b", TIMES, zero=10.0, run=4, sender=6, attributes='characterId="Anna"')
    messages = block.agenda()
    assert {(item.sender, item.content.run, item.content.character) for item in messages} == {(6, 4, "Anna")}
    assert (messages[0].time, messages[-1].time) == (9.5, 12.0)
    warning = block.warning(notice("no"), 3.0)
    assert (warning.time, warning.sender) == (3.0, 6)
    assert 'characterId="Anna"' in warning.xml


def test_prediction_feedback_of_a_block_states_its_start_and_end():
    message = small_block("b", TIMES, zero=10.0).prediction(3.0)
    assert (message.time, message.sender) == (3.0, 5)
    assert 'globalStart="9.5"' in message.xml
    assert 'globalEnd="12.0"' in message.xml


@pytest.mark.parametrize(
    ("zero", "times", "differs"),
    [
        (1.0, {"h": {"start": 0.0, "end": 1.0}}, False),
        (1.25, {"h": {"start": 0.0, "end": 1.0}}, False),
        (1.26, {"h": {"start": 0.0, "end": 1.0}}, True),
        (0.74, {"h": {"start": 0.0, "end": 1.0}}, True),
        (1.0, {"h": {"start": 0.0, "end": 1.25}}, False),
        (1.0, {"h": {"start": 0.0, "end": 1.26}}, True),
        (1.0, {"h": {"start": 0.26, "end": 1.0}}, True),
        (1.0, {"h": {"start": 0.0}}, True),
        (1.0, {"h": {"start": 0.0, "end": 1.0}, "g": {}}, True),
    ],
)
def test_block_differs_from_its_prediction_if_its_times_change_by_more_than_the_tolerance(zero, times, differs):
    block = small_block("b", {"h": {"start": 0.0, "end": 1.0}}, zero=1.0)
    assert block.differs_from_prediction(0.25)
    assert replace(block, predicted=(zero, times)).differs_from_prediction(0.25) is differs


def test_warnings_of_a_provisional_plan_are_due_after_a_second_and_dropped_if_it_is_refined():
    known, late = notice("known"), notice("late")
    quick = small_block("b", notices=(known, late), quick_notices=(known,), is_provisional=True)
    assert quick.final_notices == (known,)
    (warning,) = quick.provisional_warnings(4.0)
    assert (warning.time, warning.unless_improved, warning.sender) == (5.0, "b", 5)
    assert "late" in warning.xml
    full = small_block("b", notices=(known, late), quick_notices=(known,))
    assert full.final_notices == (known, late)
    assert full.provisional_warnings(4.0) == ()


def test_block_without_some_behaviours_keeps_its_motion():
    motion = small_motion()
    entries = [use("g", "l_hand"), use("k", "r_hand"), use("f", "look")]
    block = small_block("b", {"g": {}, "k": {}, "f": {}, "s": {}}, motion=motion, occupancy=entries)
    left = block.without(frozenset({"k", "g", "s"}))
    assert list(left.times) == ["f"]
    assert left.merged.occupancy == (entries[2],)
    assert left.merged.dropped == ("g", "k")
    assert left.merged.trajectory is motion
    assert left.without(frozenset({"f"})).merged.dropped == ("g", "k", "f")
    still = small_block("b", {"s": {}}).without(frozenset({"s"}))
    assert (still.merged, still.times, still.occupancy) == (None, {}, ())


def test_block_truncated_at_a_time_keeps_only_its_later_motion():
    still = small_block("b")
    assert still.since(1.0) is still
    assert small_block("b", motion=small_motion()).since(1.0).merged.trajectory.start == pytest.approx(1.0)
    assert np.isclose(small_block("b", motion=small_motion()).since(1.0).merged.layer.start, 1.0)
