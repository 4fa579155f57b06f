"""Requests about a conversation from the wire to the planner."""

import asyncio
from collections.abc import Callable

from kinesic.conversation.events import Conversing, PeopleSeen, Person, VoiceActivity
from kinesic.serve.messages import ConversationRequest
from kinesic.serve.wire.conversing import ConverseRequest, HeardReport, PeopleReport, SeenPerson

from .played_registry import Registry
from .staged_session import Stage, settle


def report(side: float) -> PeopleReport:
    return PeopleReport((SeenPerson("p", (1.5, side, 1.6)),))


def test_busy_planner_gets_only_the_latest_report_of_seen_people(on_stage: Callable):
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


def test_conversation_is_refused_during_an_emergency_stop(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.emergency_stop()
        assert stage.session.converse(ConverseRequest(), 1) == "an emergency stop holds; resume first"
        stage.session.resume()
        assert stage.session.converse(ConverseRequest(), 1) == ""

    on_stage(act)


def test_planner_request_for_a_conversation_contains_the_client_and_its_wish_for_fillers(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(fillers=True), 4)
        stage.planner.become_free()
        request = stage.planner.sent.popleft()
        assert (request.event, request.sender, request.fills) == (Conversing(on=True), 4, True)

    on_stage(act)


def test_folding_of_the_robot_ends_its_conversation(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(), 4)
        stage.planner.become_free()
        assert stage.planner.sent.popleft().event == Conversing(on=True)
        folding = asyncio.create_task(stage.session.fold())
        await settle()
        stage.planner.become_free()
        ended = [request.event for request in stage.planner.sent if isinstance(request, ConversationRequest)]
        folding.cancel()
        assert ended == [Conversing(on=False)]

    on_stage(act)


def test_next_planner_continues_a_conversation_before_it_gets_waiting_requests(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(amount=0.5), 4)
        stage.session.converse(HeardReport(voice=True), 4)
        assert stage.planned() == ["ConversationRequest", "ConversationRequest"]
        stage.planner.busy = True
        stage.session.interrupt(None)
        stage.planner.lost(None)
        stage.planner.become_free()
        first = stage.planner.sent.popleft()
        assert first.event == Conversing(on=True, amount=0.5)
        assert stage.planned() == ["ConversationRequest", "Interruption"]
        assert stage.told == []

    on_stage(act)


def test_client_is_told_that_its_conversation_ended_with_the_planner(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(), 4)
        stage.planner.become_free()
        stage.planner.lost(stage.planner.sent.popleft())
        assert stage.told == [('{"told":"conversing","state":"off"}', 4)]
        assert stage.planned() == []
        stage.planner.lost(None)
        assert len(stage.told) == 1

    on_stage(act)


def test_conversation_that_an_emergency_stop_has_ended_is_not_continued(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(), 4)
        assert stage.planned() == ["ConversationRequest"]
        stage.session.emergency_stop()
        stage.planner.lost(None)
        assert stage.planned() == []
        stage.session.resume()
        stage.session.converse(ConverseRequest(), 4)
        stage.planned()
        stage.planner.lost(None)
        stage.planner.become_free()
        assert stage.planner.sent.popleft().stops == 1

    on_stage(act)


def test_refusal_of_a_conversation_contains_the_reason():
    registry = Registry()
    client = registry.join("a")
    assert registry.say(client, {"do": "converse"}) == []
    assert registry.session.done == [("converse", ConverseRequest(), client.number)]
    registry.session.obstacle = "no torque"
    (answer,) = registry.say(client, {"do": "converse"})
    assert answer == '{"told":"refused","do":"converse","why":"no torque"}'
    assert registry.say(client, {"do": "people", "people": []}) == []


def test_frequent_reports_of_seen_people_do_not_use_up_the_message_quota():
    registry = Registry()
    client = registry.join("a")
    for _ in range(12):
        assert registry.say(client, {"do": "people", "people": []}) == []
    registry.say(client, b"<bml/>")
    assert len(registry.session.performed) == 1


def test_conversation_ends_before_the_arms_are_folded(on_stage: Callable):
    async def act(stage: Stage) -> None:
        stage.session.converse(ConverseRequest(), 1)
        folding = asyncio.create_task(stage.session.fold())
        await settle()
        assert stage.planned() == ["ConversationRequest", "ConversationRequest", "Interruption"]
        folding.cancel()

    on_stage(act)
