"""Limits on the number of gestures and the spacing of movements."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import Channel
from kinesic.intent.pacing.long_strokes import slowness_of
from kinesic.intent.pacing.memory import REPEAT_WINDOW
from kinesic.intent.pacing.tempo import RHYTHM_DURATION, Tempo, beat_manner_of, tempo_of

BASE_GESTURE_COUNT = 1.0  # gestures allowed in addition to those in proportion to the text's length
MIN_PICTURES = 2  # number of illustrating gestures (not beats) allowed even in a short text
STROKE_SPACINGS: Mapping[Channel, float] = {
    "gesture": 1.3,
    "head": 0.9,
    "face": 1.0,
    "gaze": 1.2,
    "torso": 2.5,
}  # [s] smallest time between strokes, by channel
MIN_CERTAINTIES: Mapping[Channel, float] = {"gaze": 0.3}  # smallest certainty of shown intents, by channel


@dataclass(frozen=True)
class MovementBudget:
    """Limits on a text's movements: number of gestures, spacings, certainty and tempo."""

    gestures: int
    gaps: Mapping[Channel, float]  # [s] smallest spacing of strokes
    least_certainty: Mapping[Channel, float]
    tempo: Tempo | None = None  # rate and spacing of beats on accents; None: beats compete with other gestures
    pictures: int = 0  # largest number of gestures other than beats, if there is a tempo
    beat_manner: Mapping[str, float] = field(default_factory=dict)  # expressivity of beats, -1..1
    preferences: Mapping[str, float] = field(default_factory=dict)  # gesture -> factor on its probability
    repeat_window: float = 0.0  # [s] time without repeated gestures; 0: three successive gestures differ
    slowness: float = 1.0  # factor on the duration of long strokes


def budget_of(seconds: float, style: Style) -> MovementBudget:
    """Return the limits on a text's gestures and movements.

    A lively style has more gestures with shorter intervals.

    Args:
        seconds: estimated duration of its words.
        style: of the performance.
    """
    tempo = tempo_of(style)
    count = max(1, round(BASE_GESTURE_COUNT + tempo.rate * seconds / 60.0)) if seconds > 0.0 else 0
    pictures = max(min(count, MIN_PICTURES), round(count * (1.0 - tempo.beat_fraction)))
    spacing = tempo.picture_spacing
    return MovementBudget(
        gestures=count,
        gaps={channel: spacing if channel == "gesture" else gap for channel, gap in STROKE_SPACINGS.items()},
        least_certainty=MIN_CERTAINTIES,
        tempo=tempo if seconds >= RHYTHM_DURATION else None,
        pictures=pictures,
        beat_manner=beat_manner_of(style),
        preferences=dict(style.prefers),
        repeat_window=REPEAT_WINDOW,
        slowness=slowness_of(style),
    )
