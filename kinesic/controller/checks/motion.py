"""How smoothly the twin moves its hands."""

import numpy as np

from kinesic.controller.checks.check import Check, goal
from kinesic.controller.performance import Performance
from kinesic.controller.smoothness import spectral_arc_length

ROUGHER = 0.2  # of spectral arc length
LEAST_WAY = 0.05  # [m] below which a hand only sways with the body


def motion_checks(performance: Performance) -> list[Check]:
    """By how much the hands of the twin are less smooth than planned."""
    rougher: dict[str, float] = {}
    for side, performed in performance.measured.hands.items():
        path = performance.reference.hands[side]
        if np.ptp(path, axis=0).max() < LEAST_WAY:
            continue
        planned = spectral_arc_length(path, period=performance.period)
        found = spectral_arc_length(performed, period=performance.period)
        if planned is not None and found is not None:
            rougher[side] = planned - found
    if not rougher:
        return []
    worst = max(rougher, key=lambda side: rougher[side])
    return [goal("smoothness.hands", rougher[worst], ROUGHER, "SPARC", f"{worst}_hand")]
