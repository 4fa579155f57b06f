"""Pending feedback of the loop and its changes by proposals."""

from math import inf

import pytest

from kinesic.bml.composition import BlockState
from kinesic.realizer.feedback import ScheduledFeedback, retime_feedback, schedule_feedback
from kinesic.serve.feedback_queue import FeedbackQueue, PendingBlock

TIMES = {"h": {"start": 0.0, "stroke": 1.0, "end": 2.0}}


def block(zero: float = 10.0, run: int = 1) -> tuple[ScheduledFeedback, ...]:
    return schedule_feedback("b", TIMES, zero, sender=3, run=run)


def send(queue: FeedbackQueue, until: float) -> list[str]:
    """Send all due messages and return their points."""
    sent = []
    while queue.due(until) is not None:
        content = queue.sent().content
        sent.append(content if isinstance(content, str) else f"{content.behaviour or ''}:{content.point}")
    return sent


@pytest.fixture
def queue() -> FeedbackQueue:
    made = FeedbackQueue()
    assert made.propose((), block())
    return made


def test_sent_sync_point_is_not_sent_again_at_another_time(queue: FeedbackQueue) -> None:
    assert send(queue, 10.5) == [":start", "h:start"]
    assert queue.propose((), block(zero=10.2)[2:]) is False
    assert queue.propose(block()[:2], retime_feedback(block()[2:], 1, block(zero=10.2), 10.5))
    assert send(queue, 13.0) == ["h:stroke", "h:end", ":relax", ":end"]


def test_withdrawal_of_a_sent_sync_point_is_refused(queue: FeedbackQueue) -> None:
    send(queue, 11.0)
    assert not queue.propose(block()[:2], block()[3:])
    assert queue.propose(block()[:3], block()[3:])


def test_sync_point_earlier_than_a_sent_point_is_refused(queue: FeedbackQueue) -> None:
    send(queue, 11.0)
    assert not queue.propose(block()[:3], (*block(zero=10.9, run=2), *block()[3:]))
    assert queue.propose(block()[:3], (*block(zero=11.0, run=2), *block()[3:]))


def test_proposal_may_withdraw_a_feedback_text_that_was_sent(queue: FeedbackQueue) -> None:
    doubt = ScheduledFeedback(10.2, "<doubt/>", unless_improved="b")
    assert queue.propose((), (*block()[:2], doubt, *block()[2:]))
    send(queue, 10.5)
    assert queue.propose(block()[:2], block()[2:])


def test_pending_block_has_its_start_and_end_time_or_minus_infinity_as_start_once_begun(queue: FeedbackQueue) -> None:
    assert queue.pending_blocks() == [PendingBlock("b", 10.0, 12.0)]
    send(queue, 10.5)
    assert queue.pending_blocks() == [PendingBlock("b", -inf, 12.0)]
    assert queue.propose(block()[:2], (*block()[2:], *block(zero=12.5, run=2)))
    assert [(pending.start, pending.end) for pending in queue.pending_blocks()] == [(-inf, 12.0), (12.5, 14.5)]
    send(queue, 20.0)
    assert queue.pending_blocks() == []


def test_emergency_stop_ends_blocks_that_have_begun(queue: FeedbackQueue) -> None:
    assert queue.propose((), (*block(), *block(zero=11.9, run=2)))
    send(queue, 11.5)
    queue.halt(11.53)
    (end,) = queue.messages
    assert (end.time, end.content.run, end.content.state) == (11.53, 1, BlockState.INTERRUPTED)
    assert send(queue, 12.0) == [":end"]
    assert queue.propose((*block()[:3], block()[-1].interrupted_at(11.53)), ())
    assert not queue.messages


def test_emergency_stop_sends_an_irrevocable_block_start_and_the_end_of_the_block_at_once(queue: FeedbackQueue) -> None:
    assert queue.propose((*block()[:2], block()[-1].interrupted_at(10.4)), ())
    queue.halt(9.0)
    assert send(queue, 9.0) == [":start", ":end"]


def test_new_planner_may_reschedule_the_feedback_it_received_at_its_start(queue: FeedbackQueue) -> None:
    send(queue, 10.5)
    queue.hand_over(tuple(queue.messages))
    assert queue.propose((), block()[2:])
    assert send(queue, 13.0) == ["h:stroke", "h:end", ":relax", ":end"]


def test_feedback_queue_keeps_the_highest_run_number_of_proposed_sync_points(queue: FeedbackQueue) -> None:
    assert FeedbackQueue().runs == 0
    assert queue.runs == 1
    assert queue.propose((), (*block(), *block(zero=20.0, run=4)))
    assert queue.runs == 4
    assert queue.propose((), (*block(), ScheduledFeedback(30.0, "<doubt/>")))
    assert queue.runs == 4


def test_first_queued_feedback_is_due_at_its_scheduled_time(queue: FeedbackQueue) -> None:
    assert FeedbackQueue().due(1e9) is None
    assert queue.due(9.999) is None
    assert queue.due(10.0) is queue.messages[0]
    assert queue.due(99.0) is queue.messages[0]
    assert [message.time for message in queue.messages] == sorted(message.time for message in block())


def test_irrevocable_feedback_is_sent_despite_a_later_proposal_without_it(queue: FeedbackQueue) -> None:
    assert queue.propose(block()[:2], block()[2:])
    assert queue.propose((), ())
    assert send(queue, 99.0) == [":start", "h:start"]


def test_irrevocable_messages_proposed_twice_are_queued_once(queue: FeedbackQueue) -> None:
    assert queue.propose(block(), ())
    assert queue.propose(block(), ())
    assert queue.messages == sorted(block(), key=lambda message: message.time)


def test_feedback_message_is_sent_again_only_after_it_was_withdrawn() -> None:
    queue, doubt = FeedbackQueue(), ScheduledFeedback(1.0, "<doubt/>", unless_improved="b")
    assert queue.propose((), (doubt,))
    assert send(queue, 1.0) == ["<doubt/>"]
    assert queue.propose((), (doubt,))
    assert queue.messages == []
    assert queue.propose((), ())
    assert queue.propose((), (doubt,))
    assert send(queue, 1.0) == ["<doubt/>"]


def test_feedback_text_may_be_scheduled_before_an_already_sent_sync_point(queue: FeedbackQueue) -> None:
    send(queue, 11.0)
    late = ScheduledFeedback(10.2, "<doubt/>")
    assert queue.propose(block()[:3], (late, *block()[3:]))
    assert queue.due(11.0) is late


def test_proposed_feedback_earlier_than_sent_feedback_is_refused(queue: FeedbackQueue) -> None:
    """A proposal may arrive between two messages of one control cycle."""
    other = schedule_feedback("c", TIMES, 10.0, sender=4, run=2)
    assert queue.propose((), (*block(), *other))
    send(queue, 10.0)
    ahead = schedule_feedback("d", TIMES, 9.5, sender=5, run=3)
    assert not queue.propose((), (*block(), *other, *ahead))


def test_emergency_stop_keeps_feedback_without_sync_points_and_feedback_that_is_already_due(
    queue: FeedbackQueue,
) -> None:
    before, after = ScheduledFeedback(10.1, "<before/>"), ScheduledFeedback(12.5, "<after/>")
    assert queue.propose((), (*block(), before, after))
    send(queue, 10.0)
    queue.halt(11.0)
    assert [message.content for message in queue.messages if isinstance(message.content, str)] == [
        "<before/>",
        "<after/>",
    ]
    assert send(queue, 99.0) == ["<before/>", "h:stroke", ":end", "<after/>"]


def test_emergency_stop_drops_provisional_feedback_of_blocks_that_have_not_begun(queue: FeedbackQueue) -> None:
    queue.halt(9.0)
    assert queue.messages == []


def test_block_end_at_an_emergency_stop_cannot_be_withdrawn(queue: FeedbackQueue) -> None:
    send(queue, 10.5)
    queue.halt(11.5)
    assert queue.propose(block()[:3], ())
    assert send(queue, 12.0) == ["h:stroke", ":end"]


def test_new_planner_may_withdraw_only_feedback_that_was_handed_over_to_it(queue: FeedbackQueue) -> None:
    send(queue, 10.5)
    text = ScheduledFeedback(12.5, "<kept/>")
    assert queue.propose((*block()[:2], text), block()[2:])
    queue.hand_over(block()[2:])
    assert queue.propose((), ())
    assert [message.content for message in queue.messages] == ["<kept/>"]
