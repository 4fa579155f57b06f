"""Messages about a conversation."""

import json
import runpy
import sys
from pathlib import Path

import pytest

from kinesic.conversation.events import (
    Conversing,
    PeopleSeen,
    Person,
    Thinking,
    Transcript,
    TurnPrediction,
    VoiceActivity,
)
from kinesic.serve.wire.conversing import MAX_PEOPLE, conversation_events
from kinesic.serve.wire.protocol import read_control


def events(**message):
    return conversation_events(read_control(json.dumps(message).encode()))


def test_conversation_messages_are_decoded_into_events():
    assert events(do="converse") == (Conversing(on=True),)
    assert events(do="converse", on=False, amount=0.5) == (Conversing(on=False, amount=0.5),)
    seen = events(do="people", people=[{"id": "p1", "at": [1, 0.5, 1.6], "looks": True}], age=0.08)
    assert seen == (PeopleSeen((Person("p1", (1.0, 0.5, 1.6), looks=True),), 0.08),)
    assert events(do="heard", voice=True, who="p1", age=0.1) == (VoiceActivity(active=True, who="p1", age=0.1),)
    assert events(do="heard", text="so I", who="p1") == (Transcript("so I", who="p1"),)
    assert events(do="turn", yours=0.8) == (TurnPrediction(0.8),)
    assert events(do="think") == (Thinking(on=True),)


def test_optional_fields_of_a_conversation_have_their_documented_defaults():
    request = read_control(b'{"do": "converse"}')
    assert (request.on, request.amount, request.fillers) == (True, 1.0, False)
    assert read_control(b'{"do": "people", "people": [{"id": "p", "at": [1, 0, 1]}]}').people[0].looks is False
    heard = read_control(b'{"do": "heard"}')
    assert (heard.voice, heard.text, heard.final, heard.who) == (None, None, False, None)


def test_transcript_event_comes_after_the_start_and_before_the_end_of_its_voice():
    begins, ends = (events(do="heard", voice=voice, text="yes", final=True) for voice in (True, False))
    assert [type(event) for event in begins] == [VoiceActivity, Transcript]
    assert [type(event) for event in ends] == [Transcript, VoiceActivity]


def test_conversation_message_with_a_value_outside_its_limits_is_refused():
    person = {"id": "p", "at": [1, 0, 1]}
    refused = [
        {"do": "people", "people": [person] * (MAX_PEOPLE + 1)},
        {"do": "people", "people": [{"id": "p", "at": [1, 0]}]},
        {"do": "people", "people": [{"id": "p", "at": [1e9, 0, 0]}]},
        {"do": "people", "people": [{"id": "", "at": [1, 0, 1]}]},
        {"do": "people", "people": [person], "age": -1},
        {"do": "heard", "text": "x" * 2001},
        {"do": "heard", "volume": 3},
        {"do": "turn", "yours": 1.5},
        {"do": "converse", "amount": 2},
        {"do": "sound", "id": "a", "data": "A" * 64_004},
        {"do": "sound", "id": "a", "data": "AAAA", "rate": 4000},
    ]
    for message in refused:
        with pytest.raises(ValueError, match="control messages"):
            read_control(json.dumps(message).encode())


def test_report_of_many_seen_people_may_exceed_the_size_limit_of_other_messages():
    people = [
        {"id": f"person-{k:057}", "at": [-1.12345678, 0.123456789, 1.6], "looks": True} for k in range(MAX_PEOPLE)
    ]
    message = json.dumps({"do": "people", "people": people}).encode()
    assert len(message) > 4096
    assert read_control(message) is not None


def test_conversation_messages_of_the_adapter_example_are_valid(capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["12_converse.py"])
    adapters = runpy.run_path(str(Path(__file__).parents[3] / "examples" / "12_converse.py"))
    messages = [*adapters["REALTIME"].values(), *adapters["PIPECAT"].values(), *adapters["messages"]]
    kinds = {type(read_control(json.dumps(message).encode())).__name__ for message in messages}
    assert kinds == {"ConverseRequest", "PeopleReport", "HeardReport", "ThinkRequest", "InterruptCommand"}
    assert len(capsys.readouterr().out.splitlines()) == len(adapters["messages"])
