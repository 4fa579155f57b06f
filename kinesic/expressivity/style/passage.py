"""How a manner passes the keys of a motion, and moves the way to them (thesis 8.7, Sequential Variation)."""

from typing import Literal

from kinesic.expressivity.style.style import Expressivity
from kinesic.motion.easing import Easing
from kinesic.motion.keys import EVEN, SOFTEST, STEEPEST, Passage

Phase = Literal["preparation", "stroke", "hold", "retraction"]

FORCE = 1.5  # steepness that a power of 1 adds: what servos can still follow on the short ways of strokes
BIG = 0.5  # power and tension from which on a hand bounces
BIAS = 0.25  # of a power of 1: the hand goes on a little the way it came


def passage_of(manner: Expressivity, phase: Phase) -> Passage:
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
