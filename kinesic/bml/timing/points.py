"""Sync points of each type of behaviour in their order, and how long it takes by nature from one to the next."""

from collections.abc import Iterable, Mapping, Sequence

from kinesic.bml.block import (
    FACE_SYNCS,
    GAZE_SYNCS,
    GESTURE_SYNCS,
    SHIFT_SYNCS,
    Action,
    Activate,
    Dialect,
    Face,
    Gaze,
    Gesture,
    Head,
    Interrupt,
    Locomotion,
    ParameterChange,
    Posture,
    Speech,
    Wait,
)
from kinesic.body.utterance import Utterance

HOLDS = frozenset({"strokeStart", "relax"})  # sync points that end a hold

_SPEECH_BEGINS, _SPEECH_ENDS = GESTURE_SYNCS[:4], GESTURE_SYNCS[4:]  # of the draft: when it begins, when it ends
_DRAFT_FACE_SYNCS = (GESTURE_SYNCS[0], "attackPeak", *GESTURE_SYNCS[1:])  # the draft's seven, and BML 1.0's
_NATURAL: Mapping[type, Mapping[str, float]] = {
    Gaze: {"ready": 0.4, "relax": 1.0, "end": 0.4},
    Face: {"attackPeak": 0.3, "relax": 0.8, "end": 0.4},
    Head: {"ready": 0.2, "stroke": 0.2, "strokeEnd": 0.2, "end": 0.3},
    Posture: {"ready": 1.0, "relax": 2.0, "end": 1.0},
    Locomotion: {"ready": 0.5, "relax": 2.0, "end": 0.5},
}
_GESTURE = {"ready": 0.6, "stroke": 0.25, "strokeEnd": 0.25, "relax": 0.2, "end": 0.7}
_REPEATED_STROKE = 0.4  # [s] from one stroke of a head movement to the next
_SHIFT = 0.8  # [s]
_WAIT = 1.0  # [s] when nothing says how long


def sync_points(action: Action, dialect: Dialect, spans: Iterable[str] = ()) -> tuple[str, ...]:
    """Lists the sync points of a behaviour; those of a speech are start, its marks as written, end.

    Speech, gaze, face and posture have the gesture's seven points in the drafts: outside BML 1.0 they get both sets.

    Args:
        action: what is done.
        dialect: of the document.
        spans: points whose natural spans are known; a gesture that style repeats has a `stroke:2` among them.
    """
    is_draft = dialect != "bml-1.0"
    match action:
        case Speech(script):
            marks = tuple(mark.name for mark in script.marks)
            begins, ends = (_SPEECH_BEGINS, _SPEECH_ENDS) if is_draft else (("start",), ("end",))
            return (*(sync for sync in begins if sync not in marks), *marks, *(s for s in ends if s not in marks))
        case Gaze(shift=True) | Face(shift=True) | Posture(shift=True) | Wait():
            return SHIFT_SYNCS
        case Interrupt() | Activate() | ParameterChange():
            return SHIFT_SYNCS
        case Face():
            return _DRAFT_FACE_SYNCS if is_draft else FACE_SYNCS
        case Gaze() | Posture():
            return GESTURE_SYNCS if is_draft else GAZE_SYNCS
        case Locomotion():
            return GAZE_SYNCS
        case Head(repetition=count) if count > 1:
            return _with_strokes([f"stroke:{k}" for k in range(2, count + 1)])
        case Gesture():
            return _with_strokes([name for name in spans if is_repeated(action, name)])
    return GESTURE_SYNCS


def speech_offsets(utterance: Utterance) -> dict[str, float]:
    """Computes when each sync point of a speech comes [s], from its start; those of the draft are its start or end."""
    begins, ends = dict.fromkeys(_SPEECH_BEGINS, 0.0), dict.fromkeys(_SPEECH_ENDS, utterance.duration)
    return {**begins, **ends, **utterance.marks}


def is_repeated(action: Action, sync: str) -> bool:
    """Checks whether a sync point is a stroke that only the style repeats, and which gives way to all others."""
    return isinstance(action, Gesture) and sync.startswith("stroke:")


def natural_spans(action: Action, given: Mapping[str, float]) -> dict[str, float]:
    """Finds each phase's natural time [s], keyed by the sync point that ends it; a missing point takes none.

    Args:
        action: what is done.
        given: what is known better, by sync point.
    """
    match action:
        case Gaze(shift=True) | Face(shift=True) | Posture(shift=True):
            usual: Mapping[str, float] = {"end": _SHIFT}
        case Interrupt() | Activate() | ParameterChange():
            usual = {}
        case Wait(duration):
            usual = {"end": _WAIT if duration is None else duration}
        case Head(repetition=count):
            usual = {**_NATURAL[Head], **{f"stroke:{k}": _REPEATED_STROKE for k in range(2, count + 1)}}
        case _:
            usual = _NATURAL.get(type(action), _GESTURE)
    return {**usual, **given}


def _with_strokes(more: Sequence[str]) -> tuple[str, ...]:
    after = GESTURE_SYNCS.index("strokeEnd")
    return (*GESTURE_SYNCS[:after], *more, *GESTURE_SYNCS[after:])
