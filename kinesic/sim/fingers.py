"""Where the fingers of a hand are, found in the hand once for each way in which they are bent; a ball about them."""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, distinct_rows, sealed
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Capsule, Skeleton
from kinesic.sim.kinematics import MotionFrames, motion_frames

BENDS_KEPT = 32  # ways in which fingers are bent whose places are kept
ALIKE = 1e-5  # [rad] fingers that are bent by so much differently are where they were, but for a micrometre


class FingerPlaces:
    """The fingers of one hand: they are bent much more seldom than the arm moves."""

    def __init__(self, robot: Robot, side: Side) -> None:
        """Cuts the hand off.

        Args:
            robot: with fingers on that side.
            side: of the hand.
        """
        self.capsules, self._hand = finger_capsules(robot, side), robot.arm(side).wrist
        self._joints = list(robot.arm(side).fingers)
        self._skeleton = _cut_off(robot, side)
        self._owners = [self._skeleton.segment(robot.skeleton.segments[k].name) for k, _ in self.capsules]
        self._sides = [
            np.array([getattr(c, side) for _, c in self.capsules]).reshape(-1, 3) for side in ("start", "end")
        ]
        self._known: dict[bytes, tuple[Floats, Floats]] = {}

    def ends(self, angles: Floats, frames: MotionFrames) -> tuple[Floats, Floats]:
        """Finds where the axes of all capsules begin and end, (c, 3, m) [m] in the world.

        Args:
            angles: (m, n) [rad] of all hinges.
            frames: of the hand in the same postures.
        """
        bent = angles[:, self._joints]
        alike = not np.ptp(bent, axis=0).any()
        chosen, back = (np.zeros(1, dtype=np.intp), None) if alike else distinct_rows(bent, ALIKE)
        here = self._in_hand(np.ascontiguousarray(bent[chosen]))
        rotation, origin = frames.rotations[self._hand], frames.origins[self._hand]
        first, last = (
            origin + (side[:, None, None, :, 0] @ rotation)[:, :, 0, :]
            if back is None
            else origin + np.einsum("ikm,ckm->cim", rotation, side[:, :, back])
            for side in here
        )
        return first, last

    def _in_hand(self, bent: Floats) -> tuple[Floats, Floats]:
        """(c, 3, m) [m] the same in the hand, for (m, f) [rad]; what was asked lately is remembered."""
        asked = bent.tobytes()
        found = self._known.pop(asked, None)
        if found is None:
            frames = motion_frames(self._skeleton, bent)
            rotations, origins = frames.rotations[self._owners], frames.origins[self._owners]
            first, last = (origins + np.einsum("ck,cikm->cim", side, rotations) for side in self._sides)
            found = first, last
            if len(self._known) >= BENDS_KEPT:
                self._known.pop(next(iter(self._known)), None)  # the one that was asked longest ago
        self._known[asked] = found
        return found


def finger_capsules(robot: Robot, side: Side) -> list[tuple[int, Capsule]]:
    """Lists the capsules of a hand's fingers with the segments that own them."""
    segments = [robot.skeleton.segment(name) for name in robot.fingers(side)]
    return [(k, capsule) for k in segments for capsule in robot.skeleton.segments[k].capsules]


def _cut_off(robot: Robot, side: Side) -> Skeleton:
    """The hand and its fingers for themselves; their hinges are in the order of the robot's."""
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


def finger_hull(robot: Robot, side: Side) -> Capsule:
    """Finds a ball, fixed to the hand's segment, that holds its fingers however they are bent.

    Args:
        robot: with fingers on that side.
        side: of the hand.
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
