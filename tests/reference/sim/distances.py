"""Self-distances of a robot in NumPy."""

from itertools import product

import numpy as np

from kinesic.sim.distances import FINGER_BALL_DISTANCE, MAX_EXACT_FINGER_GAP, CapsuleDistances
from kinesic.sim.kinematics import MotionFrames

from .kinematics import compute_motion_frames
from .segment_distances import segment_distances


class ReferenceDistances(CapsuleDistances):
    """Distances of all capsule pairs of a robot, without the kernel."""

    def gaps(self, angles):
        """Compute the distances (m, p) [m] of `CapsuleDistances.gaps`."""
        frames, gaps = self._body_frames(angles), np.full((self._counted, len(angles)), np.inf)
        pairs = self._capsule_gaps(frames)
        self._measure_fingers(pairs, (pairs < MAX_EXACT_FINGER_GAP) & self._hulled[:, None], frames, angles)
        np.minimum.at(gaps, self._of, pairs)
        return gaps.T

    def lowest(self, frames: MotionFrames, angles):
        """Return the distances of near pairs, and lower bounds for distant pairs."""
        starts, ends = self.capsule_axes(frames)
        middles = (starts + ends) / 2
        between = middles[self._first] - middles[self._second]
        above = np.sqrt(np.einsum("pkm,pkm->pm", between, between)) - self._radii[:, None]
        lowest = above - self._halves[:, None]
        closest = lowest <= above[~self._hulled].min(axis=0, initial=np.inf)
        lowest[closest] = self._capsule_gaps(frames)[closest]
        near = np.maximum(lowest[~self._hulled].min(axis=0, initial=np.inf), FINGER_BALL_DISTANCE)
        self._measure_fingers(lowest, (lowest <= near) & self._hulled[:, None], frames, angles)
        return lowest

    def survey(self, angles, segments):
        """Compute distances (p, m) and origins (k, m, 3) [m] of `CapsuleDistances.survey`."""
        frames = self._body_frames(angles)
        return self.lowest(frames, angles), frames.origins[list(segments)].transpose(0, 2, 1)

    def _nearest(self, angles, chosen):
        lowest = self.lowest(self._body_frames(angles[chosen]), angles[chosen])
        return lowest.min(axis=0), lowest.argmin(axis=0)

    def _body_frames(self, angles) -> MotionFrames:
        others = set(range(len(self._skeleton.segments))) - self._robot.finger_segments
        return compute_motion_frames(self._skeleton, angles, only=others)

    def capsule_axes(self, frames: MotionFrames):
        """Return starts and ends (c, 3, m) [m] of all capsule axes."""
        return frames.axes(self._owners, self._starts, self._ends)

    def _capsule_gaps(self, frames: MotionFrames):
        starts, ends = (side.transpose(0, 2, 1) for side in self.capsule_axes(frames))
        first, second = self._first, self._second
        axes = (side.reshape(-1, 3) for side in (starts[first], ends[first], starts[second], ends[second]))
        return segment_distances(*axes).reshape(len(first), -1) - self._radii[:, None]

    def _measure_fingers(self, gaps, near, frames: MotionFrames, angles) -> None:
        parts = [frames.axes(self._plain_owners, *self._plain_sides)]
        parts += [hand.ends(angles, frames) for hand in self._fingers]
        starts, ends = (np.concatenate(side).transpose(2, 0, 1) for side in zip(*parts, strict=True))
        for pair, posture in np.argwhere(near):
            bodies = (range(*self._begins[k : k + 2]) for k in (self._first[pair], self._second[pair]))
            first, second = np.array(list(product(*bodies))).T
            begins, ends_here = starts[posture], ends[posture]
            apart = segment_distances(begins[first], ends_here[first], begins[second], ends_here[second])
            gaps[pair, posture] = (apart - self._member_radii[first] - self._member_radii[second]).min()


def suspects(angles, known, lowest, reaches, *, limit: float):
    """Compute the result of `reaches.suspects`."""
    between = np.setdiff1d(np.arange(known[-1] + 1), known)
    after = np.searchsorted(known, between)
    bounds = []
    for neighbour in (after, np.maximum(after - 1, 0)):
        turned = np.abs(angles[between] - angles[known[neighbour]])
        bounds.append(lowest.T[neighbour] - turned @ reaches.T)
    return between[np.maximum(*bounds).min(axis=1) < limit]
