"""Spline parameters of gesture phases, derived from expressivity (thesis 8.7)."""

from dataclasses import replace
from typing import Literal

from kinesic.expressivity.style.style import Expressivity
from kinesic.motion.easing import Easing
from kinesic.motion.keys import (
    ACCENT_EASING,
    LATE_ACCENT_EASING,
    LINEAR_STEEPNESS,
    MAX_STEEPNESS,
    MIN_STEEPNESS,
    KeyPassage,
)

Phase = Literal["preparation", "stroke", "hold", "retraction"]

POWER_STEEPNESS = 1.5  # increase of a movement's easing steepness at a power of 1
FORCE_EXPONENT = 3.0  # exponent of power, and of tension if power is high, in the easing steepness
TENSION_EXPONENT = 1.5  # exponent of tension in the easing steepness of gestures without power
OVERSHOOT_THRESHOLD = 0.5  # power from which accented strokes overshoot; if tension is as high, strokes bounce
OVERSHOOT_ACCENT_FRACTION = 0.68  # steepness of easing `out_back` / steepness of an accent of equal peak velocity
MIN_LATE_ACCENT = 2.5  # smallest easing steepness, less `MIN_STEEPNESS`, if a full accent ends the movement
POWER_BIAS = 0.25  # spline bias at a power of 1, towards the direction of approach
LOOSENESS_BIAS = 0.4  # spline bias in strokes at a tension of -1, towards the direction of departure


def passage_of(
    manner: Expressivity,
    phase: Phase,
    *,
    accent: float = 0.0,
    has_late_peak: bool = False,
    swing: float = 0.0,
    gesture_power: float | None = None,
) -> KeyPassage:
    """Derive the spline parameters of a gesture phase from expressivity.

    Tension is the spline's tension; fluidity f gives its continuity c = (f - 1) / 2. In preparation and stroke, power
    and tension make the hand begin steeply, overshoot a little and return to its key in time; where both are high, it
    bounces (thesis 8.7). A loose hand turns early towards the next stroke key. Weakness first removes the accent, then
    keeps an even velocity. No duration changes. A late accent keeps the steepness that a word needs, and only a bounce
    replaces it.

    Args:
        manner: expressivity of the behaviour.
        phase: gesture phase of the movement that ends at the key.
        accent: steepness of the stroke itself, beyond the softest easing.
        has_late_peak: whether the accent lies at the end of the movement instead of its beginning.
        swing: of the key.
        gesture_power: power of the whole gesture, if this phase has another one.
    """
    passed = KeyPassage(manner.tension, (manner.fluidity - 1.0) / 2.0, swing=swing)
    if phase not in ("preparation", "stroke"):
        return passed
    power, tension, weakness = (max(0.0, value) for value in (manner.power, manner.tension, -manner.power))
    looseness = max(-manner.tension, 0.0) if phase == "stroke" else 0.0
    passed = replace(passed, bias=POWER_BIAS * power - LOOSENESS_BIAS * looseness)
    force, left = (
        POWER_STEEPNESS * power**FORCE_EXPONENT
        + tension ** tension_exponent(manner.power if gesture_power is None else gesture_power),
        accent * (1.0 - weakness) - weakness,
    )
    if has_late_peak and min(power, tension) < OVERSHOOT_THRESHOLD and accent > 0.0:
        left = max(left, MIN_LATE_ACCENT * min(accent, 1.0)) + force
        return replace(
            passed,
            easing=LATE_ACCENT_EASING,
            steepness=min(MIN_STEEPNESS + left, MAX_STEEPNESS),
        )
    if force > 0.0:
        easing, kept = _forced(power, tension, accent)
        steepness = MIN_STEEPNESS + kept * max(left, 0.0) + force
        return replace(passed, easing=easing, steepness=min(steepness, MAX_STEEPNESS))
    if left < 0.0:
        return replace(passed, easing="linear", steepness=LINEAR_STEEPNESS - (MAX_STEEPNESS - LINEAR_STEEPNESS) * left)
    return (
        replace(passed, easing=ACCENT_EASING, steepness=min(MIN_STEEPNESS + left, MAX_STEEPNESS))
        if left > 0.0
        else passed
    )


def tension_exponent(power: float) -> float:
    """Return the exponent of tension in the easing steepness, larger with power."""
    fraction = min(max(power, 0.0) / OVERSHOOT_THRESHOLD, 1.0)
    return TENSION_EXPONENT + (FORCE_EXPONENT - TENSION_EXPONENT) * fraction


def _forced(power: float, tension: float, accent: float) -> tuple[Easing, float]:
    """Return the easing and accent fraction of a powerful or tense movement.

    More power never lowers the peak velocity.
    """
    if min(power, tension) >= OVERSHOOT_THRESHOLD:
        return "out_bounce", 1.0
    if accent > 0.0 and tension <= 0.0 and power < OVERSHOOT_THRESHOLD:
        return ACCENT_EASING, 1.0
    firmness = max((power - OVERSHOOT_THRESHOLD) / OVERSHOOT_THRESHOLD, tension)
    return "out_back", OVERSHOOT_ACCENT_FRACTION + (1.0 - OVERSHOOT_ACCENT_FRACTION) * min(firmness, 1.0)
