"""Triangles on the surface of a field, by surface nets: a vertex in each cell that the surface passes.

Vertices are then moved onto the surface, normals are the field's gradient, and triangles are cut along lines where
colours change, so that the lines are sharp although the triangles are large.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices
from kinesic.sim.shells.distance import DistanceField, gradient

SETTLED = 4  # steps of Newton onto the surface
AIR_CELLS = 2.5  # cells of air round a solid
SNAP = 3e-4  # [m] vertices nearer to a line are moved onto it
STIFF = 0.01  # of a step onto a line that is nearly along the surface
RELAXED = 2  # times that vertices are drawn to the middle of their neighbours
EVEN = 0.92  # aimed at, of the triangles that are allowed


@dataclass(frozen=True, eq=False)
class ClosedSurface:
    """A closed surface."""

    vertices: Floats  # (v, 3) [m]
    triangles: Indices  # (t, 3) anticlockwise from outside


def mesh_of(field: DistanceField, low: Floats, high: Floats, *, most: int) -> ClosedSurface:
    """Covers the surface of a solid.

    Args:
        field: its signed distance.
        low: (3,) [m] of a box that holds it.
        high: likewise.
        most: triangles, about.
    """
    step = float((high - low).max()) / 12
    for _ in range(4):
        mesh = _nets(field, low, high, step)
        step *= np.sqrt(len(mesh.triangles) / (EVEN * most))
    vertices = mesh.vertices
    for _ in range(RELAXED):
        vertices = _settled(field, _relaxed(vertices, mesh.triangles))
    return ClosedSurface(_settled(field, vertices), mesh.triangles)


def _nets(field: DistanceField, low: Floats, high: Floats, step: float) -> ClosedSurface:
    start = low - AIR_CELLS * step
    shape = np.ceil((high - low) / step + 2 * AIR_CELLS).astype(int) + 1
    points = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    values = field(start + step * points).reshape(shape)
    inside = values < 0.0
    cells = tuple(n - 1 for n in shape)
    sums, counts = np.zeros((*cells, 3)), np.zeros(cells)
    for axis, corner in product(range(3), product((0, 1), repeat=2)):
        offset = np.insert(corner, axis, 0)
        a = _window(values, offset, cells)
        b = _window(values, offset + np.eye(3, dtype=int)[axis], cells)
        crossing = (a < 0.0) != (b < 0.0)
        share = np.where(crossing, a / np.where(crossing, a - b, 1.0), 0.0)
        place = np.broadcast_to(offset, (*cells, 3)) + share[..., None] * np.eye(3)[axis]
        sums += crossing[..., None] * place
        counts += crossing
    used = counts > 0
    number = np.full(cells, -1)
    number[used] = np.arange(used.sum())
    vertices = start + step * (np.argwhere(used) + sums[used] / counts[used][:, None])
    quads = np.concatenate([_quads(inside, number, axis) for axis in range(3)])
    return ClosedSurface(vertices, _halved(vertices, quads))


def _window(values: Floats, offset: Indices, cells: tuple[int, ...]) -> Floats:
    return values[tuple(slice(o, o + n) for o, n in zip(offset, cells, strict=True))]


def _quads(inside: Flags, number: Indices, axis: int) -> Indices:
    """One for each edge along an axis that crosses the surface, of the four cells about it."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    a, b = (np.take(inside, range(k, inside.shape[axis] - 1 + k), axis) for k in (0, 1))
    edges = np.argwhere(a != b)
    outward = a[tuple(edges.T)]
    u, v = np.eye(3, dtype=int)[[first, second]]
    around = [edges - u - v, edges - v, edges, edges - u]
    rings = np.stack([number[tuple(cell.T)] for cell in around], axis=1)
    rings[~outward] = rings[~outward][:, ::-1]
    return rings


def _halved(vertices: Floats, quads: Indices) -> Indices:
    """Two triangles of each, along its shorter diagonal."""
    corners = vertices[quads]
    shorter = np.linalg.norm(corners[:, 0] - corners[:, 2], axis=1) <= np.linalg.norm(
        corners[:, 1] - corners[:, 3], axis=1
    )
    turned = np.where(shorter[:, None], quads, np.roll(quads, -1, axis=1))
    return np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])


def _relaxed(vertices: Floats, triangles: Indices) -> Floats:
    sums, counts = np.zeros_like(vertices), np.zeros(len(vertices))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        np.add.at(sums, triangles[:, a], vertices[triangles[:, b]])
        np.add.at(counts, triangles[:, a], 1.0)
    return np.asarray(0.4 * vertices + 0.6 * sums / counts[:, None])


def _settled(field: DistanceField, vertices: Floats) -> Floats:
    for _ in range(SETTLED):
        slope = gradient(field, vertices)
        square = np.maximum((slope**2).sum(axis=1), 0.1)
        vertices = vertices - (field(vertices) / square)[:, None] * slope
    return vertices


def cut(mesh: ClosedSurface, solid: DistanceField, lines: Sequence[DistanceField]) -> ClosedSurface:
    """Cuts triangles where fields are 0, so that none is on both sides.

    Args:
        mesh: of the surface.
        solid: whose surface it is.
        lines: fields, all but constant over a few millimetres along the surface.
    """
    for line in lines:
        mesh = _cut(mesh, solid, line)
    return mesh


def _cut(mesh: ClosedSurface, solid: DistanceField, line: DistanceField) -> ClosedSurface:
    vertices, values = mesh.vertices.copy(), line(mesh.vertices)
    near = np.flatnonzero(np.abs(values) < SNAP)
    vertices[near] = _onto(solid, line, vertices[near])
    values[near] = 0.0
    sides = np.sign(values[mesh.triangles])
    split = (sides.min(axis=1) < 0) & (sides.max(axis=1) > 0)
    known: dict[tuple[int, int], int] = {}

    def between(a: int, b: int) -> int:
        return known.setdefault((min(a, b), max(a, b)), len(vertices) + len(known))

    fresh = [piece for corners in mesh.triangles[split].tolist() for piece in _pieces(corners, values, between)]
    ends = np.array(list(known), dtype=np.intp).reshape(-1, 2)
    share = values[ends[:, 0]] / (values[ends[:, 0]] - values[ends[:, 1]])
    middles = vertices[ends[:, 0]] + share[:, None] * (vertices[ends[:, 1]] - vertices[ends[:, 0]])
    triangles = np.concatenate([mesh.triangles[~split], np.array(fresh, dtype=np.intp).reshape(-1, 3)])
    return ClosedSurface(np.concatenate([vertices, _onto(solid, line, middles)]), triangles)


def _onto(solid: DistanceField, line: DistanceField, places: Floats) -> Floats:
    """Moves places by the shortest way to where both fields are 0."""
    for _ in range(SETTLED):
        slopes = np.stack([gradient(solid, places), gradient(line, places)], axis=1)
        square = slopes @ slopes.transpose(0, 2, 1) + STIFF * np.eye(2)
        values = np.stack([solid(places), line(places)], axis=1)[..., None]
        places = places - (slopes.transpose(0, 2, 1) @ np.linalg.solve(square, values))[..., 0]
    return places


def _pieces(corners: list[int], values: Floats, between: Callable[[int, int], int]) -> list[tuple[int, int, int]]:
    """A triangle that a line crosses, in two or three."""
    a, b, c = corners
    while values[a] != 0.0 and not (values[a] * values[b] < 0.0 and values[a] * values[c] < 0.0):
        a, b, c = b, c, a
    if values[a] == 0.0:
        middle = between(b, c)
        return [(a, b, middle), (a, middle, c)]
    ab, ac = between(a, b), between(a, c)
    return [(a, ab, ac), (ab, b, c), (ab, c, ac)]
