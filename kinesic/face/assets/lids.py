"""Sliding of eyelids over the eyeballs without penetration.

Shapes move vertices along straight lines, which cut through a sphere. Instead, the upper lid turns about the lateral
axis of the eyeball by a fraction of the angle to the lower lid; then vertices inside the eyeball or its cornea are
lifted to the surface. Closed lids just meet in every expression. Lashes stand on the edges of the lids.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.eyeball import compute_cornea_bulge
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.mesh import MESH_PARTS, Indices, Mesh
from kinesic.face.assets.paint import IRIS_RADIUS

LID_REGION_RADIUS = 1.8  # radius of the skin around an eye, in radii of the eyeball
SKIN_CLEARANCE = 0.0004  # [m] minimum distance of skin from the eyeball, unless it is smaller at rest
BURIED_DEPTH = 0.001  # [m] depth in the eyeball at rest from which skin is never visible
LID_OVERLAP = 0.02  # overlap of closed lids / travel of the upper lid
PROTRUSION_WEIGHT = 20.0  # [rad/m] weight of protrusion against elevation angle in the lid-edge search
LID_STEPS = 40  # number of steps between sampled lid positions from open to closed
MIN_BLINK = 5e-4  # [m] lower bound of the lid edge's displacement in a blink, used as a divisor

Vertices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Lids:
    """Geometry of the upper and lower lid of one eye."""

    centre: Floats  # (3,) [m] centre of the eyeball
    radius: float  # [m] radius of the eyeball
    upper: Vertices  # edge of the upper lid, from right to left
    lower: Vertices  # edge of the lower lid, from right to left
    skin: Vertices  # (k,) skin that may touch the eyeball
    lid_motion: Floats  # (k,) 0..1 motion relative to the edge of the upper lid
    clearance: Floats  # (k,) [m] minimum distance from the eyeball
    hidden_fractions: Floats  # (n,) hidden fraction of the iris at n equally spaced lid positions
    lashes: Vertices  # (l,) vertices of the lashes
    roots: "scipy.sparse.csr_array"  # (l, v) interpolation of the root of each lash on a lid edge
    strands: Floats  # (l, 3) [m] vectors from root to vertex of each lash
    rest_elevations: Floats  # (l,) [rad] elevation of the roots at rest

    def close(self, positions: Floats, closure: float, ahead: Floats) -> None:
        """Move lid and lash vertices to a lid position, in place.

        Args:
            positions: (v, 3) [m] vertices after the shapes.
            closure: fraction of the visible iris that the upper lid hides; at 1 it meets the lower lid.
            ahead: (3,) unit vector of the gaze.
        """
        progress = (1.0 + LID_OVERLAP) * np.interp(
            closure, self.hidden_fractions, np.linspace(0.0, 1.0, len(self.hidden_fractions))
        )
        points = positions[self.skin] - self.centre
        gap = self._measure_gap(positions, points[:, 1])
        points = _pitch_points(points, self.lid_motion * (np.maximum(gap, 0.0) * (1.0 - progress) - gap))
        away = np.linalg.norm(points, axis=1)
        least = self.surface(points / away[:, None], ahead) + self.clearance
        positions[self.skin] = self.centre + points * (np.maximum(away, least) / away)[:, None]
        roots = self.roots @ positions
        lean = _compute_elevations(roots - self.centre) - self.rest_elevations
        positions[self.lashes] = roots + _pitch_points(self.strands, lean)

    def surface(self, directions: Floats, ahead: Floats) -> Floats:
        """Return the (n,) eyeball radius [m] in (n, 3) directions."""
        return np.asarray(self.radius * (1.0 + compute_cornea_bulge(np.arccos(np.clip(directions @ ahead, -1.0, 1.0)))))

    def _measure_gap(self, positions: Floats, aside: Floats) -> Floats:
        """Return the (k,) elevation angle [rad] between upper and lower lid edge.

        Args:
            positions: (v, 3) [m] vertices.
            aside: (k,) [m] lateral positions.
        """
        top, bottom = (_interpolate_edge(positions[edge] - self.centre, aside) for edge in (self.upper, self.lower))
        return np.asarray(top - bottom)


def find_lids(mesh: Mesh, side: str, number: int) -> Lids:
    """Find the lid edges, lid skin and lashes of an eye.

    Args:
        mesh: mesh of a head.
        side: "Left" or "Right", as in names of shapes.
        number: number of the eyeball in `mesh.eyes`.
    """
    centre = mesh.eyes[number]
    points = mesh.positions - centre
    away, here = np.linalg.norm(points, axis=1), np.sign(mesh.positions[:, 1]) == np.sign(centre[1])
    radius = float(away[here & (mesh.parts == MESH_PARTS.index("eyes")) & (points[:, 0] > 0.0)].max())
    near = here & (away < LID_REGION_RADIUS * radius) & (points[:, 0] > 0.0) & (mesh.parts == MESH_PARTS.index("skin"))
    blink = np.linalg.norm(mesh.deltas[:, [mesh.shapes.index(f"eyeBlink{side}")]].toarray().reshape(-1, 3), axis=1)
    moved = np.flatnonzero(near & (blink > 0.5 * blink[near].max()) & (np.abs(points[:, 1]) < 0.2 * radius))
    start = moved[np.argmin(_compute_elevations(points[moved]) - PROTRUSION_WEIGHT * away[moved])]
    upper, lower = _find_edges(mesh.faces[near[mesh.faces].all(axis=1)], int(start), points)
    over = _compute_elevations(points) > 0.5 * (
        _interpolate_edge(points[upper], points[:, 1]) + _interpolate_edge(points[lower], points[:, 1])
    )
    outside = away - radius * (1.0 + compute_cornea_bulge(np.arccos(np.clip(points[:, 0] / away, -1.0, 1.0))))
    skin = np.flatnonzero(near)
    whole = np.interp(points[skin, 1], points[upper, 1], np.maximum(blink[upper], MIN_BLINK))
    lashes = np.flatnonzero(here & (mesh.parts == MESH_PARTS.index("lashes")))
    roots = _attach_lashes(points, lashes, [upper if over[lash] else lower for lash in lashes])
    stand = roots @ mesh.positions
    return Lids(
        centre=centre,
        radius=radius,
        upper=upper,
        lower=lower,
        skin=skin,
        lid_motion=np.clip(blink[skin] / whole, 0.0, 1.0) * over[skin],
        clearance=np.where(outside[skin] > -BURIED_DEPTH, np.minimum(outside[skin], SKIN_CLEARANCE), -radius),
        hidden_fractions=_compute_hidden_fractions(points[upper], points[lower], radius),
        lashes=lashes,
        roots=roots,
        strands=mesh.positions[lashes] - stand,
        rest_elevations=_compute_elevations(stand - centre),
    )


def _find_edges(faces: Indices, start: int, points: Floats) -> tuple[Vertices, Vertices]:
    """Return the edges of both lids, from right to left corner.

    They form the ring through a vertex of the upper lid: each next vertex has no face in common with the previous one.
    """
    at: dict[int, list[list[int]]] = {}
    for face in faces.tolist():
        for corner in face:
            at.setdefault(corner, []).append(face)
    neighbours = {corner for face in at[start] for corner in _find_adjacent_corners(face, start)}
    ring = [start, max(neighbours, key=lambda vertex: abs(points[vertex, 1] - points[start, 1]))]
    while ring[-1] != start:
        previous, last = ring[-2:]
        shared = {corner for face in at[last] if previous in face for corner in face}
        (following,) = {corner for face in at[last] for corner in _find_adjacent_corners(face, last)} - shared
        ring.append(following)
    around = np.array(ring[:-1])
    around = np.roll(around, -int(points[around, 1].argmin()))
    corner = int(points[around, 1].argmax())
    halves = around[: corner + 1], np.append(around[corner:], around[0])[::-1]
    upper, lower = sorted(halves, key=lambda half: -float(points[half, 2].mean()))
    return upper, lower


def _find_adjacent_corners(face: list[int], corner: int) -> tuple[int, int]:
    """Return the two vertices next to a corner of a mesh face."""
    place = face.index(corner)
    return face[place - 1], face[place - 3]


def _compute_hidden_fractions(upper: Floats, lower: Floats, radius: float) -> Floats:
    """Return the (n,) hidden fraction of the iris at each lid position."""
    aside = np.linspace(-IRIS_RADIUS, IRIS_RADIUS, 65)[:, None] * radius
    half = np.sqrt((IRIS_RADIUS * radius) ** 2 - aside**2) / radius
    top, bottom = _interpolate_edge(upper, aside), _interpolate_edge(lower, aside)
    edges = top - (top - bottom) * np.linspace(0.0, 1.0, LID_STEPS + 1)
    shown = np.maximum(np.minimum(edges, half) - np.maximum(bottom, -half), 0.0).sum(axis=0)
    return np.asarray(1.0 - shown / shown[0])


def _attach_lashes(points: Floats, lashes: Vertices, edges: list[Vertices]) -> "scipy.sparse.csr_array":
    """Return the (l, v) interpolation of lash roots between edge vertices."""
    stencil = scipy.sparse.lil_array((len(lashes), len(points)))
    for row, (lash, edge) in enumerate(zip(lashes, edges, strict=True)):
        aside = np.maximum.accumulate(points[edge, 1])
        place = float(np.interp(points[lash, 1], aside, np.arange(len(edge))))
        first = min(int(place), len(edge) - 2)
        stencil[row, edge[first]] += 1.0 - (place - first)
        stencil[row, edge[first + 1]] += place - first
    return scipy.sparse.csr_array(stencil)


def _interpolate_edge(points: Floats, aside: Floats) -> Floats:
    """Return the (n,) elevation [rad] of a lid edge at lateral positions."""
    return np.asarray(np.interp(aside, np.maximum.accumulate(points[:, 1]), _compute_elevations(points)))


def _compute_elevations(points: Floats) -> Floats:
    """Return the (n,) elevation angles [rad] of points above the forward direction."""
    return np.asarray(np.arctan2(points[:, 2], points[:, 0]))


def _pitch_points(points: Floats, up: Floats) -> Floats:
    """Rotate (n, 3) points of an eye upwards by (n,) angles [rad].

    The axis is lateral.
    """
    (x, y, z), cos, sin = points.T, np.cos(up), np.sin(up)
    return np.stack([cos * x - sin * z, y, sin * x + cos * z], axis=1)
