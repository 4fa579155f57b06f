"""Supported attributes and nested elements of each BML element.

All other attributes and elements have no effect and produce a notice.
"""

from collections.abc import Mapping

_FACE_ATTRIBUTES = ("lexeme", "au", "side", "amount", "type")  # attributes of all facial behaviours
_GAZE_ATTRIBUTES = ("target", "type", "influence", "modality", "offsetAngle", "offsetDirection")
HAND_SHAPE_NAMES = ("handShape", "handshape")  # attribute or nested element with a gesture's hand shape
_POSTURE_ATTRIBUTES = ("stance", "part", "shape")  # attributes of posture and postureShift
BLOCK_ATTRIBUTES = ("id", "characterId", "character", "agent", "composition")  # attributes of a <bml>
AGENT_ATTRIBUTES = ("characterId", "character", "agent")  # attributes that name the performing agent
# Supported attributes of each behaviour element, without id, agent and sync points.
BEHAVIOUR_ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    "gesture": ("lexeme", "type", "mode", "hand", "target", *HAND_SHAPE_NAMES),
    "pointing": ("target", "mode", "hand", *HAND_SHAPE_NAMES),
    "head": ("lexeme", "rotation", "type", "action", "repetition", "amount"),
    "headDirectionShift": ("target", "lexeme"),
    "gaze": _GAZE_ATTRIBUTES,
    "gazeShift": _GAZE_ATTRIBUTES,
    "face": _FACE_ATTRIBUTES,
    "faceLexeme": _FACE_ATTRIBUTES,
    "faceFacs": _FACE_ATTRIBUTES,
    "faceShift": _FACE_ATTRIBUTES,
    "posture": _POSTURE_ATTRIBUTES,
    "postureShift": _POSTURE_ATTRIBUTES,
    "torso": ("lexeme", "amount"),
    "locomotion": ("target", "manner", "type"),
    "speech": ("text", "type", "language", "voice"),
    "wait": ("duration", "max-wait"),
}
NESTED_ATTRIBUTES: Mapping[str, tuple[str, ...]] = {  # supported attributes of each nested element or constraint
    "lexeme": ("lexeme", "amount"),
    "facs": ("au", "side", "amount"),
    "stance": ("type",),
    **dict.fromkeys(HAND_SHAPE_NAMES, ("value",)),
    "pose": ("part", "lexeme", "shape"),
    "description": ("type", "priority"),
    "text": (),
    "sync": ("id", "ref", "time"),
    "tm": ("id", "time"),
    "mark": ("name", "time"),
    "constraint": ("id",),
    "synchronize": ("ref",),
    "before": ("ref",),
    "after": ("ref",),
}
NESTED_ELEMENTS: Mapping[str, frozenset[str]] = {  # supported children by element, without <description>
    **dict.fromkeys(("gesture", "pointing"), frozenset(HAND_SHAPE_NAMES)),
    **dict.fromkeys(("face", "faceLexeme", "faceFacs", "faceShift"), frozenset({"lexeme", "facs", "faceFacs"})),
    **dict.fromkeys(("posture", "postureShift"), frozenset({"stance", "pose"})),
    "constraint": frozenset({"synchronize", "before", "after"}),
    **dict.fromkeys(("synchronize", "before", "after"), frozenset({"sync"})),
}
SPEECH_ATTRIBUTES: Mapping[str, tuple[str, ...]] = {  # supported attributes of each element inside a speech
    "sync": NESTED_ATTRIBUTES["sync"],
    "tm": NESTED_ATTRIBUTES["tm"],
    "mark": ("name", "id", "time"),
    "break": ("time", "strength"),
    "sub": ("alias",),
    "prosody": ("rate", "pitch", "range", "volume", "contour", "duration"),
    "emphasis": ("level",),
    "say-as": ("interpret-as", "format", "detail"),
    **dict.fromkeys(("lang", "voice", "p", "s", "text"), ()),
    "speak": ("version",),
}
SYNONYMOUS_ATTRIBUTES: Mapping[
    str, tuple[tuple[str, ...], ...]
] = {  # synonymous attributes by element; the first one present applies
    "gesture": (("lexeme", "type"), ("mode", "hand"), HAND_SHAPE_NAMES),
    "pointing": (("mode", "hand"), HAND_SHAPE_NAMES),
    "head": (("lexeme", "rotation", "type"),),
    "headDirectionShift": (("target", "lexeme"),),
    **dict.fromkeys(("face", "faceLexeme", "faceFacs", "faceShift"), (("lexeme", "au", "type"),)),
    **dict.fromkeys(("gaze", "gazeShift"), (("influence", "modality"),)),
    "wait": (("duration", "max-wait"),),
}
SUPPORTED_VALUES: Mapping[tuple[str, str], frozenset[str]] = {  # (element, attribute) -> supported values
    ("gaze", "type"): frozenset({"at"}),
    ("gazeShift", "type"): frozenset({"at"}),
    ("head", "action"): frozenset({"rotation"}),
    ("speech", "type"): frozenset({"text/plain", "application/ssml+xml"}),
    ("speech", "voice"): frozenset(),
    ("prosody", "contour"): frozenset(),
    ("prosody", "duration"): frozenset(),
    ("say-as", "interpret-as"): frozenset({"characters", "telephone", "tts:char", "tts:digits", "tts:key"}),
    ("say-as", "format"): frozenset({"glyphs"}),
}
UNSET_VALUES = frozenset({"", "none"})  # values equivalent to a missing attribute
NEEDED_ATTRIBUTES: Mapping[tuple[str, str], str] = {  # (element, attribute) -> attribute that it needs for an effect
    **dict.fromkeys((("gaze", "offsetAngle"), ("gazeShift", "offsetAngle")), "offsetDirection"),
    **dict.fromkeys((("gaze", "offsetDirection"), ("gazeShift", "offsetDirection")), "offsetAngle"),
}
NOTATION_TYPES = frozenset({"lexicalized", "lexicalised", "facs"})  # `type` values that name a notation, not a lexeme
