"""Requests about a conversation from the wire to the planner."""

import asyncio
from collections.abc import Callable

from kinesic.conversation.events import Conversing, PeopleSeen, Person, VoiceActivity
from kinesic.serve.wire.conversing import ConverseRequest, HeardReport, PeopleReport, SeenPerson

from .played_registry import Registry
from .staged_session import Stage, settle


def report(side: float) -> PeopleReport:
    return PeopleReport((SeenPerson("p", (1.5, side, 1.6)),))


def test_busy_planner_gets_only_the_latest_report_of_people(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.perform(stage.document("a"))  # keeps the planner busy
        for message, sender in (
            *((report(side), 1) for side in (0.1, 0.2, 0.3)),
            (report(0.4), 2),
            (HeardReport(voice=True), 2),
            (report(0.5), 2),
        ):
            assert stage.session.converse(message, sender) == ""
        stage.planner.sent.clear()
        received = []
        for _ in range(4):
            stage.planner.become_free()
            received.append(stage.planner.sent.popleft())
        seen = [PeopleSeen((Person("p", (1.5, side, 1.6)),)) for side in (0.3, 0.4, 0.5)]
        assert [item.event for item in received] == [*seen[:2], VoiceActivity(active=True), seen[2]]
        assert [item.sender for item in received] == [1, 2, 2, 2]

    on_stage(act)


def test_robot_does_not_converse_while_it_is_stopped(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.emergency_stop()
        assert stage.session.converse(ConverseRequest(), 1) == "an emergency stop holds; resume first"
        stage.session.resume()
        assert stage.session.converse(ConverseRequest(), 1) == ""

    on_stage(act)


def test_planner_learns_the_client_and_whether_it_wants_fillers(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(fillers=True), 4)
        stage.planner.become_free()
        request = stage.planner.sent.popleft()
        assert (request.event, request.sender, request.fills) == (Conversing(on=True), 4, True)

    on_stage(act)


def test_client_is_told_why_the_robot_cannot_converse():
    registry = Registry()
    client = registry.join("a")
    assert registry.say(client, {"do": "converse"}) == []
    assert registry.session.done == [("converse", ConverseRequest(), client.number)]
    registry.session.obstacle = "no torque"
    (answer,) = registry.say(client, {"do": "converse"})
    assert answer == '{"told":"refused","do":"converse","why":"no torque"}'
    assert registry.say(client, {"do": "people", "people": []}) == []


def test_frequent_reports_of_people_leave_the_message_quota_to_documents():
    registry = Registry()
    client = registry.join("a")
    for _ in range(12):
        assert registry.say(client, {"do": "people", "people": []}) == []
    registry.say(client, b"<bml/>")
    assert len(registry.session.performed) == 1


def test_folding_the_arms_ends_the_conversation_first(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(), 1)
        folding = asyncio.create_task(stage.session.fold())
        await settle()
        assert stage.planned() == ["ConversationRequest", "ConversationRequest", "Interruption"]
        folding.cancel()

    on_stage(act)
