"""What a language model is told before it writes a performance, and the schema of what it writes."""

from collections.abc import Mapping, Sequence

Json = str | int | float | bool | None | Sequence["Json"] | Mapping[str, "Json"]

TEACHING = """\
You move a robot that speaks and gestures. Write one JSON object per performance:

{"id": "b1", "behaviours": [
  {"type": "speech", "id": "s", "text": ["Welcome! It is ", {"sync": "m1"}, "large."]},
  {"type": "gesture", "id": "g1", "lexeme": "welcome", "stroke": "s:start+0.3"},
  {"type": "gesture", "id": "g2", "lexeme": "large", "stroke": "s:m1"},
  {"type": "head", "id": "h1", "lexeme": "NOD", "stroke": "s:m1"},
  {"type": "face", "id": "f1", "lexeme": "smile", "start": "s:start", "end": "s:end"}]}

- A sync in the text stands right before the word on which a stroke shall fall: "stroke": "s:m1".
- Times are seconds or references with an offset: 1.5, "s:m1", "g1:end+0.5".
- One gesture for each phrase, strokes at least 1.3 s apart. Never the same gesture twice in a row.
- gesture: "lexeme" of the vocabulary (list_gestures searches by meaning), "mode": LEFT_HAND, RIGHT_HAND or BOTH_HANDS.
- head: NOD, SHAKE, TILT with "amount" 0 to 1. gaze: "target": AUDIENCE, or UP_LEFT and the other directions.
- face: smile, sadness, surprise, anger, fear, disgust, raise_brows, lower_brows, with "start" and "end".
- pointing: "target": left, right, or "x y z" in metres.
- postureShift: "pose": [{"part": "ARMS", "lexeme": "ARMS_CROSSED"}].
- "kinesic:style" on the object: neutral, joyful, calm, proud, sad, shy, angry.
- Every id once; a new id for every performance.

The answer says what was not as asked, with line and column of an error: mend that and send it again.
For plain talk use say: it finds gestures by itself. stop ends every motion at once; use it whenever somebody asks.
"""

_TIME: Json = {"anyOf": [{"type": "number"}, {"type": "string", "description": "id:sync, id:sync+0.5, or seconds"}]}
_SYNCS: Mapping[str, Json] = dict.fromkeys(("start", "stroke", "end"), _TIME)


def _behaviour(kind: str, required: Sequence[str], **properties: Json) -> Json:
    return {
        "type": "object",
        "properties": {"type": {"const": kind}, "id": {"type": "string"}, **properties, **_SYNCS},
        "required": ["type", "id", *required],
    }


_WORDS: Json = {"type": "string"}
_MARK: Json = {"type": "object", "properties": {"sync": {"type": "string"}}, "required": ["sync"]}
_TEXT: Json = {"anyOf": [_WORDS, {"type": "array", "items": {"anyOf": [_WORDS, _MARK]}}]}
_AMOUNT: Json = {"type": "number", "minimum": 0, "maximum": 1}
_HANDS: Json = {"enum": ["LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS"]}
_POSES: Json = {
    "type": "array",
    "items": {"type": "object", "properties": {"part": _WORDS, "lexeme": _WORDS}, "required": ["part", "lexeme"]},
}

BML_SCHEMA: Mapping[str, Json] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "BML as JSON",
    "type": "object",
    "properties": {
        "id": {"type": "string"},
        "kinesic:style": {"type": "string"},
        "composition": {"enum": ["MERGE", "APPEND", "REPLACE"]},
        "behaviours": {
            "type": "array",
            "items": {
                "oneOf": [
                    _behaviour("speech", ["text"], text=_TEXT),
                    _behaviour("gesture", ["lexeme"], lexeme=_WORDS, mode=_HANDS),
                    _behaviour("head", ["lexeme"], lexeme=_WORDS, amount=_AMOUNT, repetition={"type": "integer"}),
                    _behaviour("face", ["lexeme"], lexeme=_WORDS, amount=_AMOUNT),
                    _behaviour("gaze", ["target"], target=_WORDS),
                    _behaviour("gazeShift", ["target"], target=_WORDS),
                    _behaviour("pointing", ["target"], target=_WORDS, mode=_HANDS),
                    _behaviour("postureShift", ["pose"], pose=_POSES),
                ]
            },
        },
    },
    "required": ["id", "behaviours"],
}
