"""From the element of a behaviour, in the richest form that is understood, to what it asks the body to do.

Elements and attributes: facts, BML 1.0 section 2.3; `type`, `hand`, `rotation` and `modality` are the draft's.
What an element fails to say (a gesture without lexeme) stays empty: who performs it knows what to do about it.
"""

from collections.abc import Callable
from dataclasses import replace
from types import MappingProxyType
from typing import Literal

from kinesic.bml.block import (
    Action,
    Face,
    Gaze,
    Gesture,
    HandMode,
    Head,
    HeadDirectionShift,
    Locomotion,
    NoticeType,
    Pointing,
    Posture,
    Speech,
    Torso,
    Wait,
)
from kinesic.bml.reading.hands import hands_named
from kinesic.bml.reading.manner import lexeme, reference_of
from kinesic.bml.reading.namespaces import is_core
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_number, read_whole
from kinesic.bml.reading.references import LONGEST_BLOCK
from kinesic.bml.reading.script import pause_of, script_of
from kinesic.bml.reading.sync_names import sync_name
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import HAND_SHAPE, KINDS

MOST_STROKES = 100  # of one head movement
LAST_ACTION_UNIT = 99
WITH_THE_CORE = frozenset({"gretabml", "kinesic", "application/ssml+xml", "audio/x-wav", "audio/wav"})  # descriptions

INFLUENCES = ("EYES", "HEAD", "NECK", "SHOULDER", "CHEST", "TORSO", "WAIST", "WHOLE", "AUTO")
DIRECTIONS = ("NONE", "RIGHT", "LEFT", "UP", "DOWN", "UPRIGHT", "UPLEFT", "DOWNLEFT", "DOWNRIGHT")

_MODES: dict[str, HandMode] = {"left": "left", "right": "right", "both": "both", "unspecified": "unspecified"}
_ROTATIONS = {"X": "NOD", "Y": "SHAKE", "Z": "TILT"}  # of the draft: about which axis
_WHOLE = "WHOLEBODY"  # part of a posture that names none
_SIDES: dict[str, Literal["left", "right", "both"]] = {"left": "left", "right": "right", "both": "both"}


def _gesture(named: BehaviourElement, reading: DocumentReading) -> Action:
    kind = named.word("type")
    if kind.upper() == "POINT" and not named.word("lexeme"):
        return _pointing(named, reading)
    written = _lexeme(named, "lexeme", "type")
    target = named.word("target") or None
    name = "" if written.lower() in KINDS else written
    return Gesture(name, _mode(named, reading, name=written), target, _hand_shape(named))


def _pointing(named: BehaviourElement, reading: DocumentReading) -> Action:
    return Pointing(named.word("target"), _mode(named, reading), _hand_shape(named))


def _hand_shape(named: BehaviourElement) -> str:
    """The shape of the hand, as an attribute or in an element of its own; empty where none is asked for."""
    inside = [child.attributes for child in named.element.children if child.local in HAND_SHAPE]
    return named.word(*HAND_SHAPE) or next((word for part in inside if (word := part.get("value", "").strip())), "")


def _head(named: BehaviourElement, reading: DocumentReading) -> Action:
    strokes = read_whole(named, "repetition", reading, default=1, largest=MOST_STROKES)
    written = _lexeme(named, "lexeme", "rotation", "type")
    return Head(_ROTATIONS.get(written.upper(), written), strokes, read_number(named, "amount", reading, default=0.5))


def _head_direction(named: BehaviourElement, _: DocumentReading) -> Action:
    return HeadDirectionShift(named.word("target") or _lexeme(named, "lexeme"))


def _gaze(named: BehaviourElement, reading: DocumentReading) -> Action:
    return Gaze(
        target=named.word("target") or None,
        influence=_influence(named, reading),
        offset_angle=read_number(named, "offsetAngle", reading, default=0.0),
        offset_direction=_one_of(DIRECTIONS, named, reading, "offsetDirection"),
        shift=named.element.local == "gazeShift",
    )


def _face(named: BehaviourElement, reading: DocumentReading) -> Action:
    """A face with lexemes or an action unit, as attributes or as elements inside."""
    inside = [named] + [
        BehaviourElement(named.id, child, child.attributes)
        for child in named.element.children
        if child.local in ("lexeme", "facs", "faceFacs")
    ]
    lexemes = tuple(word for part in inside if (word := part.word("lexeme")))
    units = [part for part in inside if part.word("au")]
    if len(units) > 1:
        others = ", ".join(part.word("au") for part in units[1:])
        what = f"one face shows one action unit: {others} passed over; write one faceFacs for each"
        reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    first = units[0] if units else named
    amount = next((part for part in (named, first, *inside) if part.word("amount")), named)
    kind = "" if units or named.word("type").lower() in KINDS else named.word("type")
    return Face(
        lexemes=lexemes or tuple(filter(None, [reference_of(named.element) or kind])),
        action_unit=read_whole(first, "au", reading, default=1, largest=LAST_ACTION_UNIT) if units else None,
        side=_SIDES.get(first.word("side").lower(), "both"),
        amount=read_number(amount, "amount", reading, default=0.5),
        shift=named.element.local == "faceShift",
    )


def _posture(named: BehaviourElement, _: DocumentReading) -> Action:
    inside = [BehaviourElement(named.id, child, child.attributes) for child in named.element.children]
    stances = (part.word("type") for part in inside if part.element.local == "stance")
    poses = [part for part in (named, *inside) if part.element.local == "pose" or part.word("shape")]
    return Posture(
        stance=named.word("stance") or next(stances, None),
        poses=tuple(_pose(part.word("part", default=_WHOLE), part.word("lexeme", "shape")) for part in poses),
        shift=named.element.local == "postureShift",
    )


def _pose(part: str, lexeme: str) -> tuple[str, str]:
    """A pose of a part; of both arms or the whole body, its name may say that one arm takes it."""
    side = hands_named(lexeme)
    one_arm = part.upper() in (_WHOLE, "ARMS") and side in ("left", "right")
    return (f"{side.upper()}_ARM" if one_arm else part, lexeme)


def _torso(named: BehaviourElement, reading: DocumentReading) -> Action:
    return Torso(_lexeme(named, "lexeme"), read_number(named, "amount", reading, default=0.5))


def _locomotion(named: BehaviourElement, _: DocumentReading) -> Action:
    return Locomotion(named.word("target"), named.word("manner", "type", default="WALK"))


def _speech(named: BehaviourElement, reading: DocumentReading) -> Action:
    return Speech(script_of(named, reading), pause_of(named.element, reading))


def _wait(named: BehaviourElement, reading: DocumentReading) -> Action:
    name = next((name for name in ("duration", "max-wait") if named.word(name)), None)
    if name is None:
        return Wait()
    duration = read_number(named, name, reading, default=0.0)
    if not 0.0 <= duration <= LONGEST_BLOCK:
        what = f"{name}='{named.word(name)}' is no duration"
        raise reading.refuse(named.element.place, what, f"0 to {LONGEST_BLOCK:g} s is")
    return Wait(duration)


ACTIONS: dict[str, Callable[[BehaviourElement, DocumentReading], Action]] = {
    "gesture": _gesture,
    "pointing": _pointing,
    "head": _head,
    "headDirectionShift": _head_direction,
    "gaze": _gaze,
    "gazeShift": _gaze,
    "face": _face,
    "faceLexeme": _face,
    "faceFacs": _face,
    "faceShift": _face,
    "posture": _posture,
    "postureShift": _posture,
    "torso": _torso,
    "locomotion": _locomotion,
    "speech": _speech,
    "wait": _wait,
}


def richest(element: Element, *, home: str | None) -> Element:
    """Picks the form of a behaviour that is performed: of its <description>s the most important that is understood.

    What is understood: a behaviour of BML inside, which takes the place of the core form at the same times;
    expressivity, and speech in a markup of its own, which go with the core form. Without one the core form stays.

    Args:
        element: the behaviour, descriptions inside.
        home: namespace of the <bml>.
    """
    described = [child for child in element.children if child.local == "description" and is_core(child, home=home)]
    for description in sorted(described, key=_priority, reverse=True):
        if description.attributes.get("type", "").strip().lower() in WITH_THE_CORE:
            return element
        inside = [child for child in description.children if child.local in ACTIONS and is_core(child, home=home)]
        if len(inside) == 1:
            return _in_place(inside[0], element)
    return element


def _priority(description: Element) -> float:
    try:
        return float(description.attributes.get("priority", "0"))
    except ValueError:
        return 0.0


def _in_place(richer: Element, element: Element) -> Element:
    """The richer form with the id of the core form, and with its times unless the richer one has its own."""
    kept = {name: value for name, value in element.attributes.items() if name == "id" or sync_name(name)}
    own = {name: value for name, value in richer.attributes.items() if name != "id"}
    return replace(richer, attributes=MappingProxyType({**kept, **own}))


def _lexeme(named: BehaviourElement, *names: str) -> str:
    return reference_of(named.element) or lexeme(named.word(*names))


def _influence(named: BehaviourElement, reading: DocumentReading) -> str | None:
    """The widest part that takes part; AUTO leaves it to the angle, as saying nothing does."""
    found = _one_of(INFLUENCES, named, reading, "influence", "modality")
    return None if found == "AUTO" else found


def _one_of(known: tuple[str, ...], named: BehaviourElement, reading: DocumentReading, *names: str) -> str | None:
    """An attribute in capitals; None, with a notice, when it is none of those that are known."""
    written = named.word(*names).upper()
    meant = written.replace("_", "")
    if meant and meant not in known:
        what = f"{names[0]} '{written}' is passed over; known are {', '.join(known)}"
        reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    return meant if meant in known else None


def _mode(named: BehaviourElement, reading: DocumentReading, *, name: str = "") -> HandMode:
    """Which hands do it: those that the document says, else those that the name of the gesture decides."""
    if not named.word("mode", "hand"):
        return hands_named(name)
    written = named.word("mode", "hand", default="unspecified")
    mode = _MODES.get(written.lower().removesuffix("s").removesuffix("_hand"))
    if mode is None:
        what = f"mode '{written}' is none of LEFT_HAND, RIGHT_HAND, BOTH_HANDS: any hand is taken"
        reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    return mode or "unspecified"
