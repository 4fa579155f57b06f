"""What a message of feedback means for the block that it is about."""

import pytest

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import warning
from kinesic.mcp.feedback import Feedback, read_feedback
from kinesic.serve.wire.quotas import quota_feedback

XMLNS = 'xmlns="http://www.bml-initiative.org/bml/bml-1.0"'


def read(message: str) -> Feedback:
    feedback = read_feedback(message)
    assert feedback is not None
    return feedback


def warned(text: str, type_: NoticeType = NoticeType.IMPOSSIBLE_TO_SCHEDULE, id_: str = "b") -> Feedback:
    return read(warning(Notice(type_, id_, text)))


@pytest.mark.parametrize("name", ["b", "a:b", "a:", "x & y", 'q"<', "ü"])
def test_ids_are_read_as_they_were_written(name: str):
    assert warned("left out", id_=name).subject == name
    assert warned("revoked", id_=name).ended_block == name
    escaped = name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    assert read(f'<predictionFeedback {XMLNS}><bml id="{escaped}" globalStart="1"/></predictionFeedback>').begins(name)
    started = read(f'<blockProgress {XMLNS} id="{escaped}:start" globalTime="1"/>')
    assert started.begins(name)
    assert started.ended_block == ""
    assert read(f'<blockProgress {XMLNS} id="{escaped}:end" globalTime="1"/>').ended_block == name


def test_prediction_names_the_block_and_not_its_behaviours():
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
def test_warnings_refuse_end_or_only_tell(feedback: Feedback, is_refusal: bool, is_over: bool):
    assert feedback.is_refusal is is_refusal
    assert feedback.ended_block == (feedback.subject if is_over else "")
    assert not feedback.begins(feedback.subject)


def test_progress_of_a_behaviour_neither_begins_nor_ends_a_block():
    message = read(f'<syncPointProgress {XMLNS} id="b:g:end" time="1" globalTime="1">rule x</syncPointProgress>')
    assert not message.begins("b")
    assert message.ended_block == ""
    assert not message.is_refusal
    assert not read(f'<blockProgress {XMLNS} id="b:start"/>').begins("c")


@pytest.mark.parametrize("message", ["", "hello", "<open", '{"told": "status"}'])
def test_other_messages_are_no_feedback(message: str):
    assert read_feedback(message) is None
