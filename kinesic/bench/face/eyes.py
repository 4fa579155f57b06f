"""Benchmark of the eyelids.

It measures how evenly the lids close, and eyeball pixels outside the lids.
"""

import numpy as np
from matplotlib.path import Path

from kinesic.body.action_units import FACE_CHANNELS
from kinesic.body.arrays import Floats
from kinesic.face.assets.lids import Lids, find_lids
from kinesic.face.assets.mesh import FACE_VARIANTS, MESH_PARTS
from kinesic.face.assets.paint import IRIS_RADIUS
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET

PICTURE_SIDE = 512  # [pixels] width and height of the eye pictures
CLOSE_CAMERA = Camera(field_deg=12.0)  # camera with the eyes in full view
CLOSING_STEPS = 10  # number of intensity steps from open to closed lids
LID_LINE_WIDTH = 1.5  # [pixels] eye pixels this close to the lids' outline count as inside
ACTIVE_UNITS = 5  # mean number of active action units in a random expression
EXPRESSION_SEED = 23  # seed of the random expressions


def measure_eyes(expressions: int = 500) -> dict[str, float]:
    """Measure eyelid errors of the two heads while closing and in expressions.

    The values are the unevenness of closing and the number of eye pixels outside the lids.
    """
    uneven, outside = [], 0
    random = np.random.default_rng(EXPRESSION_SEED)
    for variant in FACE_VARIANTS:
        with Portrait(variant, preset=DRAFT_PRESET, size=(PICTURE_SIDE, PICTURE_SIDE)) as portrait:
            uneven.append(_measure_unevenness(portrait))
            outside += sum(
                _count_outside(portrait, _expression(random)) for _ in range(expressions // len(FACE_VARIANTS))
            )
    return {"face.lids.uneven": max(uneven), "face.lids.outside": float(outside)}


def _measure_unevenness(portrait: Portrait) -> float:
    """Return the largest deviation of the visible iris fraction from linear closing."""
    seen = np.array([_iris_pixels(portrait, {"43": k / CLOSING_STEPS}) for k in range(CLOSING_STEPS + 1)])
    return float(np.abs(seen / seen[0] - np.linspace(1.0, 0.0, CLOSING_STEPS + 1)).max())


def _iris_pixels(portrait: Portrait, units: dict[str, float]) -> int:
    _, points = _find_eye_points(portrait, units)
    spokes = points - portrait.mesh.eyes[np.where(points[:, 1] > 0.0, 0, 1)]
    return int(np.count_nonzero(np.hypot(*spokes[:, 1:].T) < IRIS_RADIUS * np.linalg.norm(spokes, axis=1)))


def _count_outside(portrait: Portrait, units: dict[str, float]) -> int:
    eyes, points = _find_eye_points(portrait, units)
    outside_count = 0
    for number, side in enumerate(("Left", "Right")):
        side_pixels = eyes[(points[:, 1] > 0.0) == (number == 0)]
        outline = _find_outline(find_lids(portrait.mesh, side, number), portrait.pipeline.geometry.on_screen)
        inside = Path(outline).contains_points(side_pixels, radius=LID_LINE_WIDTH) | Path(outline).contains_points(
            side_pixels, radius=-LID_LINE_WIDTH
        )
        outside_count += int(np.count_nonzero(~inside))
    return outside_count


def _find_outline(eye: Lids, on_screen: Floats) -> Floats:
    """Return the closed outline of the lids, shape (n, 2) [pixels]."""
    return np.asarray(on_screen[:, np.append(eye.upper, eye.lower[::-1])].T)


def _find_eye_points(portrait: Portrait, units: dict[str, float]) -> tuple[Floats, Floats]:
    """Return pixel centres and 3D positions of all visible eye pixels.

    The centres (n, 2) [pixels] count from the lower left; the positions (n, 3) [m] are on the head.
    """
    geometry, view = portrait.pipeline.geometry, CLOSE_CAMERA.view()
    with geometry.context:
        geometry.draw(units, CLOSE_CAMERA)
        rows, columns = np.nonzero(geometry.parts() == MESH_PARTS.index("eyes") + 1)
        points = geometry.positions()[rows, columns]
    return np.column_stack([columns + 0.5, PICTURE_SIDE - rows - 0.5]), (points - view[:3, 3]) @ view[:3, :3]


def _expression(random: np.random.Generator) -> dict[str, float]:
    shown = random.random(len(FACE_CHANNELS)) < ACTIVE_UNITS / len(FACE_CHANNELS)
    return {name: float(random.uniform()) for name, does in zip(FACE_CHANNELS, shown, strict=True) if does}
