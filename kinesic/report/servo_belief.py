"""Tells by what goals of servos lead, and what the servos have told of themselves."""

from collections.abc import Mapping
from math import degrees
from typing import TYPE_CHECKING

from kinesic.controller.learned_gains import Lesson, describe_belief
from kinesic.sim.servo_factors import NOMINAL, Factors

if TYPE_CHECKING:
    from kinesic.report.report import Json  # which has these tables


def lead(believed: Factors) -> dict[str, "Json"]:
    """Says how servos are believed to be, by which goals lead: P gains as shares of the data sheets', and the delay."""
    gains: dict[str, Json] = {name: own.gain for name, own in believed.servos.items()}
    said = "as data sheets say" if believed == NOMINAL else describe_belief(believed)
    return {"gain": gains or believed.gain, "latency_s": believed.latency, "text": said}


def taught(lesson: Lesson | None) -> dict[str, "Json"] | None:
    """Says what servos have told; None where nobody asked."""
    if lesson is None:
        return None
    before, after = degrees(lesson.before), degrees(lesson.after)
    return {**lead(lesson.believed), "before_deg": before, "after_deg": after, "why": lesson.why, "text": str(lesson)}


def with_lesson(data: Mapping[str, "Json"], lesson: Lesson | None) -> dict[str, "Json"]:
    """Adds what the servos of a robot have told of themselves to a report."""
    return {**data, "learned": taught(lesson)}
