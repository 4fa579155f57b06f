"""Tests of BML as JSON, web realizer vocabulary and rejected documents."""

import json
from typing import Any

import pytest

from kinesic.bml.block import (
    Action,
    BmlError,
    Composition,
    Custom,
    Face,
    Gaze,
    Gesture,
    Head,
    NoticeType,
    Place,
    Posture,
    Precedence,
    Speech,
    Synchronize,
    SyncRef,
    Torso,
)
from kinesic.bml.parse import parse
from kinesic.body.utterance import Mark


@pytest.mark.parametrize(
    ("behaviour", "action"),
    [
        ({"type": "gesture", "lexeme": "beat", "mode": "LEFT_HAND"}, Gesture("beat", "left")),
        ({"type": "gesture", "lexeme": "beat", "hand": "NON_DOMINANT"}, Gesture("beat", "left")),
        ({"type": "head", "lexeme": "NOD", "repetition": 2, "amount": 1}, Head("NOD", 3, 1.0)),
        ({"type": "gaze", "target": "user", "influence": "EYES"}, Gaze("user", "EYES")),
        ({"type": "gaze", "target": "UP_LEFT"}, Gaze(offset_angle=20.0, offset_direction="UPLEFT")),
        ({"type": "gaze", "target": "FRONT", "shift": True}, Gaze("audience", shift=True)),
        ({"type": "face", "lexeme": "SMILE"}, Face(("SMILE",), amount=1.0)),
        ({"type": "face", "lexeme": [{"lexeme": "A"}, {"lexeme": "B"}], "amount": 0.3}, Face(("A", "B"), amount=0.3)),
        ({"type": "faceEmotion", "emotion": "FEAR", "shift": True}, Face(("FEAR",), amount=1.0, shift=True)),
        ({"type": "faceFacs", "au": 12, "side": "LEFT", "amount": 0.5}, Face((), 12, "left", 0.5)),
        ({"type": "blink", "start": 1}, Face((), 45, amount=1.0)),
        ({"type": "gesture", "bodyMovement": "TILT_FORWARD", "amount": 1}, Torso("TILT_FORWARD", 1.0)),
        ({"type": "posture", "stance": {"type": "SITTING"}, "shift": True}, Posture("SITTING", shift=True)),
        (
            {"type": "postureShift", "pose": [{"part": "ARMS", "lexeme": "ARMS_OPEN"}]},
            Posture(poses=(("ARMS", "ARMS_OPEN"),), shift=True),
        ),
        ({"type": "lights", "colour": "red"}, Custom("lights")),
    ],
)
def test_json_behaviour_is_read_as_an_action(behaviour: dict[str, Any], action: Action) -> None:
    block = parse(json.dumps([behaviour]))
    assert [item.action for item in block.behaviours] == [action]
    assert block.behaviours[0].type == behaviour["type"]
    assert block.dialect == "json"


def test_json_and_xml_give_the_same_block() -> None:
    text = {
        "id": "b1",
        "characterId": "robot",
        "composition": "APPEND",
        "behaviours": [
            {"type": "speech", "id": "s", "text": ["now ", {"sync": "m1"}, "here"]},
            {"type": "gesture", "id": "g", "lexeme": "beat", "stroke": "s:m1", "end": 3.5},
        ],
        "required": [
            {"type": "head", "id": "h", "lexeme": "NOD", "start": "g:end+0.5"},
            {"type": "before", "ref": "h:end", "refs": ["s:end"]},
        ],
        "constraints": [
            {"type": "after", "ref": "s:end", "refs": ["h:start"]},
            {"type": "synchronize", "refs": ["s:start", "1.5"]},
        ],
    }
    xml = (
        '<bml id="b1" characterId="robot" composition="APPEND"><speech id="s"><text>now <sync id="m1"/>here</text>'
        '</speech><gesture id="g" lexeme="beat" stroke="s:m1" end="3.5"/><required><head id="h" lexeme="NOD" '
        'start="g:end+0.5"/><constraint><before ref="h:end"><sync ref="s:end"/></before></constraint></required>'
        '<constraint><after ref="s:end"><sync ref="h:start"/></after><synchronize><sync ref="s:start"/>'
        '<sync ref="1.5"/></synchronize></constraint></bml>'
    )
    here, there = parse(json.dumps(text)), parse(xml)
    assert (here.id, here.character, here.composition) == ("b1", "robot", Composition.APPEND)
    assert [(b.id, b.action, b.syncs, b.required) for b in here.behaviours] == [
        (b.id, b.action, b.syncs, b.required) for b in there.behaviours
    ]
    assert [_constraint(item) for item in here.constraints] == [_constraint(item) for item in there.constraints]
    speech = here.behaviours[0].action
    assert isinstance(speech, Speech)
    assert (speech.script.text, speech.script.marks) == ("now here", (Mark("m1", 4),))


def _constraint(constraint: Synchronize | Precedence) -> tuple[object, ...]:
    if isinstance(constraint, Synchronize):
        return constraint.refs, constraint.required
    return constraint.earlier, constraint.later, constraint.required


@pytest.mark.parametrize("key", ["data", "behaviors", "behaviours"])
def test_json_behaviour_list_may_be_wrapped_in_an_object(key: str) -> None:
    behaviours = [{"type": "head", "lexeme": "NOD"}]
    assert len(parse(json.dumps({"type": "behaviours", "composition": "REPLACE", key: behaviours})).behaviours) == 1
    assert parse(json.dumps({"bml": {"id": "b", key: behaviours}})).id == "b"


def test_json_numbers_are_times_and_attack_peak_is_the_stroke() -> None:
    (behaviour,) = parse('[{"type": "gesture", "id": "g", "lexeme": "beat", "start": 0.1, "attackPeak": 1}]').behaviours
    assert behaviour.syncs == {
        "start": SyncRef("block", "bml", "start", offset=0.1),
        "stroke": SyncRef("block", "bml", "start", offset=1.0),
    }


def test_json_behaviours_have_line_and_column() -> None:
    block = parse('[\n {"type": "head",\n  "lexeme": "NOD"}, {"type": "gaze", "target": "user"}\n]')
    assert [item.place for item in block.behaviours] == [Place(2, 2), Place(3, 21)]


def test_unknown_json_keys_give_notices() -> None:
    block = parse('[{"type": "gesture", "lexeme": "beat", "palmor": "UP"}]')
    assert [(notice.type, "palmor" in notice.text) for notice in block.notices] == [
        (NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, True)
    ]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("[", "f:1:2: not JSON: Expecting value"),
        ("{'a': 1}", 'f:1:2: not JSON: Expecting value; put names and texts in double quotes: "type": "gesture"'),
        ('[{"type": "head", // nod\n"id": "h"}]', "f:1:19: not JSON: Expecting value; remove the comment"),
        ('{"gesture": "wave"}', '; write {"id": "b1", "behaviours": [{"type": "gesture", "lexeme": "wave"}]}'),
        ('[{"gesture": "wave", "start": 2}]', '; write {"type": "gesture", "start": 2, "lexeme": "wave"}'),
        ('{"gesture": {"lexeme": "wave"}}', 'behaviours": [{"type": "gesture", "lexeme": "wave"}]}'),
        ('{"type": "head", "lexeme": "NOD"}', 'behaviours": [{"type": "head", "lexeme": "NOD"}]}'),
        ('[{"type": "head"}', "f:1:18: not JSON: ',' is missing"),
        ('{"a": 1}', "f:1:1: the object has no 'behaviours'"),
        ('[{"lexeme": "NOD"}]', "f:1:2: a behaviour has no type"),
        ("[1]", "f:1:1: a behaviour has no type"),
        ('{"constraints": [\n {"type": "order"}]}', "f:2:2: not a constraint; its type must be one of synchronize"),
        ("[] []", "f:1:3: text after"),
        ("[" * 100, "nested levels"),
        ('[{"type": "head", "start": NaN}]', "f:1:2: start: 'nan' is not a sync reference"),
        ('[{"type": "head", "amount": 1e9}]', "f:1:2: amount='1000000000.0' is out of range"),
        ("[{1: 2}]", "f:1:4: 1 is not a name"),
        ('[{"type": "he<ad"}]', "f:1:2: the type 'he<ad' is not a name"),
        (r'[{"type": "head", "id": "\ud800"}]', "character 55296 is not allowed in a text"),
        (r'[{"type": "head", "id": "\u0000"}]', "character 0 is not allowed in a text"),
        ('[{"type": "head", "repetition": ' + 5000 * "9" + "}]", "not JSON: Exceeds the limit"),
    ],
)
def test_invalid_json_documents_are_rejected(text: str, what: str) -> None:
    with pytest.raises(BmlError) as refused:
        parse(text, source="f")
    assert what in str(refused.value)
    assert "; " in str(refused.value)


@pytest.mark.parametrize("text", ["[]", '{"behaviours": []}', " \n[] ", b"\xef\xbb\xbf[]"])
def test_empty_json_document_is_read_as_an_empty_block(text: str | bytes) -> None:
    assert parse(text).behaviours == ()


def test_json_comma_before_a_closing_bracket_is_reported_and_ignored():
    block = parse('[\n{"type": "head", "id": "h"},\n]')
    assert [behaviour.id for behaviour in block.behaviours] == ["h"]
    assert "a comma before ']' in line 2, column 28 is ignored" in [notice.text for notice in block.notices]


@pytest.mark.parametrize(("start", "end"), [({}, "0.25"), ({"start": 1}, "1.25"), ({"start": "g:end"}, "g:end+0.25")])
def test_json_blink_ends_a_quarter_second_after_its_start(start: dict[str, Any], end: str) -> None:
    texts = json.dumps([{"type": "blink", "id": "b", **start}, {"type": "gesture", "id": "g", "lexeme": "beat"}])
    explicit = json.dumps(
        [
            {"type": "faceFacs", "id": "b", "au": 45, "amount": 1.0, **start, "end": end},
            {"type": "gesture", "id": "g", "lexeme": "beat"},
        ]
    )
    assert parse(texts).behaviours[0].syncs == parse(explicit).behaviours[0].syncs
