"""How the keys of a motion are passed, and how the way to them is moved (thesis 8.7, Sequential Variation)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from kinesic.expressivity.style.style import Expressivity
from kinesic.motion.easing import Easing

Phase = Literal["preparation", "stroke", "hold", "retraction"]

SOFTEST, STEEPEST = 1.0, 8.0
RANGES: Mapping[str, tuple[float, float]] = {
    "tension": (-1.0, 1.0),
    "continuity": (-1.0, 0.0),
    "bias": (-1.0, 1.0),
    "steepness": (SOFTEST, STEEPEST),
}
EVEN = 3.3  # steepness with which the linear easing has the peak speed of minimum jerk
FORCE = 1.5  # steepness that a power of 1 adds: what servos can still follow on the short ways of strokes
BIG = 0.5  # power and tension from which on a hand bounces
BIAS = 0.25  # of a power of 1: the hand goes on a little the way it came


@dataclass(frozen=True)
class Passage:
    """How one key is passed (Kochanek and Bartels 1984), and how the way to it is moved.

    Raises:
        ValueError: a number outside its range, which is named.
    """

    tension: float = 0.0  # -1 swings out .. 1 stops at the key
    continuity: float = 0.0  # -1 stops at the key .. 0 runs through; above 0 speeds would jump, which no servo can
    bias: float = 0.0  # -1 turns to the next key already .. 1 follows the way it came
    easing: Easing = "minimum_jerk"  # of the way to the key
    steepness: float = 4.0  # of that easing: 1 begins as softly as minimum jerk .. 8 nearly at once

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")


PLAIN = Passage()


def passage(manner: Expressivity, phase: Phase) -> Passage:
    """How a manner passes the keys of a phase.

    Tension is the spline's tension, fluidity f its continuity c = (f - 1) / 2. On the way to a stroke and in it power
    and tension force the hand: it begins steeply, overshoots a little and comes back to its key in time; where both are
    big it bounces (thesis 8.7). Without power it keeps an even speed. No key's time changes.

    Args:
        manner: of the behaviour.
        phase: that the way to the key belongs to.
    """
    continuity = (manner.fluidity - 1.0) / 2.0
    power, tension = (max(0.0, value) for value in (manner.power, manner.tension))
    force = FORCE * power**2 + tension
    if phase not in ("preparation", "stroke") or (force == 0.0 and manner.power == 0.0):
        return Passage(manner.tension, continuity)
    if force == 0.0:
        return Passage(manner.tension, continuity, 0.0, "linear", EVEN - (STEEPEST - EVEN) * manner.power)
    easing: Easing = "out_bounce" if min(power, tension) >= BIG else "out_back"
    return Passage(manner.tension, continuity, BIAS * power, easing, SOFTEST + force)
