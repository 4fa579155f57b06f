"""Report data on the servo parameters, as assumed and as identified."""

from collections.abc import Mapping
from math import degrees
from typing import TYPE_CHECKING

from kinesic.controller.learned_gains import Identification, describe_estimate
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

if TYPE_CHECKING:
    from kinesic.report.report import Json  # which has these tables


def describe_assumed(factors: Factors) -> dict[str, "Json"]:
    """Describe the servo parameters assumed by the feed-forward."""
    gains: dict[str, Json] = {name: servo_factors.gain for name, servo_factors in factors.servos.items()}
    text = "as in the data sheets" if factors == NOMINAL_FACTORS else describe_estimate(factors)
    return {"gain": gains or factors.gain, "latency_s": factors.latency, "text": text}


def describe_identified(identification: Identification | None) -> dict[str, "Json"] | None:
    """Describe the identified servo parameters, or return None without identification."""
    if identification is None:
        return None
    before, after = degrees(identification.before), degrees(identification.after)
    return {
        **describe_assumed(identification.estimate),
        "before_deg": before,
        "after_deg": after,
        "why": identification.why,
        "text": str(identification),
    }


def add_identification(data: Mapping[str, "Json"], identification: Identification | None) -> dict[str, "Json"]:
    """Add the identified servo parameters to report data."""
    return {**data, "learned": describe_identified(identification)}
