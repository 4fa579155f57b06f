"""How near to its word the hand is fastest and a nod ends, in texts that tie strokes to words."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from statistics import median

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.rows import PERCENTILES, written
from kinesic.bml.timing.syllables import find_syllables
from kinesic.body.config import CONFIGS
from kinesic.controller.perform import plan, set_up
from kinesic.controller.synchrony import StrokeLag, median_lag, planned_lags
from kinesic.expressivity.style.style import Style

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="tour">{}</bml>'
STORY_STYLES: Mapping[str, str] = {"neutral": "", "calm": "_calm", "joyful": "_joyful"}  # and endings of their figures
NODDED = "Well done, my friends, this is a wonderful afternoon, and everybody came to see our beautiful garden tonight."
NODS, NOD = (1, 3, 7, 8, 10, 15, 16), 0.4  # words on which somebody nods, and how much
LARGEST = 0.1  # [s] by which hands may be off in the median: people's lead the accent a little (Pouw and Dixon 2019)
PASSAGE = (  # words, and the gesture whose stroke falls on the word after them
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


def synchrony_figures(part: str) -> list[Figure]:
    """Measures the passage in the neutral manner, a story that nobody wrote for it in three, and nods.

    Args:
        part: what the names of the figures begin with.
    """
    nods = [*nod_lags().values()]
    return [
        _lag_figure(f"{part}.word_lag", passage_lags(), LARGEST),
        *(
            _lag_figure(f"{part}.word_lag_story{ending}", story_lags(style), None if ending else LARGEST)
            for style, ending in STORY_STYLES.items()
        ),
        Figure(f"{part}.nod_lag", median(map(abs, nods)), "s", LARGEST, "lower", f"later: {_spread(nods)}"),
    ]


@cache
def passage_lags() -> tuple[StrokeLag, ...]:
    """Plans the passage once in a process."""
    return planned_lags(plan(passage(), set_up()))


@cache
def story_lags(style: str) -> tuple[StrokeLag, ...]:
    """Plans the story that comes with kinesic, once in a process."""
    known = replace(set_up(), style=Style.load(style))
    return planned_lags(plan((CONFIGS / "bml" / "story.bml").read_text(encoding="utf-8"), known))


@cache
def nod_lags() -> Mapping[str, float]:
    """Finds how much later than the accented syllable each of some nods ends [s], by id; negative where sooner."""
    planned = plan(nods(), set_up())
    times = {(sync.behaviour, sync.sync): sync.planned for sync in planned.syncs}
    syllables = find_syllables(planned.timeline.block, planned.utterances)
    return {id: times[id, "strokeEnd"] - times[id, sync] - left for (id, sync), left in syllables.items()}


def nods() -> str:
    """Writes nods on words as BML."""
    words = " ".join(f'<sync id="w{k}"/>{word}' for k, word in enumerate(NODDED.split()))
    heads = "".join(f'<head id="n{k}" lexeme="NOD" amount="{NOD}" stroke="s:w{k}"/>' for k in NODS)
    return ROOT.format(f'<speech id="s" start="1.5"><text>{words}</text></speech>{heads}')


def passage() -> str:
    """Writes the passage as BML."""
    words = "".join(f'{said} <sync id="w{k}"/>' for k, (said, _) in enumerate(PASSAGE))
    gestures = "".join(
        f'<gesture id="{lexeme}" lexeme="{lexeme}" stroke="s:w{k}"/>' for k, (_, lexeme) in enumerate(PASSAGE) if lexeme
    )
    return ROOT.format(f'<speech id="s" start="1.5"><text>{words}</text></speech>{gestures}')


def _lag_figure(name: str, lags: Sequence[StrokeLag], goal: float | None) -> Figure:
    return Figure(name, median_lag(lags), "s", goal, "lower", f"later: {_spread([each.lag for each in lags])}")


def _spread(found: Sequence[float]) -> str:
    return f"{written(np.percentile(found, PERCENTILES).tolist())} (n {len(found)})"
