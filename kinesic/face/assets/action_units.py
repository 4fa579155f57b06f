"""Turns action units into the shape of a face: the expression shapes of each unit, and the vertices that they move.

The shapes are those of the Face Units pack: 52, and the inner brow's cut in two. What a shape shows was judged on
pictures of both heads against the appearance changes that the Facial Action Coding System lists.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.action_units import (
    ASIDE,
    CHANNELS,
    DOWNWARD,
    INWARD,
    UNITS,
    UPWARD,
    channels,
    face_keys,
    unknown_unit,
)
from kinesic.body.arrays import Floats, sealed
from kinesic.face.assets.lids import Lids, lids
from kinesic.face.assets.lips import Lips, lips
from kinesic.face.assets.mesh import Mesh
from kinesic.face.display import DisplayError

SIDES = {"L": "Left", "R": "Right"}

# SIDE stands for Left or Right in units that have sides.
SHAPES: Mapping[int, Mapping[str, float]] = {
    1: {"browInnerUpSIDE": 1.0},
    2: {"browOuterUpSIDE": 1.0},
    4: {"browDownSIDE": 1.0},
    5: {"eyeWideSIDE": 1.0},
    6: {"cheekSquintSIDE": 1.0, "eyeSquintSIDE": 0.45},  # orbicularis oculi pushes the lower lid up as well
    7: {"eyeSquintSIDE": 1.0},
    9: {"noseSneerSIDE": 1.0, "mouthUpperUpSIDE": 0.15, "browDownSIDE": 0.2},  # the levator draws brow and lip along
    10: {"mouthUpperUpSIDE": 1.0, "noseSneerSIDE": 0.25},  # the furrow beside the nose deepens with the lip
    11: {"noseSneerSIDE": 0.4, "mouthUpperUpSIDE": 0.2},
    12: {
        "mouthSmileSIDE": 0.85,
        "mouthLowerDownSIDE": 0.3,
    },  # at full weight the cheek folds on itself; lips meet as high
    13: {"mouthSmileSIDE": 0.5, "cheekSquintSIDE": 0.3, "mouthPressSIDE": 0.2},  # corners sharply up, cheeks puffy
    14: {"mouthDimpleSIDE": 1.0},
    15: {"mouthFrownSIDE": 1.0},
    16: {"mouthLowerDownSIDE": 1.0},
    17: {"mouthShrugLower": 1.0, "mouthShrugUpper": 0.7},  # the chin boss pushes both lips up
    18: {"mouthPucker": 1.0},
    19: {"tongueOut": 1.0, "jawOpen": 0.25},  # the tongue needs the teeth apart
    20: {"mouthStretchSIDE": 1.0, "mouthDimpleSIDE": 0.75},  # together straight outward
    22: {"mouthFunnel": 1.0},
    23: {"mouthRollLower": 0.45, "mouthRollUpper": 0.35, "mouthPucker": 0.13},  # narrow lips, no corner moves
    24: {"mouthRollLower": 0.5, "mouthRollUpper": 0.4},  # the pack's mouthPress lifts the corners as a smile would
    25: {"mouthLowerDownLeft": 0.7, "mouthLowerDownRight": 0.7, "mouthUpperUpLeft": 0.3, "mouthUpperUpRight": 0.3},
    26: {"jawOpen": 0.55},  # as far as it falls when its muscle relaxes
    27: {"jawOpen": 1.0, "mouthStretchLeft": 0.1, "mouthStretchRight": 0.1},
    28: {"mouthRollLower": 1.0, "mouthRollUpper": 1.0},
    29: {"jawForward": 1.0},
    30: {"jawSIDE": 1.0},
    32: {"mouthRollLower": 0.8, "mouthUpperUpLeft": 0.8, "mouthUpperUpRight": 0.8},  # upper teeth on the lower lip
    34: {"cheekPuff": 1.0},
    43: {"eyeBlinkSIDE": 1.0},
    45: {"eyeBlinkSIDE": 1.0},
    46: {"eyeBlinkSIDE": 1.0, "cheekSquintSIDE": 0.4},  # a wink is helped by the cheek
    61: {"eyeLookOutLeft": 1.0, "eyeLookInRight": 1.0},  # of these four the lids; the eyeballs turn
    62: {"eyeLookInLeft": 1.0, "eyeLookOutRight": 1.0},
    63: {"eyeLookUpLeft": 1.0, "eyeLookUpRight": 1.0},
    64: {"eyeLookDownLeft": 1.0, "eyeLookDownRight": 1.0},
    66: {"eyeLookInLeft": 0.4, "eyeLookInRight": 0.4},
}
COMBINATIONS: Mapping[tuple[str, str], Mapping[str, float]] = {  # what two units do that neither does alone
    **{  # a smile parts the lips over the teeth
        (f"{side}12", "25"): {f"mouthUpperUp{name}": 0.7, f"mouthLowerDown{name}": 0.35} for side, name in SIDES.items()
    },
    ("26", "25"): {"mouthUpperUpLeft": 0.25, "mouthUpperUpRight": 0.25},  # a mouth wide open shows the upper teeth
    ("27", "25"): {"mouthUpperUpLeft": 0.3, "mouthUpperUpRight": 0.3},
}
SEALS = ("24", "28")  # action units that hold the lips together, whatever the jaw does
PARTING = ("mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft", "mouthUpperUpRight", "mouthFunnel")
LIDS = ("eyeWide", "eyeSquint", "eyeLookDown", "eyeLookUp", "eyeLookIn", "eyeLookOut")  # that a closing lid undoes
BLINK = "eyeBlink"  # a shape of which only is used which vertices it moves: lids slide instead

_CHANNEL = {name: place for place, name in enumerate(CHANNELS)}


def shape_mixing(shapes: tuple[str, ...]) -> Floats:
    """Gives the weight of each of a mesh's shapes in each of `CHANNELS`, (s, c).

    Args:
        shapes: names, in the mesh's order.
    """
    found = np.zeros((len(shapes), len(CHANNELS)))
    for number in UNITS:
        for channel in channels(number):
            for shape, weight in SHAPES[number].items():
                name = shape.replace("SIDE", SIDES.get(channel[0], ""))
                found[shapes.index(name), CHANNELS.index(channel)] = weight
    return sealed(found)


@dataclass(frozen=True, eq=False)
class _Rig:
    """What deforming a mesh needs to look up once."""

    mixing: Floats  # (s, c)
    shape: Mapping[str, int]  # name -> place
    eyeballs: tuple[NDArray[np.intp], NDArray[np.intp]]  # vertices of the left and of the right
    lids: tuple[Lids, Lids]
    lips: Lips
    rest: Floats  # (v, 3) [m] of a face that shows nothing: lips touch


def intensities(units: Mapping[str, float]) -> Floats:
    """(c,) intensity of each of `CHANNELS`; a number without side is both sides, and the stronger counts.

    Args:
        units: action unit -> 0..1, as in `Command.face`.

    Raises:
        DisplayError: an unknown unit, or an intensity outside 0..1.
    """
    found = np.zeros(len(CHANNELS))
    for name, value in units.items():
        if not (math.isfinite(value) and 0.0 <= value <= 1.0):
            raise DisplayError(f"action unit {name} is {value:g}; intensities go from 0 to 1")
        keys = face_keys(name)
        if not keys:
            raise DisplayError(unknown_unit(name))
        for channel in keys:
            found[_CHANNEL[channel]] = max(found[_CHANNEL[channel]], value)
    return found


def shape_weights(mesh: Mesh, units: Mapping[str, float]) -> Floats:
    """Gives the weights 0..1 of a mesh's shapes, (s,), for who has shapes alone.

    Weights of one shape add up to at most 1. A closed mouth undoes what parts the lips: pressed lips stay together on
    a dropped jaw. A closing lid, which `deform` slides over the eyeball instead, undoes what else moves it.

    Raises:
        DisplayError: an unknown unit, or an intensity outside 0..1.
    """
    rig = _rig(mesh)
    found = _weights(rig, intensities(units))
    for side in SIDES.values():
        found[[rig.shape[f"{lid}{side}"] for lid in LIDS]] *= 1.0 - found[rig.shape[f"{BLINK}{side}"]]
    return found


def deform(mesh: Mesh, units: Mapping[str, float]) -> Floats:
    """Moves the vertices of a mesh to where they are when it shows some action units, (v, 3) [m].

    Skin, teeth and tongue are moved by shapes; lips give way to each other; the eyeballs turn about their centres, by
    up to `ASIDE`, `UPWARD`, `DOWNWARD` and `INWARD`, and the lids slide over them.

    Args:
        mesh: of the head, subdivided or not.
        units: action unit -> 0..1, as in `Command.face`.

    Raises:
        DisplayError: an unknown unit, or an intensity outside 0..1.
    """
    rig, told = _rig(mesh), intensities(units)
    if not told.any():
        return rig.rest.copy()
    weights = _weights(rig, told)
    shut = [rig.shape[f"{BLINK}{side}"] for side in SIDES.values()]
    closing = weights[shut]
    weights[shut] = 0.0
    positions: Floats = mesh.positions + (mesh.deltas @ weights).reshape(-1, 3)
    rig.lips.part(positions, _seal(told))
    for number, (eyeball, centre, closer) in enumerate(zip(rig.eyeballs, mesh.eyes, rig.lids, strict=True)):
        turned = gaze_rotation(told, number)
        positions[eyeball] = centre + (mesh.positions[eyeball] - centre) @ turned.T
        closer.close(positions, closing[number], turned[:, 0])
    return positions


def lid_closure(told: Floats) -> float:
    """Tells how far the lids are shut, 0..1, in the mean of both eyes.

    Args:
        told: (c,) intensity of each of `CHANNELS`.
    """
    shut = [min(told[_CHANNEL[f"{side}43"]] + told[_CHANNEL[f"{side}45"]], 1.0) for side in SIDES]
    return float(np.mean(shut))


def gaze_rotation(told: Floats, number: int) -> Floats:
    """(3, 3) rotation of the left (0) or the right (1) eyeball.

    Args:
        told: (c,) intensity of each of `CHANNELS`.
        number: of the eyeball.
    """
    left, right, up, down, inward = (told[_CHANNEL[name]] for name in ("61", "62", "63", "64", "66"))
    aside = ASIDE * (left - right) + INWARD * inward * (2 * number - 1)
    raised = UPWARD * up - DOWNWARD * down
    cy, sy, cp, sp = math.cos(aside), math.sin(aside), math.cos(raised), math.sin(raised)
    return np.array([[cy * cp, -sy, -cy * sp], [sy * cp, cy, -sy * sp], [sp, 0.0, cp]])


def _weights(rig: _Rig, told: Floats) -> Floats:
    found = rig.mixing @ told
    for both, shapes in COMBINATIONS.items():
        amount = min(told[_CHANNEL[name]] for name in both)
        for name, weight in shapes.items():
            found[rig.shape[name]] += amount * weight
    found = np.minimum(found, 1.0)
    seal = _seal(told)
    found[[rig.shape[name] for name in PARTING]] *= 1.0 - seal
    found[rig.shape["mouthClose"]] = seal * found[rig.shape["jawOpen"]]
    return found


def _seal(told: Floats) -> float:
    """0..1 how firmly the lips are held together."""
    return float(max(told[_CHANNEL[name]] for name in SEALS))


@lru_cache(maxsize=8)
def _rig(mesh: Mesh) -> _Rig:
    eyes = mesh.vertices("eyes")
    is_left = mesh.positions[eyes, 1] > 0.0
    shape = {name: place for place, name in enumerate(mesh.shapes)}
    closing = (lids(mesh, "Left", 0), lids(mesh, "Right", 1))
    parting, rest = lips(mesh), mesh.positions.copy()
    parting.part(rest, 0.0)
    return _Rig(shape_mixing(mesh.shapes), shape, (eyes[is_left], eyes[~is_left]), closing, parting, sealed(rest))
