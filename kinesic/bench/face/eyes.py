"""The eyes in the id buffer: how evenly a lid closes, and whether an eyeball shows where its lids are."""

import numpy as np
from matplotlib.path import Path

from kinesic.body.action_units import CHANNELS
from kinesic.body.arrays import Floats
from kinesic.face.assets.lids import Lids, lids
from kinesic.face.assets.mesh import PARTS, VARIANTS
from kinesic.face.assets.paint import IRIS
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT

SIDE = 512  # pixels
NEAR = Camera(field_deg=12.0)
STEPS = 10  # in which lids are closed
EDGE = 1.5  # [pixels] beyond the line of a lid that still count as on it
UNITS = 5  # of a random expression, on average
SEED = 23


def measure_eyes(expressions: int = 500) -> dict[str, float]:
    """Measures both heads: how unevenly lids close, and pixels of eyes outside them in random expressions."""
    uneven, outside = [], 0
    random = np.random.default_rng(SEED)
    for variant in VARIANTS:
        with Portrait(variant, preset=DRAFT, size=(SIDE, SIDE)) as portrait:
            uneven.append(_unevenness(portrait))
            outside += sum(_outside(portrait, _expression(random)) for _ in range(expressions // len(VARIANTS)))
    return {"face.lids.uneven": max(uneven), "face.lids.outside": float(outside)}


def _unevenness(portrait: Portrait) -> float:
    """Greatest difference between the share of the iris that shows and what a straight line from 1 to 0 has."""
    seen = np.array([_iris_pixels(portrait, {"43": k / STEPS}) for k in range(STEPS + 1)])
    return float(np.abs(seen / seen[0] - np.linspace(1.0, 0.0, STEPS + 1)).max())


def _iris_pixels(portrait: Portrait, units: dict[str, float]) -> int:
    _, points = _eye_points(portrait, units)
    spokes = points - portrait.mesh.eyes[np.where(points[:, 1] > 0.0, 0, 1)]
    return int(np.count_nonzero(np.hypot(*spokes[:, 1:].T) < IRIS * np.linalg.norm(spokes, axis=1)))


def _outside(portrait: Portrait, units: dict[str, float]) -> int:
    eyes, points = _eye_points(portrait, units)
    found = 0
    for number, side in enumerate(("Left", "Right")):
        own = eyes[(points[:, 1] > 0.0) == (number == 0)]
        outline = _outline(lids(portrait.mesh, side, number), portrait.pipeline.geometry.on_screen)
        inside = Path(outline).contains_points(own, radius=EDGE) | Path(outline).contains_points(own, radius=-EDGE)
        found += int(np.count_nonzero(~inside))
    return found


def _outline(eye: Lids, on_screen: Floats) -> Floats:
    """(n, 2) [pixels] the edges of the lids, all round."""
    return np.asarray(on_screen[:, np.append(eye.upper, eye.lower[::-1])].T)


def _eye_points(portrait: Portrait, units: dict[str, float]) -> tuple[Floats, Floats]:
    """(n, 2) middles of the pixels of the eyes, from the lower left, and (n, 3) [m] where they are on the head."""
    geometry, view = portrait.pipeline.geometry, NEAR.view()
    with geometry.context:
        geometry.draw(units, NEAR)
        rows, columns = np.nonzero(geometry.parts() == PARTS.index("eyes") + 1)
        points = geometry.positions()[rows, columns]
    return np.column_stack([columns + 0.5, SIDE - rows - 0.5]), (points - view[:3, 3]) @ view[:3, :3]


def _expression(random: np.random.Generator) -> dict[str, float]:
    shown = random.random(len(CHANNELS)) < UNITS / len(CHANNELS)
    return {name: float(random.uniform()) for name, does in zip(CHANNELS, shown, strict=True) if does}
