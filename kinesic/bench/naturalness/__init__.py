"""Benchmark of naturalness: hand motion of the lexicon compared with captured gestures."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from kinesic.bench.blocks import find_corpus
from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE, list_tasks
from kinesic.bench.metric import Metric
from kinesic.bench.naturalness import plots
from kinesic.bench.naturalness.bars import MEDIAN_GOALS, METRIC_PREFIX, bar_metrics
from kinesic.bench.naturalness.body import body_metrics
from kinesic.bench.naturalness.captured import METRIC_PREFIX as CAPTURED_PREFIX
from kinesic.bench.naturalness.captured import captured_metrics, measure_clips
from kinesic.bench.naturalness.legibility import legibility_metrics, shoulder_metric
from kinesic.bench.naturalness.lexicon import MeasuredGesture, group_by_style, measure_lexicon, measure_varied
from kinesic.bench.naturalness.rows import EFFORT_ROWS, row_metrics
from kinesic.bench.naturalness.story import story_metrics
from kinesic.bench.naturalness.synchrony import synchrony_metrics
from kinesic.bench.naturalness.whole_body.clips import UnreadClip, read_clips
from kinesic.bench.naturalness.whole_body.comparison import compare_body, compare_sets
from kinesic.bench.naturalness.whole_body.features import measure_set, measure_sets
from kinesic.bench.naturalness.whole_body.lexicon import list_seeded_gestures, perform_gestures
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.stored import read_captured_sets
from kinesic.body.config import names_of
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.legibility_table import legibility_table

VARIATION_SEEDS = (1, 2)  # random seeds of varied gestures that must remain legible
COMPARED_ROBOTS = ("human", "upper22", "upper36")  # robots whose whole-body motion is compared with people's
CAPTURE_FOLDER = "capture"  # corpus folder of captured gestures


def bench() -> list[Metric]:
    """Measure the lexicon's gestures in every style, and captured gestures."""
    return [*bench_styles(names_of("style")), *people_metrics(COMPARED_ROBOTS), *_corpus_metrics()]


def bench_styles(styles: Sequence[str]) -> list[Metric]:
    """Measure the hand motion of gestures, each planned alone, in given styles.

    The neutral style gets all metrics, other styles only the medians of the hand-motion measures.
    """
    metrics = style_metrics(measured(tuple(styles)), Robot.load().arm_length)
    return [*metrics, *document_metrics(), *varied_metrics()] if NEUTRAL_STYLE in styles else metrics


def bench_clips(folder: Path) -> list[Metric]:
    """Measure the captured gestures below a folder.

    Raises:
        ConfigError: the folder does not exist.
    """
    clips = list(read_clips(folder))
    bodies = measure_sets(clip for clip in clips if isinstance(clip, BodyMotion))
    unread = [f"{clip.name}: {clip.why}" for clip in clips if isinstance(clip, UnreadClip)]
    return [
        *captured_metrics(measure_clips(folder)),
        Metric(f"{CAPTURED_PREFIX}.unread_bodies", float(len(unread)), "clips", None, "lower", "; ".join(unread[:3])),
        *compare_sets(bodies, read_captured_sets()),
    ]


def draw(styles: Sequence[str], folder: Path) -> list[Path]:
    """Plot gesture statistics by style, compared with captured gestures."""
    return plots.draw(measured(tuple(styles)), folder)


@cache
def measured(styles: tuple[str, ...]) -> tuple[MeasuredGesture, ...]:
    """Measure the hand motion of the lexicon's gestures in given styles.

    The result is cached.
    """
    return tuple(measure_lexicon(list_tasks(styles)))


@cache
def varied() -> Mapping[int, tuple[MeasuredGesture, ...]]:
    """Measure the hand motion of the lexicon's gestures for each variation seed.

    The result is cached.
    """
    return {seed: tuple(measure_varied(seed)) for seed in VARIATION_SEEDS}


def style_metrics(gestures: Sequence[MeasuredGesture], arm: float) -> list[Metric]:
    """Return hand-motion metrics of gestures in several styles.

    Args:
        gestures: gestures of the lexicon.
        arm: arm length of the robot from shoulder to wrist [m].
    """
    metrics: list[Metric] = []
    for style, group in group_by_style(gestures).items():
        hands = [gesture.hand for gesture in group if gesture.hand]
        if style == NEUTRAL_STYLE:
            metrics += [*row_metrics(METRIC_PREFIX, hands, MEDIAN_GOALS), *bar_metrics(group, arm)]
            metrics += body_metrics(
                METRIC_PREFIX, [(measured.gesture, measured.category, measured.body) for measured in group]
            )
            metrics += category_metrics(group)
            metrics += _legibility(METRIC_PREFIX, group)
        else:
            metrics += row_metrics(f"{METRIC_PREFIX}.{style}", hands, {})
    return metrics


def document_metrics() -> list[Metric]:
    """Measure stroke and nod timing, and stillness, of spoken documents."""
    return [*synchrony_metrics(METRIC_PREFIX), *story_metrics(METRIC_PREFIX)]


def varied_metrics() -> list[Metric]:
    """Measure whether gestures remain legible with their default variation."""
    groups = (_legibility(f"{METRIC_PREFIX}.varied.{seed}", group) for seed, group in varied().items())
    return [metric for metrics in groups for metric in metrics]


def people_metrics(robots: Sequence[str], every: int = 1) -> list[Metric]:
    """Compare the whole-body gestures of each robot with captured sets.

    Gestures have the default amounts of idle motion and variation.

    Args:
        robots: names of the robots.
        every: 1 for all gestures of the lexicon, 3 for every third one.
    """
    metrics: list[Metric] = []
    for robot in robots:
        ours = measure_set(robot, perform_gestures(robot, list_seeded_gestures(every)))
        metrics += compare_body(ours, read_captured_sets())
    return metrics


def category_metrics(gestures: Sequence[MeasuredGesture]) -> list[Metric]:
    """Return each gesture category's median hand speeds and flow.

    Flow is the speed at strokeStart / largest speed before strokeEnd.
    """
    metrics: list[Metric] = []
    for category in sorted({gesture.category for gesture in gestures}):
        hands = [gesture.hand for gesture in gestures if gesture.hand and gesture.category == category]
        metrics += row_metrics(f"{METRIC_PREFIX}.category.{category}", hands, {}, names=EFFORT_ROWS)
    return metrics


def _legibility(part: str, group: Sequence[MeasuredGesture]) -> list[Metric]:
    seen = {measured.gesture: measured.seen for measured in group if measured.seen is not None}
    places = {measured.gesture: measured.place for measured in group if measured.place is not None}
    lifts = {measured.gesture: measured.body.shoulders for measured in group}
    return [
        *legibility_metrics(part, seen, places, legibility_table()),
        shoulder_metric(part, lifts, legibility_table()),
    ]


def _corpus_metrics() -> list[Metric]:
    corpus = find_corpus()
    if corpus is None or not (corpus / CAPTURE_FOLDER).is_dir():
        why = "no captured gestures (KINESIC_CORPUS); --capture names a folder"
        return [Metric("naturalness.captured.clips", None, "clips", None, "higher", why)]
    return bench_clips(corpus / CAPTURE_FOLDER)
