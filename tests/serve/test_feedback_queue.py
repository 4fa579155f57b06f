"""What the loop sends of what planners propose."""

import pytest

from kinesic.bml.composition import BlockState
from kinesic.realizer.feedback import ScheduledFeedback, agenda, retime_feedback
from kinesic.serve.feedback_queue import FeedbackQueue

TIMES = {"h": {"start": 0.0, "stroke": 1.0, "end": 2.0}}


def block(zero: float = 10.0, run: int = 1) -> tuple[ScheduledFeedback, ...]:
    return agenda("b", TIMES, zero, sender=3, run=run)


def send(queue: FeedbackQueue, until: float) -> list[str]:
    """Sends what is due, and returns the points."""
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


def test_sent_point_is_not_sent_again_at_another_time(queue: FeedbackQueue) -> None:
    assert send(queue, 10.5) == [":start", "h:start"]
    assert queue.propose((), block(zero=10.2)[2:]) is False
    assert queue.propose(block()[:2], retime_feedback(block()[2:], 1, block(zero=10.2), 10.5))
    assert send(queue, 13.0) == ["h:stroke", "h:end", ":relax", ":end"]


def test_withdrawal_of_a_sent_point_is_refused(queue: FeedbackQueue) -> None:
    send(queue, 11.0)
    assert not queue.propose(block()[:2], block()[3:])
    assert queue.propose(block()[:3], block()[3:])


def test_point_before_a_sent_point_is_refused(queue: FeedbackQueue) -> None:
    send(queue, 11.0)
    assert not queue.propose(block()[:3], (*block(zero=10.9, run=2), *block()[3:]))
    assert queue.propose(block()[:3], (*block(zero=11.0, run=2), *block()[3:]))


def test_withdrawn_text_may_have_been_sent(queue: FeedbackQueue) -> None:
    doubt = ScheduledFeedback(10.2, "<doubt/>", unless_improved="b")
    assert queue.propose((), (*block()[:2], doubt, *block()[2:]))
    send(queue, 10.5)
    assert queue.propose(block()[:2], block()[2:])


def test_emergency_stop_ends_blocks_that_have_begun(queue: FeedbackQueue) -> None:
    assert queue.propose((), (*block(), *block(zero=11.9, run=2)))
    send(queue, 11.5)
    queue.halt(11.53)
    (end,) = queue.messages
    assert (end.time, end.content.run, end.content.state) == (11.53, 1, BlockState.INTERRUPTED)
    assert send(queue, 12.0) == [":end"]
    assert queue.propose((*block()[:3], block()[-1].interrupted_at(11.53)), ())
    assert not queue.messages


def test_emergency_stop_begins_a_block_whose_start_the_planner_has_said(queue: FeedbackQueue) -> None:
    assert queue.propose((*block()[:2], block()[-1].interrupted_at(10.4)), ())
    queue.halt(9.0)
    assert send(queue, 9.0) == [":start", ":end"]


def test_next_planner_changes_only_what_it_was_given(queue: FeedbackQueue) -> None:
    send(queue, 10.5)
    queue.hand_over(tuple(queue.messages))
    assert queue.propose((), block()[2:])
    assert send(queue, 13.0) == ["h:stroke", "h:end", ":relax", ":end"]


def test_number_of_the_last_running_block_is_that_of_the_points_proposed(queue: FeedbackQueue) -> None:
    assert FeedbackQueue().runs == 0
    assert queue.runs == 1
    assert queue.propose((), (*block(), *block(zero=20.0, run=4)))
    assert queue.runs == 4
    assert queue.propose((), (*block(), ScheduledFeedback(30.0, "<doubt/>")))
    assert queue.runs == 4


def test_first_message_is_due_at_its_time_and_no_sooner(queue: FeedbackQueue) -> None:
    assert FeedbackQueue().due(1e9) is None
    assert queue.due(9.999) is None
    assert queue.due(10.0) is queue.messages[0]
    assert queue.due(99.0) is queue.messages[0]
    assert [message.time for message in queue.messages] == sorted(message.time for message in block())


def test_what_the_planner_has_said_stays_whatever_it_proposes_next(queue: FeedbackQueue) -> None:
    assert queue.propose(block()[:2], block()[2:])
    assert queue.propose((), ())
    assert send(queue, 99.0) == [":start", "h:start"]


def test_message_that_was_said_waits_once_though_it_is_proposed_again(queue: FeedbackQueue) -> None:
    assert queue.propose(block(), ())
    assert queue.propose(block(), ())
    assert queue.messages == sorted(block(), key=lambda message: message.time)


def test_text_that_was_withdrawn_after_it_was_sent_is_new_when_it_comes_back() -> None:
    queue, doubt = FeedbackQueue(), ScheduledFeedback(1.0, "<doubt/>", unless_improved="b")
    assert queue.propose((), (doubt,))
    assert send(queue, 1.0) == ["<doubt/>"]
    assert queue.propose((), (doubt,))
    assert queue.messages == []
    assert queue.propose((), ())
    assert queue.propose((), (doubt,))
    assert send(queue, 1.0) == ["<doubt/>"]


def test_text_may_come_before_a_point_that_was_sent(queue: FeedbackQueue) -> None:
    send(queue, 11.0)
    late = ScheduledFeedback(10.2, "<doubt/>")
    assert queue.propose(block()[:3], (late, *block()[3:]))
    assert queue.due(11.0) is late


def test_point_that_was_due_already_may_still_wait_at_its_time(queue: FeedbackQueue) -> None:
    """The loop sends one message after the other, and a proposal may come between."""
    other = agenda("c", TIMES, 10.0, sender=4, run=2)
    assert queue.propose((), (*block(), *other))
    send(queue, 10.0)
    ahead = agenda("d", TIMES, 9.5, sender=5, run=3)
    assert not queue.propose((), (*block(), *other, *ahead))


def test_emergency_stop_leaves_texts_and_what_is_due(queue: FeedbackQueue) -> None:
    before, after = ScheduledFeedback(10.1, "<before/>"), ScheduledFeedback(12.5, "<after/>")
    assert queue.propose((), (*block(), before, after))
    send(queue, 10.0)
    queue.halt(11.0)
    assert [each.content for each in queue.messages if isinstance(each.content, str)] == ["<before/>", "<after/>"]
    assert send(queue, 99.0) == ["<before/>", "h:stroke", ":end", "<after/>"]


def test_emergency_stop_revokes_blocks_whose_start_may_be_withdrawn(queue: FeedbackQueue) -> None:
    queue.halt(9.0)
    assert queue.messages == []


def test_end_at_an_emergency_stop_is_final(queue: FeedbackQueue) -> None:
    send(queue, 10.5)
    queue.halt(11.5)
    assert queue.propose(block()[:3], ())
    assert send(queue, 12.0) == ["h:stroke", ":end"]


def test_new_planner_may_withdraw_what_it_was_given_and_nothing_else(queue: FeedbackQueue) -> None:
    send(queue, 10.5)
    text = ScheduledFeedback(12.5, "<kept/>")
    assert queue.propose((*block()[:2], text), block()[2:])
    queue.hand_over(block()[2:])
    assert queue.propose((), ())
    assert [message.content for message in queue.messages] == ["<kept/>"]
