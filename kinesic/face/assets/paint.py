"""Procedural painting of skin, brows and iris.

Skin and brows are painted in the chart of the head, the iris around the axis of an eye. There are no image assets; all
pictures come from a few numbers and a seed. Colours are linear.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, seal_in_place, sealed
from kinesic.body.choices import Variant
from kinesic.face.assets.chart import WINDOW_LEFT_RIGHT, WINDOW_LOW_HIGH
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.pores import paint_creases, paint_oil, paint_pores
from kinesic.files.late_pillow import Image, ImageDraw

Colour = tuple[float, ...]  # red, green, blue

SKIN_RESOLUTION = 1024  # [pixels] side of the skin texture
PORE_DARKNESS = 0.09  # fraction by which the skin is darkened in the deepest pores and creases
PORE_DRYNESS = 0.25  # dryness that the deepest pores and creases add to the skin
OIL_SHINE = 0.12  # largest reduction of the skin's dryness by oil
BROW_HAIR_COUNT = 1700  # number of hairs of both brows together
BROW_HAIR_WIDTHS = (4, 2)  # [pixels of the oversampled picture] width of a brow hair at root and tip
BROW_OVERSAMPLING = 4  # resolution in which brows are drawn / SKIN_RESOLUTION
PAINT_SEED = 7  # seed of the random generator for painted skin and brows
IRIS_RESOLUTION = 256  # [pixels] side of the iris texture
IRIS_OVERSAMPLING = 2  # resolution in which the iris is computed / IRIS_RESOLUTION
EYE_HALF_WIDTH = 0.8  # half width of the painted square, in radii of the eyeball
MIN_OPACITY = 1e-12  # opacity below which a colour is skipped
BLUR_REACH = 4.0  # range of a blur, in standard deviations of its Gaussian
IRIS_RADIUS = 0.40  # [eyeball radii] radius of the painted iris
PUPIL_RADIUS = 0.17  # [eyeball radii] radius of the painted pupil


@dataclass(frozen=True)
class Complexion:
    """Skin, hair and eye colours of a person, and brow shape."""

    skin: Colour
    flush: Colour  # tint of cheeks, nose and chin
    lips: Colour
    hair: Colour
    iris: Colour
    brow: tuple[tuple[float, float], ...]  # chart a and y of the centre line, from the nose outward
    brow_width: float  # maximum half width in the chart
    beard: float = 0.0  # darkness of a shaven beard, 0..1


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
            skin=(0.46, 0.27, 0.18),
            flush=(0.47, 0.18, 0.13),
            lips=(0.36, 0.165, 0.135),
            hair=(0.022, 0.016, 0.013),
            iris=(0.14, 0.085, 0.045),
            brow=((0.17, 0.315), (0.42, 0.38), (0.66, 0.41), (0.84, 0.37), (0.99, 0.29)),
            brow_width=0.056,
            beard=0.26,
        ),
    }
)
MOUTH_LINE = -1.09  # height at which closed lips meet, as chart coordinate y
UPPER_LIP = (
    (0.0, -0.975),
    (0.07, -0.95),
    (0.22, -0.995),
    (0.36, -1.06),
    (0.43, MOUTH_LINE),
)  # upper edge of the red lips as chart coordinates a and y
# Lower edge of the red lips as chart coordinates a and y.
LOWER_LIP = ((0.0, -1.30), (0.12, -1.295), (0.25, -1.235), (0.36, -1.15), (0.43, MOUTH_LINE))
MOUTH_CORNER = (0.38, 0.025)  # lateral chart coordinate of the mouth corners, and width of their shade
CORNER_SHADE = 0.35  # factor on the lips' colour in the corners of the mouth
# Upper and lower edge of a beard as chart coordinates a and y.
BEARD_TOP = ((0.0, -0.82), (0.3, -0.86), (0.5, -1.12), (0.9, -1.22), (1.25, -0.95), (1.45, -0.55), (1.6, -0.3))
BEARD_BOTTOM = ((0.0, -2.05), (0.6, -2.0), (1.2, -1.5), (1.45, -1.0), (1.6, -0.3))
BEARD_SHADE = np.array([0.42, 0.45, 0.52])  # colour of a shaven beard relative to the skin
FLUSHED_AREAS = (  # reddish areas of the skin: chart coordinates a and y, half width, strength
    (0.62, -0.62, 0.32, 0.26),
    (0.0, -0.62, 0.13, 0.34),
    (0.0, -1.72, 0.20, 0.16),
)


@cache
def paint_skin(complexion: Complexion) -> Floats:
    """Return the painted texture (n, n, 4) of the face skin.

    The first row is the bottom row. The last component is dryness: 0 on the lips, 1 in pores of dry skin.
    """
    random = np.random.default_rng(PAINT_SEED)
    (left, right), (low, high) = WINDOW_LEFT_RIGHT, WINDOW_LOW_HIGH
    a = np.linspace(left, right, SKIN_RESOLUTION)[None, :]
    y = np.linspace(low, high, SKIN_RESOLUTION)[:, None]
    painted = np.empty((SKIN_RESOLUTION, SKIN_RESOLUTION, 4))
    colours = painted[..., :3]
    colours[:] = complexion.skin
    for centre, height, width, strength in FLUSHED_AREAS:
        _mix_colour(
            colours,
            complexion.flush,
            strength * _evaluate_bell(np.abs(a), centre, width) * _evaluate_bell(y, height, width),
        )
    shade = _evaluate_bell(np.abs(a), 0.55, 0.30) * _evaluate_bell(y, 0.02, 0.16)
    _mix_colour(colours, tuple(0.62 * component for component in complexion.flush), 0.30 * shade)  # lids are thin
    mottled = sum(
        amount
        * scipy.ndimage.gaussian_filter(random.standard_normal((SKIN_RESOLUTION, SKIN_RESOLUTION)), size, mode="wrap")
        * size
        for size, amount in ((1.2, 0.06), (3.0, 0.08), (7.0, 0.08))
    )
    inside = (
        _smoothstep(y, low, low + 0.5)
        * _smoothstep(-y, -high, -high + 0.3)
        * _smoothstep(-np.abs(a), -right, -right + 0.4)
    )
    mottled *= inside  # border pixels are repeated outside the window
    colours[..., 0] *= 1.0 + 0.6 * mottled
    colours[..., 1:] *= (1.0 + mottled)[..., None]
    red = _paint_lips(np.abs(a), y)
    if complexion.beard:
        stubble = complexion.beard * _paint_beard(np.abs(a), y) * (1.0 + 2.5 * mottled).clip(0.4, 1.6)
        _mix_colour(colours, BEARD_SHADE * np.asarray(complexion.skin), stubble * (1.0 - red))
    _mix_colour(colours, complexion.lips, 0.85 * red)
    corner = _evaluate_bell(np.abs(a), *MOUTH_CORNER) * _evaluate_bell(y, MOUTH_LINE, MOUTH_CORNER[1])
    _mix_colour(colours, tuple(CORNER_SHADE * component for component in complexion.lips), 0.5 * corner)
    _mix_colour(colours, complexion.hair, _paint_brows(complexion, random))
    oil = paint_oil(np.abs(a), y)
    creases = paint_creases(SKIN_RESOLUTION, SKIN_RESOLUTION, random)
    pits = inside * ((1.0 - red) * paint_pores(oil, random) + red * creases)
    colours *= 1.0 - PORE_DARKNESS * pits[..., None]
    painted[..., 3] = (1.0 - red) * (1.0 - PORE_DRYNESS - OIL_SHINE * oil) + PORE_DRYNESS * pits
    return seal_in_place(painted.clip(0.0, 1.0, out=painted))


@cache
def paint_iris(complexion: Complexion) -> Floats:
    """Return an (n, n, 3) picture of an eye along its axis.

    Its half width is `EYE_HALF_WIDTH` radii of the eyeball.
    """
    random = np.random.default_rng(PAINT_SEED)
    x, y = np.meshgrid(*[np.linspace(-EYE_HALF_WIDTH, EYE_HALF_WIDTH, IRIS_OVERSAMPLING * IRIS_RESOLUTION)] * 2)
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    waves = angle + 0.25 * np.sin(5.0 * angle) * (radius - PUPIL_RADIUS)  # fibres are not quite straight
    coarse, fine = (
        np.interp(waves, np.linspace(-np.pi, np.pi, count), random.standard_normal(count), period=2 * np.pi)
        for count in (60, 180)
    )
    fibres = coarse * _evaluate_bell(radius, 0.32, 0.10) + fine
    bright = 1.0 + 0.26 * fibres + 0.9 * np.exp(-(((radius - 0.24) / 0.07) ** 2)) - 0.35 * y / IRIS_RADIUS
    colours = np.asarray(complexion.iris) * np.maximum(bright, 0.2)[..., None]
    _mix_colour(
        colours, (0.012, 0.012, 0.014), 0.75 * _smoothstep(radius, IRIS_RADIUS - 0.09, IRIS_RADIUS)
    )  # the limbal ring
    _mix_colour(colours, (0.003, 0.003, 0.003), 1.0 - _smoothstep(radius, PUPIL_RADIUS - 0.02, PUPIL_RADIUS + 0.02))
    white = np.array([0.74, 0.70, 0.67]) - np.array([0.10, 0.22, 0.22]) * _smoothstep(radius, 0.45, 0.95)[..., None]
    _mix_colour(colours, white, _smoothstep(radius, IRIS_RADIUS - 0.03, IRIS_RADIUS + 0.06))
    return sealed(
        colours.reshape(IRIS_RESOLUTION, IRIS_OVERSAMPLING, IRIS_RESOLUTION, IRIS_OVERSAMPLING, 3).mean(axis=(1, 3))
    )


def _paint_beard(a: Floats, y: Floats) -> Floats:
    """Return the (n, n) soft mask 0..1 of a beard."""
    top = np.interp(a, *np.array(BEARD_TOP).T)
    bottom = np.interp(a, *np.array(BEARD_BOTTOM).T)
    return _blur(((y < top) & (y > bottom)).astype(np.float64), 14.0)


def _paint_lips(a: Floats, y: Floats) -> Floats:
    """Return the (n, n) soft mask 0..1 of the red lips."""
    top, bottom = (np.interp(a, *np.array(edge).T) for edge in (UPPER_LIP, LOWER_LIP))
    drawn = (y < top) & (y > bottom) & (a < UPPER_LIP[-1][0])
    return _blur(drawn.astype(np.float64), 4.0)


def _paint_brows(complexion: Complexion, random: np.random.Generator) -> Floats:
    """Return the (n, n) density of brow hair, 0..1."""
    size = BROW_OVERSAMPLING * SKIN_RESOLUTION
    canvas = Image.new("L", (size, size))
    pen = ImageDraw.Draw(canvas)
    along, middle, heights = _measure_brow(complexion)
    for _ in range(BROW_HAIR_COUNT // 2):
        t = random.uniform(0.0, 1.0)
        thick = complexion.brow_width * min(1.0, 0.35 + 3.0 * t, 1.9 * (1.04 - t))
        a = np.interp(t, along, middle) + random.uniform(-0.03, 0.02)
        y = np.interp(t, along, heights) + thick * random.uniform(-1.0, 0.8)
        lean = np.radians(np.interp(t, (0.0, 0.15, 0.6, 1.0), (62.0, 36.0, 10.0, -22.0)) + random.normal(0.0, 7.0))
        length = random.uniform(0.06, 0.12) * (0.75 if t > 0.85 else 1.0)
        bend = lean - np.radians(random.uniform(0.0, 22.0))  # hairs curve outward
        middle_point = a + 0.5 * length * np.cos(lean), y + 0.5 * length * np.sin(lean)
        tip = middle_point[0] + 0.5 * length * np.cos(bend), middle_point[1] + 0.5 * length * np.sin(bend)
        darkness = int(random.uniform(120, 245))
        for side in (1, -1):
            root, halfway, end = (
                _to_pixel(side * each_a, each_y, size) for each_a, each_y in ((a, y), middle_point, tip)
            )
            for ends, width in zip(((root, halfway), (halfway, end)), BROW_HAIR_WIDTHS, strict=True):
                pen.line(ends, fill=darkness, width=width)
    fine = np.asarray(canvas.resize((SKIN_RESOLUTION, SKIN_RESOLUTION), Image.Resampling.BOX), dtype=np.float64) / 255
    return np.asarray(np.clip(0.95 * _blur(fine, 0.5) + 0.40 * _blur(fine, 7.0), 0.0, 0.92))


def _measure_brow(complexion: Complexion) -> tuple[Floats, Floats, Floats]:
    """Return brow points: position 0..1 along the brow, chart a, chart y."""
    points = np.array(complexion.brow)
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return lengths / lengths[-1], points[:, 0], points[:, 1]


def _to_pixel(a: float, y: float, size: int) -> tuple[float, float]:
    """Convert head surface coordinates to pixels of a square picture.

    The first row is at the lowest y.
    """
    (left, right), (low, high) = WINDOW_LEFT_RIGHT, WINDOW_LOW_HIGH
    return (a - left) / (right - left) * size, (y - low) / (high - low) * size


def _mix_colour(picture: Floats, over: Colour | Floats, opacity: Floats) -> None:
    """Blend a colour into a picture where its opacity is not negligible."""
    part = _find_window(opacity > MIN_OPACITY)
    added = np.broadcast_to(over, picture.shape)[part] - picture[part]
    added *= opacity[part][..., None]
    picture[part] += added


def _blur(drawn: Floats, size: float) -> Floats:
    """Return a picture blurred with a standard deviation of `size` [pixels]."""
    part = _find_window(drawn != 0.0, int(BLUR_REACH * size + 0.5))
    blurred = np.zeros_like(drawn)
    blurred[part] = scipy.ndimage.gaussian_filter(drawn[part], size, truncate=BLUR_REACH)
    return blurred


def _find_window(there: NDArray[np.bool_], beyond: int = 0) -> tuple[slice, slice]:
    """Return rows and columns of a mask's non-zero region, with a margin.

    An empty picture gives empty slices.
    """
    rows, columns = (np.flatnonzero(there.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return slice(0), slice(0)
    down, across = (
        slice(max(0, int(indices[0]) - beyond), int(indices[-1]) + beyond + 1) for indices in (rows, columns)
    )
    return down, across


def _evaluate_bell(values: Floats, middle: float, width: float) -> Floats:
    return np.asarray(np.exp(-(((values - middle) / width) ** 2)))


def _smoothstep(values: Floats, low: float, high: float) -> Floats:
    """Return a smooth step from 0 at low to 1 at high."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))
