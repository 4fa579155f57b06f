"""How close the robot comes to itself: exact distances between capsules, for a whole motion at once."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import Robot
from kinesic.sim.kinematics import MotionFrames, motion_frames

Indices = NDArray[np.intp]

BLOCK = 512  # postures at once, so that the arrays stay in the cache


class CapsuleDistances:
    """Self-distance of a robot over its counted pairs; implements `body.dynamics.Distances`."""

    def __init__(self, robot: Robot) -> None:
        """Lists the pairs of capsules that count.

        Args:
            robot: whose capsules, and whose counted pairs of segments.
        """
        self._skeleton = robot.skeleton
        self._capsules = [(k, c) for k, segment in enumerate(robot.skeleton.segments) for c in segment.capsules]
        owners = [robot.skeleton.segments[k].name for k, _ in self._capsules]
        counted = set(robot.counted_pairs)
        pairs = [(i, j) for i, a in enumerate(owners) for j, b in enumerate(owners) if (a, b) in counted]
        self._first, self._second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        self._names = [(owners[i], owners[j]) for i, j in pairs]
        radii = np.array([capsule.radius for _, capsule in self._capsules])
        halves = np.array([np.linalg.norm(capsule.end - capsule.start) / 2 for _, capsule in self._capsules])
        self._radii = radii[self._first] + radii[self._second]  # (p,) [m]
        self._halves = halves[self._first] + halves[self._second]  # (p,) [m]

    def clearance(self, angles: Floats) -> Clearance:
        """Smallest distance between the capsules of counted pairs.

        Args:
            angles: (m, n) [rad] in joint order.

        Returns:
            Distance and pair of segments for each posture; infinite for a robot without counted pairs.
        """
        if not self._names or not len(angles):
            return Clearance(sealed(np.full(len(angles), np.inf)), [("", "")] * len(angles))
        blocks = [self._closest(angles[k : k + BLOCK]) for k in range(0, len(angles), BLOCK)]
        closest = np.concatenate([pair for _, pair in blocks])
        return Clearance(sealed(np.concatenate([d for d, _ in blocks])), [self._names[k] for k in closest])

    def _closest(self, angles: Floats) -> tuple[Floats, Indices]:
        """(m,) [m] and index of the closest pair of capsules, for (m, n) [rad]."""
        starts, ends = self._axes(motion_frames(self._skeleton, angles))
        middles = (starts + ends) / 2
        between = middles[self._first] - middles[self._second]
        above = np.sqrt(np.einsum("pkm,pkm->pm", between, between)) - self._radii[:, None]
        # the axes' middles bound the distance from above, less their half lengths from below
        pairs, postures = np.nonzero(above - self._halves[:, None] <= above.min(axis=0))
        i, j = self._first[pairs], self._second[pairs]
        axes = (starts[i, :, postures], ends[i, :, postures], starts[j, :, postures], ends[j, :, postures])
        exact = segment_distances(*axes) - self._radii[pairs]
        distances = np.full(above.shape, np.inf)
        distances[pairs, postures] = exact
        closest = distances.argmin(axis=0)
        return distances[closest, np.arange(len(angles))], closest

    def _axes(self, frames: MotionFrames) -> tuple[Floats, Floats]:
        """(c, 3, m) [m] starts and ends of the capsules' axes in the world."""
        starts = np.array([frames.points(k, capsule.start) for k, capsule in self._capsules])
        ends = np.array([frames.points(k, capsule.end) for k, capsule in self._capsules])
        return starts, ends


def segment_distances(a0: Floats, a1: Floats, b0: Floats, b1: Floats) -> Floats:
    """Distances between straight segments, after Ericson, Real-Time Collision Detection, 5.1.9.

    Args:
        a0: (k, 3) [m] one end of the first segments; may equal the other.
        a1: (k, 3) [m] their other end.
        b0: (k, 3) [m] one end of the second segments.
        b1: (k, 3) [m] their other end.

    Returns:
        (k,) [m].
    """
    along_a, along_b, apart = a1 - a0, b1 - b0, a0 - b0
    aa, bb, ab = _dot(along_a, along_a), _dot(along_b, along_b), _dot(along_a, along_b)
    ar, br = _dot(along_a, apart), _dot(along_b, apart)
    s = _share(ab * br - ar * bb, aa * bb - ab * ab)  # of the unbounded lines; any s serves parallel ones
    t = _share(ab * s + br, bb)
    s = _share(ab * t - ar, aa)
    gap = apart + s[:, None] * along_a - t[:, None] * along_b
    return cast(Floats, np.sqrt(_dot(gap, gap)))


def _dot(a: Floats, b: Floats) -> Floats:
    return cast(Floats, np.einsum("kc,kc->k", a, b))


def _share(part: Floats, whole: Floats) -> Floats:
    """The quotient of part and whole within 0..1, and 0 where the whole vanishes."""
    share = np.zeros_like(part)
    np.divide(part, whole, out=share, where=whole > np.finfo(float).tiny)
    return np.clip(share, 0.0, 1.0, out=share)
