"""Measures how the hands move in gestures of the lexicon and of people, and how far these are apart."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from kinesic.bench.blocks import corpus_folder
from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE, every
from kinesic.bench.figure import Figure
from kinesic.bench.naturalness import plots
from kinesic.bench.naturalness.bars import MEDIANS, PART, bar_figures
from kinesic.bench.naturalness.body import body_figures
from kinesic.bench.naturalness.captured import captured_figures, measure_clips
from kinesic.bench.naturalness.legibility import legibility_figures
from kinesic.bench.naturalness.legibility_table import legibility_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture, by_style, measure_lexicon
from kinesic.bench.naturalness.rows import EFFORT, row_figures
from kinesic.bench.naturalness.synchrony import synchrony_figures
from kinesic.body.config import names_of
from kinesic.body.robot import Robot

CAPTURE = "capture"  # the corpus's folder of captured gestures


def bench() -> list[Figure]:
    """Measures every gesture alone in every manner, and the corpus's captured gestures."""
    return [*bench_styles(names_of("style")), *_corpus_figures()]


def bench_styles(styles: Sequence[str]) -> list[Figure]:
    """Measures every gesture alone: all bars in the neutral manner, the rows in others."""
    return lexicon_figures(measured(tuple(styles)), Robot.load().arm_length)


def bench_clips(folder: Path) -> list[Figure]:
    """Measures the captured gestures below a folder.

    Raises:
        ConfigError: there is no such folder.
    """
    return captured_figures(measure_clips(folder))


def draw(styles: Sequence[str], folder: Path) -> list[Path]:
    """Draws every row in these manners, and how far the neutral one is from captured gestures."""
    return plots.draw(measured(tuple(styles)), folder)


@cache
def measured(styles: tuple[str, ...]) -> tuple[MeasuredGesture, ...]:
    """Measures the lexicon in some manners; once in a process."""
    return tuple(measure_lexicon(every(styles)))


def lexicon_figures(gestures: Sequence[MeasuredGesture], arm: float) -> list[Figure]:
    """Sums up gestures in several manners.

    Args:
        gestures: of the lexicon.
        arm: [m] of the robot, from shoulder to wrist.
    """
    found: list[Figure] = []
    for style, group in by_style(gestures).items():
        hands = [each.hand for each in group if each.hand]
        if style == NEUTRAL_STYLE:
            found += [*row_figures(PART, hands, MEDIANS), *bar_figures(group, arm), *synchrony_figures(PART)]
            found += body_figures(PART, [(each.gesture, each.category, each.body) for each in group])
            found += category_figures(group)
            seen = {each.gesture: each.seen for each in group if each.seen is not None}
            places = {each.gesture: each.place for each in group if each.place is not None}
            found += legibility_figures(PART, seen, places, legibility_table())
        else:
            found += row_figures(f"{PART}.{style}", hands, {})
    return found


def category_figures(gestures: Sequence[MeasuredGesture]) -> list[Figure]:
    """Gives the medians of effort in each category."""
    found: list[Figure] = []
    for category in sorted({each.category for each in gestures}):
        hands = [each.hand for each in gestures if each.hand and each.category == category]
        found += row_figures(f"{PART}.category.{category}", hands, {}, names=EFFORT)
    return found


def _corpus_figures() -> list[Figure]:
    corpus = corpus_folder()
    if corpus is None or not (corpus / CAPTURE).is_dir():
        why = "no captured gestures (KINESIC_CORPUS); --capture names a folder"
        return [Figure("naturalness.captured.clips", None, "clips", None, "higher", why)]
    return bench_clips(corpus / CAPTURE)
