"""Streamed texts over real sockets: phrases are performed when complete."""

import json
import re
from itertools import pairwise
from time import monotonic, sleep

import pytest
from websockets.sync.client import connect

from kinesic.client import Client
from kinesic.serve.messages import Words
from kinesic.serve.queues import MAX_TEXT_LENGTH
from kinesic.serve.talks import Talks
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.quotas import Quotas

from .conftest import running

pytestmark = pytest.mark.realtime

MAX_WAIT = 20.0  # [s] longest wait for a message or condition


def told(client, until, seconds=MAX_WAIT):
    """Return messages up to one that contains a text."""
    end, results = monotonic() + seconds, []
    while monotonic() < end:
        message = client.receive(max(end - monotonic(), 0.0))
        if message is None:
            break
        results.append(message)
        if re.search(until, message):
            return results
    raise AssertionError(f"{until} was not told: {results}")


def answers(messages, kind):
    results = (json.loads(message) for message in messages if message.startswith("{"))
    return [item for item in results if item["told"] == kind]


def starts(messages):
    return {
        match[1]: float(match[2])
        for message in messages
        if (match := re.search(r'<syncPoint[^>]* id="([^"]*:s:(?:start|end))" [^>]*?globalTime="([^"]*)"', message))
    }


def test_successive_streamed_phrases_do_not_overlap(server):
    with server.client() as client:
        for word in re.findall(r"\S+ ?", "Hello, my friend! I saw it, but it was dark. "):
            client.do("words", text=word)
            sleep(0.1)  # speed of a language model; all words at once would become one phrase
        client.do("words", ends=True)
        messages = told(client, '"all_said"')
        end = f'id="{answers(messages, "all_said")[0]["block"]}:end"'
        messages += [] if any(end in message for message in messages) else told(client, end)
    saying = answers(messages, "saying")
    assert " ".join(item["text"] for item in saying).split()[:4] == ["Hello,", "my", "friend!", "I"]
    assert " ".join(item["text"] for item in saying).endswith("it was dark.")
    assert len(saying) >= 2
    at = starts(messages)
    for one, other in pairwise(saying):
        gap = at[f"{other['block']}:s:start"] - at[f"{one['block']}:s:end"]
        assert gap > 0.05
    assert not [message for message in messages if "speaks until" in message]


def test_first_streamed_phrase_is_spoken_before_the_next_one_is_received(server):
    with server.client() as client:
        client.do("words", text="Look at the old house on the hill, and ")
        messages = told(client, r'id="[^"]*:start"')
        assert answers(messages, "saying")[0]["text"] == "Look at the old house on the hill,"
        client.do("words", text="the tower", ends=True)
        assert answers(told(client, '"all_said"'), "saying")[0]["text"] == "and the tower"


def test_streamed_words_that_are_not_yet_spoken_can_be_replaced(server):
    with server.client() as client:
        client.do("words", text="The captain told us. It was dull. ")
        told(client, '"saying"')
        client.do("words", text="It was wonderful!", instead=True, ends=True)
        saying = answers(told(client, '"all_said"'), "saying")
    assert "dull" not in json.dumps(saying) or "dull" in saying[0]["text"]
    assert saying[-1]["text"].endswith("wonderful!")


def test_unfinished_streamed_phrase_is_spoken_after_a_silence(server):
    with server.client() as client:
        client.do("words", text="I never saw the tower")
        assert answers(told(client, '"saying"'), "saying")[0]["text"] == "I never saw the tower"


@pytest.mark.parametrize("verb", ["stop", "interrupt"])
def test_emergency_stop_and_interrupt_discard_unspoken_streamed_words(server, verb):
    with server.client() as client:
        client.do("words", text="One two three four five six seven eight nine ten. " * 6, ends=True)
        told(client, r'id="[^"]*-1:start"')
        client.do(verb)
        if verb == "stop":
            told(client, '"stopped"')
            client.do("words", text="Not now. ")
            assert "resume first" in told(client, "<warning")[-1]
            client.do("resume")
        sleep(0.3)
        client.do("words", text="Back again. ", ends=True)
        assert answers(told(client, '"all_said"'), "saying")[-1]["text"] == "Back again."


def test_phrases_of_two_streamed_texts_alternate_without_overlap(server):
    with server.client() as one, server.client() as other:
        for client in (one, other):
            client.do("words", text="Here I am. ", ends=True)
        first, second = (told(client, r'id="[^"]*:s:end"') for client in (one, other))
    spans = sorted(sorted(starts(item).values()) for item in (first, second))
    assert spans[0][1] <= spans[1][0]


def test_plain_text_is_refused_by_default(server):
    with connect(f"ws://127.0.0.1:{server.port}") as web:
        web.send("Hello there!")
        assert "PARSING_FAILURE" in web.recv(MAX_WAIT)


@pytest.fixture(scope="module")
def talkative():
    with running(Quotas(), Access(texts=True)) as result:
        yield result


def test_plain_text_over_websocket_and_tcp_is_spoken(talkative):
    with connect(f"ws://127.0.0.1:{talkative.port}") as web:
        web.send("Hello there, my \N{SNOWMAN} friend!")
        assert json.loads(web.recv(MAX_WAIT))["text"] == "Hello there, my friend!"
    with talkative.client() as client:
        client.do("ping")
        client.send("Look over there!")
        assert answers(told(client, '"all_said"'), "saying")[0]["text"] == "Look over there!"
        client.send("[1, 2]")
        told(client, "PARSING_FAILURE")


def test_client_that_stops_sending_gets_feedback_on_all_text(talkative):
    with Client(port=talkative.port) as client:
        client.do("words", text="We saw. " * 2, ends=True)
        client._socket.shutdown(1)
        messages = told(client, '"all_said"')
        end = f'id="{answers(messages, "all_said")[0]["block"]}:end"'
        assert any(end in message for message in messages) or told(client, end)


def test_waiting_text_of_a_client_is_limited():
    talks = Talks()
    assert talks.take(Words("x " * (MAX_TEXT_LENGTH // 4), 1), 0.0) == ""
    assert "characters already wait" in talks.take(Words("x " * MAX_TEXT_LENGTH, 1), 0.0)
    assert talks.senders == {1}


def test_incomplete_streamed_text_counts_towards_the_length_limit():
    talks = Talks()
    assert talks.take(Words("-" * (MAX_TEXT_LENGTH - 1), 1), 0.0) == ""
    assert "already wait" in talks.take(Words("--", 1), 0.0)
