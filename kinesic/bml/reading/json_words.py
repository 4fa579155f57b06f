"""Words of web realizers that send BML as JSON (UPF's Performs and its kin), in those of BML itself.

`shift` makes a behaviour stay; emotions are faces; a gaze may go in a direction; a blink has a start alone; hands may
be the dominant one, which is the right; repetition counts what comes after the first time; a face is full unless an
amount is given. What moves hands by parts, for sign language, has no lexeme and is left to be noticed.
"""

from collections.abc import Callable, Mapping

from kinesic.bml.reading.tree import Element

GLANCE = 20.0  # [deg] of a gaze that names a direction instead of a target
BLINK = 0.25  # [s]
IN_FRONT = "audience"  # who is in front

_DIRECTIONS = frozenset({"UP", "DOWN", "LEFT", "RIGHT", "UPRIGHT", "UPLEFT", "DOWNRIGHT", "DOWNLEFT", "FRONT"})
_HANDS = {"DOMINANT": "RIGHT", "NON_DOMINANT": "LEFT"}
_YES = ("true", "1")
_DIGITS = 4  # of a number of strokes


def rewritten(element: Element) -> Element:
    """Rewrites a web realizer's behaviour as the BML element that it means."""
    rewrite = REWRITES.get(element.name)
    return element if rewrite is None else rewrite(element)


def _stays(element: Element) -> bool:
    return element.attributes.get("shift", "").lower() in _YES


def _gaze(element: Element) -> Element:
    written = element.attributes
    stays = _stays(element) or element.name == "gazeShift"
    found = element.reword("gazeShift" if stays else "gaze", "shift")
    direction = written.get("target", "").upper().replace("_", "")
    if direction not in _DIRECTIONS:
        return found
    if direction == "FRONT":
        return found.reword(target=IN_FRONT)
    where = {"offsetDirection": direction, "offsetAngle": written.get("offsetAngle", repr(GLANCE))}
    return found.reword(None, "target", **where)


def _head(element: Element) -> Element:
    again = element.attributes.get("repetition", "")
    return element.reword(repetition=str(int(again) + 1)) if again.isdecimal() and len(again) <= _DIGITS else element


def _face(element: Element) -> Element:
    written = element.attributes
    kind = "faceShift" if _stays(element) or element.name == "faceShift" else "face"
    added = {} if "amount" in written else {"amount": "1.0"}
    if "emotion" in written:
        added["lexeme"] = written["emotion"]
    return element.reword(kind, "shift", "emotion", **added)


def _gesture(element: Element) -> Element:
    written = element.attributes
    found = element
    if "attackPeak" in written and "stroke" not in written:
        found = found.reword(None, "attackPeak", stroke=written["attackPeak"])
    if "bodyMovement" in written and "lexeme" not in written:
        return found.reword("torso", "bodyMovement", "hand", lexeme=written["bodyMovement"])
    hand = written.get("hand", "").upper()
    return found.reword(hand=_HANDS.get(hand, hand)) if hand else found


def _posture(element: Element) -> Element:
    return element.reword("postureShift", "shift") if _stays(element) else element


def _blink(element: Element) -> Element:
    times = {"au": "45", "amount": "1.0"}
    start = element.attributes.get("start", "")
    try:
        times["end"] = repr(float(start or 0.0) + BLINK)
    except ValueError:
        times["end"] = f"{start}+{BLINK}"
    return element.reword("face", **times)


REWRITES: Mapping[str, Callable[[Element], Element]] = {
    "gaze": _gaze,
    "gazeShift": _gaze,
    "head": _head,
    "face": _face,
    "faceLexeme": _face,
    "faceFACS": _face,
    "faceFacs": _face,
    "faceShift": _face,
    "faceEmotion": _face,
    "faceVA": _face,
    "gesture": _gesture,
    "posture": _posture,
    "blink": _blink,
}
