"""Where a robot stands in a picture, from how far it is seen, and the rods that hold its parts together."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, RobotArm
from kinesic.body.skeleton import Capsule

VIEW_ANGLE = 28.0  # [deg] of the camera, vertical
VIEW_FROM = (0.92, 0.36, 0.16)  # direction from the robot to the camera: in front, slightly to its left and above
SUN = (-0.5, -0.45, -0.8)  # where the light shines that throws shadows
ASPECT = 4 / 3  # of pictures, width to height
VIEW_MARGIN = 1.03  # times what must be seen
AIR = 0.12  # arm lengths between hanging hands and the floor
ROD = 0.035  # arm lengths: radius of a rod
SHORTEST_ROD = 1e-3  # [m] of a rod
STANDS = 0.2  # arm lengths between the lowest shape's axis and the floor, below which the shape itself stands there


@dataclass(frozen=True, eq=False)
class SceneView:
    """What is seen of a robot from before it."""

    floor: float  # [m] height in the world
    middle: Floats  # (3,) [m] of the picture, in the world
    height: float  # [m] of the picture, at the robot


@dataclass(frozen=True, eq=False)
class Rod:
    """A round bar of a segment, which is drawn and weighs nothing."""

    segment: str
    shape: Capsule


def view_of(robot: Robot) -> SceneView:
    """Finds a floor that the robot stands on, and a picture in which its hands stay wherever they reach."""
    arm, rest, straight = robot.arm("l"), _balls(robot), robot.skeleton.straight.origins
    arms = {segment for side in SIDES for segment in robot.arm(side).segments}
    hands, trunk = (
        min((float(z) - r for (_, _, z), r, name in rest if (name in arms) == of_arm), default=robot.gesture_origin[2])
        for of_arm in (True, False)
    )
    below = float(hands) - AIR * robot.arm_length
    tips = [float(np.linalg.norm(end)) + shape.radius for shape in _shapes(robot, arm) for end in _ends(shape)]
    reach, shoulder = robot.arm_length + max(tips, default=0.0), straight[arm.shoulder]
    out, up = abs(float(shoulder[1])) + reach, float(shoulder[2]) + reach
    seen = [*((place, radius) for place, radius, name in rest if name in arms or place[2] > below)]
    seen += [(np.array([shoulder[0], side * out, shoulder[2]]), 0.0) for side in (-1, 1)]
    seen += [(np.array([shoulder[0], 0.0, height]), 0.0) for height in (up, below)]
    middle = np.array([*robot.gesture_origin[:2], (max(up, *(p[2] + r for p, r in seen)) + below) / 2])
    return SceneView(min(float(trunk), below), sealed(middle), VIEW_MARGIN * _least_height(seen, middle))


def _least_height(seen: Iterable[tuple[Floats, float]], middle: Floats) -> float:
    """[m] of the least picture, at its middle, that shows all of the balls (centre, radius) in perspective."""
    towards = np.array(VIEW_FROM) / np.linalg.norm(VIEW_FROM)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up, half = np.cross(towards, right), np.tan(np.radians(VIEW_ANGLE) / 2)
    distances = []
    for place, radius in seen:
        x, y, depth = (place - middle) @ np.stack([right, up, towards], axis=1)
        distances.append(depth + max(abs(y) + radius, (abs(x) + radius) / ASPECT) / half)
    return float(2 * half * max(distances))


def rods(robot: Robot) -> tuple[Rod, ...]:
    """Joins the shapes of each segment to one another and to its children, and stands the robot on the floor.

    No rod is thicker than the thinnest shape that it joins, so that it hides no finger.
    """
    thickest, segments = ROD * robot.arm_length, robot.skeleton.segments
    found: list[Rod] = []
    for segment in segments:
        shapes = segment.capsules
        children = [child.origin_in_parent for child in segments if child.parent == segment.name]
        radius = min([thickest, *(shape.radius for shape in shapes)])
        ends = [*_inside(shapes), *((_on(shapes, child), child) for child in children)]
        found += [Rod(segment.name, Capsule(start, end, radius)) for start, end in ends]
    return (*(rod for rod in found if np.linalg.norm(rod.shape.end - rod.shape.start) > SHORTEST_ROD), *stand(robot))


def _inside(shapes: Sequence[Capsule]) -> Iterator[tuple[Floats, Floats]]:
    """Yields where rods begin and end that join the origin of a segment and all its shapes, the nearest ones first."""
    joined, left = [np.zeros(3)], list(shapes)
    while left:
        ways = [(point, _nearest(shape, point), shape) for point in joined for shape in left]
        start, end, shape = min(ways, key=lambda way: float(np.linalg.norm(way[1] - way[0])))
        yield sealed(start), end
        left.remove(shape)
        joined += [end, shape.start, shape.end]


def _on(shapes: Sequence[Capsule], point: Floats) -> Floats:
    """The place nearest to a point, of the axes of a segment's shapes and its origin."""
    places = [sealed(np.zeros(3)), *(_nearest(shape, point) for shape in shapes)]
    return min(places, key=lambda place: float(np.linalg.norm(place - point)))


def stand(robot: Robot) -> Iterator[Rod]:
    """Yields the column from the lowest place of what is fixed to the world down to the floor."""
    floor = view_of(robot).floor
    for segment, origin in zip(robot.skeleton.segments, robot.skeleton.straight.origins, strict=True):
        if segment.parent is None:
            ends = [end for shape in segment.capsules for end in _ends(shape)] or [sealed(np.zeros(3))]
            foot = min(ends, key=lambda end: float(end[2]))
            below = sealed([*foot[:2], floor - origin[2]])
            if foot[2] - below[2] > STANDS * robot.arm_length:
                yield Rod(segment.name, Capsule(foot, below, 2 * ROD * robot.arm_length))


def _balls(robot: Robot) -> list[tuple[Floats, float, str]]:
    """The ends of all shapes at rest: (3,) [m] in the world, radius [m], and segment."""
    frames = robot.skeleton.frames(robot.skeleton.rest)
    return [
        (sealed(origin + turn @ end), shape.radius, segment.name)
        for segment, turn, origin in zip(robot.skeleton.segments, frames.rotations, frames.origins, strict=True)
        for shape in segment.capsules
        for end in _ends(shape)
    ]


def _ends(shape: Capsule) -> tuple[Floats, Floats]:
    return shape.start, shape.end


def _shapes(robot: Robot, arm: RobotArm) -> tuple[Capsule, ...]:
    """Shapes of the hand."""
    return robot.skeleton.segments[arm.wrist].capsules


def _nearest(shape: Capsule, point: Floats) -> Floats:
    """The place on a capsule's axis that is nearest to a point."""
    way = shape.end - shape.start
    share = float((point - shape.start) @ way) / max(float(way @ way), SHORTEST_ROD**2)
    return sealed(shape.start + min(max(share, 0.0), 1.0) * way)
