"""Keeps the lips from passing through each other, and pressed ones together.

Shapes move either lip without regard to the other: a smile lifts the lower one into the upper. Here the lowest point of
the upper lip is compared with the highest of the lower one in columns from side to side. Where they overlap, both give
way, the softer lower one more; what must be shut is drawn together likewise.
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.mesh import Mesh

JAW = "jawOpen"  # the shape that takes the lower lip along
CORNER = 0.4  # share of the jaw's way that the corners of the mouth go: what goes further is the lower lip
ASIDE, FORWARD, AROUND = 0.40, 0.28, 0.42  # distances between the eyes: the corners, the teeth, the skin that gives way
NEAR = 0.22  # distances between the eyes from there, within which an edge of a lip is looked for
MIDDLE = 0.2  # distances between the eyes from the middle, within which the lower lip's edge says how high the mouth is
COLUMNS = 25
SOFTER = 0.75  # share of what both give way that is the lower lip's
TOUCHING = 0.0004  # [m] that closed lips overlap, so that no slit is left between them
STICKY = 0.001  # [m] of a gap, over which lips hold on to each other ever less
CORNERS = 0.002  # [m] and at the corners of the mouth, where a column is wider than what it must close
SAMPLES = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [1, 1, 0], [0, 1, 1], [1, 0, 1]])


@dataclass(frozen=True, eq=False)
class Lip:
    """One lip."""

    skin: NDArray[np.intp]  # (k,) that gives way
    gives: Floats  # (k,) 0..1 how much of what the edge does
    places: "scipy.sparse.csr_array"  # (n, v) points on its surface among the vertices
    outward: float  # 1 where it grows upward from the other, -1 downward


@dataclass(frozen=True, eq=False)
class Lips:
    """Both lips, in columns from right to left."""

    upper: Lip
    lower: Lip
    middles: Floats  # (c,) [m] to the left
    touching: Floats  # (c,) [m] that they overlap when they are closed

    def part(self, positions: Floats, seal: float) -> None:
        """Moves lips in place.

        Args:
            positions: (v, 3) [m] where shapes have put the vertices.
            seal: 0..1 how much of what is open between them is shut.
        """
        gap = self.touching - self.overlap(positions)
        opened = np.maximum(gap, 0.0)
        stuck = opened * np.exp(-opened / STICKY)
        change = -np.where(gap < 0.0, gap, seal * gap + (1.0 - seal) * stuck)
        for lip, share in ((self.upper, 1.0 - SOFTER), (self.lower, SOFTER)):
            amount = share * np.interp(positions[lip.skin, 1], self.middles, change, left=0.0, right=0.0)
            positions[lip.skin, 2] += lip.outward * lip.gives * amount

    def overlap(self, positions: Floats) -> Floats:
        """(c,) [m] how far the lower lip reaches over the end of the upper one; below 0 where they are apart."""
        return _edge(self.lower, positions, self.middles) - _edge(self.upper, positions, self.middles)


def lips(mesh: Mesh) -> Lips:
    """Finds the lips of a head."""
    unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = (mesh.positions / unit).T
    below = falls(mesh) > CORNER
    skin = (mesh.parts == 0) & (forward > FORWARD) & (np.abs(left) < ASIDE)
    away = np.abs(up - up[skin & below & (np.abs(left) < MIDDLE)].max())
    skin &= away < AROUND
    gives = np.clip(1.25 * (1.0 - away / AROUND), 0.0, 1.0) ** 2
    middles = np.linspace(-ASIDE, ASIDE, COLUMNS) * unit
    upper, lower = (
        Lip(
            skin=np.flatnonzero(each),
            gives=gives[each],
            places=_points(mesh, each & (away < NEAR)),
            outward=outward,
        )
        for each, outward in ((skin & ~below, 1.0), (skin & below, -1.0))
    )
    aside = np.clip((np.abs(middles) / middles[-1] - 0.7) / 0.15, 0.0, 1.0)
    return Lips(upper, lower, middles, TOUCHING + (CORNERS - TOUCHING) * aside)


def falls(mesh: Mesh) -> Floats:
    """(v,) how far a dropping jaw takes each vertex along, against what it takes furthest."""
    down = -mesh.deltas[:, [mesh.shapes.index(JAW)]].toarray().reshape(-1, 3)[:, 2]
    return np.asarray(down / down.max())


def _points(mesh: Mesh, lip: NDArray[np.bool_]) -> "scipy.sparse.csr_array":
    """(n, v) places of points all over a lip."""
    triangles = mesh.triangles[lip[mesh.triangles].all(axis=1)]
    shares = SAMPLES / SAMPLES.sum(axis=1, keepdims=True)
    count = len(triangles) * len(shares)
    rows = np.repeat(np.arange(count), 3)
    columns = np.repeat(triangles[:, None], len(shares), axis=1).ravel()
    values = np.tile(shares.ravel(), len(triangles))
    return scipy.sparse.csr_array((values, (rows, columns)), shape=(count, len(mesh.positions)))


def _edge(lip: Lip, positions: Floats, middles: Floats) -> Floats:
    """(c,) [m] height of the end of a lip that is nearer to the other, in each column."""
    points = lip.places @ positions
    wide = middles[1] - middles[0]
    column = np.clip(np.rint((points[:, 1] - middles[0]) / wide).astype(np.intp), 0, len(middles) - 1)
    found = np.full(len(middles), np.inf)
    np.minimum.at(found, column, lip.outward * points[:, 2])
    found = lip.outward * found
    known = np.isfinite(found)
    return np.asarray(np.interp(middles, middles[known], found[known]))
