"""How smoothly the twin moves its hands."""

from kinesic.controller.checks.check import Check, goal
from kinesic.controller.performance import Performance
from kinesic.controller.smoothness import spectral_arc_length

ROUGHER = 0.2  # of spectral arc length


def motion_checks(performance: Performance) -> list[Check]:
    """By how much the hands of the twin are less smooth than planned."""
    rougher: dict[str, float] = {}
    for side, performed in performance.measured.hands.items():
        planned = performance.reference.smoothness[side]
        if planned is None:
            continue
        found = spectral_arc_length(performed, period=performance.period)
        if found is not None:
            rougher[side] = planned - found
    if not rougher:
        return []
    worst = max(rougher, key=lambda side: rougher[side])
    return [goal("smoothness.hands", rougher[worst], ROUGHER, "SPARC", f"{worst}_hand")]
