"""What shells are designed from: segments with shapes and servos, and how these are enclosed."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.body.skeleton import Capsule, Segment
from kinesic.sim.shells.distance import DistanceField, box, cone, drum

SKIN = 0.0015  # [m] of a shell outside the shapes that it encloses
SERVO_ROOM = 0.002  # [m] between the corners of a servo and the outside
BLEND = 0.012  # [m] in which solids flow into one another
FINGER_SKIN, FINGER_BLEND = 0.0004, 0.003  # [m]
SOFT = 0.007  # [m] rounding of servos' housings
LINE = 0.0016  # [m] width of a panel line
CUFF = 0.0025  # [m] by which a limb is wider at its end than the next one where it begins
FOOT = (1.25, 0.010)  # radius in radii of a column, and half of its height [m], of the plate that it stands on
FRONT_RADIUS = 0.26  # arm lengths: radius of the head's front, about the upright axis
VISOR = (0.137, 0.104)  # arm lengths: half of its width, half of its height
BUDGET = {"trunk": 2050, "head": 2000, "limb": 1350, "hand": 1000, "finger": 140}  # triangles, before they are cut


@dataclass(frozen=True, eq=False)
class ServoBox:
    """The box of one hinge's servos."""

    centre: Floats  # (3,) [m] in the segment
    half: Floats  # (3,) [m]

    @property
    def corners(self) -> Floats:
        """(8, 3) [m]."""
        signs = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 3)
        return sealed(self.centre + signs * self.half)


@dataclass(frozen=True, eq=False)
class Housing:
    """One surface as fields."""

    solid: DistanceField
    dark: DistanceField | None  # less than 0 where it is a joint
    lines: tuple[DistanceField, ...]  # panel lines are where these are 0
    held: Floats  # (k, 3) [m] places that it is round, for its bounds
    triangles: int


def servos_of(robot: Robot, name: str) -> tuple[ServoBox, ...]:
    """Gives the servos that sit in a segment."""
    found = []
    for mount in robot.mounts:
        if mount.segment == name and mount.drive.servo.mass > 0.0:
            width, length, height = mount.drive.servo.size
            found.append(ServoBox(mount.position, np.array([mount.drive.count * width, length, height]) / 2))
    return tuple(found)


class ShellPart:
    """A segment with what sits in it."""

    def __init__(self, robot: Robot, segment: Segment, origin: Floats | None = None) -> None:
        self.robot, self.segment = robot, segment
        self.origin = sealed(np.zeros(3)) if origin is None else origin  # in the segment that is drawn
        at = self.origin
        self.capsules = [Capsule(sealed(c.start + at), sealed(c.end + at), c.radius) for c in segment.capsules]
        self.servos = [ServoBox(sealed(s.centre + at), s.half) for s in servos_of(robot, segment.name)]
        self.children = [s for s in robot.skeleton.segments if s.parent == segment.name]

    @property
    def held(self) -> Floats:
        """(k, 3) [m] the outermost places of shapes and servos."""
        ends = [np.array([end - c.radius, end + c.radius]) for c in self.capsules for end in (c.start, c.end)]
        return np.concatenate([*ends, *(servo.corners for servo in self.servos)])

    def onward(self) -> Floats | None:
        """Where the next joint of the arm is."""
        arms = [self.robot.arm(side).segments for side in SIDES]
        found = [c.origin_in_parent for c in self.children if any(c.name in arm for arm in arms)]
        return found[0] if found else None


def drum_about(servo: ServoBox, base: Floats, axis: Floats) -> tuple[DistanceField, float]:
    """Puts a servo into a drum about a bone: its field, and its radius [m]."""
    along = (servo.corners - base) @ axis
    away = servo.corners - base - along[:, None] * axis
    radius, half = float(np.linalg.norm(away, axis=1).max()) + SERVO_ROOM, float(np.ptp(along)) / 2 + 2 * SERVO_ROOM
    middle = base + (along.max() + along.min()) / 2 * axis
    return drum(middle, axis, radius + 0.3 * SOFT, half + 0.3 * SOFT, SOFT), radius


def own_shape(shape: Capsule) -> DistanceField:
    """A capsule with a skin."""
    return cone(shape.start, shape.end, shape.radius + SKIN, shape.radius + SKIN)


def boxed(servo: ServoBox, rounding: float = SOFT) -> DistanceField:
    """A servo in a box."""
    return box(servo.centre, servo.half + SERVO_ROOM + 0.43 * rounding, rounding)
