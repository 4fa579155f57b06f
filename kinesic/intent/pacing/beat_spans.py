"""Time that long beats need between neighbouring strokes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kinesic.intent.behaviour_sets import Choice


@dataclass(frozen=True)
class BeatSpan:
    """Smallest intervals between a beat and the strokes around it."""

    before: float = 0.0  # [s] smallest interval since the last stroke
    after: float = 0.0  # [s] smallest interval until the next stroke


# Times that some beats need before and after their stroke. Other beats fit between any two strokes.
BEAT_SPANS: Mapping[str, BeatSpan] = {
    "beat_alternate": BeatSpan(after=1.0),
    "beat_double": BeatSpan(after=1.5),
    "beat_finger": BeatSpan(after=1.4),
    "beat_low_double": BeatSpan(after=1.5),
    "beat_purse": BeatSpan(after=1.5),
    "beat_roll": BeatSpan(before=1.8),
}
PLAIN_SPAN = BeatSpan()  # intervals to neighbouring strokes that other gestures need: none


def select_fitting(choices: Sequence[Choice], before: float, after: float) -> Sequence[Choice]:
    """Return the gestures that fit between two strokes, all if none fits.

    Args:
        choices: gestures for one word.
        before: time since the last stroke [s].
        after: time until the next stroke [s].
    """
    spans = (BEAT_SPANS.get(choice.lexeme, PLAIN_SPAN) for choice in choices)
    fitting = [
        choice for choice, span in zip(choices, spans, strict=True) if span.before <= before and span.after <= after
    ]
    return fitting or choices
