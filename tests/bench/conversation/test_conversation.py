"""Benchmark of scripted dialogues."""

import pytest

from kinesic.bench.conversation import bench
from kinesic.bench.conversation.dialogues import EXCHANGE_COUNT, write_dialogue
from kinesic.bench.conversation.record import DialogueRecord


@pytest.fixture(scope="module")
def metrics():
    return {metric.name.removeprefix("conversation."): metric for metric in bench(2, first=2000)}


def test_scripted_dialogues_meet_the_goals_for_motion_gaze_and_processor_load(metrics):
    names = ("limit_ratio", "standing_error_p95", "longest_look", "looks_first_second", "looks_last_second", "load")
    assert {name: metrics[name].value for name in names if metrics[name].ok is not True} == {}
    assert metrics["limit_ratio"].value > 0.1


def test_scripted_dialogues_meet_the_goals_for_turn_taking(metrics):
    names = ("turn_end_median", "turn_end_p95", "false_turn_ends", "missed_interruptions", "false_interruptions")
    assert {name: metrics[name].value for name in names if metrics[name].ok is not True} == {}
    assert metrics["turn_end_median"].value == pytest.approx(0.7, abs=0.01)
    assert metrics["yield_p95"].value < 0.76


def test_dialogue_script_depends_only_on_its_random_seed():
    one, same, other = write_dialogue(3), write_dialogue(3), write_dialogue(4)
    assert one.events == same.events
    assert one.events != other.events
    assert len(one.turns) == len(one.speeches) == EXCHANGE_COUNT
    assert all(turn[1] < speech[0] for turn, speech in zip(one.turns, one.speeches, strict=True))
    assert [time for time, _ in one.events] == sorted(time for time, _ in one.events)


def test_looking_fraction_and_longest_look_are_computed_from_gaze_changes():
    done = DialogueRecord(looks=[(0.0, True), (2.0, False), (3.0, True), (3.5, True), (6.0, False)])
    assert done.looking_fraction(1.0, 4.0) == pytest.approx(2.0 / 3.0)
    assert done.longest_look == 3.0
