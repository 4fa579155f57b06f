"""Reading of SmartBody fragments: behaviours without a surrounding <bml>.

Fragments are read as if a <bml> surrounded them and are translated into BML where the meaning is the same. Elements
without an equivalent keep their name and produce a notice. SmartBody's y axis points up, its z axis forward.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from kinesic.bml.block import DEFAULT_BOUNDS, DocumentBounds
from kinesic.bml.reading.hands import infer_hands
from kinesic.bml.reading.tree import Element, read_tree

_TAG_PATTERN = re.compile(r"<([A-Za-z_][\w.:-]*)")  # beginning of a start tag
_ROOT_PATTERN = re.compile(r"<(?:[\w.-]+:)?(?:bml|fml-apml)[\s/>]")  # beginning of a root element
_DECLARATION_PATTERN = re.compile(r"\s*<\?xml[^>]*\?>")  # XML declaration
_ACTION_UNIT_PATTERN = re.compile(r"(\d+)_(left|right|both)", re.IGNORECASE)  # action unit with side, as in `1_left`
_JOINT_INFLUENCES = {
    "BACK": "WAIST",
    "CHEST": "SHOULDER",
    "NECK": "NECK",
    "EYES": "EYES",
}  # joint of a SmartBody gaze, from the lowest up -> value of BML's attribute `influence`
# gesture categories in SmartBody's lexemes
_GESTURE_CATEGORIES = frozenset({"BEAT", "DEICTIC", "METAPHORIC", "ICONIC", "EMBLEM", "ADAPTOR"})

_POSTURE_SUFFIX_PATTERN = re.compile(r"_(Motex|Idle\d*)$", re.IGNORECASE)  # suffix of posture animations

SMARTBODY_ELEMENTS = frozenset({"body", "saccade", "animation", "blend", "event", "viseme"})  # not in BML


def is_fragment(text: str, behaviour_names: frozenset[str]) -> bool:
    """Return whether a text is a sequence of behaviours without a <bml>.

    Args:
        text: text of the document.
        behaviour_names: local names of behaviours in addition to SmartBody's.
    """
    first = _TAG_PATTERN.search(text)
    if first is None:
        return False
    prefix, _, name = first[1].rpartition(":")
    return (prefix == "sbm" or name in behaviour_names or name in SMARTBODY_ELEMENTS) and _ROOT_PATTERN.search(
        text
    ) is None


def read_fragments(text: str, *, source: str, bounds: DocumentBounds = DEFAULT_BOUNDS) -> Element:
    """Read a sequence of SmartBody behaviours as a <bml>.

    Args:
        text: text of the document.
        source: name of the document, for messages.
        bounds: maximum size and depth.

    Raises:
        BmlError: too large, too deep, or not well-formed.
    """
    declared = _DECLARATION_PATTERN.match(text)
    blank = " " * (declared.end() if declared else 0)
    root = read_tree(blank + text[len(blank) :], source=source, bounds=bounds, wrapper="bml")
    counts: dict[str, int] = {}
    return replace(root, content=tuple(_translate(child, counts) for child in root.children))


def _translate(element: Element, counts: dict[str, int]) -> Element:
    counts[element.local] = counts.get(element.local, 0) + 1
    attributes = {"id": f"{element.local}.{counts[element.local]}", **element.attributes}
    rewrite = SMARTBODY_REWRITERS.get(element.local)
    identified = replace(element, attributes=MappingProxyType(attributes))
    return identified if rewrite is None else rewrite(identified)


def _translate_gaze(element: Element) -> Element:
    """Translate a SmartBody gaze into BML.

    It becomes a gazeShift unless it has an end or relax attribute.
    """
    attributes = element.attributes
    joints = attributes.get("sbm:joint-range", "").upper().split()
    added: dict[str, str | None] = {}
    if joints:
        added["influence"] = next(
            (influence for joint, influence in _JOINT_INFLUENCES.items() if joint in joints), None
        )
    if "sbm:target-pos" in attributes:
        added["target"] = _convert_axes(attributes["sbm:target-pos"])
    if "sbm:time-hint" in attributes:
        added["ready"] = f"start+{attributes['sbm:time-hint'].strip()}"
    name = None if "end" in attributes or "relax" in attributes else "gazeShift"
    return element.reword(name, "sbm:joint-range", "sbm:target-pos", "sbm:time-hint", "sbm:handle", **added)


def _convert_axes(point: str) -> str:
    """Convert SmartBody coordinates "left up forward" to kinesic's axis order.

    Return other text unchanged.
    """
    numbers = point.split()
    if len(numbers) != 3:
        return point
    left, up, forward = numbers
    return f"{forward} {left} {up}"


def _translate_head(element: Element) -> Element:
    attributes = element.attributes
    return element.reword(None, "repeats", repetition=attributes["repeats"]) if "repeats" in attributes else element


def _translate_face(element: Element) -> Element:
    """Translate a SmartBody face into BML.

    Split a sided action unit such as `1_left`.
    """
    sided = _ACTION_UNIT_PATTERN.fullmatch(element.attributes.get("au", "").strip())
    return element.reword(au=sided[1], side=sided[2].upper()) if sided else element


def _translate_gesture(element: Element) -> Element:
    """Translate a SmartBody gesture, named by category and type or by animation."""
    attributes = dict(element.attributes)
    lexeme, kind, name = attributes.get("lexeme", ""), attributes.get("type", ""), attributes.get("name", "")
    side = infer_hands(name, of_animation=True)
    added: dict[str, str | None] = {} if side == "unspecified" or "mode" in attributes else {"mode": side}
    if kind and lexeme.upper() in _GESTURE_CATEGORIES:
        added |= {"lexeme": f"{kind}_{lexeme}", "type": None}
    elif not lexeme and not kind and name:
        words = _POSTURE_SUFFIX_PATTERN.sub("", name.rpartition("@")[2])
        added["lexeme"] = words.rpartition("_")[2]  # last word, behind character, skeleton and posture
    for hold, point, before in (("prestroke_hold", "strokeStart", "ready"), ("poststroke_hold", "relax", "strokeEnd")):
        if hold in attributes and point not in attributes:
            added[point] = f"{before}+{attributes[hold].strip()}"
    return element.reword(None, "prestroke_hold", "poststroke_hold", "name", **added)


def _translate_animation(element: Element) -> Element:
    """Translate a SmartBody animation into the gesture that its name describes."""
    return (
        replace(_translate_gesture(element), name="gesture", original_tag=element.tag)
        if element.attributes.get("name")
        else element
    )


def _translate_body(element: Element) -> Element:
    """Translate SmartBody's <body posture=...> into a BML postureShift.

    The shift is immediate if `ready` is not after the start.
    """
    attributes = element.attributes
    name = attributes.get("posture", "")
    words = name.rpartition("@")[2] or name
    pose = Element("pose", MappingProxyType({"part": "WHOLEBODY", "lexeme": words}), (), element.place, element.scope)
    at_once = _read_seconds(attributes.get("ready", "")) <= _read_seconds(attributes.get("start", ""))
    changed = element.reword("postureShift", "posture", "relax", *(("ready",) if at_once else ()))
    return replace(changed, content=(*element.content, pose))


def _read_seconds(text: str) -> float:
    """Parse a time [s], or return 0 for any other text."""
    try:
        return float(text)
    except ValueError:
        return 0.0


def _translate_reach(element: Element) -> Element:
    """Translate a SmartBody point-at reach into BML pointing.

    Other reaches stay unchanged.
    """
    attributes = element.attributes
    if attributes.get("sbm:action", "").strip().lower() != "point-at":
        return element
    hand = {"left": "LEFT_HAND", "right": "RIGHT_HAND"}.get(attributes.get("sbm:reach-type", "").lower())
    return element.reword("pointing", "sbm:action", "sbm:reach-type", "sbm:reach-finish", mode=hand)


# SmartBody element -> function that translates it into BML
SMARTBODY_REWRITERS: Mapping[str, Callable[[Element], Element]] = {
    "gaze": _translate_gaze,
    "head": _translate_head,
    "face": _translate_face,
    "gesture": _translate_gesture,
    "animation": _translate_animation,
    "body": _translate_body,
    "reach": _translate_reach,
}
