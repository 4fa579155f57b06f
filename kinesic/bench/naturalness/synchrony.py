"""Benchmark of timing between gestures or nods and their words."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from statistics import median

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness.rows import ROW_PERCENTILES, format_percentiles
from kinesic.bml.timing.syllables import find_syllables
from kinesic.body.config import CONFIGS
from kinesic.expressivity.style.style import Style
from kinesic.metrics.synchrony import StrokeLag, compute_median_lag, measure_planned_lags
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="tour">{}</bml>'
STORY_STYLES: Mapping[str, str] = {
    "neutral": "",
    "calm": "_calm",
    "joyful": "_joyful",
}  # style -> suffix of its metric names
NODDED_TEXT = (
    "Well done, my friends, this is a wonderful afternoon, and everybody came to see our beautiful garden tonight."
)
NODDED_WORDS = (1, 3, 7, 8, 10, 15, 16)  # indices of words with a nod
NOD_AMOUNT = 0.4  # amount of each nod, 0..1
MAX_LAG = 0.1  # [s] goal for the median stroke lag; human hands precede the accent slightly (Pouw and Dixon 2019)
PASSAGE_PARTS = (  # words, and the gesture whose stroke coincides with the next word
    ("Well, good afternoon to all of you, and", "inform_raise"),
    ("welcome to this house. If you will all follow me please, it is", "straight_ahead"),
    ("straight ahead, past the doors. The hall that you see there is really", "large"),
    ("large, and once upon a time the whole of it was completely", "cut_off"),
    ("closed to people from the town, until somebody at last had", "beat_edge"),
    ("enough of that and said so; and then the builders came to", "take_out"),
    ("remove the walls, which were old, and the roof, and all of it had to", "rise"),
    ("rise again, stone by stone, as one must, and some said it would", "crush"),
    ("fall on us. Now look at it, and tell your friends that they should", "come_all"),
    ("come as well, for I have to say that this is what", "beat"),
    ("matters to me more than whatever else we may", "offer"),
    ("offer you today; so have a pleasant time with us all.", ""),
)


def synchrony_metrics(part: str) -> list[Metric]:
    """Measure delays of gesture strokes and nods relative to speech.

    Args:
        part: prefix of the metric names.
    """
    write_nods = [*nod_lags().values()]
    return [
        _lag_metric(f"{part}.word_lag", passage_lags(), MAX_LAG),
        *(
            _lag_metric(f"{part}.word_lag_story{ending}", story_lags(style), None if ending else MAX_LAG)
            for style, ending in STORY_STYLES.items()
        ),
        Metric(f"{part}.nod_lag", median(map(abs, write_nods)), "s", MAX_LAG, "lower", f"later: {_spread(write_nods)}"),
    ]


@cache
def passage_lags() -> tuple[StrokeLag, ...]:
    """Plan the passage and return its stroke delays relative to words.

    The result is cached.
    """
    return measure_planned_lags(plan(write_spoken_passage(), set_up()))


@cache
def story_lags(style: str) -> tuple[StrokeLag, ...]:
    """Plan the supplied story in a style and return its stroke delays.

    The result is cached.
    """
    setup = replace(set_up(), style=Style.load(style))
    return measure_planned_lags(plan((CONFIGS / "bml" / "story.bml").read_text(encoding="utf-8"), setup))


@cache
def nod_lags() -> Mapping[str, float]:
    """Return each nod's delay [s] after its stressed syllable, by id."""
    planned = plan(write_nods(), set_up())
    times = {(sync.behaviour, sync.sync): sync.planned for sync in planned.syncs}
    syllables = find_syllables(planned.timeline.block, planned.utterances)
    return {id: times[id, "strokeEnd"] - times[id, sync] - remaining for (id, sync), remaining in syllables.items()}


def write_nods() -> str:
    """Return BML of a spoken text with nods on `NODDED_WORDS`."""
    words = " ".join(f'<sync id="w{k}"/>{word}' for k, word in enumerate(NODDED_TEXT.split()))
    heads = "".join(f'<head id="n{k}" lexeme="NOD" amount="{NOD_AMOUNT}" stroke="s:w{k}"/>' for k in NODDED_WORDS)
    return BLOCK_TEMPLATE.format(f'<speech id="s" start="1.5"><text>{words}</text></speech>{heads}')


def write_spoken_passage() -> str:
    """Write the spoken passage with its gestures as BML."""
    spoken = "".join(f'{words} <sync id="w{k}"/>' for k, (words, _) in enumerate(PASSAGE_PARTS))
    gestures = "".join(
        f'<gesture id="{lexeme}" lexeme="{lexeme}" stroke="s:w{k}"/>'
        for k, (_, lexeme) in enumerate(PASSAGE_PARTS)
        if lexeme
    )
    return BLOCK_TEMPLATE.format(f'<speech id="s" start="1.5"><text>{spoken}</text></speech>{gestures}')


def _lag_metric(name: str, lags: Sequence[StrokeLag], goal: float | None) -> Metric:
    return Metric(name, compute_median_lag(lags), "s", goal, "lower", f"later: {_spread([lag.lag for lag in lags])}")


def _spread(lags: Sequence[float]) -> str:
    return f"{format_percentiles(np.percentile(lags, ROW_PERCENTILES).tolist())} (n {len(lags)})"
