"""Moving meshes: a turning head, or a figure posed by a skeleton."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.action_units import deform
from kinesic.face.assets.body import DressedPerson
from kinesic.face.assets.hair import measure_painted_hair
from kinesic.face.assets.mesh import Mesh
from kinesic.face.assets.rig import FRAME_INDICES
from kinesic.face.assets.skinning import Blending, Skin
from kinesic.face.render.camera import Camera
from kinesic.face.render.head_pose import keep_shoulders_still


class MovingMesh(Protocol):
    """Interface of a mesh with moving vertices."""

    mesh: Mesh

    def vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """Return (v, 6) mesh positions [m] and normals for action units."""

    def head_motion(self) -> tuple[Floats, Floats] | None:
        """Return the head's rotation and translation [m], None without rigid motion."""


class HeadShape:
    """Head that turns with `Camera.turn` on still shoulders."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self._hair = measure_painted_hair(mesh)

    def vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """Return (v, 6) positions [m] and normals of the turned head."""
        positions = keep_shoulders_still(self.mesh.positions, deform(self.mesh, units), camera.turn)
        return _add_normals(self.mesh, positions, self.mesh.eyes, self._hair)

    def head_motion(self) -> tuple[Floats, Floats] | None:
        """Return None, since the camera turns instead of the head."""
        return None


class FigureShape:
    """Figure in the world, posed by its attribute `angles`."""

    def __init__(self, figure: DressedPerson, skeleton: Skeleton, *, blending: Blending = "linear") -> None:
        """Create the figure in its rest pose.

        Args:
            figure: figure with its skin and clothes.
            skeleton: skeleton that moves it.
            blending: skinning method.
        """
        self.mesh, self.angles = figure.mesh, skeleton.rest
        self._skin = Skin(figure, skeleton, blending=blending)
        self._hair = measure_painted_hair(figure.mesh)

    def vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """Return (v, 6) positions [m] and normals of the posed figure."""
        positions = self._skin.move_skin(deform(self.mesh, units), self.angles)
        return _add_normals(self.mesh, positions, self._skin.move_with_head(self.mesh.eyes, self.angles), self._hair)

    def head_motion(self) -> tuple[Floats, Floats] | None:
        """Return rotation and translation [m] of the head from the bind pose."""
        turns, translations = self._skin.compute_frame_motions(self.angles)
        return turns[FRAME_INDICES["skullbase"]], translations[FRAME_INDICES["skullbase"]]


def _add_normals(mesh: Mesh, positions: Floats, eyes: Floats, hair: Floats) -> Floats:
    """Return (v, 6) positions, moved outwards by the hair, and normals.

    Normals of eyeballs are those of spheres.
    """
    normals = mesh.normals(positions)
    balls = mesh.vertices("eyes")
    spokes = positions[balls] - eyes[np.where(mesh.positions[balls, 1] > 0.0, 0, 1)]
    normals[balls] = spokes / np.linalg.norm(spokes, axis=1, keepdims=True)
    return np.concatenate([positions + normals * hair[:, None], normals], axis=1)
