"""Word times of ELAN's annotation files (EAF)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np

from kinesic.speech.timings.phone_symbols import SILENCE_LABELS, to_phonetic
from kinesic.speech.timings.textgrid import PHONE_TIERS, WORD_TIERS
from kinesic.speech.timings.timed_words import (
    MAX_SPANS,
    RawSpan,
    TimedSpan,
    TimedWords,
    TimingError,
    check_spans,
    check_time,
    make_phonemes,
    shorten,
)

TIME_UNITS_PER_SECOND = 1000.0  # [1/s] units of ELAN's time slots
MAX_TEXT_LENGTH = 10_000  # [characters] longest text of an annotation


@dataclass
class _Annotation:
    first: str  # id of the time slot at the annotation's start
    last: str  # id of the time slot at the annotation's end
    text: str = ""


@dataclass
class _Reader:
    """Reader that collects time slots and tiers of annotations."""

    slots: dict[str, float | None] = field(default_factory=dict)  # slot id -> time [ms]; None: slot without a time
    tiers: dict[str, list[_Annotation]] = field(default_factory=dict)
    tier: str = ""
    count: int = 0
    is_value: bool = False

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        """Read the start of an XML element."""
        self.count += 1
        if self.count > 20 * MAX_SPANS:
            raise TimingError(f"more than {20 * MAX_SPANS} XML elements")
        if name == "TIME_SLOT":
            value = attributes.get("TIME_VALUE")
            slot = attributes.get("TIME_SLOT_ID", "")
            self.slots[slot] = None if value is None else _read_slot(value, slot)
        elif name == "TIER":
            self.tier = attributes.get("TIER_ID", "")
        elif name == "ALIGNABLE_ANNOTATION":
            slots = attributes.get("TIME_SLOT_REF1", ""), attributes.get("TIME_SLOT_REF2", "")
            self.tiers.setdefault(self.tier, []).append(_Annotation(*slots))
        elif name == "REF_ANNOTATION":
            self.tier = ""  # a tier without times of its own
        self.is_value = name == "ANNOTATION_VALUE" and bool(self.tiers.get(self.tier))

    def end(self, _: str) -> None:
        """Read the end of an XML element."""
        self.is_value = False

    def add_text(self, text: str) -> None:
        """Add text to the last annotation."""
        if self.is_value:
            annotation = self.tiers[self.tier][-1]
            annotation.text = (annotation.text + text)[:MAX_TEXT_LENGTH]


def read_elan(content: bytes) -> TimedWords:
    """Read the words and phonemes of an ELAN file.

    The tiers are chosen as those of a TextGrid. Annotations without times divide the time around them equally.

    Raises:
        TimingError: the XML is cut off or declares entities, or a value is invalid.
    """
    reader = _Reader()
    _parse(content, reader)
    times = _fill_slots(reader.slots)
    phones = _choose_tier(reader, PHONE_TIERS)
    words = _choose_tier(reader, WORD_TIERS) or next(
        (name for name, rows in reader.tiers.items() if name != phones and any(row.text.strip() for row in rows)), ""
    )
    if not words and not phones:
        raise TimingError("no tier has annotations with times")
    sounds = _list_spans(reader, phones, times)
    return TimedWords(
        _list_spans(reader, words, times),
        make_phonemes(TimedSpan(to_phonetic(s.text), s.start, s.end) for s in sounds),
        "ELAN file",
    )


def _parse(content: bytes, reader: _Reader) -> None:
    def refuse(*_: object) -> None:
        raise TimingError("the XML has a document type; files of ELAN have none")

    parser = expat.ParserCreate()
    parser.StartElementHandler = reader.begin
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.add_text
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise TimingError(f"line {error.lineno}: the XML is damaged: {expat.ErrorString(error.code)}") from None


def _read_slot(value: str, slot: str) -> float:
    try:
        time = float(value)
    except ValueError:
        raise TimingError(f"time slot {shorten(slot)} is {shorten(value)}; it must be a number") from None
    check_time(time, f"time slot {shorten(slot)}", per_second=TIME_UNITS_PER_SECOND)
    return time


def _fill_slots(slots: dict[str, float | None]) -> dict[str, float]:
    """Return the times [ms] of all slots, interpolated where missing."""
    known = [k for k, time in enumerate(slots.values()) if time is not None]
    if not known:
        raise TimingError("no time slot has a time")
    times = [time for time in slots.values() if time is not None]
    filled = np.interp(np.arange(len(slots)), known, times).tolist()
    return dict(zip(slots, filled, strict=True))


def _choose_tier(reader: _Reader, names: Sequence[str]) -> str:
    return next((tier for tier in reader.tiers if tier and tier.lower().rpartition("@")[0] in names), "") or next(
        (tier for tier in reader.tiers if tier and tier.lower() in names), ""
    )


def _list_spans(reader: _Reader, tier: str, times: dict[str, float]) -> tuple[TimedSpan, ...]:
    rows: list[RawSpan] = []
    for k, annotation in enumerate(reader.tiers.get(tier, []), 1):
        place = f"tier {shorten(tier)} annotation {k}"
        for slot in (annotation.first, annotation.last):
            if slot not in times:
                raise TimingError(f"{place} refers to time slot {shorten(slot)}, which is missing")
        text = "" if annotation.text.strip().lower() in SILENCE_LABELS else annotation.text
        rows.append(RawSpan(place, text, times[annotation.first], times[annotation.last]))
    return check_spans(sorted(rows, key=lambda row: row.start), per_second=TIME_UNITS_PER_SECOND)
