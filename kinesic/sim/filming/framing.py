"""Where the camera of a film stands, and which part of its picture changes."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.files.film_file import PixelBox
from kinesic.sim.scene_layout import VIEW_ANGLE, VIEW_FROM, SceneView, rods, view_of

FRAME = 1.2  # times the hands and the head in a picture: 10 % of its width or height is free on every side
SHADOW_PIXELS = 4.0  # pixels beyond it, as shadows are drawn coarsely
TINY = 1e-9  # [m]
BLURRED = 0.04  # heights of the picture that the edge of a shadow reaches


def camera_axes() -> Floats:
    """(3, 3) what is right, up, and towards the camera in the world, as rows."""
    towards = np.array(VIEW_FROM) / np.linalg.norm(VIEW_FROM)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    return sealed(np.stack([right, np.cross(towards, right), towards]))


def motion_view(robot: Robot, postures: Floats, *, aspect: float) -> SceneView:
    """Finds the picture that holds the hands and the head of a motion, with a margin.

    Args:
        robot: who moves.
        postures: (m, n) [rad].
        aspect: width to height of the picture.
    """
    places, radii = moving_balls(robot, postures, watched_segments(robot))
    if not len(radii):
        return view_of(robot)
    turned = (places @ camera_axes().T).reshape(-1, 3)
    grown = np.broadcast_to(radii, places.shape[:2]).ravel()
    half = np.tan(np.radians(VIEW_ANGLE) / 2) / FRAME
    towards = float(camera_axes()[2] @ robot.gesture_origin)
    centre, away = [0.0, 0.0], 0.0
    for k, slope in enumerate((half * aspect, half)):
        slack = grown * np.sqrt(1 + slope**2) + slope * turned[:, 2]
        high, low = float(np.max(turned[:, k] + slack)), float(np.max(-turned[:, k] + slack))
        centre[k], away = (high - low) / 2, max(away, (high + low) / (2 * slope))
    height = 2 * FRAME * half * (away - towards)
    return SceneView(view_of(robot).floor, sealed(np.array([*centre, towards]) @ camera_axes()), float(height))


def watched_segments(robot: Robot) -> list[str]:
    """Names what a film has to show: hands, fingers and head."""
    names = [segment for side in SIDES for segment in (robot.arm(side).segments[-1], *robot.fingers(side))]
    return names + list(robot.chains.get("neck", ())[-1:])


def moving_balls(robot: Robot, postures: Floats, names: Sequence[str]) -> tuple[Floats, Floats]:
    """The ends of the capsules of some segments: (m, k, 3) [m] in the world, and (k,) [m] radii."""
    frames = robot.skeleton.frames(postures)
    bars = {name: [rod.shape for rod in rods(robot) if rod.segment == name] for name in names}
    places, radii = [], []
    for name in names:
        k = robot.skeleton.segment(name)
        shapes = (*robot.skeleton.segments[k].capsules, *bars[name])
        for shape in shapes:
            for end in (shape.start, shape.end):
                places.append(frames.origins[..., k, :] + frames.rotations[..., k, :, :] @ end)
                radii.append(shape.radius)
    if not places:
        return sealed(np.zeros((len(postures), 0, 3))), sealed(np.zeros(0))
    return sealed(np.stack(places, axis=1)), sealed(np.array(radii))


def seen_at(view: SceneView, places: Floats, *, size: tuple[int, int]) -> Floats:
    """(..., 3) pixels to the right and down, and pixels for a metre there, of (..., 3) [m] places in the world."""
    width, height = size
    distance = view.height / 2 / np.tan(np.radians(VIEW_ANGLE) / 2)
    x, y, near = np.moveaxis((places - view.middle) @ camera_axes().T, -1, 0)
    scale = height / view.height * distance / np.maximum(distance - near, 0.05 * distance)
    return sealed(np.stack([width / 2 + scale * x, height / 2 - scale * y, scale], axis=-1))


def robot_boxes(seen: Floats, reach: Floats, *, size: tuple[int, int]) -> list[PixelBox]:
    """The part of each picture that holds the robot; sides are even, as films want them.

    Args:
        seen: (m, k, 3) balls of the robot as `seen_at` finds them.
        reach: (k,) [m] that is drawn around each.
        size: of the picture.
    """
    grown = (seen[..., 2] * reach)[..., None]
    return _boxes((seen[..., :2] - grown).min(axis=1), (seen[..., :2] + grown).max(axis=1), size)


def sunk_balls(places: Floats, reach: Floats, floor: float) -> tuple[Floats, Floats]:
    """Cuts off what is above the floor, of the shapes that are ever below it: the ends of the rest.

    Args:
        places: (m, 2 k, 3) [m] the two ends of one shape after another, in m postures.
        reach: (2 k,) [m] that is drawn around each.
        floor: [m] its height.

    Returns:
        (m, 2 j, 3) [m], and (2 j,) [m] that is drawn around each; none where nothing is ever below the floor.
    """
    low = np.any(places[..., 2] - reach < floor, axis=0)
    kept = np.repeat(low[0::2] | low[1::2], 2)
    ends, level = places[:, kept].reshape(len(places), -1, 2, 3), floor + reach[kept].reshape(-1, 2)
    others = ends[:, :, ::-1]
    rise = np.maximum(ends[..., 2] - others[..., 2], TINY)
    share = np.where(ends[..., 2] > level, np.clip((level - others[..., 2]) / rise, 0.0, 1.0), 1.0)
    cut = others + share[..., None] * (ends - others)
    return sealed(cut.reshape(len(places), -1, 3)), sealed(reach[kept])


def shadow_boxes(outlines: Floats, *, size: tuple[int, int]) -> list[PixelBox]:
    """The part of each picture that holds the shadow, of (m, j, corners, 2) outlines [pixels]."""
    corners = outlines.reshape(len(outlines), -1, 2)
    soft = BLURRED * size[1] + SHADOW_PIXELS
    return _boxes(corners.min(axis=1) - soft, corners.max(axis=1) + soft, size)


def _boxes(least: Floats, most: Floats, size: tuple[int, int]) -> list[PixelBox]:
    """Boxes in a picture from (m, 2) their upper left and lower right corners, at least two pixels wide and high."""
    least = 2 * np.floor(np.clip(least, 0, np.array(size) - 2) / 2).astype(int)
    most = np.minimum(2 * np.ceil(np.clip(most, least + 2, size) / 2).astype(int), size)
    return [(left, top, right, low) for (left, top), (right, low) in zip(least.tolist(), most.tolist(), strict=True)]


def bounding_box(one: PixelBox, other: PixelBox) -> PixelBox:
    """Finds the smallest box that holds two boxes."""
    return (min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3]))
