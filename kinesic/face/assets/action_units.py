"""Deformation of the face mesh by action units.

The shapes are those of the Face Units pack: 52, with the inner brow split in two. The combination of shapes for each
action unit was judged on pictures of both heads against the appearance changes in the Facial Action Coding System.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.action_units import (
    ACTION_UNITS,
    FACE_CHANNELS,
    MAX_EYE_CONVERGENCE,
    MAX_EYE_DEPRESSION,
    MAX_EYE_ELEVATION,
    MAX_EYE_YAW,
    describe_unknown_unit,
    face_keys,
    unit_channels,
)
from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.lids import Lids, find_lids
from kinesic.face.assets.lips import Lips, find_lips
from kinesic.face.assets.mesh import Mesh
from kinesic.face.display import DisplayError

SIDE_NAMES = {"L": "Left", "R": "Right"}

# Weights of expression shapes by action unit; SIDE stands for Left and Right.
UNIT_SHAPES: Mapping[int, Mapping[str, float]] = {
    1: {"browInnerUpSIDE": 1.0},
    2: {"browOuterUpSIDE": 1.0},
    4: {"browDownSIDE": 1.0},
    5: {"eyeWideSIDE": 1.0},
    6: {"cheekSquintSIDE": 1.0, "eyeSquintSIDE": 0.45},  # orbicularis oculi also raises the lower lid
    7: {"eyeSquintSIDE": 1.0},
    9: {"noseSneerSIDE": 1.0, "mouthUpperUpSIDE": 0.15, "browDownSIDE": 0.2},  # the levator also moves brow and lip
    10: {"mouthUpperUpSIDE": 1.0, "noseSneerSIDE": 0.25},  # the nasolabial furrow deepens with the lip
    11: {"noseSneerSIDE": 0.4, "mouthUpperUpSIDE": 0.2},
    12: {
        "mouthSmileSIDE": 0.85,
        "mouthLowerDownSIDE": 0.3,
    },  # the cheek folds at full weight; keeps the height of the lip line
    13: {"mouthSmileSIDE": 0.5, "cheekSquintSIDE": 0.3, "mouthPressSIDE": 0.2},  # corners sharply up, cheeks puffy
    14: {"mouthDimpleSIDE": 1.0},
    15: {"mouthFrownSIDE": 1.0},
    16: {"mouthLowerDownSIDE": 1.0},
    17: {"mouthShrugLower": 1.0, "mouthShrugUpper": 0.7},  # the chin boss pushes both lips up
    18: {"mouthPucker": 1.0},
    19: {"tongueOut": 1.0, "jawOpen": 0.25},  # the tongue needs the teeth apart
    20: {"mouthStretchSIDE": 1.0, "mouthDimpleSIDE": 0.75},  # their sum points straight outward
    22: {"mouthFunnel": 1.0},
    23: {"mouthRollLower": 0.75, "mouthRollUpper": 0.6, "mouthPucker": 0.42},  # a narrow mouth with tight lips
    24: {  # a wide straight line; mouthPress would raise the corners as in a smile
        "mouthRollLower": 0.9,
        "mouthRollUpper": 0.75,
        "mouthStretchLeft": 0.22,
        "mouthStretchRight": 0.22,
        "mouthDimpleLeft": 0.22,
        "mouthDimpleRight": 0.22,
    },
    25: {"mouthLowerDownLeft": 0.7, "mouthLowerDownRight": 0.7, "mouthUpperUpLeft": 0.3, "mouthUpperUpRight": 0.3},
    26: {"jawOpen": 0.55},  # opening with relaxed muscles
    27: {"jawOpen": 1.0, "mouthStretchLeft": 0.1, "mouthStretchRight": 0.1},
    28: {"mouthRollLower": 2.0, "mouthRollUpper": 1.2},  # both lips disappear
    29: {"jawForward": 1.0},
    30: {"jawSIDE": 1.0},
    32: {"mouthRollLower": 0.8, "mouthUpperUpLeft": 0.8, "mouthUpperUpRight": 0.8},  # upper teeth on the lower lip
    34: {"cheekPuff": 1.0},
    43: {"eyeBlinkSIDE": 1.0},
    45: {"eyeBlinkSIDE": 1.0},
    46: {"eyeBlinkSIDE": 1.0, "cheekSquintSIDE": 0.4},  # the cheek supports a wink
    61: {"eyeLookOutLeft": 1.0, "eyeLookInRight": 1.0},  # AU 61 to 64 move lids; the eyeballs rotate
    62: {"eyeLookInLeft": 1.0, "eyeLookOutRight": 1.0},
    63: {"eyeLookUpLeft": 1.0, "eyeLookUpRight": 1.0},
    64: {"eyeLookDownLeft": 1.0, "eyeLookDownRight": 1.0},
    66: {"eyeLookInLeft": 0.4, "eyeLookInRight": 0.4},
}
# Extra shape weights while two units act together; negative ones where the sum of both would be too large.
UNIT_COMBINATIONS: Mapping[tuple[str, str], Mapping[str, float]] = {
    **{  # a smile parts the lips over the teeth
        (f"{side}12", "25"): {f"mouthUpperUp{name}": 0.6, f"mouthLowerDown{name}": 0.35}
        for side, name in SIDE_NAMES.items()
    },
    ("26", "25"): {"mouthUpperUpLeft": 0.25, "mouthUpperUpRight": 0.25},  # a mouth wide open shows the upper teeth
    ("27", "25"): {"mouthUpperUpLeft": 0.3, "mouthUpperUpRight": 0.3},
    ("18", "22"): {"mouthPucker": -0.35, "mouthFunnel": -0.35},  # their full sum is a star
    ("22", "25"): {
        "mouthLowerDownLeft": -0.5,
        "mouthLowerDownRight": -0.5,
        "mouthUpperUpLeft": -0.2,
        "mouthUpperUpRight": -0.2,
    },
}
LARGEST_WEIGHTS: Mapping[str, float] = {"mouthRollLower": 2.0, "mouthRollUpper": 1.2}  # upper bounds; for the rest 1
LIP_ROLLING_UNITS = ("23", "28")  # action units that roll the lips over the teeth
ROLLED_OVERLAP = 0.0012  # [m] extra overlap of rolled lips at full intensity
LIP_SEALING_UNITS = ("24", "28")  # action units that press the lips together at any jaw opening
LIP_PARTING_SHAPES = (
    "mouthLowerDownLeft",
    "mouthLowerDownRight",
    "mouthUpperUpLeft",
    "mouthUpperUpRight",
    "mouthFunnel",
)
LID_SHAPES = (
    "eyeWide",
    "eyeSquint",
    "eyeLookDown",
    "eyeLookUp",
    "eyeLookIn",
    "eyeLookOut",
)  # expression shapes cancelled by a closing lid
BLINK_SHAPE = "eyeBlink"  # shape that closes a lid; `deform` slides the lids instead

_CHANNEL_INDICES = {name: place for place, name in enumerate(FACE_CHANNELS)}


def build_shape_matrix(shapes: tuple[str, ...]) -> Floats:
    """Return (s, c) weights of all expression shapes for each of `FACE_CHANNELS`.

    Args:
        shapes: shape names in the order of the mesh.
    """
    weights = np.zeros((len(shapes), len(FACE_CHANNELS)))
    for number in ACTION_UNITS:
        for channel in unit_channels(number):
            for shape, weight in UNIT_SHAPES[number].items():
                name = shape.replace("SIDE", SIDE_NAMES.get(channel[0], ""))
                weights[shapes.index(name), FACE_CHANNELS.index(channel)] = weight
    return sealed(weights)


@dataclass(frozen=True, eq=False)
class _Rig:
    """Precomputed data for the deformation of a face mesh."""

    mixing: Floats  # (s, c) weights of expression shapes by action unit channel
    shape: Mapping[str, int]  # name of an expression shape -> index
    eyeballs: tuple[NDArray[np.intp], NDArray[np.intp]]  # vertices of the left and right eyeball
    lids: tuple[Lids, Lids]
    lips: Lips
    rest: Floats  # (v, 3) [m] positions at rest, with touching lips
    largest: Floats  # (s,) largest weight of each shape


def read_intensities(units: Mapping[str, float]) -> Floats:
    """Return the (c,) intensity of each action unit channel in `FACE_CHANNELS`.

    A number without a side means both sides; the stronger value counts.

    Args:
        units: action unit -> 0..1, as in `Command.face`.

    Raises:
        DisplayError: an unknown action unit, or an intensity outside 0..1.
    """
    values = np.zeros(len(FACE_CHANNELS))
    for name, value in units.items():
        if not (math.isfinite(value) and 0.0 <= value <= 1.0):
            raise DisplayError(f"action unit {name} is {value:g}; intensities go from 0 to 1")
        keys = face_keys(name)
        if not keys:
            raise DisplayError(describe_unknown_unit(name))
        for channel in keys:
            values[_CHANNEL_INDICES[channel]] = max(values[_CHANNEL_INDICES[channel]], value)
    return values


def compute_shape_weights(mesh: Mesh, units: Mapping[str, float]) -> Floats:
    """Return the (s,) weights 0..1 of a mesh's expression shapes.

    This serves renderers that know only shapes. The weight of a shape is at most 1. A closed mouth cancels shapes that
    part the lips: pressed lips stay together while the jaw drops. A closing lid, which `deform` slides over the eyeball
    instead, cancels other motion of the lid.

    Raises:
        DisplayError: an unknown action unit, or an intensity outside 0..1.
    """
    rig = _build_rig(mesh)
    weights = _compute_weights(rig, read_intensities(units))
    for side in SIDE_NAMES.values():
        weights[[rig.shape[f"{lid}{side}"] for lid in LID_SHAPES]] *= 1.0 - weights[rig.shape[f"{BLINK_SHAPE}{side}"]]
    return np.minimum(weights, 1.0)


def deform(mesh: Mesh, units: Mapping[str, float]) -> Floats:
    """Return the (v, 3) vertex positions [m] for given action units.

    Shapes move skin, teeth and tongue; lips yield to each other; the eyeballs turn about their centres by up to
    `MAX_EYE_YAW`, `MAX_EYE_ELEVATION`, `MAX_EYE_DEPRESSION` and `MAX_EYE_CONVERGENCE`, and the lids slide over them.

    Args:
        mesh: mesh of the head, subdivided or not.
        units: action unit -> 0..1, as in `Command.face`.

    Raises:
        DisplayError: an unknown action unit, or an intensity outside 0..1.
    """
    rig, channels = _build_rig(mesh), read_intensities(units)
    if not channels.any():
        return rig.rest.copy()
    weights = _compute_weights(rig, channels)
    shut = [rig.shape[f"{BLINK_SHAPE}{side}"] for side in SIDE_NAMES.values()]
    closing = weights[shut]
    weights[shut] = 0.0
    positions: Floats = mesh.positions + (mesh.deltas @ weights).reshape(-1, 3)
    rig.lips.part(positions, _compute_seal(channels), ROLLED_OVERLAP * _find_largest(channels, LIP_ROLLING_UNITS))
    for number, (eyeball, centre, closer) in enumerate(zip(rig.eyeballs, mesh.eyes, rig.lids, strict=True)):
        gaze = compute_gaze_rotation(channels, number)
        positions[eyeball] = centre + (mesh.positions[eyeball] - centre) @ gaze.T
        closer.close(positions, closing[number], gaze[:, 0])
    return positions


def compute_lid_closure(channels: Floats) -> float:
    """Return the mean lid closure of both eyes, 0..1.

    It follows from AU 43 and 45.

    Args:
        channels: (c,) intensity of each of `FACE_CHANNELS`.
    """
    shut = [
        min(channels[_CHANNEL_INDICES[f"{side}43"]] + channels[_CHANNEL_INDICES[f"{side}45"]], 1.0)
        for side in SIDE_NAMES
    ]
    return float(np.mean(shut))


def compute_gaze_rotation(channels: Floats, number: int) -> Floats:
    """Return the (3, 3) rotation of an eyeball for given action units.

    Args:
        channels: (c,) intensity of each of `FACE_CHANNELS`.
        number: 0 for the left eyeball, 1 for the right one.
    """
    left, right, up, down, inward = (channels[_CHANNEL_INDICES[name]] for name in ("61", "62", "63", "64", "66"))
    aside = MAX_EYE_YAW * (left - right) + MAX_EYE_CONVERGENCE * inward * (2 * number - 1)
    raised = MAX_EYE_ELEVATION * up - MAX_EYE_DEPRESSION * down
    cy, sy, cp, sp = math.cos(aside), math.sin(aside), math.cos(raised), math.sin(raised)
    return np.array([[cy * cp, -sy, -cy * sp], [sy * cp, cy, -sy * sp], [sp, 0.0, cp]])


def _compute_weights(rig: _Rig, channels: Floats) -> Floats:
    weights = rig.mixing @ channels
    for both, shapes in UNIT_COMBINATIONS.items():
        amount = min(channels[_CHANNEL_INDICES[name]] for name in both)
        for name, weight in shapes.items():
            weights[rig.shape[name]] += amount * weight
    weights = np.minimum(weights, rig.largest)
    seal = _compute_seal(channels)
    weights[[rig.shape[name] for name in LIP_PARTING_SHAPES]] *= 1.0 - seal
    weights[rig.shape["mouthClose"]] = seal * weights[rig.shape["jawOpen"]]
    return weights


def _compute_seal(channels: Floats) -> float:
    """Return the strength 0..1 with which the lips are pressed together."""
    return _find_largest(channels, LIP_SEALING_UNITS)


def _find_largest(channels: Floats, units: tuple[str, ...]) -> float:
    """Return the largest intensity of some action units."""
    return float(max(channels[_CHANNEL_INDICES[name]] for name in units))


@lru_cache(maxsize=8)
def _build_rig(mesh: Mesh) -> _Rig:
    eyes = mesh.vertices("eyes")
    is_left = mesh.positions[eyes, 1] > 0.0
    shape = {name: place for place, name in enumerate(mesh.shapes)}
    closing = (find_lids(mesh, "Left", 0), find_lids(mesh, "Right", 1))
    parting, rest = find_lips(mesh), mesh.positions.copy()
    parting.part(rest, 0.0)
    return _Rig(
        build_shape_matrix(mesh.shapes),
        shape,
        (eyes[is_left], eyes[~is_left]),
        closing,
        parting,
        sealed(rest),
        sealed(np.array([LARGEST_WEIGHTS.get(name, 1.0) for name in mesh.shapes])),
    )
