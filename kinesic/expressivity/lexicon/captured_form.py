"""Conversion of captured motion to the stroke keys of a gesture.

The keys are at strokeStart, stroke and strokeEnd. Between them the hands follow the captured paths in the captured
timing, so that style, amplitude and tempo act on them as on other gestures.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.expressivity.lexicon.form import HandPose, StrokeKey
from kinesic.expressivity.lexicon.gesture_motion import GestureMotion
from kinesic.expressivity.lexicon.hand_shapes import HandShape, hand_shapes
from kinesic.expressivity.lexicon.path_course import PathCourse
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.lexicon.space import spread_hands

MARKER_NAMES = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")  # markers in time order
KEY_MARKERS = ("strokeStart", "stroke", "strokeEnd")  # markers at which a captured gesture has stroke keys
VIA_INTERVAL = 0.05  # [s] interval between via points of a captured path
MIN_STROKE_TIME = 0.12  # [s] shortest time between two stroke keys; a closer strokeEnd is left out
FINGER_WEIGHTS = sealed([0.5, 1.0, 1.0, 1.0, 1.0])  # weights of thumb .. little finger in the comparison of shapes
SPECIAL_SHAPE_COST = 0.2  # squared extension difference by which a shape that needs fingers must be nearer
FULL_SWIVEL = float(np.radians(31.0))  # [rad] elbow swivel at openness 1 of a gesture form
MIN_EXTENT = 0.12  # [arm lengths] smallest extent of the path of a hand that takes part
MIN_EXTENT_RATIO = 0.4  # smallest extent of the path of a hand that takes part / that of the other hand
MIN_DIRECTION_LENGTH = 0.5  # length of an interpolated direction below which it is undefined
SPREAD_WINDOW = 0.3  # [s] time over which the outward shift of hands that would meet is smoothed
SWIVEL_WINDOW = 0.2  # [s] time around a key over which the elbow's swivel is averaged


def check_markers(markers: Mapping[str, float], duration: float) -> None:
    """Raise an error for markers missing, out of order or too late.

    Raises:
        ValueError: a marker is invalid.
    """
    if unknown := sorted(markers.keys() ^ set(MARKER_NAMES)):
        raise ValueError(f"markers must be {', '.join(MARKER_NAMES)}; wrong or missing: {', '.join(unknown)[:80]}")
    times = [markers[name] for name in MARKER_NAMES]
    if not all(np.isfinite(times)) or times[0] < 0.0 or any(b < a for a, b in pairwise(times)):
        raise ValueError(f"markers must increase from 0; they are {', '.join(f'{time:g}' for time in times)}")
    if times[-1] > duration + VIA_INTERVAL:
        raise ValueError(f"marker end is {times[-1]:g} s, and the motion lasts {duration:.2f} s")


def captured_keys(motion: GestureMotion, markers: Mapping[str, float], sides: Sequence[Side]) -> tuple[StrokeKey, ...]:
    """Return the stroke keys of a captured gesture.

    Hands that would meet are moved apart over the whole gesture.

    Args:
        motion: of the hands.
        markers: time [s] of each of `MARKER_NAMES`.
        sides: hands of the motion that take part.
    """
    start, stroke, end = (markers[name] for name in KEY_MARKERS)
    times = [min(start, stroke - MIN_STROKE_TIME), stroke, *([end] if end - stroke >= MIN_STROKE_TIME else [])]
    counts = [max(1, round((after - before) / VIA_INTERVAL)) for before, after in pairwise(times)]
    grids = [np.linspace(*ends, count + 1)[:-1] for ends, count in zip(pairwise(times), counts, strict=True)]
    samples = _spread([_sample(motion, side, np.concatenate([*grids, times[-1:]])) for side in sides])
    keys = [StrokeKey({hand.side: hand.pose(motion, 0) for hand in samples})]
    first = 0
    for count, (before, after) in zip(counts, pairwise(times), strict=True):
        last = first + count
        keys.append(
            StrokeKey({hand.side: hand.pose(motion, last, hand.path(first, last, after - before)) for hand in samples})
        )
        first = last
    return tuple(keys)


@dataclass(frozen=True, eq=False)
class _HandSamples:
    """Motion of one hand at key times and via points."""

    side: Side
    times: Floats  # (p,) [s]
    positions: Floats  # (p, 3) [arm lengths]
    pointing: Floats | None  # (p, 3) unit directions
    palm: Floats | None  # (p, 3) unit normals

    def pose(self, motion: GestureMotion, k: int, path: HandPath | None = None) -> HandPose:
        """Return the hand pose at sample `k`, reached along `path`."""
        hand, time = motion.hands[self.side], float(self.times[k])
        near = np.abs(motion.times - time) <= SWIVEL_WINDOW / 2.0
        swivel = float(hand.swivel[near].mean()) if near.any() else float(hand.swivel[motion.at(time)])
        return HandPose(
            sealed(self.positions[k].copy()),
            palm=None if self.palm is None else sealed(self.palm[k].copy()),
            pointing=None if self.pointing is None else sealed(self.pointing[k].copy()),
            shape=None if hand.straight is None else nearest_shape(hand.straight[motion.at(time)]),
            openness=float(np.clip(swivel / FULL_SWIVEL, 0.0, 1.0)),
            path=path,
            captured=True,
        )

    def path(self, first: int, last: int, duration: float) -> HandPath:
        """Return the captured path between two samples."""
        inner, count = slice(first + 1, last), last - first
        course = PathCourse(
            duration,
            sealed(np.arange(1, count) / count),
            None if self.pointing is None else sealed(self.pointing[inner].copy()),
            None if self.palm is None else sealed(self.palm[inner].copy()),
        )
        zero = sealed(np.zeros(3))
        return HandPath("points", zero, zero, zero, points=sealed(self.positions[inner].copy()), course=course)


def _sample(motion: GestureMotion, side: Side, times: Floats) -> _HandSamples:
    """Interpolate the motion of a hand at given times (p,) [s]."""
    hand = motion.hands[side]
    positions = _interpolate(motion.times, hand.wrist, times)
    pointing, palm = (_interpolate_directions(motion.times, rows, times) for rows in (hand.pointing, hand.palm))
    return _HandSamples(side, sealed(times), positions, pointing, palm)


def _interpolate(motion_times: Floats, rows: Floats, times: Floats) -> Floats:
    return np.stack([np.interp(times, motion_times, column) for column in rows.T], axis=1)


def _interpolate_directions(motion_times: Floats, rows: Floats | None, times: Floats) -> Floats | None:
    """Return unit directions (p, 3), or None if unknown or vanishing."""
    if rows is None:
        return None
    vectors = _interpolate(motion_times, rows, times)
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / lengths if float(lengths.min()) > MIN_DIRECTION_LENGTH else None


def _spread(samples: Sequence[_HandSamples]) -> Sequence[_HandSamples]:
    """Move both hands outward at every sample until the hands are clear.

    The largest outward shift within `SPREAD_WINDOW` applies, so that the paths stay smooth.
    """
    if len(samples) < len(SIDES):
        return samples
    shifts = np.zeros(len(samples[0].times))
    for k in range(len(shifts)):
        poses = {
            hand.side: HandPose(hand.positions[k], pointing=None if hand.pointing is None else hand.pointing[k].copy())
            for hand in samples
        }
        moved = spread_hands(StrokeKey(poses)).hands[samples[0].side].position
        shifts[k] = moved[1] - samples[0].positions[k, 1]
    if not shifts.any():
        return samples
    half = round(SPREAD_WINDOW / VIA_INTERVAL / 2.0)
    padded = np.pad(shifts, 2 * half, mode="edge")
    widest = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1).max(axis=1)
    smooth = np.convolve(widest, np.full(2 * half + 1, 1.0 / (2 * half + 1)), mode="valid")
    return [replace(hand, positions=hand.positions + smooth[:, None] * [0.0, 1.0, 0.0]) for hand in samples]


def nearest_shape(straight: Floats) -> str:
    """Return the hand shape with the nearest finger extensions (5,).

    Shapes with meeting fingertips, which extensions cannot tell, are excluded. A plain shape is preferred.
    """

    def distance(shape: HandShape) -> float:
        difference = FINGER_WEIGHTS * (np.array(shape.straight) - straight) ** 2
        return float(difference.sum()) + (0.0 if shape.plain else SPECIAL_SHAPE_COST)

    return min((shape for shape in hand_shapes().values() if not shape.meets), key=distance).name


def moving_sides(motion: GestureMotion, markers: Mapping[str, float]) -> tuple[Side, ...]:
    """Return the hands whose wrists move during preparation and stroke.

    A hand takes part if its path extends at least `MIN_EXTENT`, and `MIN_EXTENT_RATIO` of the other hand's extent.
    """
    inside = (motion.times >= markers["start"]) & (motion.times <= markers["relax"])
    extents = {side: float(np.ptp(hand.wrist[inside], axis=0).max()) for side, hand in motion.hands.items()}
    widest = max(extents.values())
    chosen = tuple(
        side for side in SIDES if side in extents and extents[side] >= max(MIN_EXTENT, MIN_EXTENT_RATIO * widest)
    )
    return chosen or (max(extents, key=lambda side: extents[side]),)
