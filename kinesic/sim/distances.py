"""How close the robot comes to itself: exact distances between capsules, for a whole motion at once.

The fingers of a hand are one body. A ball about all that they can reach stands for them, so that they cost nothing
where the hand is far from everything; where the ball is near, the fingers themselves are measured.
"""

from collections.abc import Sequence
from functools import lru_cache
from itertools import product

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, distinct_rows, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Capsule
from kinesic.sim.fingers import FingerPlaces, finger_hull
from kinesic.sim.kinematics import KERNEL, MotionFrames, body_frames, compiled_frames
from kinesic.sim.reaches import capsule_reach, reaches_of_pairs, suspects
from kinesic.sim.segment_distances import segment_distances

if KERNEL == "compiled":
    from kinesic.sim import _kernel

POSTURES_PER_BATCH = 512  # postures whose kinematics are computed at once
POSTURES_PER_STRIP = 128  # of them for all pairs, so that arrays stay in the cache
POSTURES_PER_WINDOW = 4096  # postures whose frames are kept together while a whole motion is looked at
SAME_POSTURE = 1e-5  # [rad] postures that differ by less are one: no capsule is farther off than 0.01 mm for each hinge
NEAR_FINGERS = 0.03  # [m] the ball about fingers comes to something, from which on they are measured in a motion
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
        self._begins = np.cumsum([0, *map(len, members)])  # (b + 1,) of each body's own among all members
        self._hulled = np.array([max(pair) >= len(plain) for pair in pairs], dtype=np.bool_)  # (p,)
        within = [np.array(list(product(members[i], members[j])), dtype=np.intp).T for i, j in pairs]
        # rows of pairs with as many pairs of capsules within, and these (2, r, k)
        self._within = _by_size(within, self._hulled)
        reach = [capsule_reach(robot.skeleton, k, capsule) for k, capsule in self._members]
        reaches = np.array([np.max([reach[k] for k in row], axis=0) for row in members])
        self._reaches = reaches_of_pairs(reaches.reshape(-1, len(robot.skeleton.hinges)), pairs)  # (p, n) [m]

    def clearance(self, angles: Floats) -> Clearance:
        """Finds the smallest distance between the capsules of counted pairs; a posture that lasts is measured once.

        Args:
            angles: (m, n) [rad] in joint order.

        Returns:
            Distance and pair of segments for each posture; infinite for a robot without counted pairs.
        """
        chosen, back = distinct_rows(angles, SAME_POSTURE)
        distances, pairs = self._nearest(angles, chosen)
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
            found = np.empty((len(self._names), len(angles)))
            if KERNEL == "compiled":
                placed = np.ascontiguousarray(frames.rotations), np.ascontiguousarray(frames.origins)
                _compiled(self).gaps(*placed, found)
            else:
                found[:] = self._gaps(frames)
            self._measure_fingers(found, (found < SIGHT) & self._hulled[:, None], frames, angles)
            np.minimum.at(gaps, self._of, found)
        return sealed(gaps.T)

    def _gaps(self, frames: MotionFrames) -> Floats:
        """(p, m) [m] of all pairs of capsules."""
        starts, ends = (side.transpose(0, 2, 1) for side in self._axes(frames))
        first, second = self._first, self._second
        axes = (side.reshape(-1, 3) for side in (starts[first], ends[first], starts[second], ends[second]))
        found: Floats = segment_distances(*axes).reshape(len(first), -1) - self._radii[:, None]
        return found

    def approach(
        self, angles: Floats, ends: Indices, *, near: float, least: float = np.inf, lowest: Floats | None = None
    ) -> Clearance:
        """Finds the closest approach in each stretch of a motion, and measures only postures that may count.

        A turn of a hinge brings no two capsules nearer than by its angle times what the hinge can reach, so most
        postures between two measured ones are known to be further.

        Args:
            angles: (s, n) [rad] the postures of the motion.
            ends: (m,) where each stretch ends among them, never decreasing; it begins after the one before.
            near: [m] every approach below this is found.
            least: [m] the smallest that was found elsewhere.
            lowest: (p, m) [m] of the postures at the ends, when `lowest` was asked already.

        Returns:
            Distance and pair for each stretch: the smallest of all its postures wherever that is below `near`, or below
            `least` and that of every end, and so the smallest of all; elsewhere that of its end.
        """
        if not self._names or not len(ends):
            return self.clearance(angles[ends])
        if lowest is None:
            lowest = self.lowest(body_frames(self._robot, angles[ends]), angles[ends])
        distances, pairs = np.full(len(angles), np.inf), np.zeros(len(angles), dtype=np.intp)
        pairs[ends] = lowest.argmin(axis=0)
        distances[ends] = lowest.min(axis=0)
        between = suspects(angles, ends, lowest, self._reaches, limit=max(near, min(least, float(lowest.min()))))
        distances[between], pairs[between] = self._nearest(angles, between)
        chosen, stretches = ends.copy(), np.searchsorted(ends, between)
        nearer = np.flatnonzero(distances[between] < distances[ends[stretches]])
        nearer = nearer[np.argsort(-distances[between][nearer], kind="stable")]
        chosen[stretches[nearer]] = between[nearer]  # of several in a stretch the last, which is the nearest, stays
        return self._named(distances[chosen], pairs[chosen])

    def bounds(self, angles: Floats, turns: Floats) -> Floats:
        """Bounds the distances of postures from below, by what the hinges between each pair reach.

        Args:
            angles: (m, n) [rad].
            turns: (m, n) [rad] by which each hinge may be elsewhere at most, this way or that.

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

    def _nearest(self, angles: Floats, chosen: Indices) -> tuple[Floats, Indices]:
        """(c,) [m] and index of the closest pair of capsules, for some of the postures (m, n) [rad]."""
        distances, pairs = np.full(len(chosen), np.inf), np.zeros(len(chosen), dtype=np.int64)
        count = len(chosen) if self._names else 0
        for block in (slice(k, k + POSTURES_PER_BATCH) for k in range(0, count, POSTURES_PER_BATCH)):
            postures = angles[chosen[block]]
            if KERNEL == "compiled" and not self._fingers:
                _compiled(self).nearest(*self._turned(postures), distances[block], pairs[block])
                continue
            lowest = self.lowest(body_frames(self._robot, postures), postures)
            distances[block], pairs[block] = lowest.min(axis=0), lowest.argmin(axis=0)
        return distances, pairs

    def lowest(self, frames: MotionFrames, angles: Floats) -> Floats:
        """(p, m) [m] distance of each pair in m postures; for those that cannot be the closest, a lower bound."""
        if not self._names:
            return np.empty((0, len(angles)))
        if KERNEL == "compiled":
            lowest = np.empty((len(self._names), len(angles)))
            placed = np.ascontiguousarray(frames.rotations), np.ascontiguousarray(frames.origins)
            _compiled(self).closest(*placed, lowest)
        else:
            starts, ends = self._axes(frames)
            strips = (slice(k, k + POSTURES_PER_STRIP) for k in range(0, len(angles), POSTURES_PER_STRIP))
            lowest = np.concatenate([self._closest(starts[:, :, strip], ends[:, :, strip]) for strip in strips], axis=1)
        near = np.maximum(lowest[~self._hulled].min(axis=0, initial=np.inf), NEAR_FINGERS)
        self._measure_fingers(lowest, (lowest <= near) & self._hulled[:, None], frames, angles)
        return lowest

    def survey(self, angles: Floats, segments: Sequence[int]) -> tuple[Floats, Floats]:
        """Finds what `lowest` says, and where segments are; the frames of all postures are never all there.

        Args:
            angles: (m, n) [rad] in joint order.
            segments: whose origins are asked for.

        Returns:
            (p, m) [m] between the pairs, and (k, m, 3) [m] in the world.
        """
        if KERNEL == "compiled" and self._names and not self._fingers:
            lowest, origins = np.empty((len(self._names), len(angles))), np.empty((len(segments), len(angles), 3))
            asked = np.array(segments, dtype=np.intp)
            _compiled(self).survey(*self._turned(angles), asked, lowest, origins)
            return lowest, origins
        found = []
        for block in (angles[k : k + POSTURES_PER_WINDOW] for k in range(0, len(angles), POSTURES_PER_WINDOW)):
            frames = body_frames(self._robot, block)
            found.append((self.lowest(frames, block), frames.origins[list(segments)].transpose(0, 2, 1)))
        lowest, origins = (np.concatenate(parts, axis=1) for parts in zip(*found, strict=True))
        return lowest, origins

    def _turned(self, angles: Floats) -> tuple["_kernel.MotionFrames", Flags, Floats, Floats]:
        """What the kernel needs to place all segments in postures (m, n) [rad]."""
        turns = np.ascontiguousarray(self._skeleton.turns(angles).T)
        chosen = np.ones(len(self._skeleton.segments), dtype=np.bool_)
        return compiled_frames(self._skeleton), chosen, np.sin(turns), np.cos(turns)

    def compiled(self) -> "_kernel.CapsulePairs":
        """Makes what the kernel measures; not kept in the object, which other processes get."""
        return _kernel.make_pairs(
            np.array(self._owners, dtype=np.int64),
            self._starts,
            self._ends,
            self._first,
            self._second,
            self._radii,
            self._halves,
            self._hulled,
        )

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
        asked = {body for row in np.flatnonzero(near.any(axis=1)) for body in (self._first[row], self._second[row])}
        parts = [placed.axes(self._plain_owners, *self._plain_sides)]
        for body, hand in enumerate(self._fingers, start=len(self._plain_owners)):
            nowhere = np.zeros((len(hand.capsules), 3, len(postures)))
            parts.append(hand.ends(angles[postures], placed) if body in asked else (nowhere, nowhere))
        starts, ends = (np.concatenate(side) for side in zip(*parts, strict=True))
        if KERNEL == "compiled":
            first, second, reaches = self._first, self._second, self._member_radii
            _kernel.measure_bodies(self._begins, reaches, first, second, starts, ends, postures, near, gaps)
            return
        starts, ends = starts.transpose(0, 2, 1), ends.transpose(0, 2, 1)
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
        return frames.axes(self._owners, self._starts, self._ends)


@lru_cache(maxsize=8)
def _compiled(distances: CapsuleDistances) -> "_kernel.CapsulePairs":
    return distances.compiled()


def _by_size(within: Sequence[Indices], counted: Flags) -> list[tuple[Indices, Indices]]:
    """Puts counted pairs of bodies with as many pairs of capsules within together."""
    sizes = np.array([pairs.shape[1] for pairs in within], dtype=np.intp)
    rows = [np.flatnonzero((sizes == size) & counted) for size in sorted({*sizes[counted].tolist()})]
    return [(row, np.stack([within[int(k)] for k in row], axis=1)) for row in rows]


def _hands(robot: Robot) -> list[tuple[Side, str]]:
    """Sides with fingers, and how these are called together."""
    return [(side, f"{side}_fingers") for side in SIDES if robot.fingers(side)]


def _sides(capsules: Sequence[tuple[int, Capsule]]) -> tuple[Floats, Floats]:
    """(c, 3) [m] starts and ends of capsules in their segments."""
    starts, ends = ([getattr(capsule, side) for _, capsule in capsules] for side in ("start", "end"))
    return np.array(starts).reshape(-1, 3), np.array(ends).reshape(-1, 3)
