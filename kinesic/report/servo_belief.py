"""Report data on the servo parameters, as assumed and as identified."""

from collections.abc import Mapping
from math import degrees
from typing import TYPE_CHECKING

from kinesic.controller.learned_gains import Identification, describe_estimate
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

if TYPE_CHECKING:
    from kinesic.report.report import Json  # which has these tables


def lead(factors: Factors) -> dict[str, "Json"]:
    """Describe the servo parameters assumed by the feed-forward."""
    gains: dict[str, Json] = {name: servo_factors.gain for name, servo_factors in factors.servos.items()}
    text = "as in the data sheets" if factors == NOMINAL_FACTORS else describe_estimate(factors)
    return {"gain": gains or factors.gain, "latency_s": factors.latency, "text": text}


def taught(lesson: Identification | None) -> dict[str, "Json"] | None:
    """Describe the identified servo parameters, or return None without identification."""
    if lesson is None:
        return None
    before, after = degrees(lesson.before), degrees(lesson.after)
    return {**lead(lesson.estimate), "before_deg": before, "after_deg": after, "why": lesson.why, "text": str(lesson)}


def with_lesson(data: Mapping[str, "Json"], lesson: Identification | None) -> dict[str, "Json"]:
    """Add the identified servo parameters to report data."""
    return {**data, "learned": taught(lesson)}
