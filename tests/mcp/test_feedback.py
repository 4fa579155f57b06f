"""Interpretation of feedback messages for their block."""

import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import write_warning
from kinesic.mcp.feedback import Feedback, read_feedback
from kinesic.serve.wire.quotas import quota_feedback

XMLNS = 'xmlns="http://www.bml-initiative.org/bml/bml-1.0"'


def read(message: str) -> Feedback:
    feedback = read_feedback(message)
    assert feedback is not None
    return feedback


def warned(text: str, type_: NoticeType = NoticeType.IMPOSSIBLE_TO_SCHEDULE, id_: str = "b") -> Feedback:
    return read(write_warning(Notice(type_, id_, text)))


@pytest.mark.parametrize("name", ["b", "a:b", "a:", "x & y", 'q"<', "ü"])
def test_escaped_ids_in_feedback_are_decoded(name: str):
    assert warned("left out", id_=name).subject == name
    assert warned("revoked", id_=name).ended_block == name
    escaped = name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    assert read(f'<predictionFeedback {XMLNS}><bml id="{escaped}" globalStart="1"/></predictionFeedback>').begins(name)
    started = read(f'<blockProgress {XMLNS} id="{escaped}:start" globalTime="1"/>')
    assert started.begins(name)
    assert started.ended_block == ""
    assert read(f'<blockProgress {XMLNS} id="{escaped}:end" globalTime="1"/>').ended_block == name


def test_prediction_feedback_refers_to_its_block_id():
    message = f'<predictionFeedback {XMLNS} id="x"><gesture id="g"/><bml id="b"/></predictionFeedback>'
    assert read(message).subject == "b"
    assert read(f"<predictionFeedback {XMLNS}/>").subject == ""
    assert not read(f"<predictionFeedback {XMLNS}/>").begins("b")
    assert not read(message).begins("g")
    assert read(message).ended_block == ""
    assert not read(message).is_refusal


@pytest.mark.parametrize(
    ("feedback", "is_refusal", "is_over"),
    [
        (warned("rule depth: too deep"), True, True),
        (warned("not performed, because it requires g1"), True, True),
        (warned("<text>:1:2: no BML", NoticeType.PARSING_FAILURE), True, False),
        (warned("left out: no hand is free"), False, False),
        (warned("revoked before it began: replaced"), False, True),
        (warned("a block of this id plays already"), False, True),
        (warned("it is for B, and A performs here"), False, True),
        (warned("256 blocks play and wait already, send it again"), False, True),
        (warned("another rule "), False, False),
        (warned(""), False, False),
        (read(quota_feedback("rate", "too many")), True, True),
    ],
)
def test_feedback_warnings_are_classified_as_refusal_end_or_notice(feedback: Feedback, is_refusal: bool, is_over: bool):
    assert feedback.is_refusal is is_refusal
    assert feedback.ended_block == (feedback.subject if is_over else "")
    assert not feedback.begins(feedback.subject)


def test_progress_feedback_of_a_behaviour_is_not_read_as_that_of_its_block():
    message = read(f'<syncPointProgress {XMLNS} id="b:g:end" time="1" globalTime="1">rule x</syncPointProgress>')
    assert not message.begins("b")
    assert message.ended_block == ""
    assert not message.is_refusal
    assert not read(f'<blockProgress {XMLNS} id="b:start"/>').begins("c")


@pytest.mark.parametrize("message", ["", "hello", "<open", '{"told": "status"}'])
def test_messages_that_are_not_xml_are_not_read_as_feedback(message: str):
    assert read_feedback(message) is None
