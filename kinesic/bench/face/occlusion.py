"""Benchmark of ambient occlusion on the face (thesis Table 3.1).

It measures exact and separable occlusion on a face and on boxes.

It measures times and differences.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from statistics import median
from typing import get_args

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from kinesic.bench.face.clock import DrawingClock
from kinesic.body.arrays import Flags, Floats
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import FRONT_CAMERA
from kinesic.face.render.geometry import PositionBuffer, PositionPass
from kinesic.face.render.occlusion import OcclusionPass, count_samples
from kinesic.face.render.passes import make_texture
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, TILE_SIZES, Estimator, Occlusion, Pattern

TABLE_SIZE = (1024, 768)  # [pixels] picture size of Table 3.1 of the thesis
TIMING_REPETITIONS = 5  # number of timed drawings per estimator
SMILE_UNITS = {"12": 0.5, "26": 0.6}  # action units of the drawn smile, with intensities
LARGEST_SETTINGS = Occlusion(size=21)  # occlusion with the largest filter
MAX_OCCLUDED_OPENNESS = 0.9  # openness below which a pixel counts as occluded; open pixels would hide errors
OTHER_SETTINGS = {  # further settings for the picture of boxes: thesis Figures 3.9 and 3.3
    "one_axis": replace(LARGEST_SETTINGS, axes=1),
    "one_axis_same_cost": replace(LARGEST_SETTINGS, axes=1, size=2 * LARGEST_SETTINGS.size - 1),
}
BOX_COUNT = 60  # random boxes in the compared picture
BOX_PICTURE_SIDE = 256  # [pixels] width and height of the picture of boxes
BOX_SCALE = 2000.0  # [pixels/m] scale of the picture of boxes
RGB_TO_XYZ = np.array(  # linear sRGB to XYZ: IEC 61966-2-1, D65
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE_POINT = np.array([0.95047, 1.0, 1.08883])  # XYZ coordinates of white D65
LAB_EPSILON = 216 / 24389  # relative luminance below which CIE L*a*b* is linear
LAB_KAPPA = 24389 / 27  # slope of the linear part of CIE L*a*b*


def measure_occlusion(sizes: Sequence[int]) -> dict[str, float]:
    """Measure times [ms] and errors of all ambient-occlusion estimators and sizes."""
    metrics = {
        "face.occlusion.samples_21_exact": float(count_samples(replace(LARGEST_SETTINGS, exact=True))),
        "face.occlusion.samples_21_separable": float(count_samples(LARGEST_SETTINGS)),
    }
    with Portrait(preset=replace(NORMAL_PRESET, subdivided=True, hair=False), size=TABLE_SIZE) as portrait:
        geometry = portrait.pipeline.geometry
        with geometry.context as context:
            geometry.draw(SMILE_UNITS, FRONT_CAMERA)
            head, seen = geometry.parts() > 0, PositionPass(context, geometry).draw()
            clock = DrawingClock(context)
            scale = TABLE_SIZE[1] / (2 * FRONT_CAMERA.distance * np.tan(np.radians(FRONT_CAMERA.field_deg) / 2))
            for estimator in get_args(Estimator):
                for size in sizes:
                    settings = Occlusion(size=size, estimator=estimator)
                    metrics |= _compare_passes(clock, seen, settings, scale, head)
            metrics |= _measure_boxes(context)
    return metrics | _measure_picture()


def _compare_passes(
    clock: DrawingClock, seen: PositionBuffer, settings: Occlusion, scale: float, head: Flags
) -> dict[str, float]:
    passes = {
        "separable": OcclusionPass(clock.context, seen, settings),
        "exact": OcclusionPass(clock.context, seen, replace(settings, exact=True)),
    }
    openness = {kind: occluder.draw(scale).read()[..., 0][head] for kind, occluder in passes.items()}
    times: dict[str, list[float]] = {kind: [] for kind in passes}
    for _ in range(TIMING_REPETITIONS):  # alternating, so that other load affects both
        for kind, occluder in passes.items():
            times[kind].append(clock.milliseconds(partial(occluder.draw, scale)))
    exact, separable = median(times["exact"]), median(times["separable"])
    stem = f"face.occlusion.{settings.estimator}_{settings.size}"
    return {
        f"{stem}_exact": exact,
        f"{stem}_separable": separable,
        f"{stem}_ratio": exact / separable,
        f"{stem}_rmse": rmse(openness["exact"], openness["separable"]),
        f"{stem}_rmse_occluded": rmse_occluded(openness["exact"], openness["separable"]),
    }


def _measure_boxes(context: GlContext) -> dict[str, float]:
    """Measure errors of separable against exact occlusion on random boxes."""
    position, normal = (make_texture(context, values, "f4") for values in render_boxes())
    for source in (position, normal):
        source.filter = (gl.GL_NEAREST, gl.GL_NEAREST)
    seen = PositionBuffer(position, normal)

    def draw_openness(settings: Occlusion) -> Floats:
        return OcclusionPass(context, seen, settings).draw(BOX_SCALE).read()[..., 0]

    exact, separable = draw_openness(replace(LARGEST_SETTINGS, exact=True)), draw_openness(LARGEST_SETTINGS)
    return {
        "face.occlusion.boxes_rmse": rmse(exact, separable),
        "face.occlusion.boxes_rmse_occluded": rmse_occluded(exact, separable),
        "face.occlusion.boxes_correlation": float(np.corrcoef(exact.ravel(), separable.ravel())[0, 1]),
        **{
            f"face.occlusion.boxes_{pattern}_rmse": rmse(
                exact, draw_openness(replace(LARGEST_SETTINGS, pattern=pattern))
            )
            for pattern in get_args(Pattern)
        },
        **{
            f"face.occlusion.boxes_tile_{tile}_rmse": rmse(exact, draw_openness(replace(LARGEST_SETTINGS, tile=tile)))
            for tile in TILE_SIZES
        },
        **{
            f"face.occlusion.boxes_{name}_rmse": rmse(exact, draw_openness(settings))
            for name, settings in OTHER_SETTINGS.items()
        },
    }


def render_boxes() -> tuple[Floats, Floats]:
    """Return positions and normals (n, n, 4) of boxes seen from above.

    The fourth number of a position is its part.
    """
    random = np.random.default_rng(3)
    y, x = np.mgrid[:BOX_PICTURE_SIDE, :BOX_PICTURE_SIDE] / BOX_SCALE
    height = np.zeros((BOX_PICTURE_SIDE, BOX_PICTURE_SIDE))
    for _ in range(BOX_COUNT):
        left, low = random.integers(0, BOX_PICTURE_SIDE - 16, 2)
        wide, tall = random.integers(8, 56, 2)
        height[low : low + tall, left : left + wide] = random.uniform(0.002, 0.02)
    position = np.stack([x, y, height - 0.8, np.ones_like(x)], axis=-1)
    return position, np.broadcast_to((0.0, 0.0, 1.0, 0.0), position.shape).copy()


def _measure_picture() -> dict[str, float]:
    """Measure colour differences between exact and separable occlusion on the head.

    It is measured in the occlusion buffers and in the pictures (thesis Figure 3.10).
    """
    drawn = []
    for exact in (False, True):
        occlusion = replace(LARGEST_SETTINGS, exact=exact)
        with Portrait(preset=replace(NORMAL_PRESET, occlusion=occlusion, coarse=1)) as portrait:
            picture = portrait.draw(SMILE_UNITS)
            with portrait.pipeline.geometry.context:
                head = portrait.pipeline.geometry.parts() > 0
            drawn.append((read_openness(portrait), picture))
    buffers, pictures = zip(*drawn, strict=True)
    in_buffers = colour_difference(*map(to_grey, buffers))[head]
    in_pictures = colour_difference(*pictures)[maximum_filter(head, 3)]
    return {
        "face.occlusion.lab_mean": float(in_pictures.mean()),
        "face.occlusion.lab_p95": float(np.percentile(in_pictures, 95)),
        "face.occlusion.buffer_lab_mean": float(in_buffers.mean()),
        "face.occlusion.buffer_lab_p95": float(np.percentile(in_buffers, 95)),
    }


def read_openness(portrait: Portrait) -> Floats:
    """Return the openness (height, width) of each pixel as last drawn.

    Raises:
        ValueError: the portrait is drawn without occlusion.
    """
    occluder = portrait.pipeline.occlusion
    if occluder is None:
        raise ValueError("drawn without occlusion")
    with portrait.pipeline.geometry.context:
        return (occluder.march, *occluder.blurs)[-1].target.read()[..., 0]


def to_grey(openness: Floats) -> NDArray[np.uint8]:
    """Convert openness 0..1 to grey pixels (..., 3)."""
    levels = np.rint(255 * np.clip(openness, 0.0, 1.0)).astype(np.uint8)
    return np.repeat(levels[..., None], 3, axis=-1)


def rmse(one: Floats, other: Floats) -> float:
    """Return the root mean square difference of two occlusion pictures."""
    return float(np.sqrt(np.mean((one - other) ** 2)))


def rmse_occluded(exact: Floats, other: Floats) -> float:
    """Return the root mean square difference of occlusion at occluded pixels."""
    occluded = exact < MAX_OCCLUDED_OPENNESS
    return rmse(exact[occluded], other[occluded])


def lab(pixels: NDArray[np.uint8]) -> Floats:
    """Convert sRGB pixels (..., 3) to CIE L*a*b* (thesis 3.5)."""
    encoded = pixels / 255.0
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    ratios = linear @ RGB_TO_XYZ.T / WHITE_POINT
    x, y, z = np.moveaxis(np.where(ratios > LAB_EPSILON, np.cbrt(ratios), (LAB_KAPPA * ratios + 16) / 116), -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def colour_difference(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> Floats:
    """Return the L*a*b* distance between two pictures' colours, pixel by pixel.

    1 is about the smallest visible difference.
    """
    return np.asarray(np.linalg.norm(lab(one) - lab(other), axis=-1))
