"""How smoothly the twin moves its hands."""

from kinesic.controller.performance import Performance
from kinesic.controller.smoothness import dimensionless_jerk
from kinesic.report.checks.check import Check, goal

JERKIER = 2.0  # times the dimensionless jerk


def motion_checks(performance: Performance) -> list[Check]:
    """How many times the planned jerk the hands of the twin have, both of them without dimension.

    Spectral arc length would not tell: it is made for single reaches, and of several even a shaking hand's is short.
    """
    jerkier: dict[str, float] = {}
    for side, performed in performance.measured.hands.items():
        planned = performance.reference.smoothness[side]
        if planned is None:
            continue
        found = dimensionless_jerk(performed, period=performance.period)
        if found is not None:
            jerkier[side] = found / planned
    if not jerkier:
        return []
    worst = max(jerkier, key=lambda side: jerkier[side])
    return [goal("smoothness.hands", jerkier[worst], JERKIER, "times", f"{worst}_hand")]
