"""Readable names of behaviours in reports."""

from kinesic.bml.block import (
    Action,
    Activate,
    Behaviour,
    Block,
    Custom,
    Face,
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Interrupt,
    Locomotion,
    ParameterChange,
    Pointing,
    Posture,
    Speech,
    Torso,
    Wait,
)
from kinesic.planning.syncs import SyncTime

MAX_LABEL_LENGTH = 40  # [characters] longest label of a behaviour
WHOLE_BODY = "WHOLEBODY"  # BML pose part that labels omit


def label(behaviour: Behaviour) -> str:
    """Return a short readable name of a behaviour."""
    words = " ".join(_words(behaviour.action).split()) or behaviour.type
    return words if len(words) <= MAX_LABEL_LENGTH else f"{words[: MAX_LABEL_LENGTH - 1]}\u2026"


def label_with_id(id: str, block: Block) -> str:
    """Return a behaviour's name, followed by a differing id: `offer (g9)`."""
    name = next((label(behaviour) for behaviour in block.behaviours if behaviour.id == id), id)
    return name if name.lower() == id.lower() else f"{name} ({id})"


def label_sync(sync: SyncTime, block: Block) -> str:
    """Return the readable name of a sync point: `stroke of offer (g9)`."""
    return f"{sync.sync} of {label_with_id(sync.behaviour, block)}"


def _words(action: Action) -> str:
    match action:
        case Gesture(lexeme) | Head(lexeme) | Torso(lexeme):
            return lexeme
        case Pointing(target):
            return f"point at {target}"
        case Gaze(target, _, angle, direction):
            return " ".join(filter(None, ("look", f"at {target}" if target else "", direction if angle else "")))
        case HeadDirectionShift(target):
            return f"head to {target}"
        case Face(lexemes, unit):
            return ", ".join((*lexemes, *((f"AU {unit}",) if unit is not None else ())))
        case Posture(stance, poses):
            return ", ".join((*((stance,) if stance else ()), *(_pose(part, lexeme) for part, lexeme in poses)))
        case Locomotion(target):
            return f"go to {target}"
        case Speech():
            return "speech"
        case Wait():
            return "wait"
        case Interrupt(target):
            return f"interrupt {target}"
        case Activate(target):
            return f"activate {target}"
        case ParameterChange(target, parameter, value):
            return f"{parameter} of {target}: {value}"
        case Custom(name):
            return name


def _pose(part: str, lexeme: str) -> str:
    return lexeme if part.upper() == WHOLE_BODY else f"{part} {lexeme}"
