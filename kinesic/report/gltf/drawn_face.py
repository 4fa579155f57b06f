"""Drawn robot face in a glTF scene, animated by morph targets.

The shapes of the face depend linearly on its controls, so that one morph target per control shows every face exactly,
apart from the curvature of the screen. All weights are in 0..1, as editors expect.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.files.gltf import GltfFile
from kinesic.report.gltf.skin_pictures import screen_colours
from kinesic.sim.filming.drawn_face import (
    BACKGROUND_COLOUR,
    DESIGN_SIZE,
    EYE_STRIPS,
    STRIP_POINTS,
    Colour,
    FaceStrip,
    build_strips,
    read_controls,
)
from kinesic.sim.filming.face_screen import FaceScreen, ScreenSurface, Sheet, build_face_screen

FRAME_COLOUR: Colour = (24, 26, 30)  # RGB colour of the screen's frame
LAYER_DISTANCE = 3e-4  # [m] distance between shapes drawn over one another
MIN_CONTROL_CHANGE = 1e-3  # [pixels] control values of the face that change less are not animated
FACE_EMISSION = 0.8  # emitted light / colour of the face
COLOUR_STEPS = 1024  # steps of the table that converts screen colours to linear ones


@dataclass(frozen=True, eq=False)
class AddedFace:
    """Face node of a glTF scene, with morph target weights over time."""

    node: int
    weights: Floats  # (m, s) in 0..1; s is 0 if nothing moves


def add_drawn_face(
    file: GltfFile, nodes: Sequence[int], robot: Robot, units: Sequence[Mapping[str, float]]
) -> AddedFace | None:
    """Add screen and face of a robot to a glTF scene.

    Args:
        file: glTF file to extend.
        nodes: nodes of the segments, in the skeleton's order.
        robot: robot with a screen on its head.
        units: action units -> 0..1, one row per key frame.

    Returns:
        None if the robot has no screen.
    """
    screen = build_face_screen(robot)
    if screen is None:
        return None
    rows = [read_controls(row) for row in (*units, {})]
    names = list(rows[0])
    values = np.array([[row[name] for name in names] for row in rows])
    low, span = values.min(axis=0), np.ptp(values, axis=0)
    moved = np.flatnonzero(span > MIN_CONTROL_CHANGE)
    weights = (values[:, moved] - low[moved]) / span[moved]
    targets = [dict(zip(names, low + span * (np.arange(len(names)) == k), strict=True)) for k in moved]
    strips = [build_strips(controls) for controls in (dict(zip(names, low, strict=True)), *targets)]
    materials = _Materials(file)
    moving = {"weights": weights[-1].tolist(), "extras": {"targetNames": [names[k] for k in moved]}}
    face = file.add(
        "meshes",
        name="face",
        primitives=_add_strips(materials, screen.surface, strips),
        **(moving if len(moved) else {}),
    )
    screens = file.add("meshes", name="screen", primitives=_add_sheets(materials, screen))
    shown = [file.add("nodes", name=name, mesh=mesh) for name, mesh in (("screen", screens), ("face", face))]
    children = file.entry("nodes", nodes[robot.skeleton.segment(screen.segment)]).setdefault("children", [])
    assert isinstance(children, list)  # as nodes of segments have it
    children += shown
    return AddedFace(shown[-1], weights[:-1])


class _Materials:
    """Materials of a glTF file by colour."""

    def __init__(self, file: GltfFile) -> None:
        self.file = file
        self._indices: dict[Colour, int] = {}

    def find(self, colour: Colour) -> int:
        """Return the index of a colour's material, adding it if missing."""
        if colour not in self._indices:
            linear = _linear_colour(colour)
            look = {"baseColorFactor": [*linear, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.4}
            self._indices[colour] = self.file.add(
                "materials",
                name="face",
                pbrMetallicRoughness=look,
                emissiveFactor=[FACE_EMISSION * value for value in linear],
            )
        return self._indices[colour]


def _add_strips(
    materials: _Materials, surface: ScreenSurface, strips: Sequence[tuple[FaceStrip, ...]]
) -> list[dict[str, object]]:
    """Build glTF primitives of face parts, with morph targets for moving controls."""
    shapes = zip(*strips, strict=True)
    return [
        _add_strip(materials, surface, shape, (k % EYE_STRIPS + 1) * LAYER_DISTANCE) for k, shape in enumerate(shapes)
    ]


def _add_strip(
    materials: _Materials, surface: ScreenSurface, shape: Sequence[FaceStrip], ahead: float
) -> dict[str, object]:
    (points, normals), *others = (
        surface.place(strip.rows.reshape(-1, 2) / np.array(DESIGN_SIZE), ahead) for strip in shape
    )
    low = np.arange(STRIP_POINTS - 1)
    high = low + STRIP_POINTS  # the lower row follows the upper one
    corners = np.concatenate([np.stack([low, high, high + 1], axis=1), np.stack([low, high + 1, low + 1], axis=1)])
    primitive = _primitive(materials, points, normals, corners, shape[0].colour)
    if others:
        moves = [moved - points for moved, _ in others]
        changed = [np.flatnonzero(np.abs(move).max(axis=1) > 0.0) for move in moves]
        primitive["targets"] = [
            {"POSITION": materials.file.sparse(len(points), rows, move[rows])}
            for move, rows in zip(moves, changed, strict=True)
        ]
    return primitive


def _add_sheets(materials: _Materials, screen: FaceScreen) -> list[dict[str, object]]:
    """Build the glTF primitives of the screen's frame and background."""
    sheets: tuple[tuple[Sheet, Colour], ...] = ((screen.frame, FRAME_COLOUR), (screen.picture, BACKGROUND_COLOUR))
    return [_primitive(materials, sheet.places, sheet.normals, sheet.triangles, colour) for sheet, colour in sheets]


def _primitive(
    materials: _Materials, points: Floats, normals: Floats, corners: NDArray[np.integer], colour: Colour
) -> dict[str, object]:
    file = materials.file
    attributes = {
        "POSITION": file.numbers(points, target="vertices", bounds=True),
        "NORMAL": file.numbers(normals / np.linalg.norm(normals, axis=1, keepdims=True), target="vertices"),
    }
    indices = file.numbers(corners.ravel(), "u4", "indices")
    return {"attributes": attributes, "indices": indices, "material": materials.find(colour)}


def _linear_colour(colour: Colour) -> list[float]:
    """Convert an sRGB colour, 0..255, to linear RGB in 0..1."""
    table = np.linspace(0.0, 1.0, COLOUR_STEPS)
    return [float(value) for value in np.interp(np.array(colour) / 255.0, screen_colours(table), table)]
