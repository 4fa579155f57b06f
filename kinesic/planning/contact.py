"""Contact of fingertips and palms with the body or the other hand."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import OTHER_SIDE, FingerTip, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.keyframes import Hand, Touch

PALM_FRACTIONS = (0.75, 1.25)  # distances of heel and finger roots from the wrist / distance of the palm's centre
PALM_EXCESS = 0.006  # [m] accepted gap between two palms beyond the contact distance
HEEL_EXCESS_RATIO = 1.5  # extra accepted gap between the heels of two palms / contact distance, as wrists are thick
MAX_HAND_DEPTH = 0.06  # [m] largest searched distance from the middle plane of the hand to the palm's surface
DEPTH_STEP = 5e-4  # [m] resolution of the search for the palm's surface
LENGTH_EPSILON = 1e-9  # smallest divisor, which avoids division by zero


@dataclass(frozen=True, eq=False)
class SurfaceTouch:
    """Contact spheres of a hand, with the segments or spheres they touch."""

    robot: Robot
    meetings: tuple[tuple[FingerTip, FingerTip | int], ...]  # hand sphere, and touched sphere or segment index
    excess: tuple[float, ...] = (0.0,)  # [m] accepted additional distance of each meeting

    @classmethod
    def of(cls, side: Side, hand: Hand, robot: Robot) -> "SurfaceTouch | None":
        """Return a hand's contact, or None without a touching surface.

        None also if the robot lacks this surface or the touched part.
        """
        if hand.touch is None or hand.tip is None:
            return None
        own, opposite = (find_surface(hand.tip, which, robot) for which in (side, OTHER_SIDE[side]))
        part = touched_segment(side, hand.touch, robot)
        if hand.touch == "hand" and opposite:
            heel = PALM_EXCESS + HEEL_EXCESS_RATIO * robot.contact_distance
            excess = (heel, PALM_EXCESS) if hand.tip == "palm" else (0.0,)
            return cls(robot, tuple(zip(own, opposite, strict=True)), excess)
        if not own or part is None:
            return None
        return cls(robot, ((own[len(own) // 2], robot.skeleton.segment(part)),))

    def gaps(self, angles: Floats) -> Floats:
        """Compute the gaps (k, m) [m] of k contacts in m postures.

        The accepted excess is subtracted.
        """
        frames = self.robot.skeleton.frames(angles)
        rows = [self._gap(own, other, frames) for own, other in self.meetings]
        return np.asarray(np.array(rows) - np.array(self.excess)[:, None])

    def _gap(self, own: FingerTip, other: FingerTip | int, frames: Frames) -> Floats:
        """Compute the distance (m,) [m] of one sphere from its counterpart."""
        here = _place(frames, own)
        if isinstance(other, FingerTip):
            apart = np.linalg.norm(here - _place(frames, other), axis=1)
            return np.asarray(apart - own.radius - other.radius)
        rotations, origins = frames.rotations[:, other], frames.origins[:, other]
        rows = []
        for capsule in self.robot.skeleton.segments[other].capsules:
            start, direction = origins + rotations @ capsule.start, rotations @ (capsule.end - capsule.start)
            fraction = np.einsum("mk,mk->m", here - start, direction) / max(
                float(np.sum(direction[0] ** 2)), LENGTH_EPSILON
            )
            nearest = start + np.clip(fraction, 0.0, 1.0)[:, None] * direction
            rows.append(np.linalg.norm(here - nearest, axis=1) - capsule.radius)
        return np.asarray(np.min(rows, axis=0, initial=np.inf) - own.radius)


def _place(frames: Frames, ball: FingerTip) -> Floats:
    """Return a sphere's centre in the world, (m, 3) [m]."""
    place: Floats = frames.origins[:, ball.segment] + frames.rotations[:, ball.segment] @ ball.place
    return place


def find_surface(name: str, side: Side, robot: Robot) -> tuple[FingerTip, ...]:
    """Return the contact spheres of a palm or fingertip, empty if missing."""
    if name == "palm":
        return palm_balls(robot, side)
    tip = robot.finger_tips(side).get(name)
    return () if tip is None else (tip,)


@lru_cache(maxsize=16)
def palm_balls(robot: Robot, side: Side) -> tuple[FingerTip, ...]:
    """Return contact spheres in the heel and finger roots of a palm."""
    arm = robot.arm(side)
    palm, capsules = arm.palm, robot.skeleton.segments[arm.wrist].capsules
    middle = palm.position - (palm.position @ palm.facing) * palm.facing
    depths = np.arange(0.0, MAX_HAND_DEPTH, DEPTH_STEP)
    balls = []
    for fraction in PALM_FRACTIONS:
        ray = fraction * middle + depths[:, None] * palm.facing
        inside = [
            depth
            for capsule in capsules
            for depth in depths[_distances(ray, capsule.start, capsule.end) <= capsule.radius]
        ]
        balls.append(FingerTip(arm.wrist, fraction * middle, max(inside, default=0.0)))
    return tuple(balls)


def _distances(points: Floats, start: Floats, end: Floats) -> Floats:
    """Compute the distances (m,) [m] of points from a line segment."""
    along = end - start
    fraction = np.clip((points - start) @ along / max(float(along @ along), LENGTH_EPSILON), 0.0, 1.0)
    distances: Floats = np.linalg.norm(points - start - fraction[:, None] * along, axis=1)
    return distances


def touched_segment(side: Side, touch: Touch, robot: Robot) -> str | None:
    """Return the segment name of a touched body part, or None."""
    arm, torso, neck = robot.arm(OTHER_SIDE[side]).segments, robot.chains.get("torso"), robot.chains.get("neck")
    match touch:
        case "hand":
            return arm[-1]
        case "forearm":
            return arm[-2]
        case "upper_arm":
            return arm[-3]
        case "head":
            return neck[-1] if neck else None
        case "chest":
            return torso[-1] if torso else None
        case "lap":
            return robot.skeleton.segments[robot.skeleton.segment(torso[0])].parent if torso else None


def touched_pairs(side: Side, touch: Touch, robot: Robot) -> Iterator[int]:
    """Yield the `counted_pairs` indices of pairs of hand and touched part."""
    part, other = touched_segment(side, touch, robot), f"{OTHER_SIDE[side]}_fingers"
    hand, parts = {robot.arm(side).segments[-1], f"{side}_fingers"}, {part, *_rigid_children(part, robot)}
    if touch == "hand":
        parts.add(other)
    for k, (a, b) in enumerate(robot.counted_pairs):
        if (a in hand and b in parts) or (b in hand and a in parts):
            yield k


def _rigid_children(part: str | None, robot: Robot) -> Iterator[str]:
    """Yield the names of segments that are rigidly attached to a segment."""
    turned = {hinge.segment for hinge in robot.skeleton.hinges} | {c.segment for c in robot.skeleton.couplings}
    for segment in robot.skeleton.segments:
        if segment.parent is not None and segment.parent == part and segment.name not in turned:
            yield segment.name
