"""Which documents are performed, under which id, and which are refused before anything moves."""

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import pytest

from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.performing import MAX_NOTICES, Performing

PLAN = {"told": "plan", "id": 1, "block": "b", "duration": 1.5, "notices": []}


@dataclass
class FakeDocuments:
    """Answers to plans and documents, and what was sent."""

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
    """A robot whose emergency stops are counted."""

    def __init__(self, **settings: object) -> None:
        self.documents = FakeDocuments(**settings)
        self.state, self.stops = "resting", 0

    async def status(self) -> Mapping[str, object]:
        return {"state": self.state, "stops": self.stops}


def perform(robot: FakeRobot, document: str) -> Mapping[str, object]:
    return asyncio.run(Performing(robot).perform(lambda: document))


def refused(robot: FakeRobot, document: str) -> str:
    with pytest.raises(RefusedError) as found:
        perform(robot, document)
    assert robot.documents.performed == []
    return str(found.value)


def test_block_has_the_id_that_the_server_has_read():
    document = '<!-- <bml id="old"> --><bml id="new"/>'
    robot = FakeRobot(plan={**PLAN, "block": "new"})
    assert perform(robot, document) == {"block": "new", "seconds": 1.5, "not_as_asked": []}
    assert robot.documents.planned == [document]
    assert robot.documents.performed[0][:2] == (document, "new")


def test_ids_that_a_refusal_may_have_are_handed_on():
    robot = FakeRobot()
    perform(robot, '{"id": "json", "behaviours": []}')
    assert robot.documents.performed == [('{"id": "json", "behaviours": []}', "b", "json")]


@pytest.mark.parametrize(
    ("document", "told"),
    [
        ('{"do": "resume"}', "no document"),
        ('{"do": "stop_line"}', "no document"),
        ('{"do": "nonsense"}', "neither BML nor"),
        ('<bml id="x"/>\0{"do": "resume"}', "NUL"),
        ('<bml id="\ud800"/>', "UTF-8"),
    ],
)
def test_what_is_no_document_is_not_even_planned(document: str, told: str):
    robot = FakeRobot()
    assert told in refused(robot, document)
    assert robot.documents.planned == []


def test_document_that_cannot_be_written_is_refused():
    def write() -> str:
        raise RecursionError("too deep")

    with pytest.raises(RefusedError, match="too deep"):
        asyncio.run(Performing(FakeRobot()).perform(write))


def test_errors_of_the_parser_are_told_with_their_place():
    error = {"line": 3, "column": 7, "text": "no such sync point"}
    assert refused(FakeRobot(plan={"told": "plan", "error": error}), "<bml") == "line 3, column 7: no such sync point"


def test_block_without_an_id_is_refused_with_the_remedy():
    told = refused(FakeRobot(plan={**PLAN, "block": "block"}), "<bml/>")
    assert 'other than "block"' in told
    assert '"id": "b1" in JSON, or <bml id="b1">' in told


def test_plan_that_was_replaced_is_refused():
    assert "send it again" in refused(FakeRobot(plan={"told": "plan", "outdated": True}), "<bml/>")
    assert refused(FakeRobot(plan={"told": "refused", "why": "unknown key"}), "<bml/>") == "unknown key"


def test_refusal_of_the_server_is_told():
    robot = FakeRobot(why="rule stopped: resume first")
    with pytest.raises(RefusedError, match=r"^rule stopped: resume first$"):
        perform(robot, "<bml/>")


def test_only_so_many_notices_are_told():
    def notices(count: int) -> list[dict[str, str]]:
        return [{"id": f"g{k}", "text": "left out", "type": "X"} for k in range(count)]

    few = perform(FakeRobot(plan={**PLAN, "notices": notices(MAX_NOTICES)}), "<bml/>")["not_as_asked"]
    many = perform(FakeRobot(plan={**PLAN, "notices": notices(MAX_NOTICES + 3)}), "<bml/>")["not_as_asked"]
    assert few == [f"g{k}: left out" for k in range(12)]
    assert many == [*few, "and 3 more"]


def test_nothing_is_planned_while_a_stop_holds():
    robot = FakeRobot()
    robot.state = "stopped"
    assert refused(robot, "<bml/>") == "an emergency stop holds: resume, then send it again"
    assert robot.documents.planned == []


def test_plan_that_was_made_before_a_stop_of_anybody_is_discarded():
    robot = FakeRobot()

    def plan() -> Mapping[str, object]:
        robot.stops += 1  # and a person has resumed already
        return PLAN

    robot.documents.plan = plan
    assert "an emergency stop came" in refused(robot, "<bml/>")


def test_calls_that_waited_during_a_stop_of_anybody_are_discarded():
    robot = FakeRobot()

    async def act() -> None:
        performing = Performing(robot)
        planned = asyncio.Event()

        def plan() -> Mapping[str, object]:
            planned.set()
            robot.stops += 1
            return PLAN

        robot.documents.plan = plan
        calls = [asyncio.create_task(performing.perform(lambda: "<bml/>")) for _ in range(3)]
        await planned.wait()
        robot.documents.plan = PLAN
        assert [type(each) for each in await asyncio.gather(*calls, return_exceptions=True)] == [RefusedError] * 3
        assert robot.documents.performed == []
        await performing.perform(lambda: "<bml/>")
        assert len(robot.documents.performed) == 1

    asyncio.run(act())


def test_discarded_call_is_told_that_a_stop_came():
    robot = FakeRobot()

    async def act() -> None:
        performing = Performing(robot)
        call = asyncio.create_task(performing.perform(lambda: "<bml/>"))
        while not robot.documents.planned:
            await asyncio.sleep(0)
        performing.discard()
        with pytest.raises(RefusedError, match=r"an emergency stop came.*nothing of it moves.*resume, then"):
            await call
        assert robot.documents.performed == []

    asyncio.run(act())


def test_robot_that_does_not_answer_is_reported():
    robot = FakeRobot()

    def plan() -> Mapping[str, object]:
        raise RobotError("the server is gone")

    robot.documents.plan = plan
    with pytest.raises(RobotError, match="gone"):
        perform(robot, "<bml/>")
