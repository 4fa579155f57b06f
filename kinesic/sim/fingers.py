"""Positions of finger capsules, cached by finger posture.

Also the ball that contains all fingers of a hand.
"""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, find_distinct_rows, sealed
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Capsule, Skeleton
from kinesic.sim.kinematics import MotionFrames, compute_motion_frames

MAX_CACHED_BENDINGS = 32  # largest number of sets of finger postures per hand whose positions are cached
SAME_BENDING_TOLERANCE = 1e-5  # [rad] grid to which finger angles are rounded to find equal finger postures


class FingerPlaces:
    """Capsule positions of the fingers of one hand.

    Fingers bend much less often than the arm moves, so their positions in the hand are cached.
    """

    def __init__(self, robot: Robot, side: Side) -> None:
        """Extract the hand and its fingers as a separate skeleton.

        Args:
            robot: Robot with fingers on that side.
            side: Side of the hand.
        """
        self.capsules, self._hand = list_finger_capsules(robot, side), robot.arm(side).wrist
        self._joints = list(robot.arm(side).fingers)
        self._skeleton = _extract_hand(robot, side)
        self._owners = [self._skeleton.segment(robot.skeleton.segments[k].name) for k, _ in self.capsules]
        self._sides = [
            np.array([getattr(c, side) for _, c in self.capsules]).reshape(-1, 3) for side in ("start", "end")
        ]
        self._cache: dict[bytes, tuple[Floats, Floats]] = {}

    def ends(self, angles: Floats, frames: MotionFrames) -> tuple[Floats, Floats]:
        """Compute start and end points of all finger capsules in the world.

        Args:
            angles: (m, n) [rad] of all hinges.
            frames: Frames of the hand in the same postures.

        Returns:
            Starts and ends, each (c, 3, m) [m].
        """
        finger_angles = angles[:, self._joints]
        is_constant = not np.ptp(finger_angles, axis=0).any()
        chosen, back = (
            (np.zeros(1, dtype=np.intp), None)
            if is_constant
            else find_distinct_rows(finger_angles, SAME_BENDING_TOLERANCE)
        )
        in_hand = self._locate_in_hand(np.ascontiguousarray(finger_angles[chosen]))
        rotation, origin = frames.rotations[self._hand], frames.origins[self._hand]
        first, last = (
            origin + (side[:, None, None, :, 0] @ rotation)[:, :, 0, :]
            if back is None
            else origin + np.einsum("ikm,ckm->cim", rotation, side[:, :, back])
            for side in in_hand
        )
        return first, last

    def _locate_in_hand(self, finger_angles: Floats) -> tuple[Floats, Floats]:
        """Return start and end points of finger capsules in the hand's frame.

        Recent results are cached.

        Args:
            finger_angles: (m, f) [rad] angles of the finger joints.

        Returns:
            Starts and ends, each (c, 3, m) [m].
        """
        key = finger_angles.tobytes()
        positions = self._cache.pop(key, None)
        if positions is None:
            frames = compute_motion_frames(self._skeleton, finger_angles)
            rotations, origins = frames.rotations[self._owners], frames.origins[self._owners]
            first, last = (origins + np.einsum("ck,cikm->cim", side, rotations) for side in self._sides)
            positions = first, last
            if len(self._cache) >= MAX_CACHED_BENDINGS:
                self._cache.pop(next(iter(self._cache)), None)  # least recently used
        self._cache[key] = positions
        return positions


def list_finger_capsules(robot: Robot, side: Side) -> list[tuple[int, Capsule]]:
    """List a hand's finger capsules with the indices of their segments."""
    segments = [robot.skeleton.segment(name) for name in robot.fingers(side)]
    return [(k, capsule) for k in segments for capsule in robot.skeleton.segments[k].capsules]


def _extract_hand(robot: Robot, side: Side) -> Skeleton:
    """Return a skeleton of the hand and its fingers alone.

    Its hinges keep the robot's order.
    """
    skeleton, joints = robot.skeleton, robot.arm(side).fingers
    names = {skeleton.segments[robot.arm(side).wrist].name, *robot.fingers(side)}
    root = replace(skeleton.segments[robot.arm(side).wrist], parent=None, origin_in_parent=np.zeros(3))
    return Skeleton(
        (root, *(part for part in skeleton.segments if part.name in names and part.name != root.name)),
        tuple(skeleton.hinges[joint] for joint in joints),
        tuple(
            replace(coupling, driver=joints.index(coupling.driver))
            for coupling in skeleton.couplings
            if coupling.segment in names and coupling.driver in joints
        ),
    )


def compute_finger_hull(robot: Robot, side: Side) -> Capsule:
    """Compute a ball that contains the fingers at all bend angles.

    It is fixed to the hand's segment.

    Args:
        robot: Robot with fingers on that side.
        side: Side of the hand.
    """
    hand = robot.skeleton.segments[robot.arm(side).wrist].name
    roots: list[Floats] = []
    lengths: list[float] = []
    for name in robot.fingers(side):
        part = robot.skeleton.segments[robot.skeleton.segment(name)]
        ends = [
            np.linalg.norm(end) + capsule.radius for capsule in part.capsules for end in (capsule.start, capsule.end)
        ]
        length = float(max(ends, default=0.0))
        while part.parent is not None and part.parent != hand:
            length += float(np.linalg.norm(part.origin_in_parent))
            part = robot.skeleton.segments[robot.skeleton.segment(part.parent)]
        roots.append(part.origin_in_parent)
        lengths.append(length)
    centre = np.mean(roots, axis=0)
    radius = max(float(np.linalg.norm(root - centre)) + length for root, length in zip(roots, lengths, strict=True))
    return Capsule(sealed(centre), sealed(centre), radius)
