"""Colours and textures of the human figure for glTF and pages."""

import io
from functools import cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.assets.hair import Locks
from kinesic.face.assets.paint import COMPLEXIONS, paint_skin
from kinesic.files.late_pillow import Image

HEM_HALF_WIDTH = 0.04  # [m] width of the clothes' texture on each side of a border
PAINTING_SIZE = 512  # [pixels] width and height of the skin texture
LOCK_SHADES = (0.6, 1.25)  # brightness factors of a lock: at its root, and beyond a third of its length


def shade_locks(locks: Locks) -> Floats:
    """Return linear RGB colours (n, 3) of lock vertices, darker at roots."""
    along, bright = locks.places[:, 1], locks.places[:, 3]
    shade = LOCK_SHADES[0] + (LOCK_SHADES[1] - LOCK_SHADES[0]) * np.clip(3.0 * along, 0.0, 1.0)
    return np.asarray((shade * bright)[:, None] * np.asarray(COMPLEXIONS["female"].hair))


@cache
def skin_painting() -> bytes:
    """Return the painted skin texture as a JPEG."""
    pixels = np.asarray(paint_skin(COMPLEXIONS["female"]))[:, :, :3]
    side = len(pixels) // PAINTING_SIZE
    return encode_jpeg(pixels.reshape(PAINTING_SIZE, side, PAINTING_SIZE, side, 3).mean(axis=(1, 3)))


def encode_jpeg(linear: Floats) -> bytes:
    """Encode linear colours (n, n, 3), bottom row first, as a JPEG."""
    data = io.BytesIO()
    Image.fromarray(np.rint(255 * screen_colours(linear)).astype(np.uint8)[::-1]).save(data, "JPEG", quality=88)
    return data.getvalue()


def screen_colours(linear: Floats) -> Floats:
    """Convert linear colours to sRGB values in 0..1."""
    low, high = linear * 12.92, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    return np.asarray(np.where(linear < 0.0031308, low, high).clip(0.0, 1.0))


@cache
def hem_texture() -> bytes:
    """Return the texture of garment borders (cloth, seam, transparency) as a PNG."""
    where = (np.arange(128) + 0.5) / 128 * 2 * HEM_HALF_WIDTH - HEM_HALF_WIDTH
    shade = np.where(where > -0.007, 225, 255)
    alpha = np.where(where < 0.0, 255, 0)
    row = np.stack([shade, shade, shade, alpha], axis=1).astype(np.uint8)
    data = io.BytesIO()
    Image.fromarray(np.repeat(row[None], 2, axis=0)).save(data, "PNG")
    return data.getvalue()
