"""Conversion of behaviour elements into actions.

Source of elements and attributes: BML 1.0, section 2.3; `type`, `hand`, `rotation` and `modality` come from the draft.
Missing values, such as a gesture without a lexeme, stay empty; the performing modality handles them.
"""

from collections.abc import Callable
from dataclasses import replace
from types import MappingProxyType
from typing import Literal

from kinesic.bml.block import (
    MAX_BLOCK_DURATION,
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
from kinesic.bml.reading.hands import infer_hands
from kinesic.bml.reading.manner import read_lexeme_reference, strip_category
from kinesic.bml.reading.namespaces import is_core
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_integer, read_number
from kinesic.bml.reading.script import read_pause, read_script
from kinesic.bml.reading.sync_names import find_sync_name
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import HAND_SHAPE_NAMES, NOTATION_TYPES

MAX_HEAD_STROKES = 100  # largest number of strokes per head movement
MAX_ACTION_UNIT = 99  # largest accepted FACS action unit number
# types of descriptions that supplement the core form instead of replacing it
SUPPLEMENTARY_TYPES = frozenset({"gretabml", "kinesic", "application/ssml+xml", "audio/x-wav", "audio/wav"})

# values of the gaze attribute `influence`: lowest body part that turns
GAZE_INFLUENCES = ("EYES", "HEAD", "NECK", "SHOULDER", "CHEST", "TORSO", "WAIST", "WHOLE", "AUTO")
# values of the gaze attribute `offsetDirection`
OFFSET_DIRECTIONS = ("NONE", "RIGHT", "LEFT", "UP", "DOWN", "UPRIGHT", "UPLEFT", "DOWNLEFT", "DOWNRIGHT")

# values of the attribute `mode` without `_HAND`
_HAND_MODES: dict[str, HandMode] = {"left": "left", "right": "right", "both": "both", "unspecified": "unspecified"}
_ROTATION_LEXEMES = {"X": "NOD", "Y": "SHAKE", "Z": "TILT"}  # rotation axis in the BML draft -> head lexeme
_WHOLE_BODY = "WHOLEBODY"  # default body part of a <pose>
# values of the attribute `side`
_SIDE_NAMES: dict[str, Literal["left", "right", "both"]] = {"left": "left", "right": "right", "both": "both"}


def _read_gesture(node: BehaviourElement, reading: DocumentReading) -> Action:
    kind = node.attribute("type")
    if kind.upper() == "POINT" and not node.attribute("lexeme"):
        return _read_pointing(node, reading)
    text = _read_lexeme(node, "lexeme", "type")
    target = node.attribute("target") or None
    name = "" if text.lower() in NOTATION_TYPES else text
    return Gesture(name, _read_mode(node, reading, name=text), target, _read_hand_shape(node))


def _read_pointing(node: BehaviourElement, reading: DocumentReading) -> Action:
    return Pointing(node.attribute("target"), _read_mode(node, reading), _read_hand_shape(node))


def _read_hand_shape(node: BehaviourElement) -> str:
    """Return the hand shape from an attribute or nested element, or ""."""
    parts = [child.attributes for child in node.element.children if child.local in HAND_SHAPE_NAMES]
    return node.attribute(*HAND_SHAPE_NAMES) or next(
        (word for part in parts if (word := part.get("value", "").strip())), ""
    )


def _read_head(node: BehaviourElement, reading: DocumentReading) -> Action:
    strokes = read_integer(node, "repetition", reading, default=1, largest=MAX_HEAD_STROKES)
    text = _read_lexeme(node, "lexeme", "rotation", "type")
    return Head(_ROTATION_LEXEMES.get(text.upper(), text), strokes, read_number(node, "amount", reading, default=0.5))


def _read_head_direction(node: BehaviourElement, _: DocumentReading) -> Action:
    return HeadDirectionShift(node.attribute("target") or _read_lexeme(node, "lexeme"))


def _read_gaze(node: BehaviourElement, reading: DocumentReading) -> Action:
    return Gaze(
        target=node.attribute("target") or None,
        influence=_read_influence(node, reading),
        offset_angle=read_number(node, "offsetAngle", reading, default=0.0),
        offset_direction=_read_choice(OFFSET_DIRECTIONS, node, reading, "offsetDirection"),
        shift=node.element.local == "gazeShift",
    )


def _read_face(node: BehaviourElement, reading: DocumentReading) -> Action:
    """Read a face: lexemes or an action unit, possibly in nested elements."""
    parts = [node] + [
        BehaviourElement(node.id, child, child.attributes)
        for child in node.element.children
        if child.local in ("lexeme", "facs", "faceFacs")
    ]
    lexemes = tuple(word for part in parts if (word := part.attribute("lexeme")))
    units = [part for part in parts if part.attribute("au")]
    if len(units) > 1:
        others = ", ".join(part.attribute("au") for part in units[1:])
        problem = f"a face has one action unit: {others} ignored; write one faceFacs for each"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=node.id)
    unit_node = units[0] if units else node
    amount = next((part for part in (node, unit_node, *parts) if part.attribute("amount")), node)
    kind = "" if units or node.attribute("type").lower() in NOTATION_TYPES else node.attribute("type")
    return Face(
        lexemes=lexemes or tuple(filter(None, [read_lexeme_reference(node.element) or kind])),
        action_unit=read_integer(unit_node, "au", reading, default=1, largest=MAX_ACTION_UNIT) if units else None,
        side=_SIDE_NAMES.get(unit_node.attribute("side").lower(), "both"),
        amount=read_number(amount, "amount", reading, default=0.5),
        shift=node.element.local == "faceShift",
    )


def _read_posture(node: BehaviourElement, _: DocumentReading) -> Action:
    parts = [BehaviourElement(node.id, child, child.attributes) for child in node.element.children]
    stances = (part.attribute("type") for part in parts if part.element.local == "stance")
    poses = [part for part in (node, *parts) if part.element.local == "pose" or part.attribute("shape")]
    return Posture(
        stance=node.attribute("stance") or next(stances, None),
        poses=tuple(
            _read_pose(part.attribute("part", default=_WHOLE_BODY), part.attribute("lexeme", "shape")) for part in poses
        ),
        shift=node.element.local == "postureShift",
    )


def _read_pose(part: str, lexeme: str) -> tuple[str, str]:
    """Return body part and lexeme of a <pose> element.

    If the part is both arms or the whole body, a lexeme that names one hand restricts the pose to that arm.
    """
    side = infer_hands(lexeme)
    one_arm = part.upper() in (_WHOLE_BODY, "ARMS") and side in ("left", "right")
    return (f"{side.upper()}_ARM" if one_arm else part, lexeme)


def _read_torso(node: BehaviourElement, reading: DocumentReading) -> Action:
    return Torso(_read_lexeme(node, "lexeme"), read_number(node, "amount", reading, default=0.5))


def _read_locomotion(node: BehaviourElement, _: DocumentReading) -> Action:
    return Locomotion(node.attribute("target"), node.attribute("manner", "type", default="WALK"))


def _read_speech(node: BehaviourElement, reading: DocumentReading) -> Action:
    return Speech(read_script(node, reading), read_pause(node.element, reading))


def _read_wait(node: BehaviourElement, reading: DocumentReading) -> Action:
    name = next((name for name in ("duration", "max-wait") if node.attribute(name)), None)
    if name is None:
        return Wait()
    duration = read_number(node, name, reading, default=0.0)
    if not 0.0 <= duration <= MAX_BLOCK_DURATION:
        problem = f"{name}='{node.attribute(name)}' is not a valid duration"
        raise reading.error(node.element.place, problem, f"use 0 to {MAX_BLOCK_DURATION:g} s")
    return Wait(duration)


# behaviour element -> reader of its action
ACTION_READERS: dict[str, Callable[[BehaviourElement, DocumentReading], Action]] = {
    "gesture": _read_gesture,
    "pointing": _read_pointing,
    "head": _read_head,
    "headDirectionShift": _read_head_direction,
    "gaze": _read_gaze,
    "gazeShift": _read_gaze,
    "face": _read_face,
    "faceLexeme": _read_face,
    "faceFacs": _read_face,
    "faceShift": _read_face,
    "posture": _read_posture,
    "postureShift": _read_posture,
    "torso": _read_torso,
    "locomotion": _read_locomotion,
    "speech": _read_speech,
    "wait": _read_wait,
}


def select_form(element: Element, *, home: str | None) -> Element:
    """Return an element's supported description of highest priority, or the element.

    A BML behaviour in a description replaces the core form at the same times. Expressivity, and speech with its own
    markup, supplement the core form. Without a supported description, the element itself (core form) is returned.

    Args:
        element: the behaviour with its descriptions.
        home: namespace of the <bml>.
    """
    descriptions = [child for child in element.children if child.local == "description" and is_core(child, home=home)]
    for description in sorted(descriptions, key=_read_priority, reverse=True):
        if description.attributes.get("type", "").strip().lower() in SUPPLEMENTARY_TYPES:
            return element
        parts = [child for child in description.children if child.local in ACTION_READERS and is_core(child, home=home)]
        if len(parts) == 1:
            return _merge_forms(parts[0], element)
    return element


def _read_priority(description: Element) -> float:
    try:
        return float(description.attributes.get("priority", "0"))
    except ValueError:
        return 0.0


def _merge_forms(form: Element, element: Element) -> Element:
    """Return a description's behaviour under the id of the replaced element.

    It also gets the sync attributes of the core form, unless it has its own.
    """
    core_attributes = {
        name: value for name, value in element.attributes.items() if name == "id" or find_sync_name(name)
    }
    richer_attributes = {name: value for name, value in form.attributes.items() if name != "id"}
    return replace(form, attributes=MappingProxyType({**core_attributes, **richer_attributes}))


def _read_lexeme(node: BehaviourElement, *names: str) -> str:
    return read_lexeme_reference(node.element) or strip_category(node.attribute(*names))


def _read_influence(node: BehaviourElement, reading: DocumentReading) -> str | None:
    """Return the lowest body part that turns in a gaze, or None.

    None leaves the choice to the angle. AUTO means the same as a missing value.
    """
    influence = _read_choice(GAZE_INFLUENCES, node, reading, "influence", "modality")
    return None if influence == "AUTO" else influence


def _read_choice(choices: tuple[str, ...], node: BehaviourElement, reading: DocumentReading, *names: str) -> str | None:
    """Return a valid attribute value in capitals without underscores, or None.

    None stands for a missing or an invalid value. An invalid one adds a notice.
    """
    text = node.attribute(*names).upper()
    choice = text.replace("_", "")
    if choice and choice not in choices:
        problem = f"{names[0]} '{text}' is ignored; valid values: {', '.join(choices)}"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=node.id)
    return choice if choice in choices else None


def _read_mode(node: BehaviourElement, reading: DocumentReading, *, name: str = "") -> HandMode:
    """Return the hands of a gesture from its attribute or name.

    An unknown mode adds a notice and counts as unspecified.
    """
    if not node.attribute("mode", "hand"):
        return infer_hands(name)
    text = node.attribute("mode", "hand", default="unspecified")
    mode = _HAND_MODES.get(text.lower().removesuffix("s").removesuffix("_hand"))
    if mode is None:
        problem = f"mode '{text}' is not LEFT_HAND, RIGHT_HAND or BOTH_HANDS: any hand is used"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=node.id)
    return mode or "unspecified"
