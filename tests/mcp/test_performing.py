"""Performed documents with their ids, and refusals before anything moves."""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import cast

import pytest

from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.performing import MAX_NOTICES, DocumentPerformer
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.planning.setup import Setup

PLAN = {"told": "plan", "id": 1, "block": "b", "duration": 1.5, "notices": []}


@dataclass
class FakeDocuments:
    """Stub document connection with answers and a record of sent documents."""

    plan: Mapping[str, object] | Callable[[], Mapping[str, object]] = field(default_factory=lambda: PLAN)
    why: str = ""
    planned: list[str] = field(default_factory=list)
    performed: list[tuple[str, ...]] = field(default_factory=list)

    async def ask(self, verb: str, *, bml: str) -> Mapping[str, object]:
        assert verb == "plan"
        self.planned.append(bml)
        await asyncio.sleep(0)
        return self.plan() if callable(self.plan) else self.plan

    async def perform(self, document: str, block: str, *names: str) -> str:
        self.performed.append((document, block, *names))
        return self.why


class FakeRobot:
    """Stub robot with a stop counter."""

    def __init__(self, **settings: object) -> None:
        self.documents = FakeDocuments(**settings)
        self.state, self.stops = "resting", 0

    async def status(self) -> Mapping[str, object]:
        return {"state": self.state, "stops": self.stops}


def gate(robot: FakeRobot) -> RobotGate:
    return RobotGate.of(cast(RobotLine, robot), cast(Setup, None))


def perform(robot: FakeRobot, document: str) -> Mapping[str, object]:
    return asyncio.run(DocumentPerformer(gate(robot)).perform(lambda: document))


def refused(robot: FakeRobot, document: str) -> str:
    with pytest.raises(RefusedError) as result:
        perform(robot, document)
    assert robot.documents.performed == []
    return str(result.value)


def test_perform_tool_takes_the_block_id_from_the_plan_of_the_server():
    document = '<!-- <bml id="old"> --><bml id="new"/>'
    robot = FakeRobot(plan={**PLAN, "block": "new"})
    assert perform(robot, document) == {"block": "new", "seconds": 1.5, "not_as_asked": []}
    assert robot.documents.planned == [document]
    assert robot.documents.performed[0][:2] == (document, "new")


def test_perform_tool_passes_the_planned_and_the_written_block_id_with_the_document():
    robot = FakeRobot()
    perform(robot, '{"id": "json", "behaviours": []}')
    assert robot.documents.performed == [('{"id": "json", "behaviours": []}', "b", "json")]


@pytest.mark.parametrize(
    ("document", "told"),
    [
        ('{"do": "resume"}', "not a document"),
        ('{"do": "stop_line"}', "not a document"),
        ('{"do": "nonsense"}', "neither BML nor"),
        ('<bml id="x"/>\0{"do": "resume"}', "NUL"),
        ('<bml id="\ud800"/>', "UTF-8"),
    ],
)
def test_perform_tool_refuses_invalid_documents_before_planning(document: str, told: str):
    robot = FakeRobot()
    assert told in refused(robot, document)
    assert robot.documents.planned == []


def test_perform_tool_refuses_a_document_that_cannot_be_encoded():
    def write() -> str:
        raise RecursionError("too deep")

    with pytest.raises(RefusedError, match="too deep"):
        asyncio.run(DocumentPerformer(gate(FakeRobot())).perform(write))


def test_perform_tool_reports_parser_errors_with_line_and_column():
    error = {"line": 3, "column": 7, "text": "no such sync point"}
    assert refused(FakeRobot(plan={"told": "plan", "error": error}), "<bml") == "line 3, column 7: no such sync point"


@pytest.mark.parametrize(
    ("document", "place"),
    [
        ('{"behaviours": [{"type": "head", "amount": "x"}]}', "behaviours[0].amount"),
        ('{"behaviours": [{"type": "head", "amount": "x"}}', "behaviours[0].amount (line 1, column 17)"),
        ('{"behaviours":  \n[{"type": "head"}]}', "behaviours (line 1, column 17)"),
    ],
)
def test_perform_tool_reports_errors_of_json_documents_with_json_paths(document: str, place: str):
    error = {"line": 1, "column": 17, "text": "amount='x' is not a number"}
    assert refused(FakeRobot(plan={"told": "plan", "error": error}), document) == f"{place}: {error['text']}"


def test_perform_tool_does_not_repeat_the_attribute_at_the_end_of_a_json_path():
    error = {"line": 1, "column": 17, "text": "stroke: 'x+' is not a sync reference"}
    document = '{"behaviours": [{"type": "head", "stroke": "x+"}]}'
    result = refused(FakeRobot(plan={"told": "plan", "error": error}), document)
    assert result == "behaviours[0].stroke: 'x+' is not a sync reference"


def test_perform_tool_refuses_a_block_without_id_with_a_remedy():
    result = refused(FakeRobot(plan={**PLAN, "block": "block"}), "<bml/>")
    assert 'other than "block"' in result
    assert '"id": "b1" in JSON, or <bml id="b1">' in result


def test_perform_tool_refuses_a_document_whose_plan_is_outdated_or_refused():
    assert "send it again" in refused(FakeRobot(plan={"told": "plan", "outdated": True}), "<bml/>")
    assert refused(FakeRobot(plan={"told": "refused", "why": "unknown key"}), "<bml/>") == "unknown key"


def test_perform_tool_reports_a_refusal_by_the_server():
    robot = FakeRobot(why="rule stopped: resume first")
    with pytest.raises(RefusedError, match=r"^rule stopped: resume first$"):
        perform(robot, "<bml/>")


def test_perform_tool_limits_the_number_of_reported_notices():
    def notices(count: int) -> list[dict[str, str]]:
        return [{"id": f"g{k}", "text": "left out", "type": "X"} for k in range(count)]

    few = perform(FakeRobot(plan={**PLAN, "notices": notices(MAX_NOTICES)}), "<bml/>")["not_as_asked"]
    many = perform(FakeRobot(plan={**PLAN, "notices": notices(MAX_NOTICES + 3)}), "<bml/>")["not_as_asked"]
    assert few == [f"g{k}: left out" for k in range(12)]
    assert many == [*few, "and 3 more"]


def test_perform_tool_plans_no_document_during_an_emergency_stop():
    robot = FakeRobot()
    robot.state = "stopped"
    assert refused(robot, "<bml/>") == "an emergency stop holds: resume, then send it again"
    assert robot.documents.planned == []


def test_perform_tool_discards_its_plan_if_another_client_stops_the_robot():
    robot = FakeRobot()

    def plan() -> Mapping[str, object]:
        robot.stops += 1  # a person has resumed already
        return PLAN

    robot.documents.plan = plan
    assert "an emergency stop discarded" in refused(robot, "<bml/>")


def test_waiting_perform_calls_are_discarded_if_another_client_stops_the_robot():
    robot = FakeRobot()

    async def act() -> None:
        performing = DocumentPerformer(gate(robot))
        planned = asyncio.Event()

        def plan() -> Mapping[str, object]:
            planned.set()
            robot.stops += 1
            return PLAN

        robot.documents.plan = plan
        calls = [asyncio.create_task(performing.perform(lambda: "<bml/>")) for _ in range(3)]
        await planned.wait()
        robot.documents.plan = PLAN
        assert [type(item) for item in await asyncio.gather(*calls, return_exceptions=True)] == [RefusedError] * 3
        assert robot.documents.performed == []
        await performing.perform(lambda: "<bml/>")
        assert len(robot.documents.performed) == 1

    asyncio.run(act())


def test_discarded_perform_call_reports_the_emergency_stop():
    robot = FakeRobot()

    async def act() -> None:
        performing = DocumentPerformer(gate(robot))
        call = asyncio.create_task(performing.perform(lambda: "<bml/>"))
        while not robot.documents.planned:
            await asyncio.sleep(0)
        performing.discard()
        with pytest.raises(RefusedError, match=r"an emergency stop discarded.*nothing moves.*resume, then"):
            await call
        assert robot.documents.performed == []

    asyncio.run(act())


def test_lost_robot_server_during_planning_is_reported():
    robot = FakeRobot()

    def plan() -> Mapping[str, object]:
        raise RobotError("the server is gone")

    robot.documents.plan = plan
    with pytest.raises(RobotError, match="gone"):
        perform(robot, "<bml/>")
