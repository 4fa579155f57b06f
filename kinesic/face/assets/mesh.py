"""Meshes of a female and a male head with equal topology.

`configs/faces/head.npz` holds them; `kinesic.face.assets.bake` wrote it. Both meshes are in kinesic's frame, x forward,
y left, z up, with the origin between the centres of the eyes.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, TypeVar
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.choices import Variant
from kinesic.body.config import CONFIGS, suggestion
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.display import DisplayError

MeshPart = Literal["skin", "eyes", "teeth", "tongue", "lashes", "cloth"]
Indices = NDArray[np.int32]
IntegerType = TypeVar("IntegerType", np.int32, np.uint8)

FACE_VARIANTS: tuple[Variant, ...] = ("female", "male")
MESH_PARTS: tuple[MeshPart, ...] = ("skin", "eyes", "teeth", "tongue", "lashes", "cloth")
HEAD_FILE = CONFIGS / "faces" / "head.npz"
POSITION_STEP = 1e-5  # [m] resolution of rest positions in the file
DELTA_STEP = 1e-4  # [m] resolution of expression shape displacements in the file
INNER_BROW_SHAPE = "browInnerUp"  # expression shape of both brows, split because its action unit moves one side alone
NOSE_BRIDGE_WIDTH = 0.02  # [m] width over which the two halves of the inner brow blend


@dataclass(frozen=True, eq=False)
class Mesh:
    """Mesh of a head or a figure.

    Parts have no vertices in common.
    """

    positions: Floats  # (v, 3) [m] positions at rest
    faces: Indices  # (f, 4) corners, anticlockwise from outside
    parts: NDArray[np.uint8]  # (v,) index of the part in MESH_PARTS
    shapes: tuple[str, ...]  # shape names, one per column of deltas
    deltas: "scipy.sparse.csc_array"  # (3 v, s) [m] displacement at full weight, a row per coordinate
    eyes: Floats  # (2, 3) [m] centres of the eyeballs, left and right
    tips: Floats  # (v,) lash: 0 at the root, 1 at the tip; cloth: [m] beyond its border; otherwise 0
    plain: Floats | None = None  # (v, 4) cloth: square root of linear RGB, gloss

    @cached_property
    def triangles(self) -> Indices:
        """Vertex indices (2 f, 3) of the triangles, anticlockwise from outside.

        Each face is split along its first diagonal.
        """
        return seal_integers(self.faces[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))

    def vertices(self, part: MeshPart) -> NDArray[np.intp]:
        """Return the indices of a part's vertices."""
        return np.flatnonzero(self.parts == MESH_PARTS.index(part))

    def normals(self, positions: Floats) -> Floats:
        """Return (v, 3) outward unit normals, weighted by area.

        Args:
            positions: (v, 3) vertex positions.
        """
        a, b, c, d = positions.take(self.faces.T, axis=0)
        sums = self._around @ np.cross(c - a, d - b)
        squares = np.einsum("vi,vi->v", sums, sums)
        return np.asarray(sums / np.maximum(np.sqrt(squares), 1e-12)[:, None])

    def subdivided(self) -> "Mesh":
        """Return the mesh with each face divided into four (Catmull-Clark).

        The first vertices are those of this mesh. Subdivision is linear: shapes are subdivided with the positions, so
        that deformation works on either mesh. Eyeballs, which would shrink, keep their radii; teeth, whose edges would
        be rounded, stay flat.
        """
        stencil, faces = build_subdivision(
            self.faces, len(self.positions), flat=self.parts == MESH_PARTS.index("teeth")
        )
        positions = stencil @ self.positions
        parts = np.rint(stencil @ self.parts).astype(np.uint8)
        ball = np.flatnonzero(parts == MESH_PARTS.index("eyes"))
        centres = self._find_eye_centres(positions[ball])
        spokes = positions[ball] - centres
        radii = np.linalg.norm(self.positions - self._find_eye_centres(self.positions), axis=1)
        lengths = (stencil @ radii)[ball] / np.linalg.norm(spokes, axis=1)
        positions[ball] = centres + spokes * lengths[:, None]
        return replace(
            self,
            positions=sealed(positions),
            faces=seal_integers(faces),
            parts=seal_integers(parts),
            deltas=scipy.sparse.csc_array(scipy.sparse.kron(stencil, scipy.sparse.eye_array(3)) @ self.deltas),
            tips=sealed(stencil @ self.tips),
            plain=None if self.plain is None else sealed(stencil @ self.plain),
        )

    def _find_eye_centres(self, positions: Floats) -> Floats:
        """Return the (k, 3) eyeball centre [m] on each point's side."""
        return self.eyes[np.where(positions[:, 1] > 0.0, 0, 1)]

    @cached_property
    def _around(self) -> "scipy.sparse.csr_array":
        """Incidence matrix (v, f) of faces at vertices."""
        corners, number = self.faces.ravel(), np.repeat(np.arange(len(self.faces)), 4)
        shape = (len(self.positions), len(self.faces))
        return scipy.sparse.csr_array((np.ones(len(corners)), (corners, number)), shape=shape)


def load_head(variant: Variant = "female", *, path: Path = HEAD_FILE) -> Mesh:
    """Read a head from its file.

    Args:
        variant: variant of the head.
        path: file to read.

    Raises:
        DisplayError: no such variant, or the file is missing or invalid.
    """
    if variant not in FACE_VARIANTS:
        raise DisplayError(f"no face {variant}{suggestion(variant, FACE_VARIANTS)}")
    try:
        with path.open("rb") as packed, np.load(packed) as file:
            data = {name: file[name] for name in file.files}
        return _build_mesh(data, FACE_VARIANTS.index(variant))
    except FileNotFoundError:
        raise DisplayError(f"{path}: no such file; it is part of kinesic: install kinesic again") from None
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, BadZipFile) as error:
        raise DisplayError(f"{path}: not a head that kinesic.face.assets.bake wrote: {error}") from None


def _build_mesh(data: dict[str, NDArray[np.generic]], variant: int) -> Mesh:
    positions = data["positions"][variant].astype(np.float64) * POSITION_STEP
    starts, places = data["starts"], data["places"].astype(np.int32)
    deltas = data["deltas"].astype(np.float64) * DELTA_STEP
    names = tuple(str(name) for name in data["names"])
    rows = (3 * places[:, None] + np.arange(3)).ravel()
    shape = (positions.size, len(names))
    moves = scipy.sparse.csc_array((deltas.ravel(), rows, 3 * starts), shape=shape)
    names, moves = _split_brow_shape(names, moves, positions[:, 1])
    moves.eliminate_zeros()
    return Mesh(
        positions=sealed(positions),
        faces=seal_integers(data["faces"].astype(np.int32)),
        parts=seal_integers(data["parts"].astype(np.uint8)),
        shapes=names,
        deltas=moves,
        eyes=sealed(data["eyes"][variant]),
        tips=sealed(data["tips"].astype(np.float64) / 255.0),
    )


def _split_brow_shape(
    names: tuple[str, ...], moves: "scipy.sparse.csc_array", left: Floats
) -> tuple[tuple[str, ...], "scipy.sparse.csc_array"]:
    """Split the inner brow shape into halves that fade over the nose."""
    whole = names.index(INNER_BROW_SHAPE)
    left_weight = np.repeat(np.clip(0.5 + left / NOSE_BRIDGE_WIDTH, 0.0, 1.0), 3)
    halves = [moves[:, [whole]].multiply(part[:, None]) for part in (left_weight, 1.0 - left_weight)]
    other_columns = [place for place in range(len(names)) if place != whole]
    columns = scipy.sparse.csc_array(scipy.sparse.hstack([moves[:, other_columns], *halves]))
    return (*(names[place] for place in other_columns), f"{INNER_BROW_SHAPE}Left", f"{INNER_BROW_SHAPE}Right"), columns


def seal_integers(values: NDArray[IntegerType]) -> NDArray[IntegerType]:
    """Make an integer array read-only and return it."""
    values.setflags(write=False)
    return values


def build_subdivision(
    faces: Indices, vertices: int, *, flat: NDArray[np.bool_] | None = None
) -> tuple["scipy.sparse.csr_array", Indices]:
    """Return the Catmull-Clark stencil and the subdivided faces of a mesh.

    There is a vertex for each vertex, edge and face, in this order, and four faces for each face.

    Args:
        faces: (f, 4) corners of consistently oriented quadrangles.
        vertices: number of vertices, v.
        flat: (v,) vertices that stay in place, as do the faces between them.

    Returns:
        (v + e + f, v) stencil, whose product with positions gives the finer positions, and (4 f, 4) faces.
    """
    ends, edge_of = _find_edges(faces)
    count, total = len(faces), len(ends)
    middle = _build_incidence(np.repeat(np.arange(count), 4), faces.ravel(), (count, vertices)) / 4
    halfway = _build_incidence(np.repeat(np.arange(total), 2), ends.ravel(), (total, vertices)) / 2
    edge_faces = _build_incidence(edge_of.ravel(), np.repeat(np.arange(count), 4), (total, count))
    flat = np.zeros(vertices, dtype=bool) if flat is None else flat
    border = (_sum_rows(edge_faces) < 2) | flat[ends[:, 0]]
    between = (
        _scale_rows(np.where(border, 1.0, 0.5), halfway) + _scale_rows(np.where(border, 0.0, 0.25), edge_faces) @ middle
    )
    corners = _build_corner_stencil(faces, ends, border, middle, halfway, flat)
    stencil = scipy.sparse.csr_array(scipy.sparse.vstack([corners, between, middle]))
    centres = vertices + total + np.arange(count)
    after, previous = vertices + edge_of, vertices + np.roll(edge_of, 1, axis=1)
    parts = [np.stack([faces[:, k], after[:, k], centres, previous[:, k]], axis=1) for k in range(4)]
    return stencil, np.stack(parts, axis=1).reshape(-1, 4).astype(np.int32)


def _find_edges(faces: Indices) -> tuple[Indices, NDArray[np.intp]]:
    """Return vertices (e, 2) of edges and edges (f, 4) of faces."""
    both = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ends, edge_of = np.unique(np.sort(both, axis=1), axis=0, return_inverse=True)
    return ends, edge_of.reshape(faces.shape)


def _build_corner_stencil(
    faces: Indices,
    ends: Indices,
    border: NDArray[np.bool_],
    middle: "scipy.sparse.csr_array",
    halfway: "scipy.sparse.csr_array",
    flat: NDArray[np.bool_],
) -> "scipy.sparse.csr_array":
    """Return the Catmull-Clark weights (v, v) of the original vertices.

    Inner vertices: (F + 2 R + (n - 3) P) / n; border vertices: (R + P) / 2; flat vertices stay. F is
    the mean of the adjacent face centres, R that of the midpoints of adjacent edges (on a border: border edges), P the
    vertex and n its number of edges.
    """
    vertices, count, total = len(flat), len(faces), len(ends)
    faces_at = _build_incidence(faces.ravel(), np.repeat(np.arange(count), 4), (vertices, count))
    edges_at = _build_incidence(ends.ravel(), np.repeat(np.arange(total), 2), (vertices, total))
    open_at = edges_at @ scipy.sparse.diags_array(border.astype(float))
    outside = _sum_rows(open_at) > 0
    valence = np.maximum(_sum_rows(edges_at), 1.0)
    meeting = np.maximum(_sum_rows(faces_at), 1.0)
    inner = np.where(outside, 0.0, 1.0 / valence)
    outer = np.where(outside & ~flat, 0.5 / np.maximum(_sum_rows(open_at), 1.0), 0.0)
    stays = np.where(flat, 1.0, np.where(outside, 0.5, 1.0 - 3.0 / valence))
    return (
        _scale_rows(inner / meeting, faces_at @ middle)
        + _scale_rows(2 * inner / valence, edges_at @ halfway)
        + _scale_rows(outer, open_at @ halfway)
        + scipy.sparse.diags_array(stays)
    ).tocsr()


def _build_incidence(
    rows: NDArray[np.generic], columns: NDArray[np.generic], shape: tuple[int, int]
) -> "scipy.sparse.csr_array":
    return scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=shape)


def _sum_rows(matrix: "scipy.sparse.csr_array") -> NDArray[np.float64]:
    return np.asarray(matrix.sum(axis=1)).ravel()


def _scale_rows(factors: NDArray[np.float64], matrix: "scipy.sparse.csr_array") -> "scipy.sparse.csr_array":
    return scipy.sparse.diags_array(factors) @ matrix
