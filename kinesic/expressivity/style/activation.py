"""Overall activation: how much movement there is, as a change of the parameters that make movement."""

from collections.abc import Mapping
from dataclasses import replace

from kinesic.expressivity.style.style import RANGES, Expressivity

# How far full activation goes from a parameter's value to the end of its range. An animated speaker moves wider,
# faster, with more force and away from the body; how a movement flows and how often it is repeated stay his own.
SHARES: Mapping[str, float] = {"spatial": 0.7, "temporal": 0.9, "power": 0.9, "openness": 0.3}


def activated(manner: Expressivity) -> Expressivity:
    """Folds activation into the parameters that it raises or lowers, and leaves it 0.

    Each goes its share of the way to its upper end for an activation of 1, to its lower end for -1, in proportion
    between. It is monotone, stays inside the ranges, and is the identity at 0.

    Args:
        manner: as told.
    """
    changes = {name: _towards(getattr(manner, name), name, manner.activation * share) for name, share in SHARES.items()}
    return replace(manner, activation=0.0, **changes)


def _towards(value: float, name: str, share: float) -> float:
    """A share of the way to the upper end of a parameter's range; below 0 to the lower end."""
    least, most = RANGES[name]
    return value + share * (most - value) if share > 0 else value - share * (least - value)
