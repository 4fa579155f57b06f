"""Camera position of a film, and changed regions of its pictures."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.files.film_file import PixelBox
from kinesic.sim.scene_layout import CAMERA_DIRECTION, VIEW_ANGLE, SceneView, find_scene_view, rods

FRAME_MARGIN = 1.2  # picture size / extent of hands and head: a margin of 10 % of that extent on each side
SHADOW_MARGIN = 4.0  # [pixels] margin around the shadow's region, because shadows are drawn at low resolution
FORWARD_HANDS = 0.35  # [arm lengths] distance in front of hanging hands up to which every view shows the hands
MIN_RISE = 1e-9  # [m] smallest height difference of a capsule's ends used as a divisor
SHADOW_BLUR_REACH = 0.04  # [picture heights] extent of the blurred edge of a shadow


def compute_camera_axes() -> Floats:
    """Return the camera's right, up and backward axes as rows.

    Unit vectors in the world.
    """
    towards = np.array(CAMERA_DIRECTION) / np.linalg.norm(CAMERA_DIRECTION)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    return sealed(np.stack([right, np.cross(towards, right), towards]))


def find_motion_view(robot: Robot, postures: Floats, *, aspect: float) -> SceneView:
    """Find the view that contains hands and head during a motion.

    It is the same for all motions of a robot, in all styles, that stay in the picture around its hanging arms.

    Args:
        robot: Robot that moves.
        postures: (m, n) [rad].
        aspect: Width / height of the picture.
    """
    places, radii = find_capsule_balls(robot, postures, list_watched_segments(robot))
    if not len(radii):
        return find_scene_view(robot)
    usual_places, usual_radii = _find_usual_balls(robot)
    half = np.tan(np.radians(VIEW_ANGLE) / 2) / FRAME_MARGIN
    slopes = np.array([half * aspect, half])
    usual = _find_extents(usual_places, usual_radii, slopes)
    moved = _find_extents(places, radii, slopes)
    high, low = np.maximum(usual, moved)
    away = float(np.max((high + low) / (2 * slopes)))
    centre = np.clip((usual[0] - usual[1]) / 2, high - slopes * away, slopes * away - low)
    towards = float(compute_camera_axes()[2] @ robot.gesture_origin)
    height = 2 * FRAME_MARGIN * half * (away - towards)
    return SceneView(
        find_scene_view(robot).floor, sealed(np.array([*centre, towards]) @ compute_camera_axes()), float(height)
    )


def _find_usual_balls(robot: Robot) -> tuple[Floats, Floats]:
    """Return balls around the head, hanging hands and hands held forward.

    A film shows these places even if the motion does not use them.
    """
    places, radii = find_capsule_balls(robot, np.zeros((1, len(robot.skeleton.hinges))), list_watched_segments(robot))
    forward = np.array([FORWARD_HANDS * robot.arm_length, 0.0, 0.0])
    return sealed(np.concatenate([places, places + forward])), radii


def _find_extents(places: Floats, radii: Floats, slopes: Floats) -> Floats:
    """Return the extents of balls in the picture, in the camera's plane.

    Args:
        places: (m, k, 3) [m] centres in the world.
        radii: (k,) [m] radii.
        slopes: (2,) tangents of half the width and half the height of the picture without its margin.

    Returns:
        (2, 2) [m] to the right and upwards, to the left and downwards.
    """
    turned = (places @ compute_camera_axes().T).reshape(-1, 3)
    grown = np.broadcast_to(radii, places.shape[:2]).reshape(-1, 1)
    slack = grown * np.sqrt(1 + slopes**2) + slopes * turned[:, 2:]
    return sealed(np.stack([(turned[:, :2] + slack).max(axis=0), (slack - turned[:, :2]).max(axis=0)]))


def list_watched_segments(robot: Robot) -> list[str]:
    """List the segments that a film must show: hands, fingers and head."""
    names = [segment for side in SIDES for segment in (robot.arm(side).segments[-1], *robot.fingers(side))]
    return names + list(robot.chains.get("neck", ())[-1:])


def find_capsule_balls(robot: Robot, postures: Floats, names: Sequence[str]) -> tuple[Floats, Floats]:
    """Return centres and radii of the balls at the ends of capsules.

    Args:
        robot: Description.
        postures: (m, n) [rad].
        names: Segments; their rods are included.

    Returns:
        (m, k, 3) [m] centres in the world, and (k,) [m] radii.
    """
    frames = robot.skeleton.frames(postures)
    bars, places, radii = rods(robot), [], []
    for name in names:
        k = robot.skeleton.segment(name)
        shapes = (*robot.skeleton.segments[k].capsules, *(bar.shape for bar in bars if bar.segment == name))
        for shape in shapes:
            for end in (shape.start, shape.end):
                places.append(frames.origins[..., k, :] + frames.rotations[..., k, :, :] @ end)
                radii.append(shape.radius)
    if not places:
        return sealed(np.zeros((len(postures), 0, 3))), sealed(np.zeros(0))
    return sealed(np.stack(places, axis=1)), sealed(np.array(radii))


def project_points(view: SceneView, places: Floats, *, size: tuple[int, int]) -> Floats:
    """Project points of the world into the picture.

    Args:
        view: View of the camera.
        places: (..., 3) [m] in the world.
        size: Width and height of the picture [pixels].

    Returns:
        (..., 3) pixels to the right, pixels downwards, and pixels per metre at the point.
    """
    width, height = size
    distance = view.height / 2 / np.tan(np.radians(VIEW_ANGLE) / 2)
    x, y, near = np.moveaxis((places - view.middle) @ compute_camera_axes().T, -1, 0)
    scale = height / view.height * distance / np.maximum(distance - near, 0.05 * distance)
    return sealed(np.stack([width / 2 + scale * x, height / 2 - scale * y, scale], axis=-1))


def find_robot_boxes(seen: Floats, reach: Floats, *, size: tuple[int, int]) -> list[PixelBox]:
    """Return the region of each picture that contains the robot.

    The sides of a region are even, as film encoders require.

    Args:
        seen: (m, k, 3) projected balls of the robot, from `project_points`.
        reach: (k,) [m] radius that is drawn around each centre.
        size: Width and height of the picture [pixels].
    """
    grown = (seen[..., 2] * reach)[..., None]
    return _round_boxes((seen[..., :2] - grown).min(axis=1), (seen[..., :2] + grown).max(axis=1), size)


def clip_below_floor(places: Floats, reach: Floats, floor: float) -> tuple[Floats, Floats]:
    """Clip capsules to their parts below the floor.

    Capsules that stay above the floor in all postures are left out.

    Args:
        places: (m, 2 k, 3) [m] start and end of one capsule after another, in m postures.
        reach: (2 k,) [m] radius that is drawn around each end.
        floor: [m] height of the floor.

    Returns:
        (m, 2 j, 3) [m] ends of the clipped capsules and (2 j,) [m] their radii; empty if none is ever below the floor.
    """
    is_below = np.any(places[..., 2] - reach < floor, axis=0)
    kept = np.repeat(is_below[0::2] | is_below[1::2], 2)
    ends, level = places[:, kept].reshape(len(places), -1, 2, 3), floor + reach[kept].reshape(-1, 2)
    others = ends[:, :, ::-1]
    rise = np.maximum(ends[..., 2] - others[..., 2], MIN_RISE)
    fraction = np.where(ends[..., 2] > level, np.clip((level - others[..., 2]) / rise, 0.0, 1.0), 1.0)
    cut = others + fraction[..., None] * (ends - others)
    return sealed(cut.reshape(len(places), -1, 3)), sealed(reach[kept])


def find_shadow_boxes(outlines: Floats, *, size: tuple[int, int]) -> list[PixelBox]:
    """Return the region of each picture that contains the shadow.

    Args:
        outlines: (m, j, corners, 2) [pixels] shadow outlines.
        size: Width and height of the picture [pixels].
    """
    corners = outlines.reshape(len(outlines), -1, 2)
    soft = SHADOW_BLUR_REACH * size[1] + SHADOW_MARGIN
    return _round_boxes(corners.min(axis=1) - soft, corners.max(axis=1) + soft, size)


def _round_boxes(lower: Floats, upper: Floats, size: tuple[int, int]) -> list[PixelBox]:
    """Round corner coordinates outwards to boxes inside the picture.

    Boxes have even sides of at least two pixels.

    Args:
        lower: (m, 2) [pixels] upper left corners.
        upper: (m, 2) [pixels] lower right corners.
        size: Width and height of the picture [pixels].
    """
    lower = 2 * np.floor(np.clip(lower, 0, np.array(size) - 2) / 2).astype(int)
    upper = np.minimum(2 * np.ceil(np.clip(upper, lower + 2, size) / 2).astype(int), size)
    return [
        (left, top, right, is_below)
        for (left, top), (right, is_below) in zip(lower.tolist(), upper.tolist(), strict=True)
    ]


def bounding_box(first: PixelBox, second: PixelBox) -> PixelBox:
    """Return the smallest box that contains two boxes."""
    return (min(first[0], second[0]), min(first[1], second[1]), max(first[2], second[2]), max(first[3], second[3]))
