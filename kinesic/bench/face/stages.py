"""How long each stage of a picture takes, and a picture as a whole without being read back."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from statistics import median
from time import perf_counter

from kinesic.bench.face.clock import Clock
from kinesic.bench.face.frame_rate import moving_face
from kinesic.face.gl.textures import Size
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import PRESETS, Preset

WARM, PICTURES = 1, 5
NAME = "face.stage."
MOVED = "mesh"  # what the processor does, whoever draws
Frame = tuple[dict[str, float], Camera]


def stages_of(preset: Preset) -> Iterator[str]:
    """Yields the stages that a picture has, in their order."""
    yield from (MOVED, "geometry", "wrinkles")
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
    yield from (name for name, there in parts if there)


def measure_stages(sizes: Sequence[Size]) -> dict[str, float]:
    """Measures milliseconds of each stage of each preset, and of a picture, at the median."""
    found: dict[str, float] = {}
    for name, preset in PRESETS.items():
        for width, height in sizes:
            stem = f"{NAME}{name}_{width}x{height}_"
            with Portrait(preset=preset, size=(width, height)) as portrait:
                timed = _timed(portrait)
            found |= {stem + stage: spent for stage, spent in timed.items()}
    return found


def _timed(portrait: Portrait) -> dict[str, float]:
    """Milliseconds of each stage, and of the picture."""
    spent: dict[str, list[float]] = {}
    with portrait.pipeline.geometry.context as context:
        clock = Clock(context)
        for frame in islice(moving_face(), WARM + PICTURES):
            steps = portrait.pipeline.stages(*frame, 1.0)
            for name in stages_of(portrait.preset):
                timed = clock.milliseconds(partial(next, steps), of_card=clock.of_card and name != MOVED)
                spent.setdefault(name, []).append(timed)
        context.finish()
        began = perf_counter()
        for frame in islice(moving_face(), WARM, WARM + PICTURES):
            portrait.pipeline.drawn(*frame, 1.0)
        context.finish()
        whole = 1e3 * (perf_counter() - began) / PICTURES
    return {name: median(each[WARM:]) for name, each in spent.items()} | {"picture": whole}
