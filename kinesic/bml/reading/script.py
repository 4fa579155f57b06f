"""What a speech says: its text with marks, or a recording, and how long it may wait for the body.

The text is plain, with `sync`, with Greta's `tm`, or SSML. Of SSML, marks, breaks, prosody, emphasis, say-as, sub and
changes of language are passed on to the voice, wherever they stand; other elements are read through.
"""

import re
from bisect import bisect_left
from dataclasses import dataclass, field
from pathlib import Path

from kinesic.bml.block import NoticeType
from kinesic.bml.reading.namespaces import own_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_finite
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import ATTRIBUTES, SPOKEN
from kinesic.body.utterance import Emphasis, Mark, Pause, Recording, Script, Stress

MARKS = frozenset({"sync", "tm", "mark"})
SSML = "application/ssml+xml"
STRENGTHS = {"none": 0.0, "x-weak": 0.05, "weak": 0.1, "medium": 0.25, "strong": 0.5, "x-strong": 1.0}  # [s] of a break
LONGEST_BREAK = 60.0  # [s]
WAV = frozenset({"audio/wav", "audio/x-wav", "audio/wave", "audio/vnd.wave"})
PAUSE = "pause"  # attribute of our namespace
LONGEST_PAUSE = 2.0  # [s] of `kinesic:pause="true"`

_STRESSES: tuple[Stress, ...] = ("prosody", "emphasis", "say-as")  # elements that are passed on as they are
FILES = ("ref", "src", "href", "file")  # attributes that name a recording
_SPEAKERS = frozenset({"lang", "voice", "p", "s"})  # elements that may change the language
_TIME = re.compile(r"\+?(\d++(?:\.\d*+)?|\.\d++)(ms|s)")
_LANGUAGES = {
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


def script_of(named: BehaviourElement, reading: DocumentReading) -> Script:
    """Reads what a <speech> says.

    A description in SSML goes before the text when its priority is not negative, and one that names a recording is
    played in place of a voice; other descriptions are passed over.
    """
    written = _Written(named, reading)
    written.read(spoken_part(named.element))
    if written.unusable:
        what = f"marks without a name of their own are passed over: {', '.join(map(repr, written.unusable))}"
        reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    text = written.text.rstrip() or " ".join(named.word("text").split())
    end = len(text)
    return Script(
        text,
        tuple(Mark(name, min(at, end), written.times.get(name)) for name, at in written.marks.items()),
        _language(named),
        tuple(Pause(min(pause.position, end), pause.duration, pause.after) for pause in written.pauses),
        tuple(Emphasis(e.begin, min(e.end, end), e.element, e.attributes) for e in written.emphases if e.begin < end),
        recording_of(named, reading),
    )


def recording_of(named: BehaviourElement, reading: DocumentReading) -> Recording | None:
    """Finds the recording of a <speech>, or None.

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
    """Reads the longest pause [s] that may be put before a word for the body; None where nothing is said.

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


def spoken_part(speech: Element) -> Element:
    """Finds what is said of a <speech>: a description in SSML, its <text>, or all of it."""
    inside = {child.local: child for child in reversed(speech.children)}
    for child in speech.children:
        is_ssml = child.local == "description" and child.attributes.get("type", "").strip() == SSML
        if is_ssml and not child.attributes.get("priority", "").strip().startswith("-"):
            return child
    return inside.get("text", speech)


@dataclass
class _Written:
    """A text while it is read."""

    named: BehaviourElement
    reading: DocumentReading
    text: str = ""
    marks: dict[str, int] = field(default_factory=dict)
    marked: list[int] = field(default_factory=list)  # where they are, in their order
    times: dict[str, float] = field(default_factory=dict)  # [s] of marks, where the document says them
    unusable: list[str] = field(default_factory=list)
    pauses: list[Pause] = field(default_factory=list)
    emphases: list[Emphasis] = field(default_factory=list)

    def read(self, element: Element) -> None:
        """Adds what an element has inside; behaviours and descriptions in a <speech> are none of its text."""
        for piece in element.content:
            if isinstance(piece, str):
                self._say(piece)
            elif piece.local in MARKS:
                self._mark(piece)
            elif piece.local == "break":
                self._pause(piece)
            elif piece.local == "sub" and "alias" in piece.attributes:
                self._say(piece.attributes["alias"])
            elif element.local != "speech" or piece.local not in ("description", *ATTRIBUTES):
                self._stress(piece)

    def _say(self, piece: str) -> None:
        spaced = re.sub(r"\s+", " ", piece)
        self.text += spaced.lstrip() if not self.text or self.text.endswith(" ") else spaced

    def _mark(self, element: Element) -> None:
        written = (element.attributes.get("id") or element.attributes.get("name") or "").strip()
        name = written.removeprefix(f"{self.named.id}:")  # as MARY's tools write it
        if not name or name in ("start", "end") or name in self.marks:
            self.unusable.append(name)
            return
        self.marks[name] = len(self.text)
        self.marked.append(len(self.text))
        if time := element.attributes.get("time", "").strip():
            self.times[name] = _seconds(time, element, self.reading)

    def _pause(self, element: Element) -> None:
        duration = _duration(element)
        if duration is None:
            known = f"time='0.5s', at most {LONGEST_BREAK:g} s, or strength, one of {', '.join(STRENGTHS)}"
            what = f"<{element.name}> in line {element.place.line} is passed over: it has {known}"
            self.reading.note(NoticeType.PARSING_FAILURE, what, behaviour=self.named.id)
        elif duration > 0.0:
            before = len(self.marked) - bisect_left(self.marked, len(self.text))
            self.pauses.append(Pause(len(self.text), duration, before))

    def _stress(self, element: Element) -> None:
        place, begin = len(self.emphases), len(self.text)
        self.read(element)
        stress = _stress_of(element)
        if stress is not None:
            self.emphases.insert(place, Emphasis(begin, len(self.text), *stress))


def _stress_of(element: Element) -> tuple[Stress, tuple[tuple[str, str], ...]] | None:
    language = element.attributes.get("xml:lang", "").strip()
    for stress in _STRESSES:
        if element.local == stress:
            written = element.attributes
            return stress, tuple((name, written[name]) for name in SPOKEN[stress] if name in written)
    if element.local in _SPEAKERS and language:
        return "voice", (("xml:lang", language),)
    return None


def _duration(element: Element) -> float | None:
    """[s] of a break; None when what it asks for is no duration."""
    time = element.attributes.get("time", "").strip()
    if not time:
        return STRENGTHS.get(element.attributes.get("strength", "medium").strip())
    written = _TIME.fullmatch(time)
    if written is None:
        return None
    seconds = float(written[1]) / (1000.0 if written[2] == "ms" else 1.0)
    return seconds if seconds <= LONGEST_BREAK else None


def _seconds(text: str, element: Element, reading: DocumentReading) -> float:
    """[s] of a mark, as a number or as SSML writes durations."""
    written = _TIME.fullmatch(text)
    if written is None:
        return read_finite(text, "time", element.place, reading)
    return float(written[1]) / (1000.0 if written[2] == "ms" else 1.0)


def _language(named: BehaviourElement) -> str:
    written = (named.attributes.get("language") or named.element.attributes.get("xml:lang") or "en").strip().lower()
    return _LANGUAGES.get(written, written)


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
        (mark, _seconds(child.attributes["time"].strip(), child, reading))
        for child in description.children
        if child.local in MARKS and "time" in child.attributes
        if (mark := (child.attributes.get("id") or child.attributes.get("name") or "").strip())
    )
    folder = Path(reading.source).parent
    return Recording(folder / name, marks, folder)


def _file(description: Element) -> str:
    for element in (description, *description.children):
        for name in FILES:
            if element.local not in MARKS and element.attributes.get(name, "").strip():
                return element.attributes[name].strip()
    named = next((child.text.strip() for child in description.children if child.local == "reference"), "")
    return named or description.text.strip()
