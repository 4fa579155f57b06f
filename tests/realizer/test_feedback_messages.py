"""Identity, interruption and withdrawal of single feedback messages."""

from dataclasses import replace
from math import inf

import pytest

from kinesic.bml.composition import BlockState
from kinesic.planning.syncs import SyncTime
from kinesic.realizer.feedback import (
    Progress,
    ScheduledFeedback,
    block_span,
    order_feedback,
    retime_feedback,
    schedule_feedback,
    times_by_behaviour,
    withdraw_feedback,
    withdraw_provisional,
)


def passed(point: str, behaviour: str | None = None, *, time: float = 12.0, run: int = 3) -> ScheduledFeedback:
    return ScheduledFeedback(time, Progress("b", behaviour, point, 2.0, run=run), 5)


TEXT = ScheduledFeedback(12.0, "<x/>", 5)


def test_message_of_an_interrupted_block_has_the_new_time_on_both_clocks():
    message = passed("end").interrupted_at(11.5)
    assert (message.time, message.content.time, message.sender) == (11.5, 1.5, 5)
    assert message.content.state is BlockState.INTERRUPTED
    assert 'time="1.5"' not in passed("end").xml
    assert 'globalTime="11.5"' in message.xml
    with pytest.raises(TypeError):
        TEXT.interrupted_at(1.0)


def test_keys_of_feedback_messages_differ_by_run_behaviour_and_sync_point_but_not_by_time():
    message = passed("stroke", "h")
    assert message.key == passed("stroke", "h", time=99.0).key == (3, "h", "stroke")
    assert message.content.key == ("h", "stroke")
    assert passed("stroke", "h", run=4).key != message.key
    assert TEXT.key == (12.0, "<x/>", 5)


def test_only_progress_feedback_belongs_to_a_run_and_a_block():
    assert passed("start").belongs_to(3)
    assert not passed("start").belongs_to(2)
    assert not replace(TEXT, sender=3).belongs_to(3)
    assert (passed("start").block, TEXT.block) == ("b", None)


@pytest.mark.parametrize(
    ("message", "is_start", "is_end"),
    [
        (passed("start"), True, False),
        (passed("end"), False, True),
        (passed("start", "h"), False, False),
        (passed("end", "h"), False, False),
        (passed("relax"), False, False),
        (TEXT, False, False),
    ],
)
def test_sync_points_of_behaviours_are_not_block_start_or_block_end(message, is_start, is_end):
    assert (message.is_block_start, message.is_block_end) == (is_start, is_end)


def test_feedback_message_keeps_planned_and_measured_time():
    measured = passed("start").measured_at(12.5)
    assert (measured.time, measured.measured) == (12.0, 12.5)
    assert passed("start").measured is None


def test_relax_of_a_block_is_the_last_relax_or_else_end_of_its_behaviours():
    assert block_span({"h": {"start": 1.0, "relax": 2.0, "end": 5.0}, "g": {"start": 1.0, "end": 3.0}}) == (0, 3, 5)
    assert block_span({"h": {"start": -3.0, "end": -1.0}}) == (-3.0, 0.0, 0.0)
    assert block_span({"h": {}}) == (0.0, 0.0, 0.0)


def test_scheduled_feedback_messages_contain_character_run_block_and_sync_point():
    messages = schedule_feedback("b", {"h": {"start": 0.5}}, 10.0, sender=5, character="Anna", run=3)
    assert {(item.content.character, item.content.run, item.content.block) for item in messages} == {("Anna", 3, "b")}
    assert [(item.content.behaviour, item.content.point, item.content.time) for item in messages] == [
        (None, "start", 0.0),
        ("h", "start", 0.5),
        (None, "relax", 0.5),
        (None, "end", 0.5),
    ]
    assert {item.content.run for item in schedule_feedback("b", {}, 10.0, sender=5)} == {0}
    assert {item.content.state for item in messages} == {None}


@pytest.mark.parametrize(("after", "kept"), [(-inf, []), (11.9, []), (12.0, ["stroke"]), (13.0, ["stroke", "end"])])
def test_withdrawing_feedback_after_a_time_keeps_the_sync_points_up_to_this_time(after, kept):
    agenda = (passed("stroke", "h"), passed("end", "h", time=13.0))
    assert [item.content.point for item in withdraw_feedback(agenda, 3, after=after)] == kept


def test_withdrawing_feedback_of_a_run_keeps_texts_and_feedback_of_other_runs_and_behaviours():
    agenda = (TEXT, passed("end", run=4), passed("end", "h"), passed("end", "g"), passed("end"))
    assert withdraw_feedback(agenda, 3) == agenda[:2]
    assert withdraw_feedback(agenda, 3, frozenset({"h"})) == (*agenda[:2], *agenda[3:])
    assert withdraw_feedback(agenda, 3, frozenset()) == agenda


def test_provisional_warnings_are_withdrawn_by_block():
    agenda = (replace(TEXT, unless_improved="b"), replace(TEXT, unless_improved="c"), TEXT, passed("end"))
    assert withdraw_provisional(agenda, "b") == agenda[1:]


def test_pending_sync_points_move_no_earlier_than_the_change_time():
    agenda = (passed("ready", "h", time=10.0), passed("stroke", "h", time=11.0), passed("end", "h", time=12.0), TEXT)
    fresh = [passed(point, "h", time=time) for point, time in (("ready", 8.0), ("stroke", 9.0), ("end", 13.0))]
    moved = retime_feedback(agenda, 3, [*fresh, passed("relax", "h", time=14.0)], 10.0)
    assert [(item.time, getattr(item.content, "point", "text")) for item in moved] == [
        (10.0, "ready"),
        (10.0, "stroke"),
        (12.0, "text"),
        (13.0, "end"),
    ]


def test_merged_feedback_messages_of_equal_times_keep_the_order_of_their_lists():
    first, second, earlier = TEXT, replace(TEXT, content="<y/>"), replace(TEXT, time=1.0)
    assert order_feedback((first,), (earlier, second)) == (earlier, first, second)
    assert order_feedback() == ()


def test_planned_times_are_grouped_by_behaviour_in_order():
    syncs = (SyncTime("h", "end", 0.0, 2.0), SyncTime("g", "start", 0.5, 0.6), SyncTime("h", "start", 0.1, 0.2))
    times = times_by_behaviour(syncs)
    assert times == {"h": {"end": 2.0, "start": 0.2}, "g": {"start": 0.6}}
    assert list(times["h"]) == ["end", "start"]
