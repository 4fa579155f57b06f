"""Measures Table 3.1 again: occlusion exact and separable, times and difference, on a face and on boxes."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from statistics import median
from typing import get_args

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from kinesic.bench.face.clock import Clock
from kinesic.body.arrays import Flags, Floats
from kinesic.face.gl import numbers as gl
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import FRONT
from kinesic.face.render.geometry import PositionBuffer, PositionPass
from kinesic.face.render.occlusion import OcclusionPass, samples
from kinesic.face.render.passes import texture
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL, TILES, Estimator, Occlusion, Pattern

TABLE_SIZE = (1024, 768)  # pixels; the thesis has 50 000 triangles, the finer head has 41 000
REPETITIONS = 5
UNITS = {"12": 0.5, "26": 0.6}
LARGEST = Occlusion(size=21)
OCCLUDED = 0.9  # openness of pixels that count as occluded, at most: most of a face is open, and hides errors
OTHERWISE = {  # what boxes are drawn with, too: Figure 3.9, 3.3
    "one_axis": replace(LARGEST, axes=1),
    "one_axis_same_cost": replace(LARGEST, axes=1, size=2 * LARGEST.size - 1),
}
BOXES, SIDE = 60, 256  # in how many pixels along a side
SCALE = 2000.0  # [pixels/m] there
TO_XYZ = np.array(  # IEC 61966-2-1, D65
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
SMALL, STEEP = 216 / 24389, 24389 / 27


def occlusion(sizes: Sequence[int]) -> dict[str, float]:
    """Measures milliseconds of each estimator and size, exact and separable, and how far apart they are."""
    found = {
        "face.occlusion.samples_21_exact": float(samples(replace(LARGEST, exact=True))),
        "face.occlusion.samples_21_separable": float(samples(LARGEST)),
    }
    with Portrait(preset=replace(NORMAL, subdivided=True, hair=False), size=TABLE_SIZE) as portrait:
        geometry = portrait.pipeline.geometry
        with geometry.context as context:
            geometry.draw(UNITS, FRONT)
            head, seen = geometry.parts() > 0, PositionPass(context, geometry).draw()
            clock = Clock(context)
            scale = TABLE_SIZE[1] / (2 * FRONT.distance * np.tan(np.radians(FRONT.field_deg) / 2))
            for estimator in get_args(Estimator):
                for size in sizes:
                    settings = Occlusion(size=size, estimator=estimator)
                    found |= _compared(clock, seen, settings, scale, head)
            found |= _on_boxes(context)
    return found | _on_the_picture()


def _compared(clock: Clock, seen: PositionBuffer, settings: Occlusion, scale: float, head: Flags) -> dict[str, float]:
    passes = {
        "separable": OcclusionPass(clock.context, seen, settings),
        "exact": OcclusionPass(clock.context, seen, replace(settings, exact=True)),
    }
    openness = {kind: each.draw(scale).read()[..., 0][head] for kind, each in passes.items()}
    times: dict[str, list[float]] = {kind: [] for kind in passes}
    for _ in range(REPETITIONS):  # by turns, so that other load falls on both
        for kind, each in passes.items():
            times[kind].append(clock.milliseconds(partial(each.draw, scale)))
    exact, separable = median(times["exact"]), median(times["separable"])
    stem = f"face.occlusion.{settings.estimator}_{settings.size}"
    return {
        f"{stem}_exact": exact,
        f"{stem}_separable": separable,
        f"{stem}_ratio": exact / separable,
        f"{stem}_rmse": rmse(openness["exact"], openness["separable"]),
        f"{stem}_rmse_occluded": rmse_occluded(openness["exact"], openness["separable"]),
    }


def _on_boxes(context: GlContext) -> dict[str, float]:
    """How far separable is from exact where more is hidden, with each pattern."""
    position, normal = (texture(context, each, "f4") for each in boxes())
    for each in (position, normal):
        each.filter = (gl.NEAREST, gl.NEAREST)
    seen = PositionBuffer(position, normal)

    def opened(settings: Occlusion) -> Floats:
        return OcclusionPass(context, seen, settings).draw(SCALE).read()[..., 0]

    exact, separable = opened(replace(LARGEST, exact=True)), opened(LARGEST)
    return {
        "face.occlusion.boxes_rmse": rmse(exact, separable),
        "face.occlusion.boxes_rmse_occluded": rmse_occluded(exact, separable),
        "face.occlusion.boxes_correlation": float(np.corrcoef(exact.ravel(), separable.ravel())[0, 1]),
        **{
            f"face.occlusion.boxes_{pattern}_rmse": rmse(exact, opened(replace(LARGEST, pattern=pattern)))
            for pattern in get_args(Pattern)
        },
        **{
            f"face.occlusion.boxes_tile_{tile}_rmse": rmse(exact, opened(replace(LARGEST, tile=tile))) for tile in TILES
        },
        **{f"face.occlusion.boxes_{name}_rmse": rmse(exact, opened(settings)) for name, settings in OTHERWISE.items()},
    }


def boxes() -> tuple[Floats, Floats]:
    """(n, n, 4) positions with part, and normals, of a heap of boxes seen from above."""
    random = np.random.default_rng(3)
    y, x = np.mgrid[:SIDE, :SIDE] / SCALE
    height = np.zeros((SIDE, SIDE))
    for _ in range(BOXES):
        left, low = random.integers(0, SIDE - 16, 2)
        wide, tall = random.integers(8, 56, 2)
        height[low : low + tall, left : left + wide] = random.uniform(0.002, 0.02)
    position = np.stack([x, y, height - 0.8, np.ones_like(x)], axis=-1)
    return position, np.broadcast_to((0.0, 0.0, 1.0, 0.0), position.shape).copy()


def _on_the_picture() -> dict[str, float]:
    """What is seen of the difference, in CIE Lab, where the head is."""
    pictures = []
    for exact in (False, True):
        preset = replace(NORMAL, occlusion=replace(LARGEST, exact=exact), coarse=1)
        with Portrait(preset=preset) as portrait:
            pictures.append(portrait.draw(UNITS))
            with portrait.pipeline.geometry.context:
                head = portrait.pipeline.geometry.parts() > 0
    apart = colour_difference(*pictures)[maximum_filter(head, 3)]
    return {
        "face.occlusion.lab_mean": float(apart.mean()),
        "face.occlusion.lab_p95": float(np.percentile(apart, 95)),
    }


def rmse(one: Floats, other: Floats) -> float:
    """Root of the mean square of the difference."""
    return float(np.sqrt(np.mean((one - other) ** 2)))


def rmse_occluded(exact: Floats, other: Floats) -> float:
    """The same of the pixels alone that are occluded."""
    occluded = exact < OCCLUDED
    return rmse(exact[occluded], other[occluded])


def lab(pixels: NDArray[np.uint8]) -> Floats:
    """Converts (..., 3) sRGB pixels into L*, a* and b* (CIE 1976, thesis 3.5)."""
    encoded = pixels / 255.0
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    shares = linear @ TO_XYZ.T / WHITE
    x, y, z = np.moveaxis(np.where(shares > SMALL, np.cbrt(shares), (STEEP * shares + 16) / 116), -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def colour_difference(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> Floats:
    """Measures how far colours are apart (...); 1 is about what people can see."""
    return np.asarray(np.linalg.norm(lab(one) - lab(other), axis=-1))
