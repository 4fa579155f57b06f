"""Benchmark of the frame rate of a moving face, read-back included."""

from collections.abc import Iterator, Sequence
from itertools import islice
from math import sin
from statistics import median
from time import perf_counter, process_time

from kinesic.face.gl.textures import Size
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET, NORMAL_PRESET, QUALITY_PRESETS

WARM_UP_FRAMES = 3  # frames drawn before the measurement
MEASURED_FRAMES = 48  # number of timed frames of the draft and normal presets, per size
SLOW_PRESET_FRAMES = 6  # number of timed frames of all other presets, per size


def measure_frame_rates(sizes: Sequence[Size]) -> dict[str, float]:
    """Measure frame rates [Hz], CPU times [ms] and the head's picture fraction.

    The rates and times are by preset and picture size; the fraction [%] is the smallest one.
    """
    metrics = {}
    for name, preset in QUALITY_PRESETS.items():
        for width, height in sizes:
            with Portrait(preset=preset, size=(width, height)) as portrait:
                wall, cpu = _time_frames(
                    portrait, MEASURED_FRAMES if preset in (DRAFT_PRESET, NORMAL_PRESET) else SLOW_PRESET_FRAMES
                )
            metrics[f"face.fps.{name}_{width}x{height}"] = 1.0 / wall
            metrics[f"face.fps.{name}_{width}x{height}_cpu"] = 1000.0 * cpu
    with Portrait(preset=NORMAL_PRESET, size=sizes[0]) as portrait:
        metrics["face.fps.covered"] = 100.0 * min(
            _coverage(portrait, *frame) for frame in islice(moving_face(), MEASURED_FRAMES)
        )
    return metrics


def moving_face() -> Iterator[tuple[dict[str, float], Camera]]:
    """Yield action units and cameras of an endless, never repeating head motion."""
    k = 0
    while True:
        units = {
            "1": 0.4 + 0.3 * sin(0.2 * k),
            "6": 0.5 + 0.2 * sin(0.31 * k),
            "12": 0.5 + 0.4 * sin(0.3 * k),
            "26": 0.3 + 0.3 * sin(0.9 * k),
            "45": max(0.0, sin(0.4 * k)),
            "61": 0.3 + 0.3 * sin(0.13 * k),
        }
        yield units, Camera(yaw_deg=12.0 * sin(0.17 * k))
        k += 1


def _time_frames(portrait: Portrait, count: int) -> tuple[float, float]:
    """Return the median wall time and CPU time [s] of a frame."""
    wall, cpu = [], []
    for units, camera in islice(moving_face(), WARM_UP_FRAMES + count):
        began, spent = perf_counter(), process_time()
        portrait.draw(units, camera)
        wall.append(perf_counter() - began)
        cpu.append(process_time() - spent)
    return median(wall[WARM_UP_FRAMES:]), median(cpu[WARM_UP_FRAMES:])


def _coverage(portrait: Portrait, units: dict[str, float], camera: Camera) -> float:
    geometry = portrait.pipeline.geometry
    with geometry.context:
        geometry.draw(units, camera)
        return float((geometry.parts() > 0).mean())
