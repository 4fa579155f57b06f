"""Intentions of an FML-APML document, with times and importance."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinesic.bml.reading.tree import Element
from kinesic.intent.fml.mark_times import MarkTimes
from kinesic.intent.intents import Intent, Moment

DEFAULT_TYPE = "any"  # type of an intention whose document gives none
SPEECH_INTENTIONS = ("pitchaccent", "boundary")  # intentions inside a speech
DEFAULT_IMPORTANCE = 0.5  # 0..1 importance of an intention whose document gives none
MIN_DURATION = 0.3  # [s] shortest duration of an intention
DEFAULT_DURATION = 1.5  # [s] duration of an intention without an end
MAX_STROKE_DELAY = 0.6  # [s] longest time from the start of an intention without accent to its stroke
ACCENT_DELAY = 0.2  # [s] approximate time from the start of an accented word to its vowel


@dataclass(frozen=True)
class Unreadable:
    """FML intention without a valid start time."""

    name: str
    reason: str  # element and its place
    why: str


def read_intentions(
    roots: Sequence[Element], speeches: Sequence[Element], marks: MarkTimes
) -> Iterator[Intent | Unreadable]:
    """Yield an intent, or `Unreadable`, for each intention of an FML document.

    The stroke of an intention is on its first pitch accent. Without one it is half way, but soon after the start of a
    long intention.

    Args:
        roots: its <fml> elements.
        speeches: those of its <bml>, which contain accents and boundaries.
        marks: estimated times of their marks.
    """
    speech_intentions = [child for speech in speeches for child in speech.children if child.local in SPEECH_INTENTIONS]
    accent_moments = (
        _moment(accent, "start", marks) for accent in speech_intentions if accent.local == SPEECH_INTENTIONS[0]
    )
    accents = sorted(filter(None, accent_moments), key=_seconds)
    for element in (*(child for root in roots for child in root.children), *speech_intentions):
        yield _intention(element, marks, accents)


def _intention(element: Element, marks: MarkTimes, accents: Sequence[Moment]) -> Intent | Unreadable:
    attributes = element.attributes
    name = f"{element.local}-{attributes.get('type', '').strip() or DEFAULT_TYPE}"
    start = _moment(element, "start", marks)
    if start is None:
        why = f"its start {attributes.get('start', '')!r} is not a time of a speech"
        return Unreadable(name, describe_intention(element), why)
    end = _moment(element, "end", marks) or marks.speech_end(attributes.get("end", ""))
    if end is None or end.seconds - start.seconds < MIN_DURATION:
        duration = DEFAULT_DURATION if end is None else MIN_DURATION
        end = start.later(duration)
    after = bisect_left(accents, start.seconds, key=_seconds)
    has_accent = after < len(accents) and accents[after].seconds < end.seconds
    delay = ACCENT_DELAY if has_accent else min(MAX_STROKE_DELAY, (end.seconds - start.seconds) / 2)
    onset = accents[after] if has_accent else start
    return Intent(
        name,
        start,
        onset.later(delay),
        end,
        _parse_fraction(attributes.get("importance", ""), DEFAULT_IMPORTANCE),
        describe_intention(element),
        target=attributes.get("target", "").strip(),
        strength=_parse_fraction(attributes.get("intensity", ""), 1.0),
    )


def describe_intention(element: Element) -> str:
    """Return name and place of an intention, for messages about its behaviours."""
    return f"<{element.local}> at {element.place.line}:{element.place.column}"


def _seconds(moment: Moment) -> float:
    return moment.seconds


def _moment(element: Element, name: str, marks: MarkTimes) -> Moment | None:
    return marks.moment(element.attributes.get(name, ""))


def _parse_fraction(written: str, default: float) -> float:
    """Parse a number clipped to 0..1, or return the default."""
    try:
        number = float(written)
    except ValueError:
        return default
    return min(max(number, 0.0), 1.0) if number == number else default
