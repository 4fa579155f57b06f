"""How many pictures of a moving face are drawn in a second, read back and all."""

from collections.abc import Iterator, Sequence
from itertools import islice
from math import sin
from statistics import median
from time import perf_counter, process_time

from kinesic.face.gl.textures import Size
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT, NORMAL, PRESETS

WARM, FRAMES = 3, 48
SLOW_FRAMES = 6  # of a preset that takes its time


def frames(sizes: Sequence[Size]) -> dict[str, float]:
    """Measures pictures a second and processor time of one, by preset and size, and how much the head covers."""
    found = {}
    for name, preset in PRESETS.items():
        for width, height in sizes:
            with Portrait(preset=preset, size=(width, height)) as portrait:
                wall, cpu = _timed(portrait, FRAMES if preset in (DRAFT, NORMAL) else SLOW_FRAMES)
            found[f"face.fps.{name}_{width}x{height}"] = 1.0 / wall
            found[f"face.fps.{name}_{width}x{height}_cpu"] = 1000.0 * cpu
    with Portrait(preset=NORMAL, size=sizes[0]) as portrait:
        found["face.fps.covered"] = 100.0 * min(_covered(portrait, *frame) for frame in islice(moving_face(), FRAMES))
    return found


def moving_face() -> Iterator[tuple[dict[str, float], Camera]]:
    """Yields a face that talks, smiles, blinks and looks about as the head turns; never the same twice."""
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


def _timed(portrait: Portrait, count: int) -> tuple[float, float]:
    """Seconds of the clock and of the processors for a frame, at the median."""
    wall, cpu = [], []
    for units, camera in islice(moving_face(), WARM + count):
        began, spent = perf_counter(), process_time()
        portrait.draw(units, camera)
        wall.append(perf_counter() - began)
        cpu.append(process_time() - spent)
    return median(wall[WARM:]), median(cpu[WARM:])


def _covered(portrait: Portrait, units: dict[str, float], camera: Camera) -> float:
    geometry = portrait.pipeline.geometry
    with geometry.context:
        geometry.draw(units, camera)
        return float((geometry.parts() > 0).mean())
