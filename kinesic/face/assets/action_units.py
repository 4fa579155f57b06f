"""From action units to the shape of the face: which vertices are where when a face shows something."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.action_units import ASIDE, CHANNELS, DOWNWARD, UPWARD, face_keys, unknown_unit
from kinesic.body.arrays import Floats
from kinesic.face.assets.mesh import Mesh
from kinesic.face.assets.shapes import SIDES, shape_mixing
from kinesic.face.display import DisplayError

SEALS = ("24", "28")  # action units that hold the lips together, whatever the jaw does
PRESSURE = 0.04  # weight of mouthClose beyond what the jaw needs: no slit is left
PARTING = ("mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft", "mouthUpperUpRight", "mouthFunnel")
LIDS = ("eyeWide", "eyeSquint", "eyeLookDown", "eyeLookUp", "eyeLookIn", "eyeLookOut")  # that a closing lid undoes

_CHANNEL = {name: place for place, name in enumerate(CHANNELS)}


@dataclass(frozen=True, eq=False)
class _Rig:
    """What deforming a mesh needs to look up once."""

    mixing: Floats  # (s, c)
    shape: Mapping[str, int]  # name -> place
    eyeballs: tuple[NDArray[np.intp], NDArray[np.intp]]  # vertices of the left and of the right


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
    """(s,) weights 0..1 of the mesh's shapes.

    Weights of one shape add up to at most 1. A closing lid undoes what else moves it, as does a closed mouth with
    parted lips: pressed lips stay together on a dropped jaw.

    Raises:
        DisplayError: an unknown unit, or an intensity outside 0..1.
    """
    return _weights(_rig(mesh), intensities(units))


def deform(mesh: Mesh, units: Mapping[str, float]) -> Floats:
    """(v, 3) [m] where the vertices of a mesh are when it shows some action units.

    Skin, teeth, tongue and lashes are moved by shapes; the eyeballs turn about their centres, by up to `ASIDE`,
    `UPWARD` and `DOWNWARD`.

    Args:
        mesh: of the head, subdivided or not.
        units: action unit -> 0..1, as in `Command.face`.

    Raises:
        DisplayError: an unknown unit, or an intensity outside 0..1.
    """
    rig, told = _rig(mesh), intensities(units)
    positions: Floats = mesh.positions + (mesh.deltas @ _weights(rig, told)).reshape(-1, 3)
    turned = _gaze(told)
    for eyeball, centre in zip(rig.eyeballs, mesh.eyes, strict=True):
        positions[eyeball] = centre + (mesh.positions[eyeball] - centre) @ turned.T
    return positions


def _weights(rig: _Rig, told: Floats) -> Floats:
    found = np.minimum(rig.mixing @ told, 1.0)
    seal = max(told[_CHANNEL[name]] for name in SEALS)
    found[[rig.shape[name] for name in PARTING]] *= 1.0 - seal
    found[rig.shape["mouthClose"]] = seal * min(found[rig.shape["jawOpen"]] + PRESSURE, 1.0)
    for side in SIDES.values():
        found[[rig.shape[f"{lid}{side}"] for lid in LIDS]] *= 1.0 - found[rig.shape[f"eyeBlink{side}"]]
    return found


def _gaze(told: Floats) -> Floats:
    """(3, 3) rotation of the eyeballs."""
    left, right, up, down = (told[_CHANNEL[name]] for name in ("61", "62", "63", "64"))
    aside, raised = ASIDE * (left - right), UPWARD * up - DOWNWARD * down
    cy, sy, cp, sp = math.cos(aside), math.sin(aside), math.cos(raised), math.sin(raised)
    return np.array([[cy * cp, -sy, -cy * sp], [sy * cp, cy, -sy * sp], [sp, 0.0, cp]])


@lru_cache(maxsize=8)
def _rig(mesh: Mesh) -> _Rig:
    eyes = mesh.vertices("eyes")
    is_left = mesh.positions[eyes, 1] > 0.0
    shape = {name: place for place, name in enumerate(mesh.shapes)}
    return _Rig(shape_mixing(mesh.shapes), shape, (eyes[is_left], eyes[~is_left]))
