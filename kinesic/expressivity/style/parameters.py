"""Parameters of a style with their values, units and effects."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import degrees

from kinesic.bml.block import EXPRESSIVITY_RANGES, Modality
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.standing import Standing

PARAMETER_EFFECTS: Mapping[str, str] = {  # effect of each expressivity parameter, from low to high values
    "spatial": "size of movements: tight .. wide",
    "temporal": "duration of strokes, and rate of the voice: slow .. fast",
    "fluidity": "transitions: abrupt .. smooth",
    "power": "acceleration of strokes: weak .. forceful",
    "tension": "curvature at key poses: loose .. tense",
    "repetition": "repeated strokes: once .. several times",
    "activation": "size, speed, force and openness together: passive .. animated",
    "openness": "elbows: at the body .. away from it",
}
WEIGHT_EFFECTS: Mapping[str, tuple[str, str]] = {  # (range, effect) of each weight of a style
    "whole_body": ("0 .. 2", "accompanying motion of head, trunk, shoulders and face: none .. twice the usual amount"),
    "posture": ("0 .. 2", "the standing posture, face and gaze below: as neutral .. twice as much"),
    "effort": ("0 .. 1", "profile of a gesture's phases: durations by Fitts' law .. durations of people"),
}
TURN_EFFECTS: Mapping[str, str] = {  # direction of a positive rotation of head or trunk
    "torsion": "positive to the left",
    "tilt": "positive down and forward",
    "roll": "positive to the right",
}
ANGLE_DIGITS = 1  # decimal places of an angle in degrees


@dataclass(frozen=True)
class StyleParameter:
    """One value of a style, with its unit and effect."""

    key: str  # name in the style's file, with its table, such as head.spatial or standing.trunk.tilt
    value: float | str
    unit: str  # deg, or the range of a number without unit; empty for a name
    effect: str  # what the value changes, from the lowest to the highest value

    def __str__(self) -> str:
        """Return one line: key, value, unit and effect."""
        number = self.value if isinstance(self.value, str) else f"{self.value:g}"
        unit = "" if not self.unit else " deg" if self.unit == "deg" else f" ({self.unit})"
        return f"{self.key} = {number}{unit}: {self.effect}"


def list_parameters(
    numbers: Mapping[Modality, Mapping[str, float]],
    weights: Mapping[str, float],
    standing: Standing,
    prefers: tuple[tuple[str, float], ...],
) -> tuple[StyleParameter, ...]:
    """List the values of a style in the order of its file.

    Args:
        numbers: expressivity parameters by modality; those of gestures come first, then the modalities that differ.
        weights: `whole_body`, `posture` and `effort`.
        standing: standing posture; values equal to those of the robot's rest posture are omitted.
        prefers: factors on the probabilities of gestures.
    """
    common = numbers["gesture"]
    return (
        *(StyleParameter(name, value, _range_text(name), PARAMETER_EFFECTS[name]) for name, value in common.items()),
        *(StyleParameter(name, weights[name], *texts) for name, texts in WEIGHT_EFFECTS.items()),
        *(
            StyleParameter(f"{modality}.{name}", value, _range_text(name), f"as {name}, of the {modality} alone")
            for modality, values in numbers.items()
            for name, value in values.items()
            if value != common[name]
        ),
        *_standing_parameters(standing),
        *(
            StyleParameter(f"prefers.{gesture}", factor, "factor", "probability among alternative gestures")
            for gesture, factor in prefers
        ),
    )


def _standing_parameters(standing: Standing) -> Iterator[StyleParameter]:
    """Yield a standing posture's values that differ from the rest posture."""
    yield from _turn_parameters("trunk", standing.trunk)
    yield from _turn_parameters("head", standing.head)
    for hinge, angle in standing.arms:
        effect = "offset of both resting arms at this joint"
        yield StyleParameter(f"standing.arms.{hinge}", _in_degrees(angle), "deg", effect)
    if standing.fist:
        yield StyleParameter("standing.fist", standing.fist, "0 .. 1", "fingers at rest: relaxed .. closed")
    if standing.rest:
        hand = ", by the other hand" if standing.mirrored else ""
        yield StyleParameter("standing.rest", standing.rest, "", f"gesture in which the hands rest{hand}")
    for gesture, weight in standing.pauses:
        effect = "probability of this rest in long pauses, relative to the others"
        yield StyleParameter(f"standing.pauses.{gesture}", weight, "weight", effect)
    for lexeme, amount in standing.face:
        yield StyleParameter(f"standing.face.{lexeme}", amount, "0 .. 1", "expression shown all the time")
    gaze = standing.gaze
    for name, angle, direction in (("gaze_down", gaze.down, "down"), ("gaze_aside", gaze.aside, "to either side")):
        if angle:
            yield StyleParameter(f"standing.{name}", _in_degrees(angle), "deg", f"averted gaze: angle {direction}")
    if gaze.averted:
        effect = "fraction of the time in which the gaze is averted"
        yield StyleParameter("standing.averted", gaze.averted, "0 .. 1", effect)


def _turn_parameters(part: str, turn: Turn) -> Iterator[StyleParameter]:
    for name, direction in TURN_EFFECTS.items():
        angle = getattr(turn, name)
        if angle:
            yield StyleParameter(
                f"standing.{part}.{name}", _in_degrees(angle), "deg", f"rotation of the {part}: {direction}"
            )


def _in_degrees(angle: float) -> float:
    return round(degrees(angle), ANGLE_DIGITS)


def _range_text(name: str) -> str:
    least, most = EXPRESSIVITY_RANGES[name]
    return f"{least:g} .. {most:g}"
