"""Planner process: an internal error affects only one document."""

import re
from multiprocessing.connection import Connection

import pytest

from kinesic.realizer.request import Message
from kinesic.serve import planner
from kinesic.serve.messages import DocumentRequest, FeedbackNotice, Proposal, ProposalVerdict
from kinesic.serve.planner import PlannerState

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}"><head id="h" lexeme="NOD" start="0"/></bml>'


def execute(wired: tuple[PlannerState, Connection], name: str) -> list[object]:
    """Return the planner's messages for a document; each proposal is accepted."""
    planning, loop = wired
    loop.send(ProposalVerdict(accepted=True, stops=0, time=0.0))
    planning.execute(DocumentRequest(Message(NOD.format(name), sender=7), stops=0))
    said = []
    while loop.poll():
        said.append(loop.recv())
    return said


@pytest.mark.parametrize("part", ["read_request", "prepare_block", "begin"])
@pytest.mark.parametrize("defect", [ZeroDivisionError, AssertionError, KeyError, RecursionError, MemoryError])
def test_internal_planning_error_is_reported_and_planning_continues(
    wired, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], part: str, defect: type[Exception]
):
    def fail(*_arguments: object, **_more: object) -> None:
        raise defect("a defect")

    with monkeypatch.context() as patch:
        patch.setattr(planner, part, fail)
        *_, last = execute(wired, "bad")
    assert isinstance(last, FeedbackNotice)
    assert last.sender == 7
    assert re.search(rf'id="bad".*rule planning: planning failed \({defect.__name__}\)', last.message)
    assert "a defect" in capfd.readouterr().err
    (*_, proposal) = execute(wired, "good")
    assert isinstance(proposal, Proposal)
    assert proposal.motion is not None
    assert {block for block, _ in proposal.moving} == {"good"}
