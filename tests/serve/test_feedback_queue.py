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
