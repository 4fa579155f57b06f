"""Parser of `<speech>`: text with marks, recordings and maximum pauses.

The text is plain, with `sync` elements, with Greta's `tm`, or SSML. The SSML elements mark, break, prosody, emphasis,
say-as, sub and language changes are passed to the voice at any depth; only the text of other elements is kept.
"""

import re
from bisect import bisect_left
from dataclasses import dataclass, field
from pathlib import Path

from kinesic.bml.block import NoticeType
from kinesic.bml.reading.namespaces import select_kinesic_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_finite
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import BEHAVIOUR_ATTRIBUTES, SPEECH_ATTRIBUTES
from kinesic.body.utterance import Emphasis, Mark, Pause, Recording, Script, Stress

MARK_ELEMENTS = frozenset({"sync", "tm", "mark"})  # elements that mark a position in a speech
SSML_TYPE = "application/ssml+xml"  # media type of SSML descriptions
BREAK_DURATIONS = {
    "none": 0.0,
    "x-weak": 0.05,
    "weak": 0.1,
    "medium": 0.25,
    "strong": 0.5,
    "x-strong": 1.0,
}  # [s] duration of a break by its SSML strength
MAX_BREAK_DURATION = 60.0  # [s] longest accepted break in a speech; a longer break is invalid
WAV_TYPES = frozenset({"audio/wav", "audio/x-wav", "audio/wave", "audio/vnd.wave"})  # media types of recordings
PAUSE_ATTRIBUTE = "pause"  # kinesic attribute: maximum pause before a word ([s], true or false)
MAX_AUTOMATIC_PAUSE = 2.0  # [s] longest pause for `kinesic:pause="true"`

_PASSED_ELEMENTS: tuple[Stress, ...] = ("prosody", "emphasis", "say-as")  # elements passed to the voice unchanged
FILE_ATTRIBUTES = ("ref", "src", "href", "file")  # attributes that name a recording
WORDS_ATTRIBUTE = "words"  # attribute that names the file with the times of a recording's words
_LANGUAGE_ELEMENTS = frozenset({"lang", "voice", "p", "s"})  # elements with an optional language
_DURATION_PATTERN = re.compile(r"\+?(\d++(?:\.\d*+)?|\.\d++)(ms|s)")  # SSML duration, as in `250ms`
_LANGUAGE_CODES = {  # language name -> language code
    "arabic": "ar",
    "chinese": "zh",
    "dutch": "nl",
    "english": "en",
    "french": "fr",
    "german": "de",
    "greek": "el",
    "hindi": "hi",
    "italian": "it",
    "japanese": "ja",
    "korean": "ko",
    "polish": "pl",
    "portuguese": "pt",
    "russian": "ru",
    "spanish": "es",
    "swedish": "sv",
    "turkish": "tr",
}


def read_script(node: BehaviourElement, reading: DocumentReading) -> Script:
    """Read the script of a <speech>.

    An SSML description replaces the text unless its priority is negative, and a description that names a recording
    replaces the voice; other descriptions are ignored.
    """
    reader = _TextReader(node, reading)
    reader.read(find_spoken_element(node.element))
    if reader.unusable:
        problem = f"marks without a unique name are ignored: {', '.join(map(repr, reader.unusable))}"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=node.id)
    text = reader.text.rstrip() or " ".join(node.attribute("text").split())
    end = len(text)
    return Script(
        text,
        tuple(Mark(name, min(at, end), reader.times.get(name)) for name, at in reader.marks.items()),
        _read_language(node),
        tuple(Pause(min(pause.position, end), pause.duration, pause.after) for pause in reader.pauses),
        tuple(Emphasis(e.begin, min(e.end, end), e.element, e.attributes) for e in reader.emphases if e.begin < end),
        read_recording(node, reading),
    )


def read_recording(node: BehaviourElement, reading: DocumentReading) -> Recording | None:
    """Return the recording of a <speech>, or None.

    The file name is the description's text, a <reference> in it, or an attribute `ref`, `src`, `href` or `file` of the
    description or of an element in it; it is relative to the folder of the document. The attribute `words` beside it
    names a file with the times of words. A description with a negative priority is ignored.

    Raises:
        BmlError: the time of a mark is not a number.
    """
    for child in node.element.children:
        is_wav = child.local == "description" and child.attributes.get("type", "").strip().lower() in WAV_TYPES
        if is_wav and not child.attributes.get("priority", "").strip().startswith("-"):
            return _read_recording_description(child, node, reading)
    return None


def read_pause(element: Element, reading: DocumentReading) -> float | None:
    """Return the maximum pause [s] before words that wait for gestures.

    `kinesic:pause` is a number of seconds, `true` (as long as needed, at most `MAX_AUTOMATIC_PAUSE`) or `false`. The
    result is None without this attribute.

    Raises:
        BmlError: any other value.
    """
    for name, value in select_kinesic_attributes(element).items():
        if name.rpartition(":")[2] == PAUSE_ATTRIBUTE:
            word = value.strip().lower()
            if word in ("true", "false"):
                return MAX_AUTOMATIC_PAUSE if word == "true" else 0.0
            seconds = read_finite(word, name, element.place, reading)
            if seconds < 0.0:
                raise reading.error(element.place, f"{name}='{value}' is negative", "write true, false or seconds")
            return seconds
    return None


def find_spoken_element(speech: Element) -> Element:
    """Return the element with the spoken text: SSML description, <text> or <speech>."""
    inside = {child.local: child for child in reversed(speech.children)}
    for child in speech.children:
        is_ssml = child.local == "description" and child.attributes.get("type", "").strip() == SSML_TYPE
        if is_ssml and not child.attributes.get("priority", "").strip().startswith("-"):
            return child
    return inside.get("text", speech)


@dataclass
class _TextReader:
    """Reader that collects the text, marks and pauses of a speech."""

    node: BehaviourElement
    reading: DocumentReading
    text: str = ""
    marks: dict[str, int] = field(default_factory=dict)
    marked: list[int] = field(default_factory=list)  # sorted text positions of the marks
    times: dict[str, float] = field(default_factory=dict)  # [s] time of each mark with a time in the document
    unusable: list[str] = field(default_factory=list)  # names of marks without a unique name
    pauses: list[Pause] = field(default_factory=list)
    emphases: list[Emphasis] = field(default_factory=list)

    def read(self, element: Element) -> None:
        """Add an element's content, without behaviours and descriptions in a <speech>."""
        for piece in element.content:
            if isinstance(piece, str):
                self._say(piece)
            elif piece.local in MARK_ELEMENTS:
                self._mark(piece)
            elif piece.local == "break":
                self._pause(piece)
            elif piece.local == "sub" and "alias" in piece.attributes:
                self._say(piece.attributes["alias"])
            elif element.local != "speech" or piece.local not in ("description", *BEHAVIOUR_ATTRIBUTES):
                self._stress(piece)

    def _say(self, piece: str) -> None:
        spaced = re.sub(r"\s+", " ", piece)
        self.text += spaced.lstrip() if not self.text or self.text.endswith(" ") else spaced

    def _mark(self, element: Element) -> None:
        text = (element.attributes.get("id") or element.attributes.get("name") or "").strip()
        name = text.removeprefix(f"{self.node.id}:")  # prefix written by MARY's tools
        if not name or name in ("start", "end") or name in self.marks:
            self.unusable.append(name)
            return
        self.marks[name] = len(self.text)
        self.marked.append(len(self.text))
        if time := element.attributes.get("time", "").strip():
            self.times[name] = _read_time(time, element, self.reading)

    def _pause(self, element: Element) -> None:
        duration = _read_duration(element)
        if duration is None:
            choices = f"time='0.5s', at most {MAX_BREAK_DURATION:g} s, or strength, one of {', '.join(BREAK_DURATIONS)}"
            problem = f"<{element.name}> in line {element.place.line} is ignored: write {choices}"
            self.reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=self.node.id)
        elif duration > 0.0:
            before = len(self.marked) - bisect_left(self.marked, len(self.text))
            self.pauses.append(Pause(len(self.text), duration, before))

    def _stress(self, element: Element) -> None:
        place, begin = len(self.emphases), len(self.text)
        self.read(element)
        stress = _read_stress(element)
        if stress is not None:
            self.emphases.insert(place, Emphasis(begin, len(self.text), *stress))


def _read_stress(element: Element) -> tuple[Stress, tuple[tuple[str, str], ...]] | None:
    language = element.attributes.get("xml:lang", "").strip()
    for stress in _PASSED_ELEMENTS:
        if element.local == stress:
            attributes = element.attributes
            return stress, tuple((name, attributes[name]) for name in SPEECH_ATTRIBUTES[stress] if name in attributes)
    if element.local in _LANGUAGE_ELEMENTS and language:
        return "voice", (("xml:lang", language),)
    return None


def _read_duration(element: Element) -> float | None:
    """Return the duration of a break [s], or None if invalid."""
    time = element.attributes.get("time", "").strip()
    if not time:
        return BREAK_DURATIONS.get(element.attributes.get("strength", "medium").strip())
    duration = _DURATION_PATTERN.fullmatch(time)
    if duration is None:
        return None
    seconds = float(duration[1]) / (1000.0 if duration[2] == "ms" else 1.0)
    return seconds if seconds <= MAX_BREAK_DURATION else None


def _read_time(text: str, element: Element, reading: DocumentReading) -> float:
    """Return a mark's time [s], given as number or SSML duration."""
    duration = _DURATION_PATTERN.fullmatch(text)
    if duration is None:
        return read_finite(text, "time", element.place, reading)
    return float(duration[1]) / (1000.0 if duration[2] == "ms" else 1.0)


def _read_language(node: BehaviourElement) -> str:
    language = (node.attributes.get("language") or node.element.attributes.get("xml:lang") or "en").strip().lower()
    return _LANGUAGE_CODES.get(language, language)


def _read_recording_description(
    description: Element, node: BehaviourElement, reading: DocumentReading
) -> Recording | None:
    name = _find_file_name(description)
    if not name:
        problem = f"the description in line {description.place.line} names no file and is ignored"
        reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=node.id)
        return None
    folder = reading.recordings if reading.source.startswith("<") else Path(reading.source).parent
    if folder is None:
        problem = f"the recording '{name}' is not played: the document is not a file, so it has no folder"
        reading.add_notice(NoticeType.CANNOT_CREATE_BEHAVIOR, problem, behaviour=node.id)
        return None
    marks = tuple(
        (mark, _read_time(child.attributes["time"].strip(), child, reading))
        for child in description.children
        if child.local in MARK_ELEMENTS and "time" in child.attributes
        if (mark := (child.attributes.get("id") or child.attributes.get("name") or "").strip())
    )
    words = _find_words_file(description)
    return Recording(folder / name, marks, folder, folder / words if words else None)


def _find_words_file(description: Element) -> str:
    """Return the name of the word-time file, or an empty text."""
    for element in (description, *description.children):
        for name, value in element.attributes.items():
            if name.rpartition(":")[2] == WORDS_ATTRIBUTE and value.strip():
                return value.strip()
    return ""


def _find_file_name(description: Element) -> str:
    for element in (description, *description.children):
        for name in FILE_ATTRIBUTES:
            if element.local not in MARK_ELEMENTS and element.attributes.get(name, "").strip():
                return element.attributes[name].strip()
    node = next((child.text.strip() for child in description.children if child.local == "reference"), "")
    return node or description.text.strip()
