"""Sync points of each behaviour type in order, with natural phase durations."""

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

HOLD_SYNCS = frozenset({"strokeStart", "relax"})  # sync points at the end of a hold

_SPEECH_START_SYNCS = GESTURE_SYNCS[:4]  # sync points of the BML draft that mean the start of a speech
_SPEECH_END_SYNCS = GESTURE_SYNCS[4:]  # sync points of the BML draft that mean the end of a speech
_DRAFT_FACE_SYNCS = (
    GESTURE_SYNCS[0],
    "attackPeak",
    *GESTURE_SYNCS[1:],
)  # sync points of faces in the BML draft, with attackPeak from BML 1.0
_NATURAL_DURATIONS: Mapping[type, Mapping[str, float]] = {  # [s] of each phase, by the sync point at its end
    Gaze: {"ready": 0.4, "relax": 1.0, "end": 0.4},
    Face: {"attackPeak": 0.3, "relax": 0.8, "end": 0.4},
    Head: {"ready": 0.2, "stroke": 0.2, "strokeEnd": 0.2, "end": 0.3},
    Posture: {"ready": 1.0, "relax": 2.0, "end": 1.0},
    Locomotion: {"ready": 0.5, "relax": 2.0, "end": 0.5},
}
# [s] natural durations of gesture phases, by the sync point at the end of the phase
_NATURAL_GESTURE_DURATIONS = {"ready": 0.6, "stroke": 0.25, "strokeEnd": 0.25, "relax": 0.2, "end": 0.7}
_REPEATED_STROKE_DURATION = 0.4  # [s] natural time between two strokes of a head movement
_SHIFT_DURATION = 0.8  # [s] natural duration of a shift of gaze, face or posture
_DEFAULT_WAIT_DURATION = 1.0  # [s] duration of a wait behaviour that gives none


def list_sync_points(action: Action, dialect: Dialect, spans: Iterable[str] = ()) -> tuple[str, ...]:
    """Return the sync points of a behaviour in order.

    A speech has start, its marks in document order, and end. In the drafts, speech, gaze, face and posture have the
    seven points of a gesture: outside BML 1.0 they get both sets.

    Args:
        action: action of the behaviour.
        dialect: dialect of the document.
        spans: points with given natural durations; contains `stroke:2` if the style repeats a gesture.
    """
    is_draft = dialect != "bml-1.0"
    match action:
        case Speech(script):
            marks = tuple(mark.name for mark in script.marks)
            start_syncs, end_syncs = (_SPEECH_START_SYNCS, _SPEECH_END_SYNCS) if is_draft else (("start",), ("end",))
            return (
                *(sync for sync in start_syncs if sync not in marks),
                *marks,
                *(s for s in end_syncs if s not in marks),
            )
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


def find_speech_offsets(utterance: Utterance) -> dict[str, float]:
    """Return the time [s] from a speech's start to each sync point.

    The draft's other points coincide with start or end.
    """
    start_syncs, end_syncs = (
        dict.fromkeys(_SPEECH_START_SYNCS, 0.0),
        dict.fromkeys(_SPEECH_END_SYNCS, utterance.duration),
    )
    return {**start_syncs, **end_syncs, **utterance.marks}


def is_repeated(action: Action, sync: str) -> bool:
    """Return whether a sync point is a repeated stroke of a gesture.

    Such a stroke yields to all others.
    """
    return isinstance(action, Gesture) and sync.startswith("stroke:")


def find_natural_spans(action: Action, known_durations: Mapping[str, float]) -> dict[str, float]:
    """Return each phase's natural duration [s] by its final sync point.

    A missing point has duration 0.

    Args:
        action: action of the behaviour.
        known_durations: durations that replace the defaults, by sync point.
    """
    match action:
        case Gaze(shift=True) | Face(shift=True) | Posture(shift=True):
            durations: Mapping[str, float] = {"end": _SHIFT_DURATION}
        case Interrupt() | Activate() | ParameterChange():
            durations = {}
        case Wait(duration):
            durations = {"end": _DEFAULT_WAIT_DURATION if duration is None else duration}
        case Head(repetition=count):
            durations = {
                **_NATURAL_DURATIONS[Head],
                **{f"stroke:{k}": _REPEATED_STROKE_DURATION for k in range(2, count + 1)},
            }
        case _:
            durations = _NATURAL_DURATIONS.get(type(action), _NATURAL_GESTURE_DURATIONS)
    return {**durations, **known_durations}


def _with_strokes(extra_strokes: Sequence[str]) -> tuple[str, ...]:
    after = GESTURE_SYNCS.index("strokeEnd")
    return (*GESTURE_SYNCS[:after], *extra_strokes, *GESTURE_SYNCS[after:])
