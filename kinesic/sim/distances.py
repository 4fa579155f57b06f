"""Self-distance of a robot: smallest distances between capsules of its segments.

All postures of a motion are measured at once. The fingers of a hand count as one body. A ball around everything that
they can reach stands for them, so that they cost nothing while the hand is far away. Once the ball is near another
capsule, the fingers themselves are measured.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Flags, Floats, Indices, find_distinct_rows, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Capsule
from kinesic.sim.fingers import FingerPlaces, compute_finger_hull
from kinesic.sim.kinematics import MotionFrames, body_frames, compile_frames
from kinesic.sim.reaches import compute_capsule_reach, compute_pair_reaches, suspects

POSTURES_PER_BATCH = 512  # number of postures per call of the forward kinematics
POSTURES_PER_WINDOW = 4096  # number of postures whose frames are in memory at the same time
SAME_POSTURE_TOLERANCE = 1e-5  # [rad] grid to which angles are rounded to find equal postures
FINGER_BALL_DISTANCE = 0.03  # [m] distance to the fingers' bounding ball up to which single fingers are always measured
MAX_EXACT_FINGER_GAP = 0.13  # [m] default finger distance up to which `gaps` is exact; larger ones are lower bounds


class CapsuleDistances:
    """Calculator of distances between the segments checked for self-collision.

    Implements `body.dynamics.Distances`.
    """

    def __init__(self, robot: Robot) -> None:
        """List the capsule pairs whose distances are checked.

        Args:
            robot: Description with capsules and counted pairs of segments.
        """
        self._robot, self._skeleton, segment = robot, robot.skeleton, robot.skeleton.segment
        hands = _find_hands(robot)
        self._fingers = [FingerPlaces(robot, side) for side, _ in hands]
        fingers = {segment(name) for side, _ in hands for name in robot.fingers(side)}
        capsules = [(k, c) for k, part in enumerate(robot.skeleton.segments) for c in part.capsules]
        plain_capsules = [(k, c) for k, c in capsules if k not in fingers]
        hulls = {f"{side}_fingers": compute_finger_hull(robot, side) for side in SIDES if robot.fingers(side)}
        self._capsules = [*plain_capsules, *((robot.arm(side).wrist, hulls[name]) for side, name in _find_hands(robot))]
        self._owners = [k for k, _ in self._capsules]
        self._starts, self._ends = _stack_ends(self._capsules)
        owners = [robot.skeleton.segments[k].name for k, _ in plain_capsules] + list(hulls)
        counted = {pair: k for k, pair in enumerate(robot.counted_pairs)}
        pairs = [(i, j) for i, a in enumerate(owners) for j, b in enumerate(owners) if (a, b) in counted]
        self._first, self._second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        self._names = [(owners[i], owners[j]) for i, j in pairs]
        self._counted, self._of = len(counted), [counted[names] for names in self._names]
        radii = np.array([capsule.radius for _, capsule in self._capsules])
        halves = np.array([np.linalg.norm(capsule.end - capsule.start) / 2 for _, capsule in self._capsules])
        self._radii = radii[self._first] + radii[self._second]  # (p,) [m]
        self._halves = halves[self._first] + halves[self._second]  # (p,) [m]
        members = [[k] for k in range(len(plain_capsules))]  # measured capsules represented by each capsule or ball
        self._members = list(plain_capsules)
        for hand in self._fingers:
            members.append([*range(len(self._members), len(self._members) + len(hand.capsules))])
            self._members += hand.capsules
        self._plain_owners, self._plain_sides = [k for k, _ in plain_capsules], _stack_ends(plain_capsules)
        self._member_radii = np.array([capsule.radius for _, capsule in self._members])
        self._begins = np.cumsum([0, *map(len, members)])  # (b + 1,) first member of each capsule or ball
        self._hulled = np.array([max(pair) >= len(plain_capsules) for pair in pairs], dtype=np.bool_)  # (p,)
        reach = [compute_capsule_reach(robot.skeleton, k, capsule) for k, capsule in self._members]
        reaches = np.array([np.max([reach[k] for k in row], axis=0) for row in members])
        self._reaches = compute_pair_reaches(reaches.reshape(-1, len(robot.skeleton.hinges)), pairs)  # (p, n) [m]

    def clearance(self, angles: Floats) -> Clearance:
        """Compute the smallest distance between checked capsules in each posture.

        Consecutive equal postures are measured once.

        Args:
            angles: (m, n) [rad] in joint order.

        Returns:
            Distance and pair of segments for each posture; infinite for a robot without counted pairs.
        """
        chosen, back = find_distinct_rows(angles, SAME_POSTURE_TOLERANCE)
        distances, pairs = self._find_nearest(angles, chosen)
        return self._named(distances[back], pairs[back])

    def gaps(self, angles: Floats, *, exact_below: float = MAX_EXACT_FINGER_GAP) -> Floats:
        """Measure the distances between the segments of every checked pair.

        Args:
            angles: (m, n) [rad] in joint order.
            exact_below: [m] finger distance up to which values are exact; a small one is much faster.

        Returns:
            (m, p) [m] in the order of `Robot.counted_pairs`; infinite where a segment has no capsule. For fingers,
            larger values may be lower bounds.
        """
        gaps = np.full((self._counted, len(angles)), np.inf)
        if self._names:
            frames = body_frames(self._robot, angles)
            pair_distances = np.empty((len(self._names), len(angles)))
            placements = np.ascontiguousarray(frames.rotations), np.ascontiguousarray(frames.origins)
            _compile_pairs(self).gaps(*placements, pair_distances)
            self._measure_fingers(
                pair_distances, (pair_distances < exact_below) & self._hulled[:, None], frames, angles
            )
            for pair, row in zip(self._of, pair_distances, strict=True):  # several times as fast as np.minimum.at
                np.minimum(gaps[pair], row, out=gaps[pair])
        return sealed(gaps.T)

    def approach(
        self,
        angles: Floats,
        ends: Indices,
        *,
        near: float,
        minimum_elsewhere: float = np.inf,
        end_distances: Floats | None = None,
    ) -> Clearance:
        """Find the closest approach in each interval of a motion.

        Only postures that can be the closest are measured: a rotation of a hinge brings two capsules closer by at
        most its angle times the reach of the hinge, so most postures between two measured ones are certainly farther
        apart.

        Args:
            angles: (s, n) [rad] postures of the motion.
            ends: (m,) non-decreasing index of the last posture of each interval; an interval begins after the
                previous one.
            near: [m] every approach below this distance is found.
            minimum_elsewhere: [m] smallest distance found in other parts of the motion.
            end_distances: (p, m) [m] result of `lowest` for the postures at the ends, if already computed.

        Returns:
            Distance and pair for each interval. The distance is the minimum over all postures of the interval if that
            minimum is below `near`, or below `minimum_elsewhere` and below the distance at every end. Otherwise it is
            the distance at the end of the interval. The smallest returned distance is that of the whole motion.
        """
        if not self._names or not len(ends):
            return self.clearance(angles[ends])
        if end_distances is None:
            end_distances = self.lowest(body_frames(self._robot, angles[ends]), angles[ends])
        distances, pairs = np.full(len(angles), np.inf), np.zeros(len(angles), dtype=np.intp)
        pairs[ends] = end_distances.argmin(axis=0)
        distances[ends] = end_distances.min(axis=0)
        limit = max(near, min(minimum_elsewhere, float(end_distances.min())))
        candidates = suspects(angles, ends, end_distances, self._reaches, limit=limit)
        distances[candidates], pairs[candidates] = self._find_nearest(angles, candidates)
        chosen, stretches = ends.copy(), np.searchsorted(ends, candidates)
        nearer = np.flatnonzero(distances[candidates] < distances[ends[stretches]])
        nearer = nearer[np.argsort(-distances[candidates][nearer], kind="stable")]
        chosen[stretches[nearer]] = candidates[
            nearer
        ]  # of several in an interval the last one stays, which is the nearest
        return self._named(distances[chosen], pairs[chosen])

    def bounds(self, angles: Floats, turns: Floats) -> Floats:
        """Compute lower bounds of the self-distance within given deviations from postures.

        The bound subtracts the largest approach that the hinges between the segments of a pair can cause.

        Args:
            angles: (m, n) [rad].
            turns: (m, n) [rad] largest deviation of each hinge from its angle, in either direction.

        Returns:
            (m,) [m].
        """
        if not self._names:
            return np.full(len(angles), np.inf)
        lowest = self.survey(angles, ())[0] - self._reaches @ turns.T
        return np.asarray(lowest.min(axis=0))

    def _named(self, distances: Floats, pairs: Indices) -> Clearance:
        names = self._names or [("", "")]
        return Clearance(sealed(distances), [names[k] for k in pairs])

    def _find_nearest(self, angles: Floats, chosen: Indices) -> tuple[Floats, Indices]:
        """Return distance and index of the closest pair in selected postures.

        Args:
            angles: (m, n) [rad] postures.
            chosen: (c,) indices of the selected postures.

        Returns:
            (c,) [m] and (c,) index among the counted pairs of capsules.
        """
        distances, pairs = np.full(len(chosen), np.inf), np.zeros(len(chosen), dtype=np.int64)
        count = len(chosen) if self._names else 0
        for block in (slice(k, k + POSTURES_PER_BATCH) for k in range(0, count, POSTURES_PER_BATCH)):
            postures = angles[chosen[block]]
            if not self._fingers:
                _compile_pairs(self).nearest(*self._pack_postures(postures), distances[block], pairs[block])
                continue
            lowest = self.lowest(body_frames(self._robot, postures), postures)
            distances[block], pairs[block] = lowest.min(axis=0), lowest.argmin(axis=0)
        return distances, pairs

    def lowest(self, frames: MotionFrames, angles: Floats) -> Floats:
        """Compute each capsule pair's distance in each posture, or a lower bound.

        Args:
            frames: Frames of all segments except fingers in m postures.
            angles: (m, n) [rad] of the same postures.

        Returns:
            (p, m) [m]; for pairs that cannot be the closest of a posture, a lower bound.
        """
        if not self._names:
            return np.empty((0, len(angles)))
        lowest = np.empty((len(self._names), len(angles)))
        placements = np.ascontiguousarray(frames.rotations), np.ascontiguousarray(frames.origins)
        _compile_pairs(self).closest(*placements, lowest)
        near = np.maximum(lowest[~self._hulled].min(axis=0, initial=np.inf), FINGER_BALL_DISTANCE)
        self._measure_fingers(lowest, (lowest <= near) & self._hulled[:, None], frames, angles)
        return lowest

    def survey(self, angles: Floats, segments: Sequence[int]) -> tuple[Floats, Floats]:
        """Compute pair distances, or lower bounds, and segment origins in all postures.

        The frames of all postures are never in memory at the same time.

        Args:
            angles: (m, n) [rad] in joint order.
            segments: Indices of the segments whose origins are returned.

        Returns:
            (p, m) [m] distance of each pair or a lower bound, as in `lowest`; (k, m, 3) [m] origins in the world.
        """
        if self._names and not self._fingers:
            lowest, origins = np.empty((len(self._names), len(angles))), np.empty((len(segments), len(angles), 3))
            origin_segments = np.array(segments, dtype=np.intp)
            _compile_pairs(self).survey(*self._pack_postures(angles), origin_segments, lowest, origins)
            return lowest, origins
        pair_distances = []
        for block in (angles[k : k + POSTURES_PER_WINDOW] for k in range(0, len(angles), POSTURES_PER_WINDOW)):
            frames = body_frames(self._robot, block)
            pair_distances.append((self.lowest(frames, block), frames.origins[list(segments)].transpose(0, 2, 1)))
        lowest, origins = (np.concatenate(parts, axis=1) for parts in zip(*pair_distances, strict=True))
        return lowest, origins

    def _pack_postures(self, angles: Floats) -> tuple[kernel.MotionFrames, Flags, Floats, Floats]:
        """Pack the skeleton and the postures' sines and cosines for the kernel.

        Args:
            angles: (m, n) [rad].
        """
        turns = np.ascontiguousarray(self._skeleton.with_couplings(angles).T)
        chosen = np.ones(len(self._skeleton.segments), dtype=np.bool_)
        return compile_frames(self._skeleton), chosen, np.sin(turns), np.cos(turns)

    def compiled(self) -> kernel.CapsulePairs:
        """Pack the pairs of capsules for the kernel.

        The result is not stored in the object, which is pickled for other processes.
        """
        return kernel.make_pairs(
            np.array(self._owners, dtype=np.int64),
            self._starts,
            self._ends,
            self._first,
            self._second,
            self._radii,
            self._halves,
            self._hulled,
        )

    def _measure_fingers(self, gaps: Floats, near: Flags, frames: MotionFrames, angles: Floats) -> None:
        """Replace distances to the fingers' bounding ball by exact finger distances.

        Args:
            gaps: (p, m) [m] of all pairs; updated in place.
            near: (p, m) true where the ball is so near that the fingers must be measured.
            frames: Frames of all segments except fingers.
            angles: (m, n) [rad].
        """
        postures = np.flatnonzero(near.any(axis=0))
        if not len(postures):
            return
        placements = frames.at(postures)
        origin_segments = {
            body for row in np.flatnonzero(near.any(axis=1)) for body in (self._first[row], self._second[row])
        }
        parts = [placements.axes(self._plain_owners, *self._plain_sides)]
        for body, hand in enumerate(self._fingers, start=len(self._plain_owners)):
            nowhere = np.zeros((len(hand.capsules), 3, len(postures)))
            parts.append(hand.ends(angles[postures], placements) if body in origin_segments else (nowhere, nowhere))
        starts, ends = (np.concatenate(side) for side in zip(*parts, strict=True))
        first, second, radii = self._first, self._second, self._member_radii
        kernel.measure_bodies(self._begins, radii, first, second, starts, ends, postures, near, gaps)


@lru_cache(maxsize=8)
def _compile_pairs(distances: CapsuleDistances) -> kernel.CapsulePairs:
    return distances.compiled()


def _find_hands(robot: Robot) -> list[tuple[Side, str]]:
    """Return side and collision-group name of each hand with fingers."""
    return [(side, f"{side}_fingers") for side in SIDES if robot.fingers(side)]


def _stack_ends(capsules: Sequence[tuple[int, Capsule]]) -> tuple[Floats, Floats]:
    """Return start and end points of capsules in segment frames.

    Each array is (c, 3) [m].
    """
    starts, ends = ([getattr(capsule, side) for _, capsule in capsules] for side in ("start", "end"))
    return np.array(starts).reshape(-1, 3), np.array(ends).reshape(-1, 3)
