"""Soft shadow of the robot on the floor from its capsules."""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.files.film_file import PixelBox
from kinesic.files.late_pillow import Image, ImageDraw, ImageFilter
from kinesic.sim.filming.framing import project_points
from kinesic.sim.scene_layout import SUN_DIRECTION, SceneView

SHADOW_PIXEL_SIZE = 4  # [pixels] side of one shadow pixel in the picture
SHADOW_BLUR_RADIUS = 0.012  # [picture heights] radius of the Gaussian blur
SHADOW_OPACITY = 0.42  # fraction of the light that the shadow absorbs
BALL_CORNERS = 16  # corners of the polygon that approximates the shadow of a ball


def compute_shadow_outlines(places: Floats, radii: Floats, view: SceneView, *, size: tuple[int, int]) -> Floats:
    """Compute the outlines of the capsule shadows on the floor.

    Args:
        places: (m, 2 k, 3) [m] start and end of one capsule after another, in m postures.
        radii: (2 k,) [m].
        view: View with the height of the floor.
        size: Width and height of the picture [pixels].

    Returns:
        (m, k, corners, 2) pixels to the right and downwards.
    """
    sun = np.array(SUN_DIRECTION)
    floor_points = places + ((view.floor - places[..., 2:]) / sun[2]) * sun
    start, end, radius = floor_points[:, 0::2], floor_points[:, 1::2], radii[0::2, None, None]
    sun_heading = sun[:2] / np.linalg.norm(sun[:2])
    stretch = np.linalg.norm(sun) / -sun[2]
    turns = 2 * np.pi * np.arange(BALL_CORNERS) / BALL_CORNERS
    ahead, aside = np.cos(turns)[:, None], np.sin(turns)[:, None]
    across = np.array([-sun_heading[1], sun_heading[0]])
    ring = np.zeros((BALL_CORNERS, 3))
    ring[:, :2] = stretch * ahead * sun_heading + aside * across
    outward = (ahead * sun_heading + stretch * aside * across) / stretch
    is_far = np.einsum("mkd,cd->mkc", (end - start)[..., :2], outward) > 0
    corners = np.where(is_far[..., None], end[:, :, None, :], start[:, :, None, :]) + radius * ring
    return sealed(project_points(view, corners, size=size)[..., :2])


def shade(picture: "Image.Image", box: PixelBox, outlines: Floats) -> None:
    """Darken a picture inside the shadow outlines.

    Args:
        picture: RGB picture of the scene; changed in place.
        box: Region of the picture that contains the shadow.
        outlines: (k, corners, 2) [pixels] of one posture.
    """
    width, height = (-(-side // SHADOW_PIXEL_SIZE) for side in picture.size)
    coarse = Image.new("L", (width, height))
    pen = ImageDraw.Draw(coarse)
    for outline in outlines / SHADOW_PIXEL_SIZE:
        pen.polygon([(x, y) for x, y in outline.tolist()], fill=round(255 * SHADOW_OPACITY))
    left, top, right, low = box
    within = (left / SHADOW_PIXEL_SIZE, top / SHADOW_PIXEL_SIZE, right / SHADOW_PIXEL_SIZE, low / SHADOW_PIXEL_SIZE)
    soft = coarse.filter(ImageFilter.GaussianBlur(SHADOW_BLUR_RADIUS * height))
    picture.paste((0, 0, 0), box, soft.resize((right - left, low - top), Image.Resampling.BILINEAR, box=within))
