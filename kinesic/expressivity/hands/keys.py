"""Keys of one hand, with interpolation of position and rotation.

A hand turns through its keys on Kochanek-Bartels splines of rotations. Between two keys the logarithm of the rotation
from the first is a cubic (Hermite), whose ends have the angular velocities of the keys; these are weighted as those of
positions are (sheet of the trajectory, 8.2). Velocities are equal before and after each key, so that they are
continuous.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.rotation import rotation_to_vector, vector_to_rotation
from kinesic.expressivity.hands.blending import interpolate_hands
from kinesic.expressivity.hands.poses import REST_HAND
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.turns import MIN_KEY_SPACING
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage
from kinesic.motion.piecewise import PiecewisePolynomial

MAX_PALM_COSINE = 0.99  # largest cosine between pointing direction and palm normal that define a rotation
PATH_TOLERANCE = 0.01  # [arm lengths] largest distance of a path from the chord of two samples
# Largest distance between two samples of a path [arm lengths]; joints are interpolated between them, so that the hand
# leaves its path.
PATH_STEP = 0.2  # [arm lengths] longest distance between two samples of a path
POWER_RAMP_GAIN = 0.5  # relative increase of the acceleration time along a path at full power
LATE_PEAK_RATIO = 0.5  # velocity after the acceleration / peak velocity, if the path ends at a word
WORD_BRAKE_TIME = 0.12  # [s] longest deceleration of a path that ends at a word
WORD_BRAKE_FRACTION = 0.5  # largest deceleration time / acceleration time, if the path ends at a word
MIN_ROTATION = 1e-6  # [rad] rotation between two keys below which the hand holds its orientation


@dataclass(frozen=True, eq=False)
class HandKey:
    """Pose of one hand at one time."""

    time: float  # [s] block time
    hand: Hand
    passage: KeyPassage = PLAIN_PASSAGE


@dataclass(frozen=True, eq=False)
class RotationSpline:
    """Rotation spline over time, constant before and after its keys."""

    times: Floats  # (k,) [s]
    keys: Floats  # (k, 3, 3)
    turns: PiecewisePolynomial  # (3,) rotation vector from the preceding key, in that key's frame

    @classmethod
    def through(cls, times: Sequence[float], keys: Floats, passages: Sequence[KeyPassage]) -> "RotationSpline":
        """Interpolate at least two rotations on the shortest arcs.

        It is at rest at both ends and in holds.

        Args:
            times: of the keys, increasing [s].
            keys: (k, 3, 3) rotations.
            passages: one per key, of which tension, continuity, swing and bias are used.
        """
        at = np.asarray(times, dtype=float)
        steps = np.diff(at)[:, None]
        rotations = rotation_to_vector(keys[:-1].transpose(0, 2, 1) @ keys[1:])
        bias, flow = (
            np.array([[getattr(passage, name)] for passage in passages[1:-1]]).reshape(-1, 1)
            for name in ("bias", "flow")
        )
        velocities = np.zeros((len(at), 3))
        earlier, later = rotations[:-1] / steps[:-1] * steps[1:], rotations[1:] / steps[1:] * steps[:-1]
        chords = (1 + bias) * earlier + (1 - bias) * later
        velocities[1:-1] = flow * chords / (steps[:-1] + steps[1:])
        is_still = np.linalg.norm(rotations, axis=1) < MIN_ROTATION
        velocities[:-1][is_still] = velocities[1:][is_still] = 0.0
        ends = np.einsum("kij,kj->ki", _inverse_jacobians(rotations), velocities[1:])
        square = (3 * rotations / steps - 2 * velocities[:-1] - ends) / steps
        cube = (velocities[:-1] + ends - 2 * rotations / steps) / steps**2
        turns = np.stack([cube, square, velocities[:-1], np.zeros_like(rotations)])
        return cls(at, keys, PiecewisePolynomial(sealed(at), sealed(turns)))

    def at(self, times: Floats) -> Floats:
        """Return the rotations (m, 3, 3) at (m,) times [s]."""
        inside = np.clip(times, self.times[0], self.times[-1])
        interval = np.clip(np.searchsorted(self.times, inside, side="right") - 1, 0, len(self.times) - 2)
        return self.keys[interval] @ vector_to_rotation(self.turns.at(inside))


def facing_rotations(pointing: Floats, palm: Floats) -> Floats:
    """Return hand rotations (..., 3, 3) from pointing directions and palm normals."""
    lateral = np.cross(palm, pointing)
    lateral /= np.linalg.norm(lateral, axis=-1, keepdims=True)
    return np.stack([pointing, lateral, np.cross(pointing, lateral)], axis=-1)


def hand_at(keys: Sequence[HandKey], time: float, rest: Reach) -> Hand:
    """Return the hand pose at a time [s], linearly interpolated between keys.

    It is constant before the first and after the last key.
    """
    k = bisect_right(keys, time, key=lambda key: key.time)
    if k == 0 or k == len(keys):
        return keys[min(k, len(keys) - 1)].hand if keys else REST_HAND
    a, b = keys[k - 1], keys[k]
    return interpolate_hands(a.hand, b.hand, (time - a.time) / (b.time - a.time), rest)


def _facing_between(keys: Sequence[HandKey], k: int) -> RotationSpline | None:
    """Interpolate the hand orientation between two keys by a spline.

    The keys are k - 1 and k. Its angular velocity is continuous at the keys, as is needed where the poses between them
    become keys too. The result is None if the keys do not rotate the hand, or leave its pointing direction or its palm
    open.
    """
    neighbours = [
        (key, reach.pointing, reach.palm)
        for j, key in enumerate(keys[max(0, k - 2) : k + 2], max(0, k - 2))
        if (reach := key.hand.reach) and reach.pointing is not None and reach.palm is not None
        if abs(reach.pointing @ reach.palm) < MAX_PALM_COSINE
        if j in (k - 1, k) or min(abs(key.time - other.time) for other in keys[k - 1 : k + 1]) >= MIN_KEY_SPACING
    ]
    ends = [row for row in neighbours if row[0] in (keys[k - 1], keys[k])]
    if len(ends) < 2 or all(np.array_equal(*pair) for pair in list(zip(*ends, strict=True))[1:]):
        return None
    near, pointing, palm = zip(*neighbours, strict=True)
    return RotationSpline.through(
        [key.time for key in near], facing_rotations(np.array(pointing), np.array(palm)), [key.passage for key in near]
    )


def _facing_along(start: HandKey, end: HandKey, path: HandPath) -> RotationSpline | None:
    """Interpolate the captured hand orientation along a path by a spline.

    The result is None without a captured orientation, or if a direction is undefined.
    """
    first, last, course = start.hand.reach, end.hand.reach, path.course
    if first is None or last is None or course is None or course.pointing is None or course.palm is None:
        return None
    if first.pointing is None or first.palm is None or last.pointing is None or last.palm is None:
        return None
    pointing = np.vstack([first.pointing, course.pointing, last.pointing])
    palm = np.vstack([first.palm, course.palm, last.palm])
    if float(np.abs(np.sum(pointing * palm, axis=1)).max()) >= MAX_PALM_COSINE:
        return None
    times = start.time + (end.time - start.time) * course.knots
    return RotationSpline.through(
        [float(time) for time in times], facing_rotations(pointing, palm), [PLAIN_PASSAGE] * len(times)
    )


def _turn_hand(hand: Hand, turning: RotationSpline | None, time: float) -> Hand:
    """Rotate a hand to a spline's orientation at a time [s].

    Without a spline or reach, the hand is unchanged.
    """
    if hand.reach is None or turning is None:
        return hand
    pointing, _, palm = turning.at(np.array([time]))[0].T
    return replace(hand, reach=structs.replace(hand.reach, pointing=sealed(pointing), palm=sealed(palm)))


@dataclass(frozen=True)
class PathVelocity:
    """Velocity profile of a hand along a curved path."""

    power: float  # power parameter of the gesture, -1 weak .. 1 forceful
    has_late_peak: bool = False  # whether the peak velocity is at the path's end, where a word sounds
    start: float = 0.0  # initial velocity / constant velocity, for a hand already in motion


def path_keys_between(
    keys: Sequence[HandKey], k: int, path: HandPath | None, *, unit: float, velocity: PathVelocity
) -> list[HandKey]:
    """Sample a curved hand path as intermediate keys between two stroke keys.

    There are as many as the curve needs, but not closer in time than keys may be; none if the hand rests or moves
    straight.

    Args:
        keys: of the whole stroke.
        k: index of the key at the end of the path.
        path: in the world; None: straight.
        unit: the arm length [m].
        velocity: profile along the path.
    """
    a, b = keys[k - 1], keys[k]
    start, end = a.hand.reach, b.hand.reach
    if path is None or start is None or end is None:
        return []
    parameters = path.samples(start.position, end.position, PATH_TOLERANCE * unit, PATH_STEP * unit)
    if path.course is None:
        brake = WORD_BRAKE_TIME / (b.time - a.time) if velocity.has_late_peak else None
        fractions = _time_fractions(
            parameters, path.swings(start.position, end.position), velocity.power, brake, velocity.start
        )
    else:
        fractions = parameters
    times = a.time + (b.time - a.time) * fractions
    positions = path.at(start.position, end.position, parameters)
    path_keys, turning = list[HandKey](), _facing_along(keys[k - 1], keys[k], path) or _facing_between(keys, k)
    for parameter, time, position in zip(parameters, map(float, times), positions, strict=True):
        if min(time - (path_keys[-1].time if path_keys else a.time), b.time - time) >= MIN_KEY_SPACING:
            hand = _turn_hand(interpolate_hands(a.hand, b.hand, float(parameter), start), turning, time)
            path_keys.append(HandKey(time, _move_hand(hand, position)))
    return path_keys


def _inverse_jacobians(rotations: Floats) -> Floats:
    """Return the inverse right Jacobians of rotation vectors.

    They map angular velocities in the body frame to derivatives of the rotation vectors.
    """
    angles = np.maximum(np.linalg.norm(rotations, axis=1), MIN_ROTATION)[:, None, None]
    x, y, z = rotations.T
    none = np.zeros_like(x)
    cross = np.stack([none, -z, y, z, none, -x, -y, x, none], axis=1).reshape(-1, 3, 3)
    coefficient = 1 / angles**2 - (1 + np.cos(angles)) / (2 * angles * np.sin(angles))
    return np.asarray(np.eye(3) + cross / 2 + coefficient * cross @ cross)


def _time_fractions(
    parameters: Floats, swings: int, power: float, brake: float | None, start_velocity: float
) -> Floats:
    """Return the time fractions (m,) at which the hand passes path parameters.

    The hand accelerates in half a swing and decelerates in the last half, later and more suddenly without power.
    Greta's t^2 has its peak velocity at the very end, where servos would have to stop at once. With a late peak the
    hand accelerates all the way, and decelerates in the fraction `brake` of the time.
    """
    ramp = min(0.5, 0.5 * (1.0 + POWER_RAMP_GAIN * power) / swings)
    brake, ramp_velocity = (ramp, 1.0) if brake is None else (min(brake, WORD_BRAKE_FRACTION * ramp), LATE_PEAK_RATIO)
    time = np.linspace(0.0, 1.0, 501)
    speed = np.interp(time, [0.0, ramp, 1.0 - brake, 1.0], [start_velocity, ramp_velocity, 1.0, 0.0])
    travel = np.concatenate([[0.0], np.cumsum(speed[1:] + speed[:-1])])
    return np.interp(parameters, travel / travel[-1], time)


def _move_hand(hand: Hand, position: Floats) -> Hand:
    reach = hand.reach
    new_reach = None if reach is None else structs.replace(reach, position=sealed(position))
    return replace(hand, reach=new_reach, passing=True)
