"""Measures how the hands move in gestures of the lexicon and of people, and how far these are apart."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from kinesic.bench.blocks import corpus_folder
from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE, every
from kinesic.bench.figure import Figure
from kinesic.bench.naturalness import plots
from kinesic.bench.naturalness.bars import MEDIANS, PART, bar_figures
from kinesic.bench.naturalness.body import body_figures
from kinesic.bench.naturalness.captured import captured_figures, measure_clips
from kinesic.bench.naturalness.legibility import legibility_figures, shoulder_figure
from kinesic.bench.naturalness.lexicon import MeasuredGesture, by_style, measure_lexicon, measure_varied
from kinesic.bench.naturalness.rows import EFFORT, row_figures
from kinesic.bench.naturalness.story import story_figures
from kinesic.bench.naturalness.synchrony import synchrony_figures
from kinesic.body.config import names_of
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.legibility_table import legibility_table

SEEDS = (1, 2)  # of variation, for which gestures must be legible, too
CAPTURE = "capture"  # the corpus's folder of captured gestures


def bench() -> list[Figure]:
    """Measures every gesture alone in every manner, and the corpus's captured gestures."""
    return [*bench_styles(names_of("style")), *_corpus_figures()]


def bench_styles(styles: Sequence[str]) -> list[Figure]:
    """Measures every gesture alone: all bars in the neutral manner, the rows in others."""
    figures = lexicon_figures(measured(tuple(styles)), Robot.load().arm_length)
    return [*figures, *document_figures(), *varied_figures()] if NEUTRAL_STYLE in styles else figures


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


@cache
def varied() -> Mapping[int, tuple[MeasuredGesture, ...]]:
    """Measures the lexicon as it varies by default, for some seeds; once in a process."""
    return {seed: tuple(measure_varied(seed)) for seed in SEEDS}


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
            found += [*row_figures(PART, hands, MEDIANS), *bar_figures(group, arm)]
            found += body_figures(PART, [(each.gesture, each.category, each.body) for each in group])
            found += category_figures(group)
            found += _legibility(PART, group)
        else:
            found += row_figures(f"{PART}.{style}", hands, {})
    return found


def document_figures() -> list[Figure]:
    """Measures strokes, nods and rests of documents that are spoken."""
    return [*synchrony_figures(PART), *story_figures(PART)]


def varied_figures() -> list[Figure]:
    """Says whether gestures can still be read where they vary as they do by default."""
    found = (_legibility(f"{PART}.varied.{seed}", group) for seed, group in varied().items())
    return [figure for figures in found for figure in figures]


def category_figures(gestures: Sequence[MeasuredGesture]) -> list[Figure]:
    """Gives the medians of effort in each category."""
    found: list[Figure] = []
    for category in sorted({each.category for each in gestures}):
        hands = [each.hand for each in gestures if each.hand and each.category == category]
        found += row_figures(f"{PART}.category.{category}", hands, {}, names=EFFORT)
    return found


def _legibility(part: str, group: Sequence[MeasuredGesture]) -> list[Figure]:
    seen = {each.gesture: each.seen for each in group if each.seen is not None}
    places = {each.gesture: each.place for each in group if each.place is not None}
    lifts = {each.gesture: each.body.shoulders for each in group}
    return [
        *legibility_figures(part, seen, places, legibility_table()),
        shoulder_figure(part, lifts, legibility_table()),
    ]


def _corpus_figures() -> list[Figure]:
    corpus = corpus_folder()
    if corpus is None or not (corpus / CAPTURE).is_dir():
        why = "no captured gestures (KINESIC_CORPUS); --capture names a folder"
        return [Figure("naturalness.captured.clips", None, "clips", None, "higher", why)]
    return bench_clips(corpus / CAPTURE)
