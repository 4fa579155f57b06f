"""Clients in the registry: who is admitted, which messages are taken, and what becomes of each."""

import json
from collections.abc import Callable, Iterator

import pytest

from kinesic.serve.clients import DRAGGED, EXCESS, LATER, NORMAL, POLICY
from kinesic.serve.messages import Restyling, Words
from kinesic.serve.wire import quotas
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.questions import ReachQuestion, ServosQuestion
from kinesic.serve.wire.quotas import Quotas

from .played_registry import GUARDED, RULES, Registry, told

DOCUMENT = b"<bml/>"


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[float], None]]:
    now = [0.0]
    monkeypatch.setattr(quotas, "monotonic", lambda: now[0])

    def go_on(seconds: float) -> None:
        now[0] += seconds

    return go_on


def test_without_a_token_everybody_is_admitted_and_with_one_only_the_trusted():
    assert Registry().join("a").admitted
    assert not Registry(GUARDED).join("a").admitted
    assert Registry(GUARDED).join("a", trusted=True).admitted


def test_every_client_has_a_number_of_its_own():
    registry = Registry()
    assert [registry.join("a").number for _ in range(3)] == [1, 2, 3]


def test_the_right_token_admits_and_gives_a_place():
    registry = Registry(GUARDED)
    client = registry.join("a")
    assert registry.say(client, {"do": "hello", "token": "open sesame"}) == ['{"told":"welcome"}']
    assert client.admitted
    assert client.placed
    registry.say(client, DOCUMENT)
    assert len(registry.session.performed) == 1


@pytest.mark.parametrize("first", [{"do": "hello", "token": "open barley"}, {"do": "ping"}, DOCUMENT, {"do": "stop"}])
def test_nothing_is_done_for_a_stranger_who_is_sent_away(first: bytes | dict):
    registry = Registry(GUARDED)
    client = registry.join("a")
    (answer,) = registry.say(client, first)
    assert json.loads(answer)["told"] == "refused"
    assert ("the token is wrong" in answer) == (isinstance(first, dict) and "token" in first)
    assert client.code == POLICY
    assert not client.open
    assert not registry.session.done
    assert not registry.session.performed


@pytest.mark.parametrize("shown", [None, "", "open", "open sesame ", "\udcff"])
def test_only_the_token_is_the_token(shown: str | None):
    registry = Registry(GUARDED)
    assert registry.is_token("open sesame")
    assert not registry.is_token(shown)
    assert not Registry().is_token(shown), "where there is none, nothing is it"


def test_places_are_limited_and_come_free_when_somebody_leaves():
    registry = Registry()
    one, two, three = (registry.join("a") for _ in range(3))
    assert registry.place(one)
    assert registry.place(one), "it keeps its place"
    assert registry.place(two)
    assert not registry.place(three)
    registry.say(three, DOCUMENT)
    assert three.code == LATER
    assert not registry.session.performed
    registry.leave(one)
    registry.leave(one)
    four, five = registry.join("a"), registry.join("a")
    assert registry.place(four)
    assert not registry.place(five)


def test_whoever_leaves_without_a_place_frees_none():
    registry = Registry()
    placed = [registry.join("a") for _ in range(2)]
    assert all(map(registry.place, placed))
    registry.leave(registry.join("a"))
    assert not registry.place(registry.join("a"))


def test_a_client_without_a_place_may_still_stop_and_say_hello():
    registry = Registry()
    for _ in range(2):
        registry.place(registry.join("a"))
    third = registry.join("a")
    assert registry.say(third, {"do": "hello", "token": ""}) == ['{"told":"welcome"}']
    assert registry.say(third, {"do": "stop"}) == ['{"told":"stopped"}']
    assert registry.session.done == [("halt",)]
    assert third.open


def test_a_document_is_handed_on_with_its_sender_and_a_source_that_is_no_file():
    registry = Registry()
    client = registry.join("127.0.0.1:5")
    registry.say(client, DOCUMENT)
    registry.say(client, DOCUMENT)
    assert [each.text for each in registry.session.performed] == [DOCUMENT] * 2
    assert {each.sender for each in registry.session.performed} == {client.number}
    assert [each.source for each in registry.session.performed] == [
        "<127.0.0.1:5, message 1>",
        "<127.0.0.1:5, message 2>",
    ]


def test_why_a_document_is_not_performed_is_told():
    registry = Registry()
    registry.session.refusal = "<no/>"
    assert registry.say(registry.join("a"), DOCUMENT) == ["<no/>"]


def test_plain_text_is_said_only_where_it_is_allowed():
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
def test_what_is_asked_is_done(message: dict, done: tuple):
    registry = Registry()
    assert registry.say(registry.join("a"), message) == []
    assert registry.session.done == [done]


def test_words_are_handed_on_as_they_are():
    registry = Registry()
    registry.say(registry.join("a"), {"do": "words", "text": "so", "ends": True, "instead": True})
    assert registry.session.performed == [Words("so", 1, ends=True, instead=True)]


@pytest.mark.parametrize(("token", "trusted"), [("open sesame", True), ("open barley", False), (None, False)])
def test_torque_asks_for_the_token_in_the_very_message(token: str | None, trusted: bool):
    registry = Registry(GUARDED)
    client = registry.join("a", trusted=True)
    registry.say(client, {"do": "arm", "token": token})
    assert registry.session.done == [("arm", client.number, trusted)]


def test_a_ping_and_a_status_are_answered_by_their_id():
    registry = Registry()
    client = registry.join("a")
    assert json.loads(*registry.say(client, {"do": "ping", "id": "x"})) == {"told": "pong", "id": "x"}
    assert json.loads(*registry.say(client, {"do": "status"})) == {"told": "status", "clients": 1, "state": "resting"}
    assert json.loads(*registry.say(client, {"do": "status", "id": 4}))["id"] == 4


def test_a_stop_that_nobody_makes_is_told_as_such():
    registry = Registry()
    registry.session.fault = RuntimeError("the loop has ended")
    (answer,) = registry.say(registry.join("a"), {"do": "stop"})
    assert json.loads(answer)["told"] == "failed"


def test_a_stop_counts_even_when_no_further_message_is_taken(time: Callable):
    registry = Registry()
    client = registry.join("a")
    for _ in range(RULES.burst + 2):
        registry.say(client, {"do": "ping"})
    assert registry.say(client, {"do": "stop"}) == ['{"told":"stopped"}']


def test_so_many_messages_are_taken_at_once_and_more_after_a_while(time: Callable):
    registry = Registry()
    client = registry.join("a")
    taken = ["pong" in registry.say(client, {"do": "ping"})[0] for _ in range(RULES.burst + 3)]
    assert taken == [True] * RULES.burst + [False] * 3
    assert client.open
    time(1.5 / RULES.rate)
    assert "pong" in registry.say(client, {"do": "ping"})[0]
    assert "rule rate: at most 10 messages a second" in registry.say(client, {"do": "ping"})[0]


@pytest.mark.parametrize("message", [{"do": "reach", "target": [0, 0, 1]}, {"do": "words", "text": "a"}])
def test_of_what_comes_word_by_word_more_is_taken(time: Callable, message: dict):
    registry = Registry()
    client = registry.join("a")
    refused = [bool(registry.say(client, message)) for _ in range(DRAGGED * RULES.burst + 1)]
    assert refused == [False] * (DRAGGED * RULES.burst) + [True]
    assert "pong" in registry.say(client, {"do": "ping"})[0], "they cost no other message its place"


def test_whoever_goes_on_after_refusals_is_sent_away(time: Callable):
    registry = Registry()
    client = registry.join("a")
    for number in range(RULES.burst + EXCESS * RULES.burst + 1):
        assert client.open, number
        registry.say(client, {"do": "ping"})
    assert client.code == POLICY


def test_a_control_message_that_is_wrong_is_refused_with_the_reason():
    registry = Registry()
    client = registry.join("a")
    (answer,) = registry.say(client, {"do": "dance"})
    assert json.loads(answer)["told"] == "refused"
    assert "dance" in answer
    assert client.open


def test_nothing_more_is_taken_of_a_client_that_was_sent_away():
    registry = Registry()
    client = registry.join("a")
    client.close(POLICY, "for a reason")
    assert (client.code, client.why) == (POLICY, "for a reason")
    client.send("never")
    assert told(client) == []


def test_messages_go_to_whom_they_belong_and_to_nobody_who_left():
    registry = Registry()
    one, two = registry.join("a"), registry.join("b")
    registry.tell("<x/>", two.number)
    registry.tell("<y/>", 99)
    assert (told(one), told(two)) == ([], ["<x/>"])
    registry.leave(two)
    registry.tell("<z/>", two.number)
    assert told(two) == []


def test_all_are_sent_away_together():
    registry = Registry()
    clients = [registry.join("a") for _ in range(3)]
    registry.close(1001, "the server ends")
    assert {client.code for client in clients} == {1001}
    assert {client.why for client in clients} == {"the server ends"}


def test_a_connection_that_wants_only_stops_is_freed_but_not_standard_input():
    registry = Registry()
    client, console = registry.join("a"), registry.join("stdin", movable=False)
    assert not client.stops_only
    assert registry.say(client, {"do": "stop_line"}) == []
    assert client.stops_only
    assert not client.placed
    (answer,) = registry.say(console, {"do": "stop_line"})
    assert json.loads(answer)["told"] == "refused"
    assert not console.stops_only


def test_an_asker_is_there_until_it_leaves_or_is_sent_away():
    registry = Registry()
    one, two = registry.join("a"), registry.join("a")
    there = []
    for client in (one, two):
        registry.say(client, {"do": "servos"})
        there.append(registry.session.asker.is_there)
    registry.session.asker.send("answer")
    assert told(two) == ["answer"]
    assert [each() for each in there] == [True, True]
    registry.leave(one)
    two.close(NORMAL + 1, "")
    assert [each() for each in there] == [False, False]


def test_an_overlong_message_is_named():
    registry = Registry()
    client = registry.join("a")
    registry.refuse_overlong(client, ValueError("a message has 9 bytes or more"))
    (answer,) = told(client)
    assert "rule message: a message has 9 bytes or more" in answer
    assert "PARSING_FAILURE" in answer


def test_what_is_unread_of_all_clients_together_is_bounded():
    registry = Registry(rules=Quotas(unread_bytes_of_all=10_000))
    one, two = registry.join("a"), registry.join("b")
    for client in (one, two):
        for _ in range(4):
            client.send("x" * 2000)
    assert len(one.output) + len(two.output) == 4
