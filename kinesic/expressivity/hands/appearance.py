"""Comparison of gestures by hand paths, orientations and shapes."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import radians

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.expressivity.durations import stroke_durations
from kinesic.expressivity.hands.keys import hand_at
from kinesic.expressivity.hands.poses import poses, resting_hands
from kinesic.expressivity.hands.strokes import Stroke, stroke_keys, time_stroke
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY

MIN_PATH_DISTANCE = 0.05  # [m] smallest RMS distance of the hand paths of two visibly different gestures
MIN_ORIENTATION_ANGLE = radians(30)  # [rad] RMS angle between hand orientations from which gestures visibly differ

_SAMPLE_COUNT = 50  # samples per stroke


@dataclass(frozen=True, eq=False)
class StrokeAppearance:
    """Sampled hand motion of a stroke, with neutral expressivity and normalised time.

    Hands that take no part hang.
    """

    positions: Floats  # (2, m, 3) [m] positions of left and right wrist
    palms: Floats  # (2, m, 3) unit palm normals
    pointing: Floats  # (2, m, 3) unit directions from wrist to fingers
    shapes: tuple[tuple[str, ...], ...]  # successive hand shapes of the left and the right hand


def look(form: GestureForm, pace: Pace) -> StrokeAppearance:
    """Sample the hand motion during a gesture's stroke.

    Args:
        form: of the gesture.
        pace: of the robot that performs it.
    """
    work = poses(form, pace.robot, NEUTRAL_EXPRESSIVITY)
    natural = stroke_durations(work, Effort(pace, work.traits))
    whole = natural["stroke"] + natural["strokeEnd"]
    times = {"ready": 0.0, "strokeStart": 0.0, "stroke": natural["stroke"], "strokeEnd": whole}
    done, rest = time_stroke(Stroke(form.id, times, (work,)), work, pace), resting_hands(pace.robot)
    seen = np.empty((3, len(SIDES), _SAMPLE_COUNT, 3))
    for s, side in enumerate(SIDES):
        keys = stroke_keys(done, side, pace) if side in work.hands else []
        for k, time in enumerate(np.linspace(0.0, whole, _SAMPLE_COUNT)):
            reach = hand_at(keys, float(time), rest[side]).reach or rest[side]
            palm = rest[side].palm if reach.palm is None else reach.palm
            pointing = rest[side].pointing if reach.pointing is None else reach.pointing
            seen[:, s, k] = reach.position, palm, pointing
    positions, palms, directions = map(sealed, seen)
    return StrokeAppearance(positions, palms, directions, tuple(_shapes(form, side) for side in SIDES))


def path_distance(a: StrokeAppearance, b: StrokeAppearance) -> float:
    """Return the RMS distance between the hand paths of two gestures [m].

    The mean is over time and both hands.
    """
    return float(np.sqrt(((a.positions - b.positions) ** 2).sum(axis=-1).mean()))


def orientation_angle(a: StrokeAppearance, b: StrokeAppearance) -> float:
    """Return the RMS angle between the hand orientations of two gestures [rad].

    It is the larger angle of palms and pointing directions, with the mean over time and both hands.
    """
    pairs = ((a.palms, b.palms), (a.pointing, b.pointing))
    return max(float(np.sqrt((_angles(one, other) ** 2).mean())) for one, other in pairs)


def distinct(a: StrokeAppearance, b: StrokeAppearance) -> bool:
    """Return whether two gestures are visibly different."""
    return (
        a.shapes != b.shapes
        or path_distance(a, b) >= MIN_PATH_DISTANCE
        or orientation_angle(a, b) >= MIN_ORIENTATION_ANGLE
    )


def nearest(seen: StrokeAppearance, others: Mapping[str, StrokeAppearance]) -> tuple[str, float]:
    """Return the gesture with the nearest hand paths, and their distance [m].

    Args:
        seen: appearance of the gesture.
        others: appearances by name; at least one.
    """
    distances = {name: path_distance(seen, other) for name, other in others.items()}
    name = min(distances, key=lambda other: distances[other])
    return name, distances[name]


def twins(looks: Iterable[tuple[str, StrokeAppearance]]) -> list[tuple[str, str]]:
    """Return pairs of names of gestures that look alike, later gesture first."""
    counted: list[tuple[str, StrokeAppearance]] = []
    duplicates = []
    for name, seen in looks:
        same = next((earlier for earlier, other in counted if not distinct(seen, other)), None)
        if same is None:
            counted.append((name, seen))
        else:
            duplicates.append((name, same))
    return duplicates


def _angles(a: Floats, b: Floats) -> Floats:
    """Return the angles between (..., 3) unit vectors, shape (...) [rad]."""
    return np.asarray(np.arccos(np.clip((a * b).sum(axis=-1), -1.0, 1.0)))


def _shapes(form: GestureForm, side: Side) -> tuple[str, ...]:
    """Return the successive shapes of one hand, without repetitions."""
    shapes = [pose.shape or "" for key in form.keys if (pose := key.hands.get(side)) is not None]
    return tuple(shape for k, shape in enumerate(shapes) if k == 0 or shape != shapes[k - 1])
