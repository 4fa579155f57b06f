"""One behaviour whose times hang on nothing else: its free sync points between those that are given.

Rule (Greta's, and facts on BML 1.0): longer than natural lengthens the hold after the stroke; shorter takes the holds
first, then strokes that are done once more, and then shortens all the rest alike.
"""

from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise

from kinesic.bml.timing.points import HOLDS

_GIVING = ("relax", "strokeStart", "end", "ready")  # phases that are lengthened, by the point that ends them


def fit(
    names: Sequence[str], spans: Mapping[str, float], given: Mapping[str, float], repeated: Collection[str] = ()
) -> list[float]:
    """Finds the times of all sync points of a behaviour.

    Args:
        names: sync points in order.
        spans: natural seconds from the previous point to each; 0 where missing.
        given: times that are asked for [s], in order; none: it starts at 0.
        repeated: points that end a stroke done once more.

    Returns:
        A time for each name, never going back.
    """
    natural = [spans.get(name, 0.0) for name in names]
    fixed = [index for index, name in enumerate(names) if name in given]
    if not fixed:
        fixed, given = [0], {names[0]: 0.0}
    times = [given.get(name, 0.0) for name in names]
    for index in range(fixed[0] - 1, -1, -1):
        times[index] = times[index + 1] - natural[index + 1]
    for early, late in pairwise(fixed):
        phases = slice(early + 1, late + 1)
        lengths = _lengths(names[phases], natural[phases], times[late] - times[early], repeated)
        for index in range(early + 1, late):
            times[index] = min(times[index - 1] + lengths[index - early - 1], times[late])
    for index in range(fixed[-1] + 1, len(names)):
        times[index] = times[index - 1] + natural[index]
    return times


def _lengths(names: Sequence[str], natural: Sequence[float], total: float, repeated: Collection[str]) -> list[float]:
    """Seconds of each phase so that they add up to a total."""
    spare = total - sum(natural)
    if spare >= 0.0:
        gives = next((name for name in _GIVING if name in names), names[-1])
        return [span + spare * (name == gives) for name, span in zip(names, natural, strict=True)]
    ranks = [2 if name in HOLDS else 1 if name in repeated else 0 for name in names]
    factors, left = [], total
    for rank in range(3):
        wanted = sum(span for span, own in zip(natural, ranks, strict=True) if own == rank)
        factors.append(min(1.0, left / wanted) if wanted else 0.0)
        left = max(0.0, left - wanted)
    return [span * factors[rank] for span, rank in zip(natural, ranks, strict=True)]
