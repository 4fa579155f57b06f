"""Slides eyelids over the eyeballs: closed they just meet, whatever else moves them, and nothing pierces them.

Shapes move vertices along straight lines, which cut through a ball. Here the upper lid turns instead about the axis
that runs through the eyeball from side to side, by a share of the way to the lower lid; then what is in the ball, or in
the bulge of its cornea, is lifted out of it. Lashes stand on the edges of the lids.
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.eyeball import cornea_bulge
from kinesic.face.assets.mesh import PARTS, Indices, Mesh
from kinesic.face.assets.paint import IRIS

AROUND = 1.8  # radii of the eyeball, within which skin is a lid's
LIFT = 0.0004  # [m] that skin stands off the eyeball, if it did at rest
BURIED = 0.001  # [m] in the ball at rest: what is deeper is never seen
OVERLAP = 0.02  # of the way, that a closed lid goes on over the other
PROUD = 20.0  # [rad/m] how much more it counts that the edge of a lid stands out than that it is low
LID_STEPS = 40  # of the way of a lid
FAINT = 5e-4  # [m] of a blink, that counts as none

Vertices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Lids:
    """The lids of one eye."""

    centre: Floats  # (3,) [m] of the eyeball
    radius: float  # [m]
    upper: Vertices  # edge of the upper lid, from right to left
    lower: Vertices
    skin: Vertices  # (k,) that may touch the eyeball
    follows: Floats  # (k,) 0..1 how much of the way of the upper lid's edge each goes
    stands_off: Floats  # (k,) [m] the eyeball, at least
    evenly: Floats  # (n,) shares of the iris that are hidden as the edge goes n equal steps of its way
    lashes: Vertices  # (l,)
    roots: "scipy.sparse.csr_array"  # (l, v) where on an edge each lash stands
    strands: Floats  # (l, 3) [m] from there
    leaning: Floats  # (l,) [rad] how high that is at rest

    def close(self, positions: Floats, share: float, ahead: Floats) -> None:
        """Moves lids and lashes in place.

        Args:
            positions: (v, 3) [m] where shapes have put the vertices.
            share: of what shows of the iris at rest that the upper lid hides; at 1 it meets the lower one.
            ahead: (3,) unit vector along which the eye looks.
        """
        way = (1.0 + OVERLAP) * np.interp(share, self.evenly, np.linspace(0.0, 1.0, len(self.evenly)))
        points = positions[self.skin] - self.centre
        gap = self._gap(positions, points[:, 1])
        points = _turned(points, self.follows * (np.maximum(gap, 0.0) * (1.0 - way) - gap))
        away = np.linalg.norm(points, axis=1)
        least = self.surface(points / away[:, None], ahead) + self.stands_off
        positions[self.skin] = self.centre + points * (np.maximum(away, least) / away)[:, None]
        roots = self.roots @ positions
        lean = _heights(roots - self.centre) - self.leaning
        positions[self.lashes] = roots + _turned(self.strands, lean)

    def surface(self, directions: Floats, ahead: Floats) -> Floats:
        """(n,) [m] how far from its centre the eyeball ends in (n, 3) directions."""
        return np.asarray(self.radius * (1.0 + cornea_bulge(np.arccos(np.clip(directions @ ahead, -1.0, 1.0)))))

    def _gap(self, positions: Floats, aside: Floats) -> Floats:
        """(k,) [rad] between the edges of the lids, at (k,) [m] to the left."""
        top, bottom = (_edge(positions[each] - self.centre, aside) for each in (self.upper, self.lower))
        return np.asarray(top - bottom)


def lids(mesh: Mesh, side: str, number: int) -> Lids:
    """Finds the lids of an eye.

    Args:
        mesh: of a head.
        side: "Left" or "Right", as shapes are named.
        number: of the eyeball in `mesh.eyes`.
    """
    centre = mesh.eyes[number]
    points = mesh.positions - centre
    away, here = np.linalg.norm(points, axis=1), np.sign(mesh.positions[:, 1]) == np.sign(centre[1])
    radius = float(away[here & (mesh.parts == PARTS.index("eyes")) & (points[:, 0] > 0.0)].max())
    near = here & (away < AROUND * radius) & (points[:, 0] > 0.0) & (mesh.parts == PARTS.index("skin"))
    blink = np.linalg.norm(mesh.deltas[:, [mesh.shapes.index(f"eyeBlink{side}")]].toarray().reshape(-1, 3), axis=1)
    moved = np.flatnonzero(near & (blink > 0.5 * blink[near].max()) & (np.abs(points[:, 1]) < 0.2 * radius))
    start = moved[np.argmin(_heights(points[moved]) - PROUD * away[moved])]
    upper, lower = _edges(mesh.faces[near[mesh.faces].all(axis=1)], int(start), points)
    over = _heights(points) > 0.5 * (_edge(points[upper], points[:, 1]) + _edge(points[lower], points[:, 1]))
    outside = away - radius * (1.0 + cornea_bulge(np.arccos(np.clip(points[:, 0] / away, -1.0, 1.0))))
    skin = np.flatnonzero(near)
    whole = np.interp(points[skin, 1], points[upper, 1], np.maximum(blink[upper], FAINT))
    lashes = np.flatnonzero(here & (mesh.parts == PARTS.index("lashes")))
    roots = _standing(points, lashes, [upper if over[lash] else lower for lash in lashes])
    stand = roots @ mesh.positions
    return Lids(
        centre=centre,
        radius=radius,
        upper=upper,
        lower=lower,
        skin=skin,
        follows=np.clip(blink[skin] / whole, 0.0, 1.0) * over[skin],
        stands_off=np.where(outside[skin] > -BURIED, np.minimum(outside[skin], LIFT), -radius),
        evenly=_hidden(points[upper], points[lower], radius),
        lashes=lashes,
        roots=roots,
        strands=mesh.positions[lashes] - stand,
        leaning=_heights(stand - centre),
    )


def _edges(faces: Indices, start: int, points: Floats) -> tuple[Vertices, Vertices]:
    """Edges of the upper and of the lower lid, each from the right corner of the eye to the left.

    They are the ring through a vertex of the upper lid: from each vertex to the one that shares no face with the last.
    """
    at: dict[int, list[list[int]]] = {}
    for face in faces.tolist():
        for corner in face:
            at.setdefault(corner, []).append(face)
    beside = {corner for face in at[start] for corner in _beside(face, start)}
    ring = [start, max(beside, key=lambda each: abs(points[each, 1] - points[start, 1]))]
    while ring[-1] != start:
        before, last = ring[-2:]
        shared = {corner for face in at[last] if before in face for corner in face}
        (following,) = {corner for face in at[last] for corner in _beside(face, last)} - shared
        ring.append(following)
    around = np.array(ring[:-1])
    around = np.roll(around, -int(points[around, 1].argmin()))
    corner = int(points[around, 1].argmax())
    halves = around[: corner + 1], np.append(around[corner:], around[0])[::-1]
    upper, lower = sorted(halves, key=lambda half: -float(points[half, 2].mean()))
    return upper, lower


def _beside(face: list[int], corner: int) -> tuple[int, int]:
    """The corners of a face next to one of them."""
    place = face.index(corner)
    return face[place - 1], face[place - 3]


def _hidden(upper: Floats, lower: Floats, radius: float) -> Floats:
    """(n,) share of what shows of the iris that is hidden after each step of the upper lid's way."""
    aside = np.linspace(-IRIS, IRIS, 65)[:, None] * radius
    half = np.sqrt((IRIS * radius) ** 2 - aside**2) / radius
    top, bottom = _edge(upper, aside), _edge(lower, aside)
    edges = top - (top - bottom) * np.linspace(0.0, 1.0, LID_STEPS + 1)
    shown = np.maximum(np.minimum(edges, half) - np.maximum(bottom, -half), 0.0).sum(axis=0)
    return np.asarray(1.0 - shown / shown[0])


def _standing(points: Floats, lashes: Vertices, edges: list[Vertices]) -> "scipy.sparse.csr_array":
    """(l, v) mean of the two vertices of an edge that each lash stands between."""
    found = scipy.sparse.lil_array((len(lashes), len(points)))
    for row, (lash, edge) in enumerate(zip(lashes, edges, strict=True)):
        aside = np.maximum.accumulate(points[edge, 1])
        place = float(np.interp(points[lash, 1], aside, np.arange(len(edge))))
        first = min(int(place), len(edge) - 2)
        found[row, edge[first]] += 1.0 - (place - first)
        found[row, edge[first + 1]] += place - first
    return scipy.sparse.csr_array(found)


def _edge(points: Floats, aside: Floats) -> Floats:
    """(n,) [rad] how high the edge of a lid is, at (n,) [m] to the left."""
    return np.asarray(np.interp(aside, np.maximum.accumulate(points[:, 1]), _heights(points)))


def _heights(points: Floats) -> Floats:
    """(n,) [rad] over straight ahead."""
    return np.asarray(np.arctan2(points[:, 2], points[:, 0]))


def _turned(points: Floats, up: Floats) -> Floats:
    """(n, 3) points turned by (n,) [rad] about the axis from side to side."""
    (x, y, z), cos, sin = points.T, np.cos(up), np.sin(up)
    return np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=1)
