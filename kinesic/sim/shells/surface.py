"""Triangle meshes of distance fields by the surface nets method.

Each grid cell that the surface crosses gets one vertex. Vertices are then projected onto the surface, normals are the
gradient of the field, and triangles are split along lines where colours change, so that the lines are sharp although
the triangles are large.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices
from kinesic.sim.shells.distance import DistanceField, gradient

NEWTON_STEPS = 4  # steps of Newton's method that project a vertex onto the surface
PADDING_CELLS = 2.5  # number of empty grid cells around a solid
SNAP_DISTANCE = 3e-4  # [m] distance from a line below which vertices are moved onto it
PROJECTION_DAMPING = 0.01  # damping of Newton's method, for surfaces that are nearly parallel where they intersect
SMOOTHING_PASSES = 2  # passes that move vertices towards the mean of their neighbours
TARGET_TRIANGLE_RATIO = 0.92  # intended number of triangles / largest number


@dataclass(frozen=True, eq=False)
class ClosedSurface:
    """Closed triangle mesh."""

    vertices: Floats  # (v, 3) [m]
    triangles: Indices  # (t, 3) counterclockwise from outside


def triangulate(field: DistanceField, low: Floats, high: Floats, *, most: int) -> ClosedSurface:
    """Triangulate the surface of a solid.

    Args:
        field: Signed distance of the solid.
        low: (3,) [m] lower corner of a box that contains the solid.
        high: (3,) [m] upper corner of the box.
        most: Approximate largest number of triangles.
    """
    step = float((high - low).max()) / 12
    for _ in range(4):
        mesh = _make_nets(field, low, high, step)
        step *= np.sqrt(len(mesh.triangles) / (TARGET_TRIANGLE_RATIO * most))
    vertices = mesh.vertices
    for _ in range(SMOOTHING_PASSES):
        vertices = _settle(field, _relax(vertices, mesh.triangles))
    return ClosedSurface(_settle(field, vertices), mesh.triangles)


def _make_nets(field: DistanceField, low: Floats, high: Floats, step: float) -> ClosedSurface:
    start = low - PADDING_CELLS * step
    shape = np.ceil((high - low) / step + 2 * PADDING_CELLS).astype(int) + 1
    points = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    values = field(start + step * points).reshape(shape)
    inside = values < 0.0
    cells = tuple(n - 1 for n in shape)
    sums, counts = np.zeros((*cells, 3)), np.zeros(cells)
    for axis, corner in product(range(3), product((0, 1), repeat=2)):
        offset = np.insert(corner, axis, 0)
        a = _find_window(values, offset, cells)
        b = _find_window(values, offset + np.eye(3, dtype=int)[axis], cells)
        crossing = (a < 0.0) != (b < 0.0)
        fraction = np.where(crossing, a / np.where(crossing, a - b, 1.0), 0.0)
        place = np.broadcast_to(offset, (*cells, 3)) + fraction[..., None] * np.eye(3)[axis]
        sums += crossing[..., None] * place
        counts += crossing
    is_used = counts > 0
    number = np.full(cells, -1)
    number[is_used] = np.arange(is_used.sum())
    vertices = start + step * (np.argwhere(is_used) + sums[is_used] / counts[is_used][:, None])
    quads = np.concatenate([_list_quads(inside, number, axis) for axis in range(3)])
    return ClosedSurface(vertices, _halve_quads(vertices, quads))


def _find_window(values: Floats, offset: Indices, cells: tuple[int, ...]) -> Floats:
    return values[tuple(slice(o, o + n) for o, n in zip(offset, cells, strict=True))]


def _list_quads(inside: Flags, number: Indices, axis: int) -> Indices:
    """Return a quad for each grid edge that crosses the surface.

    Its corners are the four cells around the edge. All edges are along one axis.
    """
    first, second = (axis + 1) % 3, (axis + 2) % 3
    a, b = (np.take(inside, range(k, inside.shape[axis] - 1 + k), axis) for k in (0, 1))
    edges = np.argwhere(a != b)
    outward = a[tuple(edges.T)]
    u, v = np.eye(3, dtype=int)[[first, second]]
    around = [edges - u - v, edges - v, edges, edges - u]
    rings = np.stack([number[tuple(cell.T)] for cell in around], axis=1)
    rings[~outward] = rings[~outward][:, ::-1]
    return rings


def _halve_quads(vertices: Floats, quads: Indices) -> Indices:
    """Split quads into two triangles along the shorter diagonal."""
    corners = vertices[quads]
    shorter = np.linalg.norm(corners[:, 0] - corners[:, 2], axis=1) <= np.linalg.norm(
        corners[:, 1] - corners[:, 3], axis=1
    )
    turned = np.where(shorter[:, None], quads, np.roll(quads, -1, axis=1))
    return np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])


def _relax(vertices: Floats, triangles: Indices) -> Floats:
    sums, counts = np.zeros_like(vertices), np.zeros(len(vertices))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        np.add.at(sums, triangles[:, a], vertices[triangles[:, b]])
        np.add.at(counts, triangles[:, a], 1.0)
    return np.asarray(0.4 * vertices + 0.6 * sums / counts[:, None])


def _settle(field: DistanceField, vertices: Floats) -> Floats:
    for _ in range(NEWTON_STEPS):
        slope = gradient(field, vertices)
        square = np.maximum((slope**2).sum(axis=1), 0.1)
        vertices = vertices - (field(vertices) / square)[:, None] * slope
    return vertices


def cut(mesh: ClosedSurface, solid: DistanceField, lines: Sequence[DistanceField]) -> ClosedSurface:
    """Split surface triangles along the zero lines of distance fields.

    Afterwards no triangle is on both sides of a line.

    Args:
        mesh: Mesh of the surface.
        solid: Field of the solid.
        lines: Fields that are nearly constant over a few millimetres along the surface.
    """
    for line in lines:
        mesh = _cut(mesh, solid, line)
    return mesh


def _cut(mesh: ClosedSurface, solid: DistanceField, line: DistanceField) -> ClosedSurface:
    vertices, values = mesh.vertices.copy(), line(mesh.vertices)
    near_indices = np.flatnonzero(np.abs(values) < SNAP_DISTANCE)
    vertices[near_indices] = _project_onto(solid, line, vertices[near_indices])
    values[near_indices] = 0.0
    sides = np.sign(values[mesh.triangles])
    is_split = (sides.min(axis=1) < 0) & (sides.max(axis=1) > 0)
    edge_vertices: dict[tuple[int, int], int] = {}

    def edge_vertex(a: int, b: int) -> int:
        return edge_vertices.setdefault((min(a, b), max(a, b)), len(vertices) + len(edge_vertices))

    new_triangles = [
        piece
        for corners in mesh.triangles[is_split].tolist()
        for piece in _split_triangle(corners, values, edge_vertex)
    ]
    ends = np.array(list(edge_vertices), dtype=np.intp).reshape(-1, 2)
    fraction = values[ends[:, 0]] / (values[ends[:, 0]] - values[ends[:, 1]])
    middles = vertices[ends[:, 0]] + fraction[:, None] * (vertices[ends[:, 1]] - vertices[ends[:, 0]])
    triangles = np.concatenate([mesh.triangles[~is_split], np.array(new_triangles, dtype=np.intp).reshape(-1, 3)])
    return ClosedSurface(np.concatenate([vertices, _project_onto(solid, line, middles)]), triangles)


def _project_onto(solid: DistanceField, line: DistanceField, places: Floats) -> Floats:
    """Move points onto the curve where two distance fields are zero."""
    for _ in range(NEWTON_STEPS):
        slopes = np.stack([gradient(solid, places), gradient(line, places)], axis=1)
        square = slopes @ slopes.transpose(0, 2, 1) + PROJECTION_DAMPING * np.eye(2)
        values = np.stack([solid(places), line(places)], axis=1)[..., None]
        places = places - (slopes.transpose(0, 2, 1) @ np.linalg.solve(square, values))[..., 0]
    return places


def _split_triangle(
    corners: list[int], values: Floats, edge_vertex: Callable[[int, int], int]
) -> list[tuple[int, int, int]]:
    """Split a triangle crossed by a line into two or three triangles."""
    a, b, c = corners
    while values[a] != 0.0 and not (values[a] * values[b] < 0.0 and values[a] * values[c] < 0.0):
        a, b, c = b, c, a
    if values[a] == 0.0:
        middle = edge_vertex(b, c)
        return [(a, b, middle), (a, middle, c)]
    ab, ac = edge_vertex(a, b), edge_vertex(a, c)
    return [(a, ab, ac), (ab, b, c), (ab, c, ac)]
