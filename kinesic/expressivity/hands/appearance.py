"""Tells gestures from one another: two are two where hands go different ways, or are turned or shaped differently."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import radians

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.expressivity.durations import stroke_spans
from kinesic.expressivity.hands.keys import hand_at
from kinesic.expressivity.hands.poses import poses, resting_hands
from kinesic.expressivity.hands.strokes import Stroke, do_stroke, stroke_keys
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL

LEAST_WAY = 0.05  # [m] RMS over both hands by which ways differ
LEAST_TURN = radians(30)  # RMS over both hands by which palms, or pointing, differ

_SAMPLES = 50


@dataclass(frozen=True, eq=False)
class StrokeAppearance:
    """What is seen of a stroke, in neutral manner and normalised time; a hand that takes no part hangs."""

    ways: Floats  # (2, m, 3) [m] of left and right wrist
    palms: Floats  # (2, m, 3) unit: where they face
    pointing: Floats  # (2, m, 3) unit: wrist to fingers
    shapes: tuple[tuple[str, ...], ...]  # of left and right hand, one after another


def look(form: GestureForm, pace: Pace) -> StrokeAppearance:
    """Measures what is seen of the stroke of a form.

    Args:
        form: of the gesture.
        pace: of the robot that plays it.
    """
    work = poses(form, pace.robot, NEUTRAL)
    natural = stroke_spans(work, Effort(pace, work.nature))
    whole = natural["stroke"] + natural["strokeEnd"]
    times = {"ready": 0.0, "strokeStart": 0.0, "stroke": natural["stroke"], "strokeEnd": whole}
    done, rest = do_stroke(Stroke(form.id, times, (work,)), work, pace), resting_hands(pace.robot)
    seen = np.empty((3, len(SIDES), _SAMPLES, 3))
    for s, side in enumerate(SIDES):
        keys = stroke_keys(done, side, pace) if side in work.hands else []
        for k, time in enumerate(np.linspace(0.0, whole, _SAMPLES)):
            reach = hand_at(keys, float(time), rest[side]).reach or rest[side]
            palm = rest[side].palm if reach.palm is None else reach.palm
            pointing = rest[side].pointing if reach.pointing is None else reach.pointing
            seen[:, s, k] = reach.position, palm, pointing
    ways, palms, directions = map(sealed, seen)
    return StrokeAppearance(ways, palms, directions, tuple(_shapes(form, side) for side in SIDES))


def way_between(a: StrokeAppearance, b: StrokeAppearance) -> float:
    """Measures how far apart the hands of two gestures are [m], RMS over time and both hands."""
    return float(np.sqrt(((a.ways - b.ways) ** 2).sum(axis=-1).mean()))


def turn_between(a: StrokeAppearance, b: StrokeAppearance) -> float:
    """Measures how differently the hands are turned [rad]: palms or pointing, RMS over time and both hands."""
    pairs = ((a.palms, b.palms), (a.pointing, b.pointing))
    return max(float(np.sqrt((_angles(one, other) ** 2).mean())) for one, other in pairs)


def distinct(a: StrokeAppearance, b: StrokeAppearance) -> bool:
    """Whether two gestures count as two."""
    return way_between(a, b) >= LEAST_WAY or turn_between(a, b) >= LEAST_TURN or a.shapes != b.shapes


def nearest(seen: StrokeAppearance, others: Mapping[str, StrokeAppearance]) -> tuple[str, float]:
    """Finds the gesture whose hands go most nearly the same way, and how far apart they are [m].

    Args:
        seen: of the gesture.
        others: by name; at least one.
    """
    ways = {name: way_between(seen, other) for name, other in others.items()}
    name = min(ways, key=lambda each: ways[each])
    return name, ways[name]


def twins(looks: Iterable[tuple[str, StrokeAppearance]]) -> list[tuple[str, str]]:
    """Lists gestures that look like an earlier one and so do not count, as (gesture, earlier one)."""
    counted: list[tuple[str, StrokeAppearance]] = []
    found = []
    for name, seen in looks:
        same = next((earlier for earlier, other in counted if not distinct(seen, other)), None)
        if same is None:
            counted.append((name, seen))
        else:
            found.append((name, same))
    return found


def _angles(a: Floats, b: Floats) -> Floats:
    """(...) [rad] between (..., 3) unit vectors."""
    return np.asarray(np.arccos(np.clip((a * b).sum(axis=-1), -1.0, 1.0)))


def _shapes(form: GestureForm, side: Side) -> tuple[str, ...]:
    """Shapes of one hand in their order, each once while it lasts."""
    every = [pose.shape or "" for key in form.keys if (pose := key.hands.get(side)) is not None]
    return tuple(shape for k, shape in enumerate(every) if k == 0 or shape != every[k - 1])
