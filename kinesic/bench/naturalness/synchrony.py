"""How near to its word the hand is fastest, in a passage that ties strokes to words."""

from functools import cache

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.rows import PERCENTILES, written
from kinesic.controller.perform import plan, set_up
from kinesic.controller.synchrony import StrokeLag, median_lag, planned_lags

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
    """Measures the passage in the neutral manner.

    Args:
        part: what the names of the figures begin with.
    """
    lags = passage_lags()
    found = np.array([each.lag for each in lags])
    spread = f"later: {written(np.percentile(found, PERCENTILES).tolist())} (n {len(lags)})"
    return [Figure(f"{part}.word_lag", median_lag(lags), "s", LARGEST, "lower", spread)]


@cache
def passage_lags() -> tuple[StrokeLag, ...]:
    """Plans the passage once in a process."""
    return planned_lags(plan(passage(), set_up()))


def passage() -> str:
    """Writes the passage as BML."""
    words = "".join(f'{said} <sync id="w{k}"/>' for k, (said, _) in enumerate(PASSAGE))
    gestures = "".join(
        f'<gesture id="{lexeme}" lexeme="{lexeme}" stroke="s:w{k}"/>' for k, (_, lexeme) in enumerate(PASSAGE) if lexeme
    )
    root = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="tour">{}</bml>'
    return root.format(f'<speech id="s" start="1.5"><text>{words}</text></speech>{gestures}')
