"""Benchmark of the rendering stages of a face picture, without read-back."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from statistics import median
from time import perf_counter

from kinesic.bench.face.clock import DrawingClock
from kinesic.bench.face.frame_rate import moving_face
from kinesic.face.gl.textures import Size
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import QUALITY_PRESETS, Preset

WARM_UP_PICTURES = 1  # pictures drawn before the measurement
MEASURED_PICTURES = 5  # pictures timed per preset
STAGE_PREFIX = "face.stage."  # prefix of the metric names
MESH_STAGE = "mesh"  # stage computed by the CPU even if a graphics card draws


def stages_of(preset: Preset) -> Iterator[str]:
    """Yield the rendering stages of a face picture in order."""
    yield from (MESH_STAGE, "geometry", "wrinkles")
    if preset.occlusion or preset.shadow:
        yield "positions"
    parts = (
        ("occlusion", preset.occlusion),
        ("shadow", preset.shadow),
        ("light", True),
        ("scattering", preset.scattering),
        ("lashes", True),
        ("focus", preset.focus),
        ("smoothing", preset.smooth),
        ("shrinking", preset.samples > 1),
    )
    yield from (name for name, is_drawn in parts if is_drawn)


def measure_stages(sizes: Sequence[Size]) -> dict[str, float]:
    """Measure median times [ms] of rendering stages and pictures by preset."""
    metrics: dict[str, float] = {}
    for name, preset in QUALITY_PRESETS.items():
        for width, height in sizes:
            stem = f"{STAGE_PREFIX}{name}_{width}x{height}_"
            with Portrait(preset=preset, size=(width, height)) as portrait:
                timed = _time_stages(portrait)
            metrics |= {stem + stage: spent for stage, spent in timed.items()}
    return metrics


def _time_stages(portrait: Portrait) -> dict[str, float]:
    """Return the times [ms] of the rendering stages and the picture."""
    spent: dict[str, list[float]] = {}
    with portrait.pipeline.geometry.context as context:
        clock = DrawingClock(context)
        for frame in islice(moving_face(), WARM_UP_PICTURES + MEASURED_PICTURES):
            steps = portrait.pipeline.stages(*frame, 1.0)
            for name in stages_of(portrait.preset):
                timed = clock.milliseconds(partial(next, steps), of_card=clock.of_card and name != MESH_STAGE)
                spent.setdefault(name, []).append(timed)
        context.finish()
        began = perf_counter()
        for frame in islice(moving_face(), WARM_UP_PICTURES, WARM_UP_PICTURES + MEASURED_PICTURES):
            portrait.pipeline.draw_target(*frame, 1.0)
        context.finish()
        whole = 1e3 * (perf_counter() - began) / MEASURED_PICTURES
    return {name: median(times[WARM_UP_PICTURES:]) for name, times in spent.items()} | {"picture": whole}
