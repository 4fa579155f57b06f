"""JSON schema of BML documents for language models.

It lists only values that the robot performs.
"""

from collections.abc import Mapping, Sequence

from kinesic.body.config import names_of

Json = str | int | float | bool | None | Sequence["Json"] | Mapping[str, "Json"]

# Values that the schema offers, a selection of those that BML documents may contain
HEAD_MOVEMENTS = ("NOD", "SHAKE", "TILT", "UP", "DOWN", "LEFT", "RIGHT", "FORWARD", "BACK")
FACE_LEXEMES = ("smile", "sadness", "surprise", "anger", "fear", "disgust", "raise_brows", "lower_brows")
GAZE_TARGETS = ("AUDIENCE", "LEFT", "RIGHT", "UP", "DOWN", "UP_LEFT", "UP_RIGHT", "DOWN_LEFT", "DOWN_RIGHT")
ARM_POSES = ("ARMS_CROSSED", "ARMS_AKIMBO", "ARMS_OPEN", "ARMS_NEUTRAL")  # lexemes of posture shifts
HAND_MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")  # values of `mode` of a gesture
UNSTRESSED_TYPES = ("speech", "face", "gazeShift", "postureShift")  # behaviour types without a stroke
COMPOSITION_NAMES = ("MERGE", "APPEND", "REPLACE")  # values of `composition` of a document

TIME_TEXT = (
    "start, stroke and end of a behaviour are seconds, such as 1.5, or references with an offset, such as 's:m1' (mark "
    "m1 of the speech s), 'g1:end+0.5' or 's:start'. The stroke is the moment that carries the meaning."
)


def _text(description: str) -> dict[str, Json]:
    return {"type": "string", "description": description}


def _choice(values: Sequence[str], description: str) -> dict[str, Json]:
    return {"type": "string", "enum": list(values), "description": description}


_TIME_SCHEMA: Mapping[str, Json] = {"type": ["number", "string"]}
_AMOUNT_SCHEMA: Mapping[str, Json] = {"type": "number", "minimum": 0, "maximum": 1, "description": "Strength."}


def _behaviour(kind: str, required: Sequence[str], **properties: Json) -> dict[str, Json]:
    times = dict.fromkeys(("start", "end") if kind in UNSTRESSED_TYPES else ("start", "stroke", "end"), _TIME_SCHEMA)
    return {
        "type": "object",
        "properties": {"type": {"const": kind}, "id": {"type": "string"}, **properties, **times},
        "required": ["type", "id", *required],
    }


_MARK_SCHEMA: Mapping[str, Json] = {"type": "object", "properties": {"sync": {"type": "string"}}, "required": ["sync"]}
_SPOKEN_SCHEMA: Mapping[str, Json] = {
    "anyOf": [{"type": "string"}, {"type": "array", "items": {"anyOf": [{"type": "string"}, _MARK_SCHEMA]}}],
    "description": 'Words, or a list of words and marks: ["It is ", {"sync": "m1"}, "large."]. A mark stands right '
    "before the word on which a stroke shall fall.",
}
_GESTURE_SCHEMA = _text("Name of a gesture, such as 'welcome'; find_gesture finds names by meaning.")
_HANDS_SCHEMA = _choice(HAND_MODES, "Hands that gesture; without it the gesture decides.")
_TARGET_SCHEMA = _text("What to point at: 'left', 'right', or 'x y z' in metres (x forward, y left, z up).")
_GAZE_SCHEMA = _choice(GAZE_TARGETS, "Where to look, seen from the robot.")
_POSE_SCHEMA: Mapping[str, Json] = {
    "type": "array",
    "items": {
        "type": "object",
        "properties": {"part": {"enum": ["ARMS"]}, "lexeme": _choice(ARM_POSES, "Pose of both arms.")},
        "required": ["part", "lexeme"],
    },
    "description": "Pose that stays until the next postureShift.",
}

BML_SCHEMA: Mapping[str, Json] = {
    "title": "BML as JSON",
    "description": "One performance: speech with gestures, head, face, gaze and posture.",
    "type": "object",
    "properties": {
        "id": _text("New for every performance; wait and status use it."),
        "kinesic:style": _choice(names_of("style"), "How everything moves."),
        "composition": _choice(
            COMPOSITION_NAMES,
            "Together with running performances (MERGE, default), after them (APPEND), or instead (REPLACE).",
        ),
        "behaviours": {
            "type": "array",
            "description": f"Every id once. {TIME_TEXT}",
            "items": {
                "oneOf": [
                    _behaviour("speech", ["text"], text=_SPOKEN_SCHEMA),
                    _behaviour("gesture", ["lexeme"], lexeme=_GESTURE_SCHEMA, mode=_HANDS_SCHEMA),
                    _behaviour(
                        "head",
                        ["lexeme"],
                        lexeme=_choice(HEAD_MOVEMENTS, "Movement of the head."),
                        amount=_AMOUNT_SCHEMA,
                        repetition={"type": "integer", "minimum": 0, "description": "Repetitions after the first."},
                    ),
                    _behaviour("face", ["lexeme"], lexeme=_choice(FACE_LEXEMES, "Expression."), amount=_AMOUNT_SCHEMA),
                    _behaviour("gaze", ["target"], target=_GAZE_SCHEMA),
                    _behaviour("gazeShift", ["target"], target=_GAZE_SCHEMA),
                    _behaviour("pointing", ["target"], target=_TARGET_SCHEMA, mode=_HANDS_SCHEMA),
                    _behaviour("postureShift", ["pose"], pose=_POSE_SCHEMA),
                ]
            },
        },
    },
    "required": ["id", "behaviours"],
}
