"""Measures how people move in gestures, and how far the lexicon is from it."""

from collections.abc import Sequence

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE, every
from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.bars import MEDIANS, PART, bar_figures
from kinesic.bench.naturalness.lexicon import MeasuredGesture, measure_lexicon
from kinesic.bench.naturalness.rows import row_figures
from kinesic.body.config import names_of
from kinesic.body.robot import Robot


def bench(styles: Sequence[str] = ()) -> list[Figure]:
    """Measures every gesture alone: the bars in the default manner, and each row in every manner.

    Args:
        styles: those that are measured; all of them without any.
    """
    measured = measure_lexicon(every(styles or names_of("style")))
    return lexicon_figures(measured, Robot.load().arm_length)


def lexicon_figures(measured: Sequence[MeasuredGesture], arm: float) -> list[Figure]:
    """Sums up gestures in several manners.

    Args:
        measured: of the lexicon.
        arm: [m] of the robot, from shoulder to wrist.
    """
    found: list[Figure] = []
    for style in sorted({each.style for each in measured}, key=lambda name: (name != NEUTRAL_STYLE, name)):
        gestures = [each for each in measured if each.style == style]
        hands = [each.hand for each in gestures if each.hand]
        if style == NEUTRAL_STYLE:
            found += [*row_figures(PART, hands, MEDIANS), *bar_figures(gestures, arm)]
        else:
            found += row_figures(f"{PART}.{style}", hands, {})
    return found
