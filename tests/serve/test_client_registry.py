"""Client registry: admission, quotas and handling of messages."""

import json
from collections.abc import Callable, Iterator

import pytest

from kinesic.serve.clients import (
    CLOSE_NORMAL,
    CLOSE_POLICY_VIOLATION,
    CLOSE_TRY_LATER,
    REFUSAL_BURST_FACTOR,
)
from kinesic.serve.messages import Restyling, Words
from kinesic.serve.wire import quotas
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.questions import ReachQuestion, ServosQuestion
from kinesic.serve.wire.quotas import Quotas

from .played_registry import TEST_QUOTAS, TOKEN_ACCESS, Registry, told

DOCUMENT = b"<bml/>"


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[float], None]]:
    now = [0.0]
    monkeypatch.setattr(quotas, "monotonic", lambda: now[0])

    def advance_scene(seconds: float) -> None:
        now[0] += seconds

    return advance_scene


def test_clients_are_admitted_if_no_token_is_required_or_they_are_trusted():
    assert Registry().join("a").admitted
    assert not Registry(TOKEN_ACCESS).join("a").admitted
    assert Registry(TOKEN_ACCESS).join("a", trusted=True).admitted


def test_numbers_of_server_clients_are_unique():
    registry = Registry()
    assert [registry.join("a").number for _ in range(3)] == [1, 2, 3]


def test_correct_token_admits_a_client_and_reserves_a_client_slot():
    registry = Registry(TOKEN_ACCESS)
    client = registry.join("a")
    assert registry.say(client, {"do": "hello", "token": "open sesame"}) == ['{"told":"welcome"}']
    assert client.admitted
    assert client.placed
    registry.say(client, DOCUMENT)
    assert len(registry.session.performed) == 1


@pytest.mark.parametrize("first", [{"do": "hello", "token": "open barley"}, {"do": "ping"}, DOCUMENT, {"do": "stop"}])
def test_unauthenticated_client_is_refused_and_disconnected(first: bytes | dict):
    registry = Registry(TOKEN_ACCESS)
    client = registry.join("a")
    (answer,) = registry.say(client, first)
    assert json.loads(answer)["told"] == "refused"
    assert ("the token is wrong" in answer) == (isinstance(first, dict) and "token" in first)
    assert client.code == CLOSE_POLICY_VIOLATION
    assert not client.open
    assert not registry.session.done
    assert not registry.session.performed


@pytest.mark.parametrize("shown", [None, "", "open", "open sesame ", "\udcff"])
def test_only_the_exact_token_is_accepted(shown: str | None):
    registry = Registry(TOKEN_ACCESS)
    assert registry.is_token("open sesame")
    assert not registry.is_token(shown)
    assert not Registry().is_token(shown), "where there is none, nothing is it"


def test_client_slots_are_limited_and_freed_when_clients_leave():
    registry = Registry()
    one, two, three = (registry.join("a") for _ in range(3))
    assert registry.place(one)
    assert registry.place(one), "it keeps its place"
    assert registry.place(two)
    assert not registry.place(three)
    registry.say(three, DOCUMENT)
    assert three.code == CLOSE_TRY_LATER
    assert not registry.session.performed
    registry.leave(one)
    registry.leave(one)
    four, five = registry.join("a"), registry.join("a")
    assert registry.place(four)
    assert not registry.place(five)


def test_leaving_client_without_a_slot_frees_no_client_slot():
    registry = Registry()
    placed = [registry.join("a") for _ in range(2)]
    assert all(map(registry.place, placed))
    registry.leave(registry.join("a"))
    assert not registry.place(registry.join("a"))


def test_client_without_a_client_slot_may_stop_the_robot_and_authenticate():
    registry = Registry()
    for _ in range(2):
        registry.place(registry.join("a"))
    third = registry.join("a")
    assert registry.say(third, {"do": "hello", "token": ""}) == ['{"told":"welcome"}']
    assert registry.say(third, {"do": "stop"}) == ['{"told":"stopped"}']
    assert registry.session.done == [("halt",)]
    assert third.open


def test_session_gets_a_document_with_client_number_and_client_address_as_source():
    registry = Registry()
    client = registry.join("127.0.0.1:5")
    registry.say(client, DOCUMENT)
    registry.say(client, DOCUMENT)
    assert [item.text for item in registry.session.performed] == [DOCUMENT] * 2
    assert {item.sender for item in registry.session.performed} == {client.number}
    assert [item.source for item in registry.session.performed] == [
        "<127.0.0.1:5, message 1>",
        "<127.0.0.1:5, message 2>",
    ]


def test_client_is_informed_of_the_refusal_of_its_document():
    registry = Registry()
    registry.session.refusal = "<no/>"
    assert registry.say(registry.join("a"), DOCUMENT) == ["<no/>"]


def test_plain_text_of_a_client_is_read_as_words_to_speak_only_if_the_server_allows_texts():
    registry = Registry(Access(texts=True))
    client = registry.join("a")
    registry.say(client, b"Hello there")
    (words,) = registry.session.performed
    assert words == Words("Hello there", client.number, ends=True)
    registry.say(client, DOCUMENT)
    assert not isinstance(registry.session.performed[1], Words)
    other = Registry()
    other.say(other.join("a"), b"Hello there")
    assert not isinstance(other.session.performed[0], Words)


@pytest.mark.parametrize(
    ("message", "done"),
    [
        ({"do": "resume"}, ("resume",)),
        ({"do": "interrupt"}, ("interrupt", None)),
        ({"do": "interrupt", "block": "b"}, ("interrupt", "b")),
        ({"do": "interrupt", "yield": True}, ("interrupt", None, "yields")),
        ({"do": "duck", "on": True}, ("duck", True)),
        ({"do": "disarm"}, ("disarm", 1)),
        ({"do": "arm"}, ("arm", 1, True)),
        (
            {"do": "style", "style": "tired", "set": ["effort=0"], "amount": 0.5, "block": "b"},
            ("restyle", Restyling("tired", ("effort=0",), 0.5, "b", 1)),
        ),
        ({"do": "servos", "id": 3}, ("answer", 1, ServosQuestion(3))),
        ({"do": "reach", "target": [0, 0, 1]}, ("answer", 1, ReachQuestion((0, 0, 1)))),
    ],
)
def test_control_message_of_a_client_calls_the_matching_method_of_the_session(message: dict, done: tuple):
    registry = Registry()
    assert registry.say(registry.join("a"), message) == []
    assert registry.session.done == [done]


def test_streamed_words_of_a_client_are_passed_to_the_session_unchanged():
    registry = Registry()
    registry.say(registry.join("a"), {"do": "words", "text": "so", "ends": True, "instead": True})
    assert registry.session.performed == [Words("so", 1, ends=True, instead=True)]


@pytest.mark.parametrize(("token", "trusted"), [("open sesame", True), ("open barley", False), (None, False)])
def test_client_registry_tells_the_session_whether_an_arm_message_has_the_token(token: str | None, trusted: bool):
    registry = Registry(TOKEN_ACCESS)
    client = registry.join("a", trusted=True)
    registry.say(client, {"do": "arm", "token": token})
    assert registry.session.done == [("arm", client.number, trusted)]


def test_answers_to_ping_and_status_requests_repeat_the_request_id():
    registry = Registry()
    client = registry.join("a")
    assert json.loads(*registry.say(client, {"do": "ping", "id": "x"})) == {"told": "pong", "id": "x"}
    assert json.loads(*registry.say(client, {"do": "status"})) == {"told": "status", "clients": 1, "state": "resting"}
    assert json.loads(*registry.say(client, {"do": "status", "id": 4}))["id"] == 4


def test_failed_emergency_stop_is_reported_to_the_client():
    registry = Registry()
    registry.session.fault = RuntimeError("the loop has ended")
    (answer,) = registry.say(registry.join("a"), {"do": "stop"})
    assert json.loads(answer)["told"] == "failed"


def test_emergency_stop_is_executed_beyond_the_rate_limit(time: Callable):
    registry = Registry()
    client = registry.join("a")
    for _ in range(TEST_QUOTAS.burst + 2):
        registry.say(client, {"do": "ping"})
    assert registry.say(client, {"do": "stop"}) == ['{"told":"stopped"}']


def test_messages_beyond_the_burst_limit_are_refused_until_the_rate_limit_allows_more(time: Callable):
    registry = Registry()
    client = registry.join("a")
    taken = ["pong" in registry.say(client, {"do": "ping"})[0] for _ in range(TEST_QUOTAS.burst + 3)]
    assert taken == [True] * TEST_QUOTAS.burst + [False] * 3
    assert client.open
    time(1.5 / TEST_QUOTAS.rate)
    assert "pong" in registry.say(client, {"do": "ping"})[0]
    assert "rule rate: at most 10 messages a second" in registry.say(client, {"do": "ping"})[0]


@pytest.mark.parametrize("message", [{"do": "reach", "target": [0, 0, 1]}, {"do": "words", "text": "a"}])
def test_burst_limit_of_streamed_words_and_reach_queries_is_four_times_that_of_other_messages(
    time: Callable, message: dict
):
    registry = Registry()
    client = registry.join("a")
    refused = [bool(registry.say(client, message)) for _ in range(4 * TEST_QUOTAS.burst + 1)]
    assert refused == [False] * (4 * TEST_QUOTAS.burst) + [True]
    assert "pong" in registry.say(client, {"do": "ping"})[0], "they cost no other message its place"


def test_client_is_disconnected_after_too_many_refusals(time: Callable):
    registry = Registry()
    client = registry.join("a")
    for number in range(TEST_QUOTAS.burst + REFUSAL_BURST_FACTOR * TEST_QUOTAS.burst + 1):
        assert client.open, number
        registry.say(client, {"do": "ping"})
    assert client.code == CLOSE_POLICY_VIOLATION


def test_invalid_control_message_is_refused_with_its_reason():
    registry = Registry()
    client = registry.join("a")
    (answer,) = registry.say(client, {"do": "dance"})
    assert json.loads(answer)["told"] == "refused"
    assert "dance" in answer
    assert client.open


def test_disconnected_client_gets_no_further_messages():
    registry = Registry()
    client = registry.join("a")
    client.close(CLOSE_POLICY_VIOLATION, "for a reason")
    assert (client.code, client.why) == (CLOSE_POLICY_VIOLATION, "for a reason")
    client.send("never")
    assert told(client) == []


def test_feedback_messages_reach_their_client_if_connected():
    registry = Registry()
    one, two = registry.join("a"), registry.join("b")
    registry.tell("<x/>", two.number)
    registry.tell("<y/>", 99)
    assert (told(one), told(two)) == ([], ["<x/>"])
    registry.leave(two)
    registry.tell("<z/>", two.number)
    assert told(two) == []


def test_closing_the_client_registry_disconnects_all_clients():
    registry = Registry()
    clients = [registry.join("a") for _ in range(3)]
    registry.close(1001, "the server ends")
    assert {client.code for client in clients} == {1001}
    assert {client.why for client in clients} == {"the server ends"}


def test_network_client_but_not_standard_input_can_become_a_stop_connection():
    registry = Registry()
    client, console = registry.join("a"), registry.join("stdin", movable=False)
    assert not client.stops_only
    assert registry.say(client, {"do": "stop_line"}) == []
    assert client.stops_only
    assert not client.placed
    (answer,) = registry.say(console, {"do": "stop_line"})
    assert json.loads(answer)["told"] == "refused"
    assert not console.stops_only


def test_client_is_connected_until_it_leaves_or_is_disconnected():
    registry = Registry()
    one, two = registry.join("a"), registry.join("a")
    there = []
    for client in (one, two):
        registry.say(client, {"do": "servos"})
        there.append(registry.session.requester.is_there)
    registry.session.requester.send("answer")
    assert told(two) == ["answer"]
    assert [item() for item in there] == [True, True]
    registry.leave(one)
    two.close(CLOSE_NORMAL + 1, "")
    assert [item() for item in there] == [False, False]


def test_client_registry_reports_an_overlong_message_to_its_client():
    registry = Registry()
    client = registry.join("a")
    registry.refuse_overlong(client, ValueError("a message has 9 bytes or more"))
    (answer,) = told(client)
    assert "rule message: a message has 9 bytes or more" in answer
    assert "PARSING_FAILURE" in answer


def test_unread_memory_of_all_clients_together_is_limited():
    registry = Registry(rules=Quotas(unread_bytes_of_all=10_000))
    one, two = registry.join("a"), registry.join("b")
    for client in (one, two):
        for _ in range(4):
            client.send("x" * 2000)
    assert len(one.output) + len(two.output) == 4
