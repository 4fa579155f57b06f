"""Scheduling of feedback."""

import pytest

from kinesic.bml.composition import BlockState
from kinesic.realizer.feedback import (
    Progress,
    ScheduledFeedback,
    block_span,
    order_feedback,
    retime_feedback,
    schedule_feedback,
    withdraw_feedback,
)

TIMES = {"h": {"start": 0.0, "stroke": 1.0, "relax": 1.5, "end": 2.0}, "s": {"start": 0.5, "m": 0.7, "end": 1.7}}


def keys(dues: tuple[ScheduledFeedback, ...]) -> list[str]:
    return [f"{due.content.behaviour or ''}:{due.content.point}" for due in dues if isinstance(due.content, Progress)]


def test_block_span_covers_all_sync_points() -> None:
    assert block_span({}) == (0.0, 0.0, 0.0)
    assert block_span(TIMES) == (0.0, 1.7, 2.0)
    assert block_span({"h": {"start": -0.5, "end": 1.0}}) == (-0.5, 1.0, 1.0)


def test_feedback_is_scheduled_in_order_of_time() -> None:
    dues = schedule_feedback("b", TIMES, 10.0, sender=4)
    assert keys(dues) == [
        ":start",
        "h:start",
        "s:start",
        "s:m",
        "h:stroke",
        "h:relax",
        "s:end",
        ":relax",
        "h:end",
        ":end",
    ]
    assert [due.time for due in dues] == pytest.approx([10, 10, 10.5, 10.7, 11, 11.5, 11.7, 11.7, 12, 12])
    assert {due.sender for due in dues} == {4}
    assert {due.block for due in dues} == {"b"}
    assert 'id="b:s:m" time="0.7" globalTime="10.7"' in dues[3].xml
    assert 'id="b:relax" globalTime="11.7"' in dues[7].xml


def test_empty_block_has_start_relax_and_end_feedback() -> None:
    assert keys(schedule_feedback("b", {}, 1.0, sender=0)) == [":start", ":relax", ":end"]


def test_sync_points_keep_their_order_despite_rounding_errors_of_their_times() -> None:
    dues = schedule_feedback("b", {"h": {"start": 0.0, "ready": 0.3, "stroke": 0.3 - 1e-9, "end": 1.0}}, 0.0, sender=0)
    assert keys(dues) == [":start", "h:start", "h:ready", "h:stroke", "h:end", ":relax", ":end"]


def test_retimed_feedback_skips_sent_sync_points_and_sends_past_ones_immediately() -> None:
    left = schedule_feedback("b", TIMES, 10.0, sender=0)[4:]
    sooner = {"h": {"start": 0.0, "stroke": 0.8, "relax": 1.2, "end": 1.6}, "s": TIMES["s"]}
    again = retime_feedback(
        (*left, ScheduledFeedback(11.0, "else")), 0, schedule_feedback("b", sooner, 10.0, sender=0), 10.9
    )
    assert keys(again) == ["h:stroke", "h:relax", "h:end", "s:end", ":relax", ":end"]
    assert [due.time for due in again] == pytest.approx([10.9, 11.0, 11.2, 11.6, 11.7, 11.7, 11.7])


def test_feedback_of_some_behaviours_can_be_withdrawn() -> None:
    dues = schedule_feedback("b", TIMES, 0.0, sender=0)
    assert keys(withdraw_feedback(dues, 0, frozenset({"h"}))) == [":start", "s:start", "s:m", "s:end", ":relax", ":end"]
    assert withdraw_feedback(dues, 0) == ()
    assert withdraw_feedback(dues, 1) == dues


def test_feedback_lists_are_merged_by_time() -> None:
    joined = order_feedback(
        schedule_feedback("a", {}, 1.0, sender=0),
        schedule_feedback("b", {}, 0.5, sender=0),
        schedule_feedback("c", {}, 1.0, sender=0),
    )
    assert [due.block for due in joined] == ["b"] * 3 + ["a"] * 3 + ["c"] * 3


def test_measured_times_in_feedback_use_the_kinesic_namespace() -> None:
    due = ScheduledFeedback(12.0, Progress("b", "h", "stroke", 2.0, "Anna")).measured_at(12.034)
    assert 'xmlns:kinesic="urn:kinesic"' in due.xml
    assert 'kinesic:measuredGlobalTime="12.034" kinesic:lag="0.034"' in due.xml
    assert 'characterId="Anna"' in due.xml
    ended = ScheduledFeedback(3.0, Progress("b", None, "end", 2.0, state=BlockState.INTERRUPTED)).measured_at(3.1)
    assert 'kinesic:state="INTERRUPTED" kinesic:measuredGlobalTime="3.1"' in ended.xml
    assert "kinesic" not in ScheduledFeedback(3.0, Progress("b", None, "end", 2.0)).xml


def test_feedback_given_as_xml_text_is_sent_unchanged() -> None:
    assert (ScheduledFeedback(1.0, "<x/>").xml, ScheduledFeedback(1.0, "<x/>").block) == ("<x/>", None)
