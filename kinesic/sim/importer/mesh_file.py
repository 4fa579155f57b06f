"""Reads the triangles of a mesh file, STL or Wavefront OBJ, and makes fewer of them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.config import ConfigError
from kinesic.files.input_file import read_inside

LARGEST_MESH = 20_000_000  # [bytes] of one file
FORMATS = (".stl", ".obj")
STL_HEAD, STL_ROW = 84, 50  # [bytes]
FARTHEST_VERTEX = 100.0  # [m] from the origin that anything of a robot is
HALVINGS = 14  # of the size of cells until triangles are few enough
FINEST = 100_000  # cells along a side, at most


@dataclass(frozen=True, eq=False)
class Triangles:
    """A surface, or a part of one."""

    vertices: Floats  # (v, 3) [m]
    corners: Indices  # (t, 3)


def read_mesh(path: Path, *, folder: Path) -> Triangles:
    """Read a mesh file.

    Args:
        path: of the file.
        folder: in which it must lie, or below.

    Raises:
        ConfigError: the file is outside, too large, of another format, or broken.
        OSError: the file cannot be read.
    """
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise ConfigError(f"{path.name}: only {' and '.join(FORMATS)} are read; convert it to one of them")
    data = read_inside(folder, path, max_size=LARGEST_MESH)
    try:
        found = _stl(data) if kind == ".stl" else _obj(data.decode("utf-8", errors="replace"))
    except (ValueError, IndexError, OverflowError) as error:
        raise ConfigError(f"{path.name}: no {kind[1:].upper()} that can be read: {error}") from None
    if not len(found.corners) or not np.isfinite(found.vertices).all():
        raise ConfigError(f"{path.name}: it has no triangles, or numbers that are not finite")
    return found


def _stl(data: bytes) -> Triangles:
    count = int.from_bytes(data[STL_HEAD - 4 : STL_HEAD], "little")
    if len(data) != STL_HEAD + count * STL_ROW:
        raise ValueError(f"{len(data)} bytes are not {count} triangles; it must be a binary STL")
    rows = np.frombuffer(data, dtype=np.uint8, offset=STL_HEAD).reshape(count, STL_ROW)
    corners = rows[:, 12:48].copy().view("<f4").reshape(-1, 3)
    vertices, placed = np.unique(corners, axis=0, return_inverse=True)
    return Triangles(sealed(vertices), placed.reshape(-1, 3))


def _obj(text: str) -> Triangles:
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
    found = np.array(corners, dtype=np.intp).reshape(-1, 3)
    if found.size and not 0 <= found.min() <= found.max() < len(vertices):
        raise ValueError("a face has a corner that is none")
    return Triangles(sealed(np.array(vertices).reshape(-1, 3)), found)


def simplify(surface: Triangles, most: int) -> Triangles:
    """Merges vertices that are near one another until there are at most so many triangles.

    Args:
        surface: with more or fewer.
        most: triangles.
    """
    surface = _kept(surface, FARTHEST_VERTEX)
    size = float(np.ptp(surface.vertices, axis=0).max()) if len(surface.vertices) else 0.0
    low, high, best = size / FINEST, size, surface
    if len(surface.corners) <= most or size == 0.0:
        return surface
    for _ in range(HALVINGS):
        cell = (low + high) / 2
        tried = _merged(surface, cell)
        if len(tried.corners) <= most:
            high, best = cell, tried
        else:
            low = cell
    return best if len(best.corners) <= most else _merged(surface, size)


def _kept(surface: Triangles, far: float) -> Triangles:
    """Without triangles that are farther away than anything of a robot."""
    near: Flags = np.all(np.abs(surface.vertices) < far, axis=1)
    return Triangles(surface.vertices, surface.corners[near[surface.corners].all(axis=1)])


def _merged(surface: Triangles, cell: float) -> Triangles:
    cells = np.floor(surface.vertices / cell + 0.5).astype(np.int64)
    _, place = np.unique(_numbered(cells - cells.min(axis=0)), return_inverse=True)
    count = int(place.max()) + 1
    sums = np.stack([np.bincount(place, surface.vertices[:, k], count) for k in range(3)], axis=1)
    vertices = sealed(sums / np.bincount(place, minlength=count)[:, None])
    corners = place[surface.corners]
    wide = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    return Triangles(vertices, _outermost(vertices, corners[wide]))


def _outermost(vertices: Floats, corners: Indices) -> Indices:
    """One of the triangles that have the same corners: the walls of a hollow part may have become one."""
    a, b, c = (vertices[corners[:, k]] for k in range(3))
    outward = np.einsum("ti,ti->t", np.cross(b - a, c - a), (a + b + c) / 3 - vertices.mean(axis=0))
    order = np.argsort(-outward, kind="stable")
    _, first = np.unique(_numbered(np.sort(corners[order], axis=1)), return_index=True)
    return corners[order][np.sort(first)]


def _numbered(rows: Indices) -> Indices:
    """One number for each row (n, 3) of small whole numbers, equal for equal rows."""
    _, high, wide = (int(most) + 1 for most in rows.max(axis=0, initial=0))
    return (rows[:, 0] * high + rows[:, 1]) * wide + rows[:, 2]
