"""The soft shadow of a robot on the floor: the shadows of its capsules, blurred."""

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from kinesic.body.arrays import Floats, sealed
from kinesic.files.film_file import PixelBox
from kinesic.sim.filming.framing import seen_at
from kinesic.sim.scene_layout import SUN, SceneView

COARSE = 4  # pixels of the picture along a side of one of the shadow
BLUR = 0.012  # of the shadow, in heights of the picture
DARK = 0.42  # share of the light that the shadow takes
BALL_CORNERS = 16  # corners of the shadow of a ball


def shadow_outlines(places: Floats, radii: Floats, view: SceneView, *, size: tuple[int, int]) -> Floats:
    """Outlines of the shadows of capsules on the floor.

    Args:
        places: (m, 2 k, 3) [m] ends of k capsules in m postures, those of one after another.
        radii: (2 k,) [m].
        view: with the floor.
        size: of the picture.

    Returns:
        (m, k, corners, 2) pixels to the right and down.
    """
    sun = np.array(SUN)
    fallen = places + ((view.floor - places[..., 2:]) / sun[2]) * sun
    start, end, radius = fallen[:, 0::2], fallen[:, 1::2], radii[0::2, None, None]
    along = sun[:2] / np.linalg.norm(sun[:2])
    stretch = np.linalg.norm(sun) / -sun[2]
    turns = 2 * np.pi * np.arange(BALL_CORNERS) / BALL_CORNERS
    ahead, aside = np.cos(turns)[:, None], np.sin(turns)[:, None]
    across = np.array([-along[1], along[0]])
    ring = np.zeros((BALL_CORNERS, 3))
    ring[:, :2] = stretch * ahead * along + aside * across
    outward = (ahead * along + stretch * aside * across) / stretch
    far = np.einsum("mkd,cd->mkc", (end - start)[..., :2], outward) > 0
    corners = np.where(far[..., None], end[:, :, None, :], start[:, :, None, :]) + radius * ring
    return sealed(seen_at(view, corners, size=size)[..., :2])


def shade(picture: Image.Image, box: PixelBox, outlines: Floats) -> None:
    """Darkens a picture where the shadow is.

    Args:
        picture: RGB, of a room.
        box: the part of it in which the shadow is.
        outlines: (k, corners, 2) of one posture.
    """
    width, height = (-(-side // COARSE) for side in picture.size)
    coarse = Image.new("L", (width, height))
    pen = ImageDraw.Draw(coarse)
    for outline in outlines / COARSE:
        pen.polygon([(x, y) for x, y in outline.tolist()], fill=round(255 * DARK))
    left, top, right, low = box
    within = (left / COARSE, top / COARSE, right / COARSE, low / COARSE)
    soft = coarse.filter(ImageFilter.GaussianBlur(BLUR * height))
    picture.paste((0, 0, 0), box, soft.resize((right - left, low - top), Image.Resampling.BILINEAR, box=within))
