"""One hand in time: its keys, where it is and how it turns between them, and what lies on its path.

A hand turns through its keys on Kochanek-Bartels splines of rotations. Between two keys the logarithm of the rotation
from the first is a cubic (Hermite), whose ends have the turning speeds of the keys; these are weighted as those of
positions are (sheet of the trajectory, 8.2). Speeds are the same before and after each key, so that nothing jumps.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.blending import between
from kinesic.expressivity.hands.poses import REST
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.turns import MERGE
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage
from kinesic.motion.piecewise import PiecewisePolynomial

PARALLEL = 0.99  # cosine of pointing and palm from which on they say no rotation
SAMPLING = 0.01  # [arm lengths] that a path may be off the straight way between two of its samples
PATH_STEP = (
    0.2  # [arm lengths] from sample to sample at most: between them hinges turn evenly, and the hand leaves its path
)
SURGE = 0.5  # by how much longer full power makes the hand speed up along a path
BEGUN = 0.5  # of the largest speed, which who is fastest at the end has after its first swing
BRAKE, BRAKING = 0.12, 0.5  # [s], and of the time of speeding up, in which a path ends at a word
SMALL = 1e-6  # [rad] turns that are none


@dataclass(frozen=True, eq=False)
class HandKey:
    """One hand at one time."""

    time: float  # [s] block time
    hand: Hand
    passage: KeyPassage = PLAIN_PASSAGE


@dataclass(frozen=True, eq=False)
class Turning:
    """A rotation as a function of time; constant before its first key and after its last."""

    times: Floats  # (k,) [s]
    keys: "scipy.spatial.transform.Rotation"  # k of them
    turns: PiecewisePolynomial  # (3,) rotation vector from the key before, in that key's frame

    @classmethod
    def through(
        cls, times: Sequence[float], keys: "scipy.spatial.transform.Rotation", passages: Sequence[KeyPassage]
    ) -> "Turning":
        """Through at least two keys, the short way from each to the next; at rest at both ends and in holds.

        Args:
            times: of the keys, increasing [s].
            keys: as many rotations.
            passages: as many, of which tension, continuity, swing and bias count.
        """
        at = np.asarray(times, dtype=float)
        steps = np.diff(at)[:, None]
        ways = (keys[:-1].inv() * keys[1:]).as_rotvec()
        bias, flow = (
            np.array([[getattr(each, name)] for each in passages[1:-1]]).reshape(-1, 1) for name in ("bias", "flow")
        )
        speeds = np.zeros((len(at), 3))
        earlier, later = ways[:-1] / steps[:-1] * steps[1:], ways[1:] / steps[1:] * steps[:-1]
        chords = (1 + bias) * earlier + (1 - bias) * later
        speeds[1:-1] = flow * chords / (steps[:-1] + steps[1:])
        still = np.linalg.norm(ways, axis=1) < SMALL
        speeds[:-1][still] = speeds[1:][still] = 0.0
        ends = np.einsum("kij,kj->ki", _inverse_jacobians(ways), speeds[1:])
        square = (3 * ways / steps - 2 * speeds[:-1] - ends) / steps
        cube = (speeds[:-1] + ends - 2 * ways / steps) / steps**2
        turns = np.stack([cube, square, speeds[:-1], np.zeros_like(ways)])
        return cls(at, keys, PiecewisePolynomial(sealed(at), sealed(turns)))

    def at(self, times: Floats) -> "scipy.spatial.transform.Rotation":
        """The rotations at (m,) times [s]."""
        inside = np.clip(times, self.times[0], self.times[-1])
        way = np.clip(np.searchsorted(self.times, inside, side="right") - 1, 0, len(self.times) - 2)
        return self.keys[way] * scipy.spatial.transform.Rotation.from_rotvec(self.turns.at(inside))


def facing_rotations(pointing: Floats, palm: Floats) -> "scipy.spatial.transform.Rotation":
    """The rotations of hands from the directions (..., 3) in which they point and in which their palms face."""
    aside = np.cross(palm, pointing)
    aside /= np.linalg.norm(aside, axis=-1, keepdims=True)
    return scipy.spatial.transform.Rotation.from_matrix(np.stack([pointing, aside, np.cross(pointing, aside)], axis=-1))


def hand_at(keys: Sequence[HandKey], time: float, rest: Reach) -> Hand:
    """Finds the hand at a time, straight between its keys, constant outside them."""
    k = bisect_right(keys, time, key=lambda key: key.time)
    if k == 0 or k == len(keys):
        return keys[min(k, len(keys) - 1)].hand if keys else REST
    a, b = keys[k - 1], keys[k]
    return between(a.hand, b.hand, (time - a.time) / (b.time - a.time), rest)


def _face_between(hand: Hand, keys: Sequence[HandKey], k: int, time: float) -> Hand:
    """Turns a hand between the keys k - 1 and k as a spline through them and their neighbours does.

    So its turning speed does not jump at the keys, which matters where what lies between them becomes keys, too. As it
    is where they do not turn it, or leave its pointing or its palm open.
    """
    about = [
        (key, reach.pointing, reach.palm)
        for j, key in enumerate(keys[max(0, k - 2) : k + 2], max(0, k - 2))
        if (reach := key.hand.reach) and reach.pointing is not None and reach.palm is not None
        if abs(reach.pointing @ reach.palm) < PARALLEL
        if j in (k - 1, k) or min(abs(key.time - other.time) for other in keys[k - 1 : k + 1]) >= MERGE
    ]
    ends = [row for row in about if row[0] in (keys[k - 1], keys[k])]
    if hand.reach is None or len(ends) < 2 or all(np.array_equal(*pair) for pair in list(zip(*ends, strict=True))[1:]):
        return hand
    near, pointing, palm = zip(*about, strict=True)
    turning = Turning.through(
        [key.time for key in near], facing_rotations(np.array(pointing), np.array(palm)), [key.passage for key in near]
    )
    along, _, facing_there = turning.at(np.array([time])).as_matrix()[0].T
    return replace(hand, reach=structs.replace(hand.reach, pointing=sealed(along), palm=sealed(facing_there)))


def along(
    keys: Sequence[HandKey], k: int, path: HandPath | None, *, unit: float, power: float, late: bool = False
) -> list[HandKey]:
    """Makes keys on a path, without those that it joins; none where the hand rests, or goes straight.

    They are as many as the curve needs, but no nearer to one another in time than keys may be.

    Args:
        keys: of the whole stroke.
        k: the key that the path leads to, from the one before.
        path: in the world; None: straight.
        unit: the arm length [m].
        power: of the gesture.
        late: whether the hand is fastest at the end of the path, as a word sounds there.
    """
    a, b = keys[k - 1], keys[k]
    start, end = a.hand.reach, b.hand.reach
    if path is None or start is None or end is None:
        return []
    shares = path.samples(start.position, end.position, SAMPLING * unit, PATH_STEP * unit)
    brake = BRAKE / (b.time - a.time) if late else None
    times = a.time + (b.time - a.time) * _when(shares, path.swings(start.position, end.position), power, brake)
    positions = path.at(start.position, end.position, shares)
    found: list[HandKey] = []
    for share, time, position in zip(shares, map(float, times), positions, strict=True):
        if min(time - (found[-1].time if found else a.time), b.time - time) >= MERGE:
            hand = _face_between(between(a.hand, b.hand, float(share), start), keys, k, time)
            found.append(HandKey(time, _moved(hand, position)))
    return found


def _inverse_jacobians(ways: Floats) -> Floats:
    """(k, 3, 3) from turning speeds in the body to the change of (k, 3) rotation vectors (right Jacobian, inverted)."""
    angles = np.maximum(np.linalg.norm(ways, axis=1), SMALL)[:, None, None]
    x, y, z = ways.T
    none = np.zeros_like(x)
    cross = np.stack([none, -z, y, z, none, -x, -y, x, none], axis=1).reshape(-1, 3, 3)
    bend = 1 / angles**2 - (1 + np.cos(angles)) / (2 * angles * np.sin(angles))
    return np.asarray(np.eye(3) + cross / 2 + bend * cross @ cross)


def _when(shares: Floats, swings: int, power: float, brake: float | None) -> Floats:
    """(m,) shares of the time at which (m,) shares of a path are reached.

    The hand speeds up in half a swing and slows down in the last half, later and more suddenly without power.
    Greta's t^2 is fastest at the very end, where servos would have to stop it at once. Who is late speeds up all the
    way, and slows down in a share `brake` of the time.
    """
    ramp = min(0.5, 0.5 * (1.0 + SURGE * power) / swings)
    brake, begun = (ramp, 1.0) if brake is None else (min(brake, BRAKING * ramp), BEGUN)
    time = np.linspace(0.0, 1.0, 501)
    speed = np.interp(time, [0.0, ramp, 1.0 - brake, 1.0], [0.0, begun, 1.0, 0.0])
    along = np.concatenate([[0.0], np.cumsum(speed[1:] + speed[:-1])])
    return np.interp(shares, along / along[-1], time)


def _moved(hand: Hand, position: Floats) -> Hand:
    reach = hand.reach
    moved = None if reach is None else structs.replace(reach, position=sealed(position))
    return replace(hand, reach=moved, passing=True)
