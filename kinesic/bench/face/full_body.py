"""Benchmark of the full body: frame rate and time of skinning."""

from collections.abc import Iterator
from itertools import islice
from math import sin
from statistics import median
from time import perf_counter, process_time
from typing import get_args

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.skinning import Blending, Skin
from kinesic.face.gl.textures import Size
from kinesic.face.render.figure import FILM_PRESET, UPPER_BODY_CAMERA, FigurePortrait
from kinesic.face.render.presets import DRAFT_PRESET, NORMAL_PRESET, Preset

WARM_UP_FRAMES = 3  # frames drawn before the measurement
MEASURED_FRAMES = 24  # number of timed frames per picture size
SQUARE_SIZE = (512, 512)  # [pixels] width and height of square pictures
WIDE_SIZE = (1280, 720)  # [pixels] width and height of wide pictures
TIMED_PICTURES: dict[str, tuple[Preset, Size]] = {
    "draft_512x512": (DRAFT_PRESET, SQUARE_SIZE),
    "normal_512x512": (NORMAL_PRESET, SQUARE_SIZE),
    "filmed_1280x720": (FILM_PRESET, WIDE_SIZE),
}
METRIC_PREFIX = "face.figure."


def measure_full_body() -> dict[str, float]:
    """Measure median frame rates, read-back included, and skinning times [ms]."""
    skeleton = Robot.load("human").skeleton
    metrics = {}
    for name, (preset, size) in TIMED_PICTURES.items():
        with FigurePortrait(skeleton, preset=preset, size=size) as portrait:
            wall_times = []
            for angles in islice(_make_moving_postures(skeleton), WARM_UP_FRAMES + MEASURED_FRAMES):
                began = perf_counter()
                portrait.draw(angles, {"12": 0.5, "26": float(angles[0] > 0.0)}, UPPER_BODY_CAMERA)
                wall_times.append(perf_counter() - began)
        metrics[f"{METRIC_PREFIX}{name}"] = 1.0 / median(wall_times[WARM_UP_FRAMES:])
    points = load_figure().mesh.positions
    for blending in get_args(Blending):
        skin, cpu_times = Skin(load_figure(), skeleton, blending=blending), []
        for angles in islice(_make_moving_postures(skeleton), MEASURED_FRAMES // 2):
            began = process_time()
            skin.move_skin(points, angles)
            cpu_times.append(1000.0 * (process_time() - began))
        metrics[f"{METRIC_PREFIX}{blending}_ms"] = median(cpu_times)
    return metrics


def _make_moving_postures(skeleton: Skeleton) -> Iterator[Floats]:
    """Yield endless, never repeating postures with all joints in motion."""
    k = 0
    while True:
        fractions = [0.5 + 0.4 * sin(0.1 * k + 1.7 * joint) for joint in range(len(skeleton.hinges))]
        yield skeleton.lower + (skeleton.upper - skeleton.lower) * fractions
        k += 1
