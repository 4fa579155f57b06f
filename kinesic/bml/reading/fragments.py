"""Reads fragments: behaviours without a <bml> around them, in SmartBody's words, as its scripts hand them over.

Read as if a <bml> stood around them, and rewritten into BML's own words where they mean the same. What has no plain
meaning in BML keeps its name, and is noticed by it. SmartBody's y points up and its z forward.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from kinesic.bml.block import BOUNDS, Bounds
from kinesic.bml.reading.hands import hands_named
from kinesic.bml.reading.tree import Element, read_tree

_TAG = re.compile(r"<([A-Za-z_][\w.:-]*)")
_ROOT = re.compile(r"<(?:[\w.-]+:)?(?:bml|fml-apml)[\s/>]")
_DECLARATION = re.compile(r"\s*<\?xml[^>]*\?>")
_ACTION_UNIT = re.compile(r"(\d+)_(left|right|both)", re.IGNORECASE)
_JOINTS = {"BACK": "WAIST", "CHEST": "SHOULDER", "NECK": "NECK", "EYES": "EYES"}  # of gaze, from the widest
_CATEGORIES = frozenset({"BEAT", "DEICTIC", "METAPHORIC", "ICONIC", "EMBLEM", "ADAPTOR"})

_POSTURE = re.compile(r"_(Motex|Idle\d*)$", re.IGNORECASE)  # end of the name of an animation that is a posture

WORDS = frozenset({"body", "saccade", "animation", "blend", "event", "viseme"})


def is_fragment(text: str, known: frozenset[str]) -> bool:
    """Whether a text is a row of behaviours, with no <bml> around them.

    Args:
        text: of the document.
        known: local names of behaviours, beside SmartBody's own.
    """
    first = _TAG.search(text)
    if first is None:
        return False
    prefix, _, name = first[1].rpartition(":")
    return (prefix == "sbm" or name in known or name in WORDS) and _ROOT.search(text) is None


def read_fragments(text: str, *, source: str, bounds: Bounds = BOUNDS) -> Element:
    """Reads a row of behaviours as a <bml> in BML's words.

    Args:
        text: of the document.
        source: its name, for messages.
        bounds: largest size and depth.

    Raises:
        BmlError: too large, too deep, or not well-formed.
    """
    declared = _DECLARATION.match(text)
    blank = " " * (declared.end() if declared else 0)
    root = read_tree(blank + text[len(blank) :], source=source, bounds=bounds, around="bml")
    counts: dict[str, int] = {}
    return replace(root, content=tuple(_rewritten(child, counts) for child in root.children))


def _rewritten(element: Element, counts: dict[str, int]) -> Element:
    counts[element.local] = counts.get(element.local, 0) + 1
    attributes = {"id": f"{element.local}.{counts[element.local]}", **element.attributes}
    rewrite = REWRITTEN.get(element.local)
    known = replace(element, attributes=MappingProxyType(attributes))
    return known if rewrite is None else rewrite(known)


def _gaze(element: Element) -> Element:
    """A gaze stays until another one comes, unless it says when it ends."""
    written = element.attributes
    joints = written.get("sbm:joint-range", "").upper().split()
    added: dict[str, str | None] = {}
    if joints:
        added["influence"] = next((influence for joint, influence in _JOINTS.items() if joint in joints), None)
    if "sbm:target-pos" in written:
        added["target"] = _turned(written["sbm:target-pos"])
    if "sbm:time-hint" in written:
        added["ready"] = f"start+{written['sbm:time-hint'].strip()}"
    name = None if "end" in written or "relax" in written else "gazeShift"
    return element.reword(name, "sbm:joint-range", "sbm:target-pos", "sbm:time-hint", "sbm:handle", **added)


def _turned(point: str) -> str:
    """Three coordinates in our frame; any other text as it is."""
    numbers = point.split()
    if len(numbers) != 3:
        return point
    left, up, forward = numbers
    return f"{forward} {left} {up}"


def _head(element: Element) -> Element:
    written = element.attributes
    return element.reword(None, "repeats", repetition=written["repeats"]) if "repeats" in written else element


def _face(element: Element) -> Element:
    """An action unit may name its side: `1_left`."""
    sided = _ACTION_UNIT.fullmatch(element.attributes.get("au", "").strip())
    return element.reword(au=sided[1], side=sided[2].upper()) if sided else element


def _gesture(element: Element) -> Element:
    """The lexeme may be a category, whose gesture stands in `type`; a name is one of an animation."""
    written = dict(element.attributes)
    lexeme, kind, name = written.get("lexeme", ""), written.get("type", ""), written.get("name", "")
    side = hands_named(name, of_animation=True)
    added: dict[str, str | None] = {} if side == "unspecified" or "mode" in written else {"mode": side}
    if kind and lexeme.upper() in _CATEGORIES:
        added |= {"lexeme": f"{kind}_{lexeme}", "type": None}
    elif not lexeme and not kind and name:
        words = _POSTURE.sub("", name.rpartition("@")[2])
        added["lexeme"] = words.rpartition("_")[2]  # behind its character, skeleton and posture
    for hold, point, before in (("prestroke_hold", "strokeStart", "ready"), ("poststroke_hold", "relax", "strokeEnd")):
        if hold in written and point not in written:
            added[point] = f"{before}+{written[hold].strip()}"
    return element.reword(None, "prestroke_hold", "poststroke_hold", "name", **added)


def _animation(element: Element) -> Element:
    """An animation is performed as the gesture that its name speaks of."""
    return (
        replace(_gesture(element), name="gesture", called=element.written)
        if element.attributes.get("name")
        else element
    )


def _body(element: Element) -> Element:
    """A posture by the name of its animation; it stays, and comes at once where `ready` is not after its start."""
    written = element.attributes
    name = written.get("posture", "")
    words = name.rpartition("@")[2] or name
    pose = Element("pose", MappingProxyType({"part": "WHOLEBODY", "lexeme": words}), (), element.place, element.scope)
    at_once = _seconds(written.get("ready", "")) <= _seconds(written.get("start", ""))
    changed = element.reword("postureShift", "posture", "relax", *(("ready",) if at_once else ()))
    return replace(changed, content=(*element.content, pose))


def _seconds(text: str) -> float:
    """A time from the block's start; 0 when it is none."""
    try:
        return float(text)
    except ValueError:
        return 0.0


def _reach(element: Element) -> Element:
    """Pointing is what an arm without fingers does of reaching."""
    written = element.attributes
    if written.get("sbm:action", "").strip().lower() != "point-at":
        return element
    hand = {"left": "LEFT_HAND", "right": "RIGHT_HAND"}.get(written.get("sbm:reach-type", "").lower())
    return element.reword("pointing", "sbm:action", "sbm:reach-type", "sbm:reach-finish", mode=hand)


REWRITTEN: Mapping[str, Callable[[Element], Element]] = {
    "gaze": _gaze,
    "head": _head,
    "face": _face,
    "gesture": _gesture,
    "animation": _animation,
    "body": _body,
    "reach": _reach,
}
