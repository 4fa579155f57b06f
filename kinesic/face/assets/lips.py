"""Keeps the lips from passing through each other, and pressed ones together.

Shapes move either lip without regard to the other: a smile lifts the lower one into the upper. Here the lowest point of
the upper lip is compared with the highest of the lower one in columns from side to side. Where they overlap, both give
way, the softer lower one more; what must be shut is drawn together likewise. In a column, points outside it count too,
as being further from the other lip by as much as they are aside, so that none moves the lips by a step as it goes over.
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
EDGE = 0.22  # distances between the eyes above and below the mouth, within which the edge of a lip is looked for
MIDDLE = 0.2  # distances between the eyes from the middle, within which the lower lip's edge says how high the mouth is
COLUMNS = 25
ASIDE_SLOPE = 6.0  # [m/m] by which a point outside a column counts as further from the other lip, for its way to there
SOFTER = 0.75  # share of what both give way that is the lower lip's
TOUCHING = 0.0004  # [m] that closed lips overlap, so that no slit is left between them
TOUCHING_ASIDE = 0.002  # [m] likewise at the corners of the mouth, where a column is wider than what it must close
STICKY = 0.001  # [m] of a gap, over which lips hold on to each other ever less


@dataclass(frozen=True, eq=False)
class Lips:
    """Both lips, in columns from right to left."""

    skin: NDArray[np.intp]  # (k,) that gives way
    gives: Floats  # (k,) -1..1 how far it goes up when an overlap of 1 is parted
    points: "scipy.sparse.csr_array"  # (n, v) points on the surface of the upper lip, then of the lower one
    starts: NDArray[np.intp]  # (2,) first point of each
    outward: Floats  # (n,) 1 on the upper lip, -1 on the lower one
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
        positions[self.skin, 2] += self.gives * np.interp(positions[self.skin, 1], self.middles, change)

    def overlap(self, positions: Floats) -> Floats:
        """Measures how far (c,) [m] the lower lip reaches over the end of the upper one; below 0 where apart."""
        aside, away = self.points @ positions[:, 1], self.outward * (self.points @ positions[:, 2])
        return -np.asarray(self._ends(aside, away).sum(axis=0))

    def _ends(self, aside: Floats, away: Floats) -> Floats:
        """Measures how far (2, c) [m] the end of each lip is away from the other.

        Args:
            aside: (n,) [m] to the left, of points.
            away: (n,) [m] that they are away.
        """
        wide, count = self.middles[1] - self.middles[0], len(self.middles) + 2  # with what is outside, at either end
        right, left = self.middles - 0.5 * wide, self.middles + 0.5 * wide
        column = np.clip(((aside - right[0]) / wide + 1.0).astype(np.intp), 0, count - 1)
        column[self.starts[1] :] += count
        further = ASIDE_SLOPE * aside
        found = np.full((3, 2 * count), np.inf)
        for least, each in zip(found, (away, away - further, away + further), strict=True):
            np.minimum.at(least, column, each)
        within, before, behind = found.reshape(3, 2, count)
        # beside its outermost points a lip is as far away as these are
        first, last = (each.reduceat(further, self.starts)[:, None] for each in (np.minimum, np.maximum))
        before = np.minimum.accumulate(before, axis=1)[:, :-2] + np.clip(ASIDE_SLOPE * right, first, last)
        behind = np.minimum.accumulate(behind[:, ::-1], axis=1)[:, -3::-1] - np.clip(ASIDE_SLOPE * left, first, last)
        return np.asarray(np.minimum(within[:, 1:-1], np.minimum(before, behind)))


def lips(mesh: Mesh) -> Lips:
    """Finds the lips of a head."""
    unit = float(mesh.eyes[0, 1] - mesh.eyes[1, 1])
    forward, left, up = (mesh.positions / unit).T
    below = falls(mesh) > CORNER
    skin = (mesh.parts == 0) & (forward > FORWARD) & (np.abs(left) < ASIDE)
    away = np.abs(up - up[skin & below & (np.abs(left) < MIDDLE)].max())
    skin &= away < AROUND
    gives = np.clip(1.25 * (1.0 - away / AROUND), 0.0, 1.0) ** 2 * np.where(below, -SOFTER, 1.0 - SOFTER)
    middles = np.linspace(-ASIDE, ASIDE, COLUMNS) * unit
    aside = np.clip((np.abs(middles) / middles[-1] - 0.7) / 0.15, 0.0, 1.0)
    upper, lower = (_points(mesh, skin & each & (away < EDGE)) for each in (~below, below))
    return Lips(
        skin=np.flatnonzero(skin),
        gives=gives[skin],
        points=scipy.sparse.vstack([upper, lower], format="csr"),
        starts=np.array([0, upper.shape[0]]),
        outward=np.repeat([1.0, -1.0], [upper.shape[0], lower.shape[0]]),
        middles=middles,
        touching=TOUCHING + (TOUCHING_ASIDE - TOUCHING) * aside,
    )


def falls(mesh: Mesh) -> Floats:
    """Measures how far (v,) a dropping jaw takes each vertex along, as a share of what it takes furthest."""
    down = -mesh.deltas[:, [mesh.shapes.index(JAW)]].toarray().reshape(-1, 3)[:, 2]
    return np.asarray(down / down.max())


def _points(mesh: Mesh, lip: NDArray[np.bool_]) -> "scipy.sparse.csr_array":
    """Spreads points (n, v) all over a lip: corners and middles of edges, and three within each triangle."""
    triangles = mesh.triangles[lip[mesh.triangles].all(axis=1)].astype(np.intp)
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)) @ (len(lip), 1)
    edges = np.stack(np.divmod(np.unique(ends), len(lip)), axis=1)
    corners = np.unique(triangles)[:, None]
    within = (np.roll(triangles, turn, axis=1) for turn in range(3))
    places = (np.repeat(corners, 3, axis=1), edges[:, [0, 1, 1]], *within)
    shares = ((1.0, 0.0, 0.0), (0.5, 0.5, 0.0), *3 * ((4 / 6, 1 / 6, 1 / 6),))
    values = np.repeat(shares, [len(each) for each in places], axis=0).ravel()
    count = len(values) // 3
    return scipy.sparse.csr_array(
        (values, np.concatenate(places).ravel(), np.arange(0, 3 * count + 1, 3)), shape=(count, len(lip))
    )
