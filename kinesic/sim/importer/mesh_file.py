"""Reader of triangle meshes (STL, OBJ, COLLADA) that simplifies them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.config import ConfigError
from kinesic.files.input_file import read_inside
from kinesic.sim.importer.collada import parse_collada
from kinesic.sim.importer.reading.file_kinds import refuse_pointer

MAX_MESH_SIZE = 20_000_000  # [bytes] largest mesh file
MESH_SUFFIXES = (".stl", ".obj", ".dae")  # supported mesh formats
STL_HEADER_SIZE = 84  # [bytes] size of the header of a binary STL file
STL_TEXT_START = b"solid"  # first word of an STL file in text form
STL_TRIANGLE_SIZE = 50  # [bytes] size of each triangle in a binary STL file
MAX_VERTEX_COORDINATE = 100.0  # [m] largest accepted coordinate; farther triangles are removed
CELL_BISECTIONS = 14  # bisection steps for the cell size of simplification
MAX_GRID_CELLS = 100_000  # largest number of cells along a side of the simplification grid


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangle mesh of a surface or a part of one."""

    vertices: Floats  # (v, 3) [m] positions
    corners: Indices  # (t, 3) vertex indices of each triangle


def read_mesh(path: Path, *, folder: Path) -> Triangles:
    """Read a triangle mesh from an STL, OBJ or COLLADA file.

    Args:
        path: Mesh file.
        folder: Folder that must contain the file, directly or in a subfolder.

    Raises:
        ConfigError: the file is outside the folder, too large, of another format, or broken.
        OSError: the file cannot be read.
    """
    kind = path.suffix.lower()
    if kind not in MESH_SUFFIXES:
        raise ConfigError(f"{path.name}: only {', '.join(MESH_SUFFIXES)} are read; convert it to one of them")
    data = read_inside(folder, path, max_size=MAX_MESH_SIZE)
    refuse_pointer(path.name, data)
    try:
        mesh = _parse(kind, data)
    except (ValueError, IndexError, OverflowError) as error:
        raise ConfigError(f"{path.name}: not a readable {kind[1:].upper()} file: {error}") from None
    if not len(mesh.corners) or not np.isfinite(mesh.vertices).all():
        raise ConfigError(f"{path.name}: it has no triangles, or numbers that are not finite")
    return mesh


def _parse(kind: str, data: bytes) -> Triangles:
    """Parse the contents of a mesh file by its suffix."""
    if kind == ".dae":
        vertices, corners = parse_collada(data)
        return Triangles(sealed(vertices), corners)
    return _parse_stl(data) if kind == ".stl" else _parse_obj(data.decode("utf-8", errors="replace"))


def _parse_stl(data: bytes) -> Triangles:
    """Parse an STL file in binary or text form."""
    count = int.from_bytes(data[STL_HEADER_SIZE - 4 : STL_HEADER_SIZE], "little")
    if len(data) != STL_HEADER_SIZE + count * STL_TRIANGLE_SIZE:
        if not data.lstrip().startswith(STL_TEXT_START):
            raise ValueError(f"{len(data)} bytes are not {count} triangles of a binary STL, and it is no text either")
        return _parse_stl_text(data.decode("utf-8", errors="replace"))
    rows = np.frombuffer(data, dtype=np.uint8, offset=STL_HEADER_SIZE).reshape(count, STL_TRIANGLE_SIZE)
    return _join_corners(rows[:, 12:48].copy().view("<f4").reshape(-1, 3))


def _parse_stl_text(text: str) -> Triangles:
    rows = [line.split()[1:] for line in text.splitlines() if line.split()[:1] == ["vertex"]]
    corners = np.array(rows, dtype=float).reshape(-1, 3)
    if len(corners) % 3:
        raise ValueError(f"{len(corners)} vertices are not three for each triangle")
    return _join_corners(corners)


def _join_corners(corners: Floats) -> Triangles:
    """Merge equal corners (3 t, 3) of triangles into a mesh."""
    vertices, placed = np.unique(corners, axis=0, return_inverse=True)
    return Triangles(sealed(vertices), placed.reshape(-1, 3))


def _parse_obj(text: str) -> Triangles:
    vertices: list[list[float]] = []
    corners: list[tuple[int, int, int]] = []
    for line in text.splitlines():
        kind, _, rest = line.partition(" ")
        if kind == "v":
            vertices.append([float(word) for word in rest.split()[:3]])
        elif kind == "f":
            ring = [int(word.split("/")[0]) for word in rest.split()]
            ring = [k - 1 if k > 0 else len(vertices) + k for k in ring]
            corners += [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]
    mesh = np.array(corners, dtype=np.intp).reshape(-1, 3)
    if mesh.size and not 0 <= mesh.min() <= mesh.max() < len(vertices):
        raise ValueError("a face has an invalid vertex index")
    return Triangles(sealed(np.array(vertices).reshape(-1, 3)), mesh)


def simplify(surface: Triangles, max_triangles: int) -> Triangles:
    """Simplify a mesh to at most `max_triangles` by merging nearby vertices.

    Triangles farther than `MAX_VERTEX_COORDINATE` from the origin are removed.

    Args:
        surface: Mesh of any size.
        max_triangles: Largest number of triangles.
    """
    surface = _remove_far_triangles(surface, MAX_VERTEX_COORDINATE)
    size = float(np.ptp(surface.vertices, axis=0).max()) if len(surface.vertices) else 0.0
    low, high, best = size / MAX_GRID_CELLS, size, surface
    if len(surface.corners) <= max_triangles or size == 0.0:
        return surface
    for _ in range(CELL_BISECTIONS):
        cell = (low + high) / 2
        candidate = _merge_vertices(surface, cell)
        if len(candidate.corners) <= max_triangles:
            high, best = cell, candidate
        else:
            low = cell
    return best if len(best.corners) <= max_triangles else _merge_vertices(surface, size)


def _remove_far_triangles(surface: Triangles, max_coordinate: float) -> Triangles:
    """Remove triangles with an absolute coordinate of `max_coordinate` [m] or more."""
    is_near: Flags = np.all(np.abs(surface.vertices) < max_coordinate, axis=1)
    return Triangles(surface.vertices, surface.corners[is_near[surface.corners].all(axis=1)])


def _merge_vertices(surface: Triangles, cell: float) -> Triangles:
    cells = np.floor(surface.vertices / cell + 0.5).astype(np.int64)
    _, place = np.unique(_number_rows(cells - cells.min(axis=0)), return_inverse=True)
    count = int(place.max()) + 1
    sums = np.stack([np.bincount(place, surface.vertices[:, k], count) for k in range(3)], axis=1)
    vertices = sealed(sums / np.bincount(place, minlength=count)[:, None])
    corners = place[surface.corners]
    is_proper = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    return Triangles(vertices, _keep_outermost(vertices, corners[is_proper]))


def _keep_outermost(vertices: Floats, corners: Indices) -> Indices:
    """Keep the most outward-facing of triangles with the same corners.

    Opposite walls of a hollow part may have been merged.
    """
    a, b, c = (vertices[corners[:, k]] for k in range(3))
    outward = np.einsum("ti,ti->t", np.cross(b - a, c - a), (a + b + c) / 3 - vertices.mean(axis=0))
    order = np.argsort(-outward, kind="stable")
    _, first = np.unique(_number_rows(np.sort(corners[order], axis=1)), return_index=True)
    return corners[order][np.sort(first)]


def _number_rows(rows: Indices) -> Indices:
    """Map rows (n, 3) of small non-negative integers to unique integers."""
    _, high, is_proper = (int(most) + 1 for most in rows.max(axis=0, initial=0))
    return (rows[:, 0] * high + rows[:, 1]) * is_proper + rows[:, 2]
