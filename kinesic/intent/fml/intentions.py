"""Reads the intentions of an FML-APML document: what is meant, from when to when, and how much it matters."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinesic.bml.reading.tree import Element
from kinesic.intent.fml.mark_times import MarkTimes
from kinesic.intent.intents import Intent, Moment

UNTYPED = "any"  # type of an intention that names none
IN_SPEECH = ("pitchaccent", "boundary")  # intentions that stand in a speech
IMPORTANCE = 0.5  # where nothing is said
LEAST, USUAL = 0.3, 1.5  # [s] of an intention, and of one that says no end
LATEST_STROKE = 0.6  # [s] behind the start of an intention without an accent
ACCENT = 0.2  # [s] from the start of an accented word to its vowel, about


@dataclass(frozen=True)
class Unreadable:
    """An intention without a time."""

    name: str
    why: str


def read_intentions(
    roots: Sequence[Element], speeches: Sequence[Element], marks: MarkTimes
) -> Iterator[Intent | Unreadable]:
    """Yields every intention of a document.

    The stroke of an intention is on the first pitch accent in it; without one, half way, and soon where it is long.

    Args:
        roots: its <fml> elements.
        speeches: those of its <bml>; accents and boundaries stand in them.
        marks: when their marks come.
    """
    inside = [child for speech in speeches for child in speech.children if child.local in IN_SPEECH]
    found = (_moment(each, "start", marks) for each in inside if each.local == IN_SPEECH[0])
    accents = sorted(filter(None, found), key=_seconds)
    for element in (*(child for root in roots for child in root.children), *inside):
        yield _intention(element, marks, accents)


def _intention(element: Element, marks: MarkTimes, accents: Sequence[Moment]) -> Intent | Unreadable:
    attributes = element.attributes
    name = f"{element.local}-{attributes.get('type', '').strip() or UNTYPED}"
    start = _moment(element, "start", marks)
    if start is None:
        return Unreadable(name, f"its start {attributes.get('start', '')!r} is no time of a speech")
    end = _moment(element, "end", marks) or marks.speech_end(attributes.get("end", ""))
    if end is None or end.seconds - start.seconds < LEAST:
        lasts = USUAL if end is None else LEAST
        end = start.later(lasts)
    after = bisect_left(accents, start.seconds, key=_seconds)
    within = after < len(accents) and accents[after].seconds < end.seconds
    later = ACCENT if within else min(LATEST_STROKE, (end.seconds - start.seconds) / 2)
    onset = accents[after] if within else start
    return Intent(
        name,
        start,
        onset.later(later),
        end,
        _share(attributes.get("importance", ""), IMPORTANCE),
        f"<{element.local}> at {element.place.line}:{element.place.column}",
        target=attributes.get("target", "").strip(),
        strength=_share(attributes.get("intensity", ""), 1.0),
    )


def _seconds(moment: Moment) -> float:
    return moment.seconds


def _moment(element: Element, name: str, marks: MarkTimes) -> Moment | None:
    return marks.moment(element.attributes.get(name, ""))


def _share(written: str, usual: float) -> float:
    """A number from 0 to 1; what is none is taken as is usual."""
    try:
        number = float(written)
    except ValueError:
        return usual
    return min(max(number, 0.0), 1.0) if number == number else usual
