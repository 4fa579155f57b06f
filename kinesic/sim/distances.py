"""How close the robot comes to itself: exact distances between capsules, for a whole motion at once.

The fingers of a hand are one body. A ball about all that they can reach stands for them, so that they cost nothing
where the hand is far from everything; where the ball is near, the fingers themselves are measured.
"""

from collections.abc import Sequence
from itertools import product
from typing import cast

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, distinct_rows, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Capsule, Segment, Skeleton
from kinesic.sim.fingers import FingerPlaces, finger_hull
from kinesic.sim.kinematics import MotionFrames, body_frames

BLOCK = 512  # postures whose kinematics are computed at once
STRIP = 128  # of them at once for all pairs, so that arrays stay in the cache and products on one core
PRODUCT = 300_000  # multiplications of a matrix product that stays on one core
SAME = 1e-5  # [rad] postures that differ by less are one: no capsule is farther off than 0.01 mm for each hinge
SHORTEST = 1e-9  # [m] of a reach that is not none
NEAR = 0.03  # [m] the ball about fingers comes to something, from which on they are measured in a motion
SIGHT = 0.13  # [m] likewise where gaps are asked for: those that are wider are no less than they are said to be


class CapsuleDistances:
    """Self-distance of a robot over its counted pairs; implements `body.dynamics.Distances`."""

    def __init__(self, robot: Robot) -> None:
        """Lists the pairs of capsules that count.

        Args:
            robot: whose capsules, and whose counted pairs of bodies.
        """
        self._robot, self._skeleton, segment = robot, robot.skeleton, robot.skeleton.segment
        hands = _hands(robot)
        self._fingers = [FingerPlaces(robot, side) for side, _ in hands]
        fingers = {segment(name) for side, _ in hands for name in robot.fingers(side)}
        every = [(k, c) for k, part in enumerate(robot.skeleton.segments) for c in part.capsules]
        plain = [(k, c) for k, c in every if k not in fingers]
        hulls = {f"{side}_fingers": finger_hull(robot, side) for side in SIDES if robot.fingers(side)}
        self._capsules = [*plain, *((robot.arm(side).wrist, hulls[name]) for side, name in _hands(robot))]
        self._owners = [k for k, _ in self._capsules]
        self._starts, self._ends = _sides(self._capsules)
        owners = [robot.skeleton.segments[k].name for k, _ in plain] + list(hulls)
        counted = {pair: k for k, pair in enumerate(robot.counted_pairs)}
        pairs = [(i, j) for i, a in enumerate(owners) for j, b in enumerate(owners) if (a, b) in counted]
        self._first, self._second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        self._names = [(owners[i], owners[j]) for i, j in pairs]
        self._counted, self._of = len(counted), [counted[names] for names in self._names]
        radii = np.array([capsule.radius for _, capsule in self._capsules])
        halves = np.array([np.linalg.norm(capsule.end - capsule.start) / 2 for _, capsule in self._capsules])
        self._radii = radii[self._first] + radii[self._second]  # (p,) [m]
        self._halves = halves[self._first] + halves[self._second]  # (p,) [m]
        members = [[k] for k in range(len(plain))]  # capsules that each one stands for
        self._members = list(plain)
        for hand in self._fingers:
            members.append([*range(len(self._members), len(self._members) + len(hand.capsules))])
            self._members += hand.capsules
        self._plain_owners, self._plain_sides = [k for k, _ in plain], _sides(plain)
        self._member_radii = np.array([capsule.radius for _, capsule in self._members])
        self._hulled = np.array([max(pair) >= len(plain) for pair in pairs], dtype=np.bool_)  # (p,)
        within = [np.array(list(product(members[i], members[j])), dtype=np.intp).T for i, j in pairs]
        self._within = _by_size(
            within, self._hulled
        )  # rows of pairs with as many pairs of capsules within, and these (2, r, k)
        reach = [_reach(robot.skeleton, k, capsule) for k, capsule in self._members]
        reaches = np.array([np.max([reach[k] for k in row], axis=0) for row in members])
        self._reaches = _reaches(reaches.reshape(-1, len(robot.skeleton.hinges)), pairs)  # (p, n) [m]

    def clearance(self, angles: Floats) -> Clearance:
        """Finds the smallest distance between the capsules of counted pairs; a posture that lasts is measured once.

        Args:
            angles: (m, n) [rad] in joint order.

        Returns:
            Distance and pair of segments for each posture; infinite for a robot without counted pairs.
        """
        chosen, back = distinct_rows(angles, SAME)
        distances, pairs = self._nearest(angles[chosen])
        return self._named(distances[back], pairs[back])

    def gaps(self, angles: Floats) -> Floats:
        """Measures the distances between the segments of every counted pair.

        Args:
            angles: (m, n) [rad] in joint order.

        Returns:
            (m, p) [m] in the order of `Robot.counted_pairs`; infinite where a segment has no capsule. Those of fingers
            that are wider than `SIGHT` may be wider still.
        """
        gaps = np.full((self._counted, len(angles)), np.inf)
        if self._names:
            frames = body_frames(self._robot, angles)
            starts, ends = (side.transpose(0, 2, 1) for side in self._axes(frames))
            first, second = self._first, self._second
            axes = (side.reshape(-1, 3) for side in (starts[first], ends[first], starts[second], ends[second]))
            found = segment_distances(*axes).reshape(len(first), -1) - self._radii[:, None]
            self._measure_fingers(found, (found < SIGHT) & self._hulled[:, None], frames, angles)
            np.minimum.at(gaps, self._of, found)
        return sealed(gaps.T)

    def approach(self, angles: Floats, ends: Indices, *, near: float, frames: MotionFrames | None = None) -> Clearance:
        """Finds the closest approach in each stretch of a motion, and measures only postures that may count.

        A turn of a hinge brings no two capsules nearer than by its angle times what the hinge can reach, so most
        postures between two measured ones are known to be further.

        Args:
            angles: (s, n) [rad] the postures of the motion.
            ends: (m,) where each stretch ends among them, never decreasing; it begins after the one before.
            near: [m] every approach below this is found.
            frames: of the m postures at the ends, when they are known already; fingers may be left out.

        Returns:
            Distance and pair for each stretch: the smallest of all its postures wherever that is below `near` or below
            that of every end, and so the smallest of all; elsewhere that of its end.
        """
        if not self._names or not len(ends):
            return self.clearance(angles[ends])
        lowest = self._strips(frames or body_frames(self._robot, angles[ends]), angles[ends])
        distances, pairs = np.full(len(angles), np.inf), np.zeros(len(angles), dtype=np.intp)
        pairs[ends] = lowest.argmin(axis=0)
        distances[ends] = lowest.min(axis=0)
        between = self._suspects(angles, ends, lowest, max(near, float(lowest.min())))
        distances[between], pairs[between] = self._nearest(angles[between])
        chosen, stretches = ends.copy(), np.searchsorted(ends, between)
        nearer = np.flatnonzero(distances[between] < distances[ends[stretches]])
        nearer = nearer[np.argsort(-distances[between][nearer], kind="stable")]
        chosen[stretches[nearer]] = between[nearer]  # of several in a stretch the last, which is the nearest, stays
        return self._named(distances[chosen], pairs[chosen])

    def _suspects(self, angles: Floats, known: Indices, lowest: Floats, limit: float) -> Indices:
        """Postures between known ones that may be nearer than a limit [m], by what the hinges between a pair reach."""
        unknown = np.ones(known[-1] + 1, dtype=bool)
        unknown[known] = False
        between = np.flatnonzero(unknown)
        after = np.searchsorted(known, between)
        lowest = np.ascontiguousarray(lowest.T)  # whole rows are looked up faster
        near = np.empty(len(between), dtype=bool)
        strip = max(1, min(STRIP, PRODUCT // self._reaches.size))
        for block in (slice(k, k + strip) for k in range(0, len(between), strip)):
            bounds = []
            for neighbour in (after[block], np.maximum(after[block] - 1, 0)):
                turned = np.abs(angles[between[block]] - angles[known[neighbour]])
                bounds.append(lowest[neighbour] - turned @ self._reaches.T)
            near[block] = np.maximum(*bounds).min(axis=1) < limit
        return between[near]

    def _named(self, distances: Floats, pairs: Indices) -> Clearance:
        names = self._names or [("", "")]
        return Clearance(sealed(distances), [names[k] for k in pairs])

    def _nearest(self, angles: Floats) -> tuple[Floats, Indices]:
        """(m,) [m] and index of the closest pair of capsules, for (m, n) [rad]."""
        if not self._names:
            return np.full(len(angles), np.inf), np.zeros(len(angles), dtype=np.intp)
        distances, pairs = np.empty(len(angles)), np.empty(len(angles), dtype=np.intp)
        for block in (slice(k, k + BLOCK) for k in range(0, len(angles), BLOCK)):
            lowest = self._strips(body_frames(self._robot, angles[block]), angles[block])
            distances[block], pairs[block] = lowest.min(axis=0), lowest.argmin(axis=0)
        return distances, pairs

    def _strips(self, frames: MotionFrames, angles: Floats) -> Floats:
        """(p, m) [m] distance of each pair in m postures; for those that cannot be the closest, a lower bound."""
        starts, ends = self._axes(frames)
        strips = [
            self._closest(starts[:, :, k : k + STRIP], ends[:, :, k : k + STRIP])
            for k in range(0, starts.shape[2], STRIP)
        ]
        lowest = np.concatenate(strips, axis=1)
        near = np.maximum(lowest[~self._hulled].min(axis=0, initial=np.inf), NEAR)
        self._measure_fingers(lowest, (lowest <= near) & self._hulled[:, None], frames, angles)
        return lowest

    def _closest(self, starts: Floats, ends: Floats) -> Floats:
        """The same from the capsules' axes, (c, 3, m) [m] each."""
        middles = (starts + ends) / 2
        between = middles[self._first] - middles[self._second]
        above = np.sqrt(np.einsum("pkm,pkm->pm", between, between)) - self._radii[:, None]
        # the axes' middles bound the distance from above, less their half lengths from below
        lowest: Floats = above - self._halves[:, None]
        pairs, postures = np.nonzero(lowest <= above[~self._hulled].min(axis=0, initial=np.inf))
        i, j = self._first[pairs], self._second[pairs]
        axes = (starts[i, :, postures], ends[i, :, postures], starts[j, :, postures], ends[j, :, postures])
        lowest[pairs, postures] = segment_distances(*axes) - self._radii[pairs]
        return lowest

    def _measure_fingers(self, gaps: Floats, near: Flags, frames: MotionFrames, angles: Floats) -> None:
        """Puts the distance of fingers in place of that of the ball about them.

        Args:
            gaps: (p, m) [m] of all pairs.
            near: (p, m) where the ball is so near that fingers count.
            frames: of all segments but fingers.
            angles: (m, n) [rad].
        """
        postures = np.flatnonzero(near.any(axis=0))
        if not len(postures):
            return
        placed = frames.at(postures)
        parts = [
            _placed(placed, self._plain_owners, *self._plain_sides),
            *(hand.ends(angles[postures], placed) for hand in self._fingers),
        ]
        starts, ends = (np.concatenate(side).transpose(0, 2, 1) for side in zip(*parts, strict=True))
        for rows, within in self._within:
            cells, here = np.nonzero(near[rows[:, None], postures])
            if not len(cells):
                continue
            first, second = within[:, cells]
            axes = (
                side[capsules, here[:, None]].reshape(-1, 3) for capsules in (first, second) for side in (starts, ends)
            )
            apart = segment_distances(*axes).reshape(first.shape)
            reach = self._member_radii[first] + self._member_radii[second]
            gaps[rows[cells], postures[here]] = (apart - reach).min(axis=1)

    def _axes(self, frames: MotionFrames) -> tuple[Floats, Floats]:
        """(c, 3, m) [m] starts and ends of the capsules' axes in the world."""
        return _placed(frames, self._owners, self._starts, self._ends)


def _by_size(within: Sequence[Indices], counted: Flags) -> list[tuple[Indices, Indices]]:
    """Puts counted pairs of bodies with as many pairs of capsules within together."""
    sizes = np.array([pairs.shape[1] for pairs in within], dtype=np.intp)
    rows = [np.flatnonzero((sizes == size) & counted) for size in np.unique(sizes[counted])]
    return [(row, np.stack([within[int(k)] for k in row], axis=1)) for row in rows]


def _hands(robot: Robot) -> list[tuple[Side, str]]:
    """Sides with fingers, and how these are called together."""
    return [(side, f"{side}_fingers") for side in SIDES if robot.fingers(side)]


def _sides(capsules: Sequence[tuple[int, Capsule]]) -> tuple[Floats, Floats]:
    """(c, 3) [m] starts and ends of capsules in their segments."""
    starts, ends = ([getattr(capsule, side) for _, capsule in capsules] for side in ("start", "end"))
    return np.array(starts).reshape(-1, 3), np.array(ends).reshape(-1, 3)


def _placed(frames: MotionFrames, owners: list[int], starts: Floats, ends: Floats) -> tuple[Floats, Floats]:
    """(c, 3, m) [m] the same in the world."""
    origins, rotations = frames.origins[owners], frames.rotations[owners]
    here, there = (origins + (side[:, None, None, :] @ rotations)[:, :, 0, :] for side in (starts, ends))
    return here, there


def _reaches(turned: Floats, pairs: Sequence[tuple[int, int]]) -> Floats:
    """(p, n) [m] how far from each hinge the axis of a pair's capsule can be that it turns against the other one."""
    first, second = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    moved = turned > 0.0
    apart: Floats = np.where(moved[first] & moved[second], 0.0, turned[first] + turned[second])
    return apart


def _reach(skeleton: Skeleton, owner: int, capsule: Capsule) -> Floats:
    """(n,) [m] how far a capsule's axis moves at most per angle of each hinge, 0 for hinges that do not move it."""
    reach = np.zeros(len(skeleton.hinges))
    segment: Segment | None = skeleton.segments[owner]
    far = max(float(np.linalg.norm(end)) for end in (capsule.start, capsule.end))
    while segment is not None:
        joints = list(skeleton.joints_of((segment.name,)))
        far += 2 * sum(float(np.linalg.norm(skeleton.hinges[joint].at)) for joint in joints)  # they may miss its origin
        reach[joints] += max(far, SHORTEST)
        for coupling in (each for each in skeleton.couplings if each.segment == segment.name):
            reach[coupling.driver] += abs(coupling.ratio) * far
        far += float(np.linalg.norm(segment.origin_in_parent))
        segment = None if segment.parent is None else skeleton.segments[skeleton.segment(segment.parent)]
    return reach


def segment_distances(a0: Floats, a1: Floats, b0: Floats, b1: Floats) -> Floats:
    """Measures distances between straight segments, after Ericson, Real-Time Collision Detection, 5.1.9.

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
