"""How fast a whole figure is drawn, and how fast its skin follows its skeleton."""

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
from kinesic.face.render.figure import FILMED, UPPER, FigurePortrait
from kinesic.face.render.presets import DRAFT, NORMAL, Preset

WARM, FRAMES = 3, 24
SQUARE, WIDE = (512, 512), (1280, 720)
DRAWN: dict[str, tuple[Preset, Size]] = {
    "draft_512x512": (DRAFT, SQUARE),
    "normal_512x512": (NORMAL, SQUARE),
    "filmed_1280x720": (FILMED, WIDE),
}
NAME = "face.figure."


def measure_figure() -> dict[str, float]:
    """Measures pictures a second at the median, read back and all, and milliseconds of skinning by its blending."""
    skeleton = Robot.load("human").skeleton
    found = {}
    for name, (preset, size) in DRAWN.items():
        with FigurePortrait(skeleton, preset=preset, size=size) as portrait:
            spans = []
            for angles in islice(_moving(skeleton), WARM + FRAMES):
                began = perf_counter()
                portrait.draw(angles, {"12": 0.5, "26": float(angles[0] > 0.0)}, UPPER)
                spans.append(perf_counter() - began)
        found[f"{NAME}{name}"] = 1.0 / median(spans[WARM:])
    points = load_figure().mesh.positions
    for blending in get_args(Blending):
        skin, spent = Skin(load_figure(), skeleton, blending=blending), []
        for angles in islice(_moving(skeleton), FRAMES // 2):
            began = process_time()
            skin.place(points, angles)
            spent.append(1000.0 * (process_time() - began))
        found[f"{NAME}{blending}_ms"] = median(spent)
    return found


def _moving(skeleton: Skeleton) -> Iterator[Floats]:
    """Yields postures, all hinges on their way; never the same twice."""
    k = 0
    while True:
        shares = [0.5 + 0.4 * sin(0.1 * k + 1.7 * joint) for joint in range(len(skeleton.hinges))]
        yield skeleton.lower + (skeleton.upper - skeleton.lower) * shares
        k += 1
