"""How much a text may be accompanied by: gestures for its words, and the least distance between movements."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import Channel

FIRST, PER_WORD = 1.0, 0.065  # gestures that a text begins with, and for each of its words: about 8 in 100 words
LIVELY = 0.5  # share of them that full activation, size and power add
GAPS: Mapping[Channel, float] = {"gesture": 1.3, "head": 0.9, "face": 1.0, "gaze": 1.2, "torso": 2.5}  # [s]
LEAST_CERTAINTY: Mapping[Channel, float] = {"gaze": 0.3}  # certainty below which a channel keeps still


@dataclass(frozen=True)
class MovementBudget:
    """What one text may have."""

    gestures: int
    gaps: Mapping[Channel, float]  # [s] least distance of strokes
    least_certainty: Mapping[Channel, float]


def budget_of(words: int, style: Style) -> MovementBudget:
    """Finds the budget of a text: a lively manner has more gestures, and moves sooner again.

    Args:
        words: of the text.
        style: in which it is performed.
    """
    manner = style.gesture
    lively = (manner.activation + manner.spatial + manner.power) / 3
    factor = 1.0 + LIVELY * lively
    return MovementBudget(
        gestures=max(1, round((FIRST + PER_WORD * words) * factor)) if words else 0,
        gaps={channel: gap / factor if channel == "gesture" else gap for channel, gap in GAPS.items()},
        least_certainty=LEAST_CERTAINTY,
    )
