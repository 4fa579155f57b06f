"""Benchmark of the timing errors of strokes, for every style and body.

Short spoken texts are planned and performed on the pessimistic twin. A stroke counts with its whole error: the shift of
the plan and the lag of the servos.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.bench.meaning.stories import STORY_TEXTS
from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.config import names_of
from kinesic.controller.dry_run import dry_run
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.documents import write_text
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import PESSIMISTIC_FACTORS

DOCUMENT_COUNT = 20  # number of texts for each style and body
SENTENCES_PER_DOCUMENT = 4  # number of sentences in each text
SENTENCE_STRIDE = 2  # number of sentences between the starts of successive texts
MAX_MEDIAN_ERROR = 15.0  # [ms] goal for the median stroke error
MAX_P95_ERROR = 60.0  # [ms] goal for the 95th percentile of stroke errors


@dataclass(frozen=True, eq=False)
class StrokeErrors:
    """Stroke errors, lost strokes and largest shift of one style and body."""

    errors: Floats  # (s,) [s] deviation of each stroke's arrival from its requested time
    lost: int  # number of strokes that never arrived
    shift: float  # [s] largest shift of a stroke in the plans


def bench() -> Iterator[Metric]:
    """Measure stroke errors of all styles on all built-in bodies."""
    for robot in names_of("robot"):
        setup = set_up(robot, idle=1.0, variation=1.0)
        for style in names_of("style"):
            yield from style_error_metrics(
                f"plan.styles.{robot}.{style}", measure_style(replace(setup, style=Style.load(style)))
            )


def style_error_metrics(part: str, strokes: StrokeErrors) -> Iterator[Metric]:
    """Yield the stroke metrics of one style on one body.

    Args:
        part: prefix of the metric names.
        strokes: measured ones.
    """
    milliseconds = 1000.0 * strokes.errors
    shift = f"largest shift in the plan: {1000.0 * strokes.shift:.0f} ms"
    median, p95 = (float(np.percentile(milliseconds, percentile)) for percentile in (50, 95))
    yield Metric(f"{part}.stroke_median", median, "ms", MAX_MEDIAN_ERROR, "lower")
    yield Metric(f"{part}.stroke_p95", p95, "ms", MAX_P95_ERROR, "lower", shift)
    yield Metric(f"{part}.stroke_lost", float(strokes.lost), "strokes", None, "lower")


def measure_style(setup: Setup, documents: int = DOCUMENT_COUNT) -> StrokeErrors:
    """Measure stroke errors of benchmark texts that are planned with one setup.

    Args:
        setup: with the style to measure.
        documents: largest number of texts.
    """
    return measure_plans([plan(write_text(text, setup).bml, setup) for text in write_documents()[:documents]])


def write_documents() -> list[str]:
    """Return the stories in overlapping pieces of a few sentences."""
    texts: list[str] = []
    for story in STORY_TEXTS.values():
        sentences = [f"{sentence.rstrip('.')}." for sentence in story.split(". ")]
        starts = range(0, len(sentences) - 1, SENTENCE_STRIDE)
        texts += [" ".join(sentences[k : k + SENTENCES_PER_DOCUMENT]) for k in starts]
    return texts[:DOCUMENT_COUNT]


def measure_plans(plans: Sequence[Plan]) -> StrokeErrors:
    """Perform plans on the pessimistic twin and collect their stroke errors."""
    errors: list[float] = []
    lost, shift = 0, 0.0
    for planned in plans:
        lags = dry_run(planned, twin=PESSIMISTIC_FACTORS, correction=True).lags
        for sync, lag in lags.items():
            if not sync.is_stroke:
                continue
            shift = max(shift, abs(sync.planned - sync.requested))
            if lag is None:
                lost += 1
            else:
                errors.append(abs(sync.planned + lag - sync.requested))
    return StrokeErrors(np.array(errors), lost, shift)
