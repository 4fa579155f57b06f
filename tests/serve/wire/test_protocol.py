import json
from itertools import pairwise

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.block import DEFAULT_BLOCK_ID
from kinesic.realizer.request import block_id
from kinesic.serve.wire.protocol import (
    MESSAGE_END,
    DuckRequest,
    Enquiry,
    Hello,
    InterruptCommand,
    MessageFramer,
    Ping,
    Restyle,
    Resume,
    SpokenWords,
    Stop,
    is_text,
    json_answer,
    read_control,
)
from kinesic.serve.wire.questions import Question

MESSAGES = st.lists(
    st.binary(min_size=1, max_size=40).map(lambda data: b"<" + data.replace(MESSAGE_END, b"x")), max_size=6
)


@settings(deadline=None)
@given(MESSAGES, st.lists(st.integers(0, 250), max_size=12))
def test_message_framing_is_independent_of_chunk_boundaries(messages, cuts):
    stream = b"".join(message + MESSAGE_END for message in messages)
    places = sorted({0, len(stream), *(min(cut, len(stream)) for cut in cuts)})
    frames = MessageFramer(100)
    results = [item for a, b in pairwise(places) for item in frames.feed(stream[a:b])]
    assert results == messages
    assert not frames.is_midway


def test_blank_characters_between_client_messages_are_ignored():
    frames = MessageFramer(10)
    assert frames.feed(b" \n<a/>\0\n\0 \0<b/>") == [b"<a/>"]
    assert frames.is_midway
    assert frames.feed(b"\0\n") == [b"<b/>"]
    assert [*frames.feed(b"<c"), *frames.feed(b" d/>\0")] == [b"<c d/>"]
    assert not frames.is_midway


@pytest.mark.parametrize("pieces", [[b"12345678901"], [b"12345", b"678901"], [b"12345678901\0"]])
def test_message_longer_than_the_limit_is_detected_before_its_end(pieces):
    frames, (*first, last) = MessageFramer(10), pieces
    assert [frames.feed(piece) for piece in first] == [[]] * len(first)
    with pytest.raises(ValueError, match="11 bytes or more, at most 10"):
        frames.feed(last)


@pytest.mark.parametrize("pieces", [[b"1234567890\0"], [b"12345", b"67890", b"\0"]])
def test_message_of_the_maximum_size_is_read(pieces):
    frames = MessageFramer(10)
    assert [message for piece in pieces for message in frames.feed(piece)] == [b"1234567890"]


@pytest.mark.parametrize(
    ("text", "wish"),
    [
        ('{"do": "stop"}', Stop()),
        (' {"do": "resume"}\n', Resume()),
        ('{"do": "hello", "token": "t"}', Hello("t")),
        ('{"do": "interrupt"}', InterruptCommand()),
        ('{"do": "duck", "on": true}', DuckRequest(on=True)),
        ('{"do": "interrupt", "block": "b"}', InterruptCommand("b")),
        ('{"do": "interrupt", "yield": true}', InterruptCommand(yields=True)),
        ('{"do": "style", "style": "calm", "set": ["power=1"]}', Restyle("calm", ("power=1",))),
        ('{"do": "status"}', Enquiry()),
        ('{"do": "status", "id": 7}', Enquiry(7)),
        ('{"do": "ping", "id": "7"}', Ping("7")),
    ],
)
def test_control_messages_are_decoded(text, wish):
    assert read_control(text.encode()) == wish


@pytest.mark.parametrize(
    "text", ["<bml/>", '{"bml": {"id": "b"}}', "{", "[1]", '{"do": "stop"', '{"do": "stop"}' + " " * 9 + "x" * 5000]
)
def test_messages_without_a_control_key_are_documents(text):
    assert read_control(text.encode()) is None


def test_deeply_nested_json_message_is_not_decoded_as_a_control_message():
    for start in ('{"do": "interrupt", "block": ', '{"id": '):
        text = start + "[" * 1900 + "]" * 1900 + "}"
        assert read_control(text.encode()) is None
        assert block_id(text) == DEFAULT_BLOCK_ID


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ('{"do": "dance"}', "dance"),
        ('{"do": "stop", "now": 1}', "now"),
        ('{"do": "interrupt", "block": 5}', "block"),
        ('{"do": "hello"}', "token"),
    ],
)
def test_invalid_control_messages_report_the_error(text, why):
    with pytest.raises(ValueError, match=why):
        read_control(text.encode())


def test_answers_of_the_server_are_encoded_as_json():
    assert json.loads(json_answer("pong", id='"7"')) == {"told": "pong", "id": '"7"'}


def test_words_message_of_16_000_characters_is_decoded_with_its_flags():
    text = "I never saw it. " * 1000
    assert read_control(json.dumps({"do": "words", "text": text}).encode()) == SpokenWords(text)
    assert read_control(b'{"do": "words", "text": "a", "ends": true, "instead": true}') == SpokenWords("a", True, True)
    with pytest.raises(ValueError, match="text"):
        read_control(b'{"do": "words", "text": 7}')


@pytest.mark.parametrize(
    ("message", "is_one"),
    [
        (b"Hello", True),
        (b" \n No", True),
        (b"<speak>Hello</speak>", True),
        (b"```\nx = 1\n```", True),
        (b"<bml", False),
        (b"\xef\xbb\xbf {", False),
        (b"[", False),
        (b"Sure:\n```xml\n<bml/>\n```", False),
    ],
)
def test_message_is_plain_text_or_ssml_unless_it_is_bml_or_json(message, is_one):
    assert is_text(message) is is_one


@pytest.mark.parametrize(
    ("verb", "given_fields", "defaults"),
    [
        ("reach", {"target": [0, 0, 0]}, {"side": "right", "part": "hand", "posture": None}),
        ("plan", {"bml": "<bml/>"}, {"set": ()}),
        ("export", {"bml": "<bml/>", "format": "bap"}, {"set": ()}),
        ("gesture", {}, {"toml": None, "lexeme": None, "set": ()}),
        ("find", {"words": "hello"}, {}),
        ("author", {"text": "Hello."}, {"style": ""}),
        ("alternatives", {"text": "Hello.", "at": 0}, {"intent": ""}),
        ("servos", {}, {}),
        ("save", {"name": "a.bml", "text": ""}, {"revision": None}),
        ("open", {}, {"name": None}),
        ("versions", {"name": "a.bml"}, {"number": None}),
        ("backup", {"key": "abcdefgh"}, {"name": "", "text": None, "revision": ""}),
        ("backups", {}, {"key": None}),
        ("styles", {}, {}),
    ],
)
def test_query_without_optional_fields_has_the_documented_defaults_and_id_zero(verb, given_fields, defaults):
    question = msgspec.json.decode(json.dumps({"do": verb, **given_fields}), type=Question)
    assert {name: getattr(question, name) for name in defaults} == defaults
    assert question.id == 0
    numbered = msgspec.json.decode(json.dumps({"do": verb, **given_fields, "id": 7}), type=Question)
    assert numbered.id == 7


def test_request_for_telemetry_without_a_rate_has_twenty_reports_per_second():
    assert msgspec.json.decode(b'{"do": "watch"}', type=Question).rate == 20.0
