"""Translation of the JSON vocabulary of web realizers into BML.

An example of such a realizer is UPF's Performs.
`shift` makes a behaviour persist; emotions are faces; a gaze may name a direction; a blink has only a start; hands may
be the dominant one, here the right; `repetition` counts the strokes after the first; a face has full amount unless one
is given. Sign-language behaviours that move parts of the hands have no lexeme and produce a notice.
"""

from collections.abc import Callable, Mapping

from kinesic.bml.reading.tree import Element

DEFAULT_GAZE_OFFSET = 20.0  # [deg] rotation of a gaze that names a direction instead of a target
BLINK_DURATION = 0.25  # [s] duration of a blink behaviour
FRONT_TARGET = "audience"  # name of the target in front of the robot

# directions in place of a gaze target
_GAZE_DIRECTIONS = frozenset({"UP", "DOWN", "LEFT", "RIGHT", "UPRIGHT", "UPLEFT", "DOWNRIGHT", "DOWNLEFT", "FRONT"})
_HAND_NAMES = {"DOMINANT": "RIGHT", "NON_DOMINANT": "LEFT"}  # hand of a right-handed person
_TRUE_VALUES = ("true", "1")  # texts that mean true
_MAX_COUNT_DIGITS = 4  # largest number of digits of a `repetition` that is converted; longer numbers stay unchanged


def rewrite_json_behaviour(element: Element) -> Element:
    """Translate a web realizer's behaviour into the equivalent BML element.

    Other elements are returned unchanged.
    """
    rewrite = JSON_REWRITERS.get(element.name)
    return element if rewrite is None else rewrite(element)


def _is_persistent(element: Element) -> bool:
    return element.attributes.get("shift", "").lower() in _TRUE_VALUES


def _translate_gaze(element: Element) -> Element:
    attributes = element.attributes
    stays = _is_persistent(element) or element.name == "gazeShift"
    translated = element.reword("gazeShift" if stays else "gaze", "shift")
    direction = attributes.get("target", "").upper().replace("_", "")
    if direction not in _GAZE_DIRECTIONS:
        return translated
    if direction == "FRONT":
        return translated.reword(target=FRONT_TARGET)
    offset = {"offsetDirection": direction, "offsetAngle": attributes.get("offsetAngle", repr(DEFAULT_GAZE_OFFSET))}
    return translated.reword(None, "target", **offset)


def _translate_head(element: Element) -> Element:
    repetition = element.attributes.get("repetition", "")
    return (
        element.reword(repetition=str(int(repetition) + 1))
        if repetition.isdecimal() and len(repetition) <= _MAX_COUNT_DIGITS
        else element
    )


def _translate_face(element: Element) -> Element:
    attributes = element.attributes
    kind = "faceShift" if _is_persistent(element) or element.name == "faceShift" else "face"
    added = {} if "amount" in attributes else {"amount": "1.0"}
    if "emotion" in attributes:
        added["lexeme"] = attributes["emotion"]
    return element.reword(kind, "shift", "emotion", **added)


def _translate_gesture(element: Element) -> Element:
    attributes = element.attributes
    translated = element
    if "attackPeak" in attributes and "stroke" not in attributes:
        translated = translated.reword(None, "attackPeak", stroke=attributes["attackPeak"])
    if "bodyMovement" in attributes and "lexeme" not in attributes:
        return translated.reword("torso", "bodyMovement", "hand", lexeme=attributes["bodyMovement"])
    hand = attributes.get("hand", "").upper()
    return translated.reword(hand=_HAND_NAMES.get(hand, hand)) if hand else translated


def _translate_posture(element: Element) -> Element:
    return element.reword("postureShift", "shift") if _is_persistent(element) else element


def _translate_blink(element: Element) -> Element:
    times = {"au": "45", "amount": "1.0"}
    start = element.attributes.get("start", "")
    try:
        times["end"] = repr(float(start or 0.0) + BLINK_DURATION)
    except ValueError:
        times["end"] = f"{start}+{BLINK_DURATION}"
    return element.reword("face", **times)


# web realizer's element -> function that translates it into BML
JSON_REWRITERS: Mapping[str, Callable[[Element], Element]] = {
    "gaze": _translate_gaze,
    "gazeShift": _translate_gaze,
    "head": _translate_head,
    "face": _translate_face,
    "faceLexeme": _translate_face,
    "faceFACS": _translate_face,
    "faceFacs": _translate_face,
    "faceShift": _translate_face,
    "faceEmotion": _translate_face,
    "faceVA": _translate_face,
    "gesture": _translate_gesture,
    "posture": _translate_posture,
    "blink": _translate_blink,
}
