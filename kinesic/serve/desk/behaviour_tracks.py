"""Label and body parts of a planned behaviour for timeline tracks."""

from collections.abc import Sequence
from typing import Literal

from kinesic.bml.actions import (
    Custom,
    Face,
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Pointing,
    Posture,
    Speech,
    Torso,
    Wait,
)
from kinesic.bml.block import Behaviour
from kinesic.planning.plan import Plan

Track = Literal["voice", "face", "gaze", "head", "torso", "r_hand", "l_hand"]
# Tracks of body parts that a plan may use, the preferred main track first
USED_TRACKS: Sequence[Literal["torso", "head", "r_hand", "l_hand"]] = ("r_hand", "l_hand", "torso", "head")
MODE_TRACKS: dict[str, tuple[Track, ...]] = {
    "left": ("l_hand",),
    "right": ("r_hand",),
    "both": ("r_hand", "l_hand"),
    "unspecified": ("r_hand",),
}
MAX_LABEL_LENGTH = 40  # [characters] longest label, with its ellipsis


def list_tracks(behaviour: Behaviour, plan: Plan) -> tuple[Track, ...]:
    """Return the timeline tracks of a behaviour, the main one first.

    A gesture that the plan drops has the tracks of the hands that the document requests.
    """
    used: tuple[Track, ...] = tuple(
        part for part in USED_TRACKS if part in plan.keyframes.uses.get(behaviour.id, frozenset())
    )
    match behaviour.action:
        case Speech():
            return ("voice",)
        case Face():
            return ("face",)
        case Gaze():
            return ("gaze",)
        case Head() | HeadDirectionShift():
            return ("head",)
        case Torso():
            return ("torso",)
        case Gesture(mode=mode) | Pointing(mode=mode):
            hands: tuple[Track, ...] = tuple(part for part in used if part.endswith("hand"))
            return hands or used or MODE_TRACKS[mode]
        case Posture():
            return used or ("torso",)
    return ()


def label_behaviour(behaviour: Behaviour) -> str:
    """Return a behaviour's timeline label, cut to `MAX_LABEL_LENGTH` characters.

    The label is a lexeme, target, spoken text or similar.
    """
    match behaviour.action:
        case Gesture(lexeme=lexeme) | Head(lexeme=lexeme) | Torso(lexeme=lexeme):
            text = lexeme
        case Pointing(target=target) | HeadDirectionShift(target=target):
            text = target
        case Gaze(target=target, offset_direction=direction):
            text = target or direction or ""
        case Face(lexemes=lexemes, action_unit=unit):
            text = " ".join(lexemes) if unit is None else f"AU {unit}"
        case Posture(stance=stance, poses=poses):
            text = " ".join([*([stance] if stance else []), *(lexeme for _, lexeme in poses)])
        case Speech(script=script):
            text = " ".join(script.text.split())
        case Wait():
            text = "pause"
        case Custom(name=name):
            text = name
        case _:
            text = ""
    return text if len(text) <= MAX_LABEL_LENGTH else f"{text[: MAX_LABEL_LENGTH - 1]}…"
