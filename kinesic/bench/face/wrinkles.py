"""Measures the laws of wrinkles on the normals that pictures are lit with."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation

from kinesic.body.action_units import channels
from kinesic.body.arrays import Flags, Floats
from kinesic.face.assets.action_units import intensities
from kinesic.face.assets.chart import chart_window
from kinesic.face.render.camera import FRONT, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.wrinkles import maps, shares, wrinkles

SIZE = (512, 512)
BEHIND_DEG = (140.0, 180.0, -140.0)
BEHIND = -0.65  # [distances between the eyes] from there on it is the back of the head
DEEP = (0.05, 1.5)  # tangents that are judged for being linear
MARGIN = 8  # pixels of a map round its support, for what interpolation and differences reach


class _Head:
    """A still head whose wrinkles are asked for apart from its shape."""

    def __init__(self, portrait: Portrait) -> None:
        self._pipeline = portrait.pipeline

    def normals(self, units: dict[str, float], camera: Camera = FRONT) -> Floats:
        """(height, width, 3), 0 off the head."""
        with self._pipeline.geometry.context:
            self._pipeline.geometry.draw({}, camera)
            seen = self._pipeline.geometry.parts()[..., None] > 0
            _, bent = self._pipeline.relief.draw(shares(intensities(units)))
            width, height = bent.size
            pixels = np.frombuffer(bent.read(), np.float32).reshape(height, width, 4)[::-1, :, :3]
            return np.where(seen, pixels, 0.0).astype(np.float64)

    def changed_behind(self, units: dict[str, float], camera: Camera) -> int:
        """How many pixels of the back of the head wrinkles change."""
        changed = np.any(self.normals(units, camera) != self.normals({}, camera), axis=2)
        geometry, mesh, view = self._pipeline.geometry, self._pipeline.geometry.mesh, camera.view()
        with geometry.context:
            geometry.draw({}, camera)
            seen, positions = geometry.parts() > 0, geometry.positions()
        forward = (positions - view[:3, 3]) @ view[:3, 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
        return int(changed[seen & (forward < BEHIND)].sum())

    def support(self, numbers: tuple[int, ...]) -> Flags:
        """(height, width) where some maps have height, and a little round it."""
        with self._pipeline.geometry.context:
            place = self._pipeline.geometry.draw({}, FRONT).read(1)
        drawn = binary_dilation(np.any(maps()[list(numbers)] != 0.0, axis=0), iterations=MARGIN)
        scale, offset = np.array(chart_window()).reshape(2, 2)
        column, row = np.moveaxis(np.clip((place[..., :2] * scale + offset) * len(drawn), 0, len(drawn) - 1), -1, 0)
        return np.asarray(drawn[row.astype(int), column.astype(int)])


class _Law(NamedTuple):
    linear: float
    outside: float
    mirror: float
    steepest: float


def measure_law_violations() -> dict[str, float]:
    """Measures how far each law is from holding, at worst over all action units with wrinkles."""
    with Portrait(size=SIZE) as portrait:
        head = _Head(portrait)
        everything = {str(each.unit): 1.0 for each in wrinkles()}
        flat = head.normals({})
        nothing = head.normals(dict.fromkeys(everything, 0.0))
        found = [_of(head, str(each.unit), each.maps, flat) for each in wrinkles()]
        behind = sum(head.changed_behind(everything, Camera(yaw_deg=yaw)) for yaw in BEHIND_DEG)
    return {
        "face.wrinkle.zero": float(np.any(nothing != flat, axis=2).sum()),
        "face.wrinkle.linear": max(each.linear for each in found),
        "face.wrinkle.outside": max(each.outside for each in found),
        "face.wrinkle.mirror": max(each.mirror for each in found),
        "face.wrinkle.back": float(behind),
        "face.wrinkle.steepest": max(each.steepest for each in found),
    }


def _of(head: _Head, unit: str, numbers: tuple[int, ...], flat: Floats) -> _Law:
    """How far half the intensity is from half the tangent, energy off the maps, left from right; and the steepest."""
    full, half = (tangent(head.normals({unit: share}), flat) for share in (1.0, 0.5))
    own = channels(int(unit))
    left, right = (tangent(head.normals({name: 1.0}), flat) for name in (own[0], own[-1]))
    deep = (full > DEEP[0]) & (full < DEEP[1])
    energy = full**2
    return _Law(
        linear=float(np.abs(half[deep] / full[deep] - 0.5).max()),
        outside=float(energy[~head.support(numbers)].sum() / energy.sum()),
        mirror=float(np.sqrt(np.mean((left - right[:, ::-1]) ** 2) / np.mean(left**2))),
        steepest=float(np.degrees(np.arctan(full.max()))),
    )


def tangent(normals: Floats, flat: Floats) -> Floats:
    """(height, width) tangent of the angle between normals; the cosine alone would lose small angles."""
    cosine = (normals * flat).sum(axis=2)
    sine = np.linalg.norm(np.cross(normals, flat), axis=2)
    return np.where(cosine > 0.0, sine / np.maximum(cosine, 1e-3), 0.0)
