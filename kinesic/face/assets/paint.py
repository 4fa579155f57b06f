"""Paints the skin with its brows, in the chart of the head, and the iris round the axis of an eye.

Nothing is an image asset; everything is drawn from a few figures and a seed. Colours are linear.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import numpy as np
import scipy
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from kinesic.body.arrays import Floats, seal_own, sealed
from kinesic.body.choices import Variant
from kinesic.face.assets.chart import LEFT_RIGHT, LOW_HIGH

Colour = tuple[float, ...]  # red, green, blue

RESOLUTION = 1024
STROKES = 640  # hairs of both brows
FINER = 2  # times the resolution in which they are drawn
SEED = 7
IRIS_RESOLUTION = 80  # about what a picture shows
FINE = 4  # times that in which it is worked out
EYE = 0.8  # half the width of the painted square, in radii of the eyeball
UNSEEN = 1e-12  # share of a colour that no texture holds
BLUR = 4.0  # standard deviations that a blur reaches
IRIS, PUPIL = 0.40, 0.17  # in radii of the eyeball


@dataclass(frozen=True)
class Complexion:
    """Colours of a person, and the shape of the brows."""

    skin: Colour
    flush: Colour  # what cheeks, nose and chin are tinted with
    lips: Colour
    hair: Colour
    iris: Colour
    brow: tuple[tuple[float, float], ...]  # a and y of its middle, from the nose outward
    brow_width: float  # half, at its thickest


COMPLEXIONS: Mapping[Variant, Complexion] = MappingProxyType(
    {
        "female": Complexion(
            skin=(0.60, 0.38, 0.285),
            flush=(0.62, 0.25, 0.20),
            lips=(0.50, 0.175, 0.165),
            hair=(0.060, 0.033, 0.022),
            iris=(0.10, 0.17, 0.16),
            brow=((0.20, 0.335), (0.42, 0.415), (0.64, 0.47), (0.82, 0.43), (0.97, 0.34)),
            brow_width=0.034,
        ),
        "male": Complexion(
            skin=(0.53, 0.325, 0.235),
            flush=(0.54, 0.22, 0.17),
            lips=(0.43, 0.20, 0.17),
            hair=(0.035, 0.024, 0.018),
            iris=(0.14, 0.085, 0.045),
            brow=((0.17, 0.315), (0.42, 0.38), (0.66, 0.41), (0.84, 0.37), (0.99, 0.29)),
            brow_width=0.048,
        ),
    }
)
MOUTH = -1.09  # y where closed lips meet
UPPER_LIP = ((0.0, -0.975), (0.07, -0.95), (0.22, -0.995), (0.36, -1.06), (0.43, MOUTH))  # edges of the red, a and y
LOWER_LIP = ((0.0, -1.30), (0.12, -1.295), (0.25, -1.235), (0.36, -1.15), (0.43, MOUTH))
FLUSHED = (  # a, y, half width, strength
    (0.62, -0.62, 0.26, 0.42),
    (0.0, -0.62, 0.13, 0.34),
    (0.0, -1.72, 0.20, 0.16),
)


@cache
def skin(complexion: Complexion) -> Floats:
    """Paints skin over the chart's window, (n, n, 4), first row at the bottom; the last is dryness, 0 on the lips."""
    random = np.random.default_rng(SEED)
    (left, right), (low, high) = LEFT_RIGHT, LOW_HIGH
    a = np.linspace(left, right, RESOLUTION)[None, :]
    y = np.linspace(low, high, RESOLUTION)[:, None]
    painted = np.empty((RESOLUTION, RESOLUTION, 4))
    found = painted[..., :3]
    found[:] = complexion.skin
    for centre, height, width, strength in FLUSHED:
        _mix(found, complexion.flush, strength * _bell(np.abs(a), centre, width) * _bell(y, height, width))
    shade = _bell(np.abs(a), 0.55, 0.30) * _bell(y, 0.02, 0.16)
    _mix(found, tuple(0.62 * each for each in complexion.flush), 0.30 * shade)  # lids are thin
    mottled = sum(
        amount
        * scipy.ndimage.gaussian_filter(random.standard_normal((RESOLUTION, RESOLUTION)), size, mode="wrap")
        * size
        for size, amount in ((1.2, 0.035), (7.0, 0.05))
    )
    inside = _step(y, low, low + 0.5) * _step(-y, -high, -high + 0.3) * _step(-np.abs(a), -right, -right + 0.4)
    mottled *= inside  # the border's pixels go on for ever
    found[..., 0] *= 1.0 + 0.6 * mottled
    found[..., 1:] *= (1.0 + mottled)[..., None]
    red = _lips(np.abs(a), y)
    _mix(found, complexion.lips, 0.85 * red)
    _mix(found, complexion.hair, _brows(complexion, random))
    painted[..., 3] = 1.0 - red
    return seal_own(painted.clip(0.0, 1.0, out=painted))


@cache
def iris(complexion: Complexion) -> Floats:
    """Paints an eye seen along its axis, (n, n, 3), of half width `EYE` radii of the eyeball."""
    random = np.random.default_rng(SEED)
    x, y = np.meshgrid(*[np.linspace(-EYE, EYE, FINE * IRIS_RESOLUTION)] * 2)
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    fibres = np.interp(angle, np.linspace(-np.pi, np.pi, 180), random.standard_normal(180), period=2 * np.pi)
    bright = 1.0 + 0.18 * fibres + 0.9 * np.exp(-(((radius - 0.24) / 0.07) ** 2)) - 0.35 * y / IRIS
    found = np.asarray(complexion.iris) * np.maximum(bright, 0.2)[..., None]
    _mix(found, (0.012, 0.012, 0.014), 0.85 * _step(radius, IRIS - 0.07, IRIS))  # the limbal ring
    _mix(found, (0.003, 0.003, 0.003), 1.0 - _step(radius, PUPIL - 0.02, PUPIL + 0.02))
    white = np.array([0.74, 0.70, 0.67]) - np.array([0.10, 0.22, 0.22]) * _step(radius, 0.45, 0.95)[..., None]
    _mix(found, white, _step(radius, IRIS - 0.015, IRIS + 0.035))
    return sealed(found.reshape(IRIS_RESOLUTION, FINE, IRIS_RESOLUTION, FINE, 3).mean(axis=(1, 3)))


def _lips(a: Floats, y: Floats) -> Floats:
    """(n, n) 1 on the red of the lips, 0 elsewhere, softly."""
    top, bottom = (np.interp(a, *np.array(edge).T) for edge in (UPPER_LIP, LOWER_LIP))
    drawn = (y < top) & (y > bottom) & (a < UPPER_LIP[-1][0])
    return _blurred(drawn.astype(np.float64), 4.0)


def _brows(complexion: Complexion, random: np.random.Generator) -> Floats:
    """(n, n) how dense the hair of the brows is, 0..1."""
    size = FINER * RESOLUTION
    canvas = Image.new("L", (size, size))
    pen = ImageDraw.Draw(canvas)
    along, middle, heights = _brow_line(complexion)
    for _ in range(STROKES // 2):
        t = random.uniform(0.0, 1.0)
        thick = complexion.brow_width * min(1.0, 0.35 + 3.0 * t, 1.9 * (1.04 - t))
        a = np.interp(t, along, middle) + random.uniform(-0.03, 0.02)
        y = np.interp(t, along, heights) + thick * random.uniform(-1.0, 0.8)
        lean = np.radians(np.interp(t, (0.0, 0.15, 0.6, 1.0), (62.0, 36.0, 10.0, -22.0)) + random.normal(0.0, 7.0))
        length = random.uniform(0.07, 0.11) * (0.75 if t > 0.85 else 1.0)
        tip = a + length * np.cos(lean), y + length * np.sin(lean)
        darkness = int(random.uniform(150, 245))
        for side in (1, -1):
            ends = [_pixel(side * each_a, each_y, size) for each_a, each_y in ((a, y), tip)]
            pen.line(ends, fill=darkness, width=4)
    fine = np.asarray(canvas.resize((RESOLUTION, RESOLUTION), Image.Resampling.BOX), dtype=np.float64) / 255
    return np.asarray(np.clip(0.85 * _blurred(fine, 0.6) + 0.35 * _blurred(fine, 7.0), 0.0, 0.92))


def _brow_line(complexion: Complexion) -> tuple[Floats, Floats, Floats]:
    """Share of the length 0..1, a and y of the points of one brow."""
    points = np.array(complexion.brow)
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return lengths / lengths[-1], points[:, 0], points[:, 1]


def _pixel(a: float, y: float, size: int) -> tuple[float, float]:
    """Where in a square picture whose first row is the chart's lowest."""
    (left, right), (low, high) = LEFT_RIGHT, LOW_HIGH
    return (a - left) / (right - left) * size, (y - low) / (high - low) * size


def _mix(picture: Floats, over: Colour | Floats, share: Floats) -> None:
    """Mixes some colour into a picture, and looks only where there is some of it."""
    part = _part(share > UNSEEN)
    added = np.broadcast_to(over, picture.shape)[part] - picture[part]
    added *= share[part][..., None]
    picture[part] += added


def _blurred(drawn: Floats, size: float) -> Floats:
    """Blurs a picture with little on it as far as that spreads."""
    part = _part(drawn != 0.0, int(BLUR * size + 0.5))
    found = np.zeros_like(drawn)
    found[part] = scipy.ndimage.gaussian_filter(drawn[part], size, truncate=BLUR)
    return found


def _part(there: NDArray[np.bool_], beyond: int = 0) -> tuple[slice, slice]:
    """Rows and columns that hold something, and some pixels beyond; a picture with nothing on it has none."""
    rows, columns = (np.flatnonzero(there.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return slice(0), slice(0)
    down, across = (slice(max(0, int(each[0]) - beyond), int(each[-1]) + beyond + 1) for each in (rows, columns))
    return down, across


def _bell(values: Floats, middle: float, width: float) -> Floats:
    return np.asarray(np.exp(-(((values - middle) / width) ** 2)))


def _step(values: Floats, low: float, high: float) -> Floats:
    """From 0 at low to 1 at high, smoothly."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))
