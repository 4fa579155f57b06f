"""What moves the vertices that are drawn: a head that turns, or a whole figure that stands as a skeleton does."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Skeleton
from kinesic.face.assets.action_units import deform
from kinesic.face.assets.body import DressedPerson
from kinesic.face.assets.chart import vertex_chart
from kinesic.face.assets.hair import THICK
from kinesic.face.assets.mesh import PARTS, Mesh
from kinesic.face.assets.skinning import Blending, Skin
from kinesic.face.render.camera import Camera
from kinesic.face.render.head_pose import steady_shoulders

VOLUME = 0.0035  # [m] that painted hair stands off the scalp, so far over the hairline as it is thick


class MovingMesh(Protocol):
    """A mesh that moves."""

    mesh: Mesh

    def vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """(v, 6) positions [m] and normals of a face that shows some action units."""


class HeadShape:
    """A head that the camera turns, on shoulders that stay."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self._hair = VOLUME * np.clip(vertex_chart(mesh)[:, 3] / THICK, 0.0, 1.0) * (mesh.parts == PARTS.index("skin"))

    def vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """(v, 6) positions and normals."""
        positions = steady_shoulders(self.mesh.positions, deform(self.mesh, units), camera.turn)
        return _with_normals(self.mesh, positions, self.mesh.eyes, self._hair)


class FigureShape:
    """A figure in the world; set `angles` before it is drawn."""

    def __init__(self, figure: DressedPerson, skeleton: Skeleton, *, blending: Blending = "linear") -> None:
        """Stands at rest.

        Args:
            figure: with its skin and clothes.
            skeleton: that moves it.
            blending: how its skin follows.
        """
        self.mesh, self.angles = figure.mesh, skeleton.rest
        self._skin = Skin(figure, skeleton, blending=blending)
        self._hair = figure.hair

    def vertices(self, units: Mapping[str, float], camera: Camera) -> Floats:
        """(v, 6) positions and normals."""
        positions = self._skin.place(deform(self.mesh, units), self.angles)
        return _with_normals(self.mesh, positions, self._skin.carry(self.mesh.eyes, self.angles), self._hair)


def _with_normals(mesh: Mesh, positions: Floats, eyes: Floats, hair: Floats) -> Floats:
    """(v, 6) positions, with hair that stands off by (v,) [m], and normals; those of eyeballs are a ball's."""
    normals = mesh.normals(positions)
    balls = mesh.vertices("eyes")
    spokes = positions[balls] - eyes[np.where(mesh.positions[balls, 1] > 0.0, 0, 1)]
    normals[balls] = spokes / np.linalg.norm(spokes, axis=1, keepdims=True)
    return np.concatenate([positions + normals * hair[:, None], normals], axis=1)
