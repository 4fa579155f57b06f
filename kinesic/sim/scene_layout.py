"""Layout of a robot picture: floor, view and connecting rods."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, RobotArm
from kinesic.body.skeleton import Capsule

VIEW_ANGLE = 28.0  # [deg] vertical field of view of the camera
CAMERA_DIRECTION = (0.92, 0.36, 0.16)  # direction to the camera: in front of the robot, slightly to its left and above
SUN_DIRECTION = (-0.5, -0.45, -0.8)  # propagation direction of the light that casts shadows
PICTURE_ASPECT = 4 / 3  # width / height of a picture
VIEW_MARGIN = 1.03  # picture height / smallest height that shows all parts
HAND_FLOOR_GAP = 0.12  # [arm lengths] smallest height of hanging hands above the floor
ROD_RADIUS = 0.035  # [arm lengths] largest radius of drawn rods; the stand has twice this radius
MIN_ROD_LENGTH = 1e-3  # [m] shortest rod that is drawn
MIN_COLUMN_LENGTH = 0.2  # [arm lengths] shortest stand that is drawn below a robot


@dataclass(frozen=True, eq=False)
class SceneView:
    """View of the camera in front of a robot."""

    floor: float  # [m] height of the floor in the world
    middle: Floats  # (3,) [m] centre of the picture in the world
    height: float  # [m] height of the picture at the robot


@dataclass(frozen=True, eq=False)
class Rod:
    """Massless round bar drawn on a segment."""

    segment: str
    shape: Capsule


def find_scene_view(robot: Robot) -> SceneView:
    """Find the floor height and a view that contains all hand positions."""
    arm, rest, straight = robot.arm("l"), _list_balls(robot), robot.skeleton.zero_frames.origins
    arms = {segment for side in SIDES for segment in robot.arm(side).segments}
    hands, trunk = (
        min((float(z) - r for (_, _, z), r, name in rest if (name in arms) == of_arm), default=robot.gesture_origin[2])
        for of_arm in (True, False)
    )
    below = float(hands) - HAND_FLOOR_GAP * robot.arm_length
    tips = [
        float(np.linalg.norm(end)) + shape.radius
        for shape in _list_hand_shapes(robot, arm)
        for end in _list_ends(shape)
    ]
    reach, shoulder = robot.arm_length + max(tips, default=0.0), straight[arm.shoulder]
    out, up = abs(float(shoulder[1])) + reach, float(shoulder[2]) + reach
    seen = [*((place, radius) for place, radius, name in rest if name in arms or place[2] > below)]
    seen += [(np.array([shoulder[0], side * out, shoulder[2]]), 0.0) for side in (-1, 1)]
    seen += [(np.array([shoulder[0], 0.0, height]), 0.0) for height in (up, below)]
    middle = np.array([*robot.gesture_origin[:2], (max(up, *(p[2] + r for p, r in seen)) + below) / 2])
    return SceneView(min(float(trunk), below), sealed(middle), VIEW_MARGIN * _find_least_height(seen, middle))


def _find_least_height(seen: Iterable[tuple[Floats, float]], middle: Floats) -> float:
    """Return the smallest picture height [m] that shows all balls in perspective.

    Args:
        seen: Centre (3,) [m] and radius [m] of each ball.
        middle: (3,) [m] centre of the picture, where its height is measured.
    """
    towards = np.array(CAMERA_DIRECTION) / np.linalg.norm(CAMERA_DIRECTION)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up, half = np.cross(towards, right), np.tan(np.radians(VIEW_ANGLE) / 2)
    distances = []
    for place, radius in seen:
        x, y, depth = (place - middle) @ np.stack([right, up, towards], axis=1)
        distances.append(depth + max(abs(y) + radius, (abs(x) + radius) / PICTURE_ASPECT) / half)
    return float(2 * half * max(distances))


def rods(robot: Robot) -> tuple[Rod, ...]:
    """Return the rods that connect each segment's shapes and child segments.

    A column connects the robot to the floor. No rod is thicker than the thinnest shape that it joins, so that rods hide
    no finger.
    """
    thickest, segments = ROD_RADIUS * robot.arm_length, robot.skeleton.segments
    joints: list[Rod] = []
    for segment in segments:
        shapes = segment.capsules
        children = [child.origin_in_parent for child in segments if child.parent == segment.name]
        radius = min([thickest, *(shape.radius for shape in shapes)])
        ends = [*_connect_inside(shapes), *((_find_nearest_point(shapes, child), child) for child in children)]
        joints += [Rod(segment.name, Capsule(start, end, radius)) for start, end in ends]
    return (*(rod for rod in joints if np.linalg.norm(rod.shape.end - rod.shape.start) > MIN_ROD_LENGTH), *stand(robot))


def _connect_inside(shapes: Sequence[Capsule]) -> Iterator[tuple[Floats, Floats]]:
    """Yield the rods that connect a segment's origin with its shapes.

    Each rod is a start and an end point. The nearest shape is connected first.
    """
    joined, left = [np.zeros(3)], list(shapes)
    while left:
        candidates = [(point, _find_nearest_on_axis(shape, point), shape) for point in joined for shape in left]
        start, end, shape = min(candidates, key=lambda axis: float(np.linalg.norm(axis[1] - axis[0])))
        yield sealed(start), end
        left.remove(shape)
        joined += [end, shape.start, shape.end]


def _find_nearest_point(shapes: Sequence[Capsule], point: Floats) -> Floats:
    """Return the connection point (3,) [m] nearest to a given point.

    Candidates are the segment's origin and the axes of the shapes.
    """
    places = [sealed(np.zeros(3)), *(_find_nearest_on_axis(shape, point) for shape in shapes)]
    return min(places, key=lambda place: float(np.linalg.norm(place - point)))


def stand(robot: Robot) -> Iterator[Rod]:
    """Yield the stand: a rod from the fixed base to the floor.

    Nothing if it would be shorter than `MIN_COLUMN_LENGTH`.
    """
    floor = find_scene_view(robot).floor
    for segment, origin in zip(robot.skeleton.segments, robot.skeleton.zero_frames.origins, strict=True):
        if segment.parent is None:
            ends = [end for shape in segment.capsules for end in _list_ends(shape)] or [sealed(np.zeros(3))]
            foot = min(ends, key=lambda end: float(end[2]))
            below = sealed([*foot[:2], floor - origin[2]])
            if foot[2] - below[2] > MIN_COLUMN_LENGTH * robot.arm_length:
                yield Rod(segment.name, Capsule(foot, below, 2 * ROD_RADIUS * robot.arm_length))


def _list_balls(robot: Robot) -> list[tuple[Floats, float, str]]:
    """Return the ends of all shapes in a posture with hanging arms.

    Returns:
        Centre (3,) [m] in the world, radius [m] and segment of each end.
    """
    frames = robot.skeleton.zero_frames
    return [
        (sealed(origin + turn @ end), shape.radius, segment.name)
        for segment, turn, origin in zip(robot.skeleton.segments, frames.rotations, frames.origins, strict=True)
        for shape in segment.capsules
        for end in _list_ends(shape)
    ]


def _list_ends(shape: Capsule) -> tuple[Floats, Floats]:
    return shape.start, shape.end


def _list_hand_shapes(robot: Robot, arm: RobotArm) -> tuple[Capsule, ...]:
    """Return the capsules of an arm's hand segment, without fingers."""
    return robot.skeleton.segments[arm.wrist].capsules


def _find_nearest_on_axis(shape: Capsule, point: Floats) -> Floats:
    """Return the point [m] of a capsule's axis nearest to another point."""
    axis = shape.end - shape.start
    fraction = float((point - shape.start) @ axis) / max(float(axis @ axis), MIN_ROD_LENGTH**2)
    return sealed(shape.start + min(max(fraction, 0.0), 1.0) * axis)
