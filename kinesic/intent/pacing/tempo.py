"""Gesture tempo by style: rate, fraction of beats, length of runs."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from kinesic.expressivity.style.style import Style

RHYTHM_DURATION = 5.0  # [s] shortest text with a gesture tempo, for beats in runs
LIVELINESS_LEVELS = (-0.45, 0.0, 0.45)  # mean of activation, extent and power: restrained, neutral, lively
# [1/min] stroke rates at LIVELINESS_LEVELS; percentiles 5, 50 and 95 of people are 7.7, 24 and 34.
STROKE_RATES = (8.0, 19.5, 29.5)
BEAT_FRACTIONS = (0.3, 0.45, 0.5)  # smallest fraction of beats among gestures at LIVELINESS_LEVELS
PICTURE_SPACINGS = (1.8, 1.3, 1.1)  # [s] smallest spacing of illustrating gestures at LIVELINESS_LEVELS
BEAT_SPACINGS = (1.3, 1.05, 0.95)  # [s] smallest spacing of a beat from other strokes at LIVELINESS_LEVELS
MAX_BEAT_FRACTION = 0.54  # fraction of beats above which the stroke rate is reduced
# [1/min] lower bounds of stroke rates reduced because of MAX_BEAT_FRACTION, at LIVELINESS_LEVELS.
MIN_STROKE_RATES = (8.0, 17.0, 18.0)
RUN_LENGTHS = (2.0, 3.0, 4.0)  # [strokes] most successive strokes without rest, by LIVELINESS_LEVELS
RUN_SPACING = 1.6  # [s] largest spacing of strokes in a run, without returning to rest between
SILENCE_RATIO = 1.7  # longest silence of the hands, in mean intervals between strokes


@dataclass(frozen=True)
class Tempo:
    """Rate of gesture strokes, their smallest spacings and their grouping into runs."""

    rate: float  # [1/min] rate of gesture strokes
    min_rate: float  # [1/min] lowest rate of strokes, in a text with few gestures other than beats
    beat_fraction: float  # 0..1 smallest fraction of beats among gestures
    picture_spacing: float  # [s] smallest spacing of gestures other than beats
    beat_spacing: float  # [s] smallest spacing from a beat to another stroke
    run_length: int  # largest number of strokes of a run

    @property
    def longest_silence(self) -> float:
        """Time without strokes after which a beat is due [s]."""
        return SILENCE_RATIO * 60.0 / self.rate


def limit_beats(tempo: Tempo, pictures: int, seconds: float) -> Tempo:
    """Lower a tempo's stroke rate until beats are at most `MAX_BEAT_FRACTION`.

    The fraction of beats is at most `MAX_BEAT_FRACTION`, but the rate does not fall below `min_rate`.

    Args:
        tempo: of the style.
        pictures: gestures other than beats.
        seconds: duration of the text [s].
    """
    largest = 60.0 * pictures / max(seconds, 1.0) / (1.0 - MAX_BEAT_FRACTION)
    return replace(tempo, rate=min(tempo.rate, max(largest, tempo.min_rate)))


def beat_manner_of(style: Style) -> Mapping[str, float]:
    """Return the expressivity parameters in which beats differ from the style.

    Beats of a lively style are no larger than neutral ones and do not repeat within themselves.
    """
    gesture = style.gesture
    return {name: 0.0 for name in ("spatial", "repetition") if getattr(gesture, name) > 0.0}


def liveliness_of(style: Style) -> float:
    """Return the liveliness of a style from 0 (neutral) to 1."""
    return float(np.clip(_level_of(style) / LIVELINESS_LEVELS[-1], 0.0, 1.0))


def _level_of(style: Style) -> float:
    gesture = style.gesture
    return (gesture.activation + gesture.spatial + gesture.power) / 3.0


def tempo_of(style: Style) -> Tempo:
    """Return a style's gesture tempo, within the range observed in people."""
    level = _level_of(style)

    def at_level(values: tuple[float, float, float]) -> float:
        return float(np.interp(level, LIVELINESS_LEVELS, values))

    return Tempo(
        rate=at_level(STROKE_RATES),
        min_rate=at_level(MIN_STROKE_RATES),
        beat_fraction=at_level(BEAT_FRACTIONS),
        picture_spacing=at_level(PICTURE_SPACINGS),
        beat_spacing=at_level(BEAT_SPACINGS),
        run_length=round(at_level(RUN_LENGTHS)),
    )
