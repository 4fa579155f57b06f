"""A recording that a speech names, with the times of its marks, and how long a speech may wait for the body."""

from pathlib import Path

from kinesic.bml.block import NoticeType
from kinesic.bml.reading.namespaces import own_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_finite
from kinesic.bml.reading.tree import Element
from kinesic.body.utterance import Recording

WAV = frozenset({"audio/wav", "audio/x-wav", "audio/wave", "audio/vnd.wave"})
PAUSE = "pause"  # attribute of our namespace
LONGEST_PAUSE = 2.0  # [s] of `kinesic:pause="true"`

_NAMES = ("ref", "src", "href", "file")
_TIMED = frozenset({"sync", "tm", "mark"})


def recording_of(named: BehaviourElement, reading: DocumentReading) -> Recording | None:
    """The recording of a <speech>, or None.

    It is named by the description's text, by a <reference> in it, or by an attribute `ref`, `src`, `href` or `file`
    of the description or of an element in it; relative to the folder of the document. One with a negative priority is
    passed over.

    Raises:
        BmlError: the time of a mark is no number.
    """
    for child in named.element.children:
        is_wav = child.local == "description" and child.attributes.get("type", "").strip().lower() in WAV
        if is_wav and not child.attributes.get("priority", "").strip().startswith("-"):
            return _recording(child, named, reading)
    return None


def pause_of(element: Element, reading: DocumentReading) -> float | None:
    """Longest pause [s] that may be put before a word, so that the body is in time; None where nothing is said.

    `kinesic:pause` is a number of seconds, `true` (as long as is needed, at most `LONGEST_PAUSE`) or `false`.

    Raises:
        BmlError: it is none of these.
    """
    for name, value in own_attributes(element).items():
        if name.rpartition(":")[2] == PAUSE:
            word = value.strip().lower()
            if word in ("true", "false"):
                return LONGEST_PAUSE if word == "true" else 0.0
            seconds = read_finite(word, name, element.place, reading)
            if seconds < 0.0:
                raise reading.refuse(element.place, f"{name}='{value}' is negative", "write true, false or seconds")
            return seconds
    return None


def _recording(description: Element, named: BehaviourElement, reading: DocumentReading) -> Recording | None:
    name = _file(description)
    if not name:
        what = f"the description in line {description.place.line} names no file: it is passed over"
        reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
        return None
    if reading.source.startswith("<"):
        what = f"the recording '{name}' is not played: a document that is no file has no folder to find it in"
        reading.note(NoticeType.CANNOT_CREATE_BEHAVIOR, what, behaviour=named.id)
        return None
    marks = tuple(
        (mark, read_finite(child.attributes["time"].strip(), "time", child.place, reading))
        for child in description.children
        if child.local in _TIMED and "time" in child.attributes
        if (mark := (child.attributes.get("id") or child.attributes.get("name") or "").strip())
    )
    return Recording(Path(reading.source).parent / name, marks)


def _file(description: Element) -> str:
    for element in (description, *description.children):
        for name in _NAMES:
            if element.local not in _TIMED and element.attributes.get(name, "").strip():
                return element.attributes[name].strip()
    named = next((child.text.strip() for child in description.children if child.local == "reference"), "")
    return named or description.text.strip()
