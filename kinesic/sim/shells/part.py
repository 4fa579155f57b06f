"""Segments with shapes and servos as input of shell design."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.body.skeleton import Capsule, Segment
from kinesic.sim.shells.distance import DistanceField, box, cone, drum

SKIN_THICKNESS = 0.0015  # [m] distance of the shell from an enclosed shape
SERVO_CLEARANCE = 0.002  # [m] distance of the shell from a servo's corners
BLEND_RADIUS = 0.012  # [m] distance below which solids are blended smoothly
FINGER_SKIN_THICKNESS = 0.0004  # [m] distance of the shell from a finger's shape
FINGER_BLEND_RADIUS = 0.003  # [m] distance below which solids of a finger are blended
EDGE_ROUNDING = 0.007  # [m] edge radius of servo housings
LINE_WIDTH = 0.0016  # [m] width of a dark line between two panels of the shell
CUFF_WIDTH = 0.0025  # [m] extra radius at the end of a limb over the start of the next one
FRONT_RADIUS = 0.26  # [arm lengths] curvature radius of the head's front around the vertical axis
VISOR_HALF_SIZE = (0.166, 0.128)  # [arm lengths] half the width and half the height of the visor
TRIANGLE_BUDGET = {
    "stand": 2300,
    "trunk": 2050,
    "head": 2000,
    "limb": 1350,
    "hand": 1000,
    "finger": 140,
}  # approximate largest number of triangles, by kind of part


@dataclass(frozen=True, eq=False)
class ServoBox:
    """Bounding box of the servos of one hinge."""

    centre: Floats  # (3,) [m] in the segment's frame
    half: Floats  # (3,) [m] half the side lengths

    @property
    def corners(self) -> Floats:
        """Corners of the box, (8, 3) [m]."""
        signs = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 3)
        return sealed(self.centre + signs * self.half)


@dataclass(frozen=True, eq=False)
class Housing:
    """Shell design of one segment: solid, dark region and panel lines."""

    solid: DistanceField
    dark: DistanceField | None  # distance field, negative in the dark region of a joint
    lines: tuple[DistanceField, ...]  # panel lines are their zero sets
    extreme_points: Floats  # (k, 3) [m] points whose bounding box contains the surface
    triangles: int  # largest number of triangles before panel lines are cut


def list_servo_boxes(robot: Robot, name: str) -> tuple[ServoBox, ...]:
    """Return bounding boxes of a segment's servos that have a mass."""
    boxes = []
    for mount in robot.mounts:
        if mount.segment == name and mount.drive.servo.mass > 0.0:
            width, length, height = mount.drive.servo.size
            boxes.append(ServoBox(mount.position, np.array([mount.drive.count * width, length, height]) / 2))
    return tuple(boxes)


class ShellPart:
    """Segment with its shapes, servos and child segments."""

    def __init__(self, robot: Robot, segment: Segment, origin: Floats | None = None) -> None:
        self.robot, self.segment = robot, segment
        self.origin = (
            sealed(np.zeros(3)) if origin is None else origin
        )  # (3,) [m] origin of this segment in the drawn segment
        at = self.origin
        self.capsules = [Capsule(sealed(c.start + at), sealed(c.end + at), c.radius) for c in segment.capsules]
        self.servos = [ServoBox(sealed(s.centre + at), s.half) for s in list_servo_boxes(robot, segment.name)]
        self.children = [s for s in robot.skeleton.segments if s.parent == segment.name]

    @property
    def extreme_points(self) -> Floats:
        """Extreme points (k, 3) [m] of shapes and servos."""
        ends = [np.array([end - c.radius, end + c.radius]) for c in self.capsules for end in (c.start, c.end)]
        return np.concatenate([*ends, *(servo.corners for servo in self.servos)])

    def find_next_joint(self) -> Floats | None:
        """Return the next arm joint's position [m] in the segment, or None."""
        arms = [self.robot.arm(side).segments for side in SIDES]
        boxes = [c.origin_in_parent for c in self.children if any(c.name in arm for arm in arms)]
        return boxes[0] if boxes else None


def enclose_in_drum(servo: ServoBox, base: Floats, axis: Floats) -> tuple[DistanceField, float]:
    """Return distance field and radius [m] of a cylinder around a servo.

    Its axis goes through `base` in the direction `axis`.
    """
    along = (servo.corners - base) @ axis
    radial = servo.corners - base - along[:, None] * axis
    radius, half = (
        float(np.linalg.norm(radial, axis=1).max()) + SERVO_CLEARANCE,
        float(np.ptp(along)) / 2 + 2 * SERVO_CLEARANCE,
    )
    middle = base + (along.max() + along.min()) / 2 * axis
    return drum(middle, axis, radius + 0.3 * EDGE_ROUNDING, half + 0.3 * EDGE_ROUNDING, EDGE_ROUNDING), radius


def enclose_capsule(shape: Capsule) -> DistanceField:
    """Return the distance field of a capsule enlarged by the skin thickness."""
    return cone(shape.start, shape.end, shape.radius + SKIN_THICKNESS, shape.radius + SKIN_THICKNESS)


def enclose_in_box(
    servo: ServoBox, rounding: float = EDGE_ROUNDING, clearance: float = SERVO_CLEARANCE
) -> DistanceField:
    """Return the distance field of a rounded box around a servo."""
    return box(servo.centre, servo.half + clearance + 0.43 * rounding, rounding)
