"""The attributes that are read, element by element; what a document has beside them has no effect, which is said."""

from collections.abc import Mapping

_FACE = ("lexeme", "au", "side", "amount", "type")
_GAZE = ("target", "type", "influence", "modality", "offsetAngle", "offsetDirection")
HAND_SHAPE = ("handShape", "handshape")  # of a gesture, as attribute or element
_POSTURE = ("stance", "part", "shape")
BLOCK_ATTRIBUTES = ("id", "characterId", "character", "agent", "composition")  # of a <bml>
AGENTS = ("characterId", "character", "agent")  # of a <bml> or a behaviour: who performs
ATTRIBUTES: Mapping[str, tuple[str, ...]] = {  # of behaviours, beside the id, the agent and the sync points
    "gesture": ("lexeme", "type", "mode", "hand", "target", *HAND_SHAPE),
    "pointing": ("target", "mode", "hand", *HAND_SHAPE),
    "head": ("lexeme", "rotation", "type", "action", "repetition", "amount"),
    "headDirectionShift": ("target", "lexeme"),
    "gaze": _GAZE,
    "gazeShift": _GAZE,
    "face": _FACE,
    "faceLexeme": _FACE,
    "faceFacs": _FACE,
    "faceShift": _FACE,
    "posture": _POSTURE,
    "postureShift": _POSTURE,
    "torso": ("lexeme", "amount"),
    "locomotion": ("target", "manner", "type"),
    "speech": ("text", "type", "language", "voice"),
    "wait": ("duration", "max-wait"),
}
INSIDE: Mapping[str, tuple[str, ...]] = {  # of elements inside behaviours and of constraints
    "lexeme": ("lexeme", "amount"),
    "facs": ("au", "side", "amount"),
    "stance": ("type",),
    **dict.fromkeys(HAND_SHAPE, ("value",)),
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
PARTS: Mapping[str, frozenset[str]] = {  # elements that are read inside another, beside <description>
    **dict.fromkeys(("gesture", "pointing"), frozenset(HAND_SHAPE)),
    **dict.fromkeys(("face", "faceLexeme", "faceFacs", "faceShift"), frozenset({"lexeme", "facs", "faceFacs"})),
    **dict.fromkeys(("posture", "postureShift"), frozenset({"stance", "pose"})),
    "constraint": frozenset({"synchronize", "before", "after"}),
    **dict.fromkeys(("synchronize", "before", "after"), frozenset({"sync"})),
}
SPOKEN: Mapping[str, tuple[str, ...]] = {  # elements that are read in what a speech says, and their attributes
    "sync": INSIDE["sync"],
    "tm": INSIDE["tm"],
    "mark": ("name", "id", "time"),
    "break": ("time", "strength"),
    "sub": ("alias",),
    "prosody": ("rate", "pitch", "range", "volume", "contour", "duration"),
    "emphasis": ("level",),
    "say-as": ("interpret-as", "format", "detail"),
    **dict.fromkeys(("lang", "voice", "p", "s", "text"), ()),
    "speak": ("version",),
}
ALTERNATIVES: Mapping[str, tuple[tuple[str, ...], ...]] = {  # names of one thing, of which the first counts
    "gesture": (("lexeme", "type"), ("mode", "hand"), HAND_SHAPE),
    "pointing": (("mode", "hand"), HAND_SHAPE),
    "head": (("lexeme", "rotation", "type"),),
    "headDirectionShift": (("target", "lexeme"),),
    **dict.fromkeys(("face", "faceLexeme", "faceFacs", "faceShift"), (("lexeme", "au", "type"),)),
    **dict.fromkeys(("gaze", "gazeShift"), (("influence", "modality"),)),
    "wait": (("duration", "max-wait"),),
}
EMPTY: Mapping[tuple[str, str], frozenset[str]] = {  # values that are followed, or need not be; others have no effect
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
EMPTY_VALUES = frozenset({"", "none"})  # values that are as good as no attribute
NEEDED_ATTRIBUTES: Mapping[tuple[str, str], str] = {  # attributes that have no effect without another one
    **dict.fromkeys((("gaze", "offsetAngle"), ("gazeShift", "offsetAngle")), "offsetDirection"),
    **dict.fromkeys((("gaze", "offsetDirection"), ("gazeShift", "offsetDirection")), "offsetAngle"),
}
KINDS = frozenset({"lexicalized", "lexicalised", "facs"})  # values of `type` that say how the rest is written
