"""Benchmark of rules that wrinkle normals must satisfy, such as symmetry."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation

from kinesic.body.action_units import unit_channels
from kinesic.body.arrays import Flags, Floats
from kinesic.face.assets.action_units import read_intensities
from kinesic.face.assets.chart import compute_chart_window
from kinesic.face.render.camera import FRONT_CAMERA, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.wrinkles import compute_map_strengths, draw_wrinkle_maps, load_wrinkles

PICTURE_SIZE = (512, 512)  # [pixels] width and height of the compared pictures
BACK_YAWS_DEG = (140.0, 180.0, -140.0)  # camera angles that show the back of the head
BACK_LIMIT = -0.65  # [eye distances] forward coordinate below which a point is at the back of the head
LINEAR_RANGE = (0.05, 1.5)  # range of the tangent of normal tilt in which half the intensity must halve the tangent
SUPPORT_MARGIN = 8  # [pixels] margin around the non-zero part of a wrinkle map


class _Head:
    """Undeformed head on which the wrinkles of action units are drawn."""

    def __init__(self, portrait: Portrait) -> None:
        self._pipeline = portrait.pipeline

    def normals(self, units: dict[str, float], camera: Camera = FRONT_CAMERA) -> Floats:
        """Return the surface normals (height, width, 3) of the drawn head.

        The result is zero outside the head.
        """
        with self._pipeline.geometry.context:
            self._pipeline.geometry.draw({}, camera)
            is_head = self._pipeline.geometry.parts()[..., None] > 0
            _, relief = self._pipeline.relief.draw(compute_map_strengths(read_intensities(units)))
            width, height = relief.size
            pixels = np.frombuffer(relief.read(), np.float32).reshape(height, width, 4)[::-1, :, :3]
            return np.where(is_head, pixels, 0.0).astype(np.float64)

    def count_changed_behind(self, units: dict[str, float], camera: Camera) -> int:
        """Count pixels at the back of the head that wrinkles change."""
        changed = np.any(self.normals(units, camera) != self.normals({}, camera), axis=2)
        geometry, mesh, view = self._pipeline.geometry, self._pipeline.geometry.mesh, camera.view()
        with geometry.context:
            geometry.draw({}, camera)
            is_head, positions = geometry.parts() > 0, geometry.positions()
        forward = (positions - view[:3, 3]) @ view[:3, 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
        return int(changed[is_head & (forward < BACK_LIMIT)].sum())

    def support(self, numbers: tuple[int, ...]) -> Flags:
        """Return the mask (height, width) of pixels that wrinkle maps may change."""
        with self._pipeline.geometry.context:
            positions = self._pipeline.geometry.draw({}, FRONT_CAMERA).read(1)
        drawn = binary_dilation(np.any(draw_wrinkle_maps()[list(numbers)] != 0.0, axis=0), iterations=SUPPORT_MARGIN)
        scale, offset = np.array(compute_chart_window()).reshape(2, 2)
        column, row = np.moveaxis(np.clip((positions[..., :2] * scale + offset) * len(drawn), 0, len(drawn) - 1), -1, 0)
        return np.asarray(drawn[row.astype(int), column.astype(int)])


class _LawViolations(NamedTuple):
    linear: float
    outside: float
    mirror: float
    steepest: float


def measure_law_violations() -> dict[str, float]:
    """Measure the largest violation of each wrinkle rule over all action units."""
    with Portrait(size=PICTURE_SIZE) as portrait:
        head = _Head(portrait)
        all_units = {str(wrinkle.unit): 1.0 for wrinkle in load_wrinkles()}
        flat = head.normals({})
        unwrinkled = head.normals(dict.fromkeys(all_units, 0.0))
        laws = [_measure_unit(head, str(wrinkle.unit), wrinkle.maps, flat) for wrinkle in load_wrinkles()]
        behind = sum(head.count_changed_behind(all_units, Camera(yaw_deg=yaw)) for yaw in BACK_YAWS_DEG)
    return {
        "face.wrinkle.zero": float(np.any(unwrinkled != flat, axis=2).sum()),
        "face.wrinkle.linear": max(law.linear for law in laws),
        "face.wrinkle.outside": max(law.outside for law in laws),
        "face.wrinkle.mirror": max(law.mirror for law in laws),
        "face.wrinkle.back": float(behind),
        "face.wrinkle.steepest": max(law.steepest for law in laws),
    }


def _measure_unit(head: _Head, unit: str, numbers: tuple[int, ...], flat: Floats) -> _LawViolations:
    """Measure the violation of each wrinkle rule by one action unit.

    The values are the deviation of half the intensity from half the tangent, the energy outside the maps, the
    difference of left and right, and the steepest angle.
    """
    full, half = (tangent(head.normals({unit: intensity}), flat) for intensity in (1.0, 0.5))
    sides = unit_channels(int(unit))
    left, right = (tangent(head.normals({name: 1.0}), flat) for name in (sides[0], sides[-1]))
    is_deep = (full > LINEAR_RANGE[0]) & (full < LINEAR_RANGE[1])
    energy = full**2
    return _LawViolations(
        linear=float(np.abs(half[is_deep] / full[is_deep] - 0.5).max()),
        outside=float(energy[~head.support(numbers)].sum() / energy.sum()),
        mirror=float(np.sqrt(np.mean((left - right[:, ::-1]) ** 2) / np.mean(left**2))),
        steepest=float(np.degrees(np.arctan(full.max()))),
    )


def tangent(normals: Floats, flat: Floats) -> Floats:
    """Return the tangent (height, width) of the angle between surface normals.

    The cosine alone would be inaccurate at small angles.
    """
    cosine = (normals * flat).sum(axis=2)
    sine = np.linalg.norm(np.cross(normals, flat), axis=2)
    return np.where(cosine > 0.0, sine / np.maximum(cosine, 1e-3), 0.0)
