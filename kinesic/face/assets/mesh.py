"""The head as data: positions at rest, faces, parts and expression shapes, of two people with the same faces.

`configs/faces/head.npz` holds them; `kinesic.face.assets.bake` made it. Both meshes are in our frame, x forward, y
left, z up, with the origin between the centres of the eyes.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, TypeVar
from zipfile import BadZipFile

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.choices import Variant
from kinesic.body.config import CONFIGS, suggestion
from kinesic.face.display import DisplayError

MeshPart = Literal["skin", "eyes", "teeth", "tongue", "lashes", "cloth"]
Indices = NDArray[np.int32]
Whole = TypeVar("Whole", np.int32, np.uint8)

VARIANTS: tuple[Variant, ...] = ("female", "male")
PARTS: tuple[MeshPart, ...] = ("skin", "eyes", "teeth", "tongue", "lashes", "cloth")
HEAD_FILE = CONFIGS / "faces" / "head.npz"
POSITION_STEP = 1e-5  # [m] of the file's rest positions
DELTA_STEP = 1e-4  # [m] of its shapes
BROW = "browInnerUp"  # the only shape without sides whose action unit has them
BRIDGE = 0.02  # [m] across the nose, over which its halves change places


@dataclass(frozen=True, eq=False)
class Mesh:
    """One head, or a whole figure; parts share no vertices."""

    positions: Floats  # (v, 3) [m] at rest
    faces: Indices  # (f, 4) corners, anticlockwise from outside
    parts: NDArray[np.uint8]  # (v,) place of each vertex's part in PARTS
    shapes: tuple[str, ...]  # names of the columns of deltas
    deltas: "scipy.sparse.csc_array"  # (3 v, s) [m] what each shape adds at full weight, a row for each coordinate
    eyes: Floats  # (2, 3) [m] centres of the eyeballs, left and right
    tips: Floats  # (v,) 0 .. 1 how near to the tip of a lash; of cloth, [m] how far beyond its border; 0 elsewhere
    plain: Floats | None = None  # (v, 4) of cloth: square root of its linear colour, and how much it shines

    @cached_property
    def triangles(self) -> Indices:
        """(2 f, 3) corners, anticlockwise from outside: each face cut along its first diagonal."""
        return seal_whole(self.faces[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))

    def vertices(self, part: MeshPart) -> NDArray[np.intp]:
        """Returns the indices of a part's vertices."""
        return np.flatnonzero(self.parts == PARTS.index(part))

    def normals(self, positions: Floats) -> Floats:
        """(v, 3) unit normals outward, weighted by area, of the mesh with its vertices at (v, 3) positions."""
        a, b, c, d = positions.take(self.faces.T, axis=0)
        sums = self._around @ np.cross(c - a, d - b)
        squares = np.einsum("vi,vi->v", sums, sums)
        return np.asarray(sums / np.maximum(np.sqrt(squares), 1e-12)[:, None])

    def subdivided(self) -> "Mesh":
        """The same head with every face cut into four (Catmull-Clark); its first vertices are this mesh's.

        Subdivision is linear: shapes are subdivided with the positions, so that deforming works on either mesh.
        Eyeballs would shrink, and keep their radii; teeth would be worn at their edges, and stay as flat as they are.
        """
        stencil, faces = refine(self.faces, len(self.positions), flat=self.parts == PARTS.index("teeth"))
        positions = stencil @ self.positions
        parts = np.rint(stencil @ self.parts).astype(np.uint8)
        ball = np.flatnonzero(parts == PARTS.index("eyes"))
        centres = self._centres(positions[ball])
        spokes = positions[ball] - centres
        radii = np.linalg.norm(self.positions - self._centres(self.positions), axis=1)
        lengths = (stencil @ radii)[ball] / np.linalg.norm(spokes, axis=1)
        positions[ball] = centres + spokes * lengths[:, None]
        return replace(
            self,
            positions=sealed(positions),
            faces=seal_whole(faces),
            parts=seal_whole(parts),
            deltas=scipy.sparse.csc_array(scipy.sparse.kron(stencil, scipy.sparse.eye_array(3)) @ self.deltas),
            tips=sealed(stencil @ self.tips),
            plain=None if self.plain is None else sealed(stencil @ self.plain),
        )

    def _centres(self, positions: Floats) -> Floats:
        """(k, 3) [m] the centre of the eyeball on the side of each of (k, 3) positions."""
        return self.eyes[np.where(positions[:, 1] > 0.0, 0, 1)]

    @cached_property
    def _around(self) -> "scipy.sparse.csr_array":
        """(v, f) which faces meet at each vertex."""
        corners, number = self.faces.ravel(), np.repeat(np.arange(len(self.faces)), 4)
        shape = (len(self.positions), len(self.faces))
        return scipy.sparse.csr_array((np.ones(len(corners)), (corners, number)), shape=shape)


def load_head(variant: Variant = "female", *, path: Path = HEAD_FILE) -> Mesh:
    """Reads a head from its file.

    Args:
        variant: which of the two.
        path: of the file.

    Raises:
        DisplayError: there is no such variant, or the file is missing or no head.
    """
    if variant not in VARIANTS:
        raise DisplayError(f"no face {variant}{suggestion(variant, VARIANTS)}")
    try:
        with path.open("rb") as packed, np.load(packed) as file:
            data = {name: file[name] for name in file.files}
        return _mesh(data, VARIANTS.index(variant))
    except FileNotFoundError:
        raise DisplayError(f"{path}: no such file; it is part of kinesic: install kinesic again") from None
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, BadZipFile) as error:
        raise DisplayError(f"{path}: not a head that kinesic.face.assets.bake wrote: {error}") from None


def _mesh(data: dict[str, NDArray[np.generic]], variant: int) -> Mesh:
    positions = data["positions"][variant].astype(np.float64) * POSITION_STEP
    starts, places = data["starts"], data["places"].astype(np.int32)
    deltas = data["deltas"].astype(np.float64) * DELTA_STEP
    names = tuple(str(name) for name in data["names"])
    rows = (3 * places[:, None] + np.arange(3)).ravel()
    shape = (positions.size, len(names))
    moves = scipy.sparse.csc_array((deltas.ravel(), rows, 3 * starts), shape=shape)
    names, moves = _halved(names, moves, positions[:, 1])
    moves.eliminate_zeros()
    return Mesh(
        positions=sealed(positions),
        faces=seal_whole(data["faces"].astype(np.int32)),
        parts=seal_whole(data["parts"].astype(np.uint8)),
        shapes=names,
        deltas=moves,
        eyes=sealed(data["eyes"][variant]),
        tips=sealed(data["tips"].astype(np.float64) / 255.0),
    )


def _halved(
    names: tuple[str, ...], moves: "scipy.sparse.csc_array", left: Floats
) -> tuple[tuple[str, ...], "scipy.sparse.csc_array"]:
    """Shapes with the inner brow's cut in two, each half fading out over the nose, as (v,) [m] to the left has it."""
    whole = names.index(BROW)
    share = np.repeat(np.clip(0.5 + left / BRIDGE, 0.0, 1.0), 3)
    halves = [moves[:, [whole]].multiply(part[:, None]) for part in (share, 1.0 - share)]
    others = [place for place in range(len(names)) if place != whole]
    columns = scipy.sparse.csc_array(scipy.sparse.hstack([moves[:, others], *halves]))
    return (*(names[place] for place in others), f"{BROW}Left", f"{BROW}Right"), columns


def seal_whole(values: NDArray[Whole]) -> NDArray[Whole]:
    """Makes an array of whole numbers read-only, and returns it."""
    values.setflags(write=False)
    return values


def refine(
    faces: Indices, vertices: int, *, flat: NDArray[np.bool_] | None = None
) -> tuple["scipy.sparse.csr_array", Indices]:
    """Refines a mesh: a vertex for each vertex, edge and face, in this order, and four faces for each.

    Args:
        faces: (f, 4) corners of quadrangles that run round all in the same sense.
        vertices: their number, v.
        flat: (v,) which of them stay where they are, as do the faces between them.

    Returns:
        (v + e + f, v) stencil, whose product with positions gives the finer positions, and (4 f, 4) faces.
    """
    ends, edge_of = _edges(faces)
    count, total = len(faces), len(ends)
    middle = _incidence(np.repeat(np.arange(count), 4), faces.ravel(), (count, vertices)) / 4
    halfway = _incidence(np.repeat(np.arange(total), 2), ends.ravel(), (total, vertices)) / 2
    beside = _incidence(edge_of.ravel(), np.repeat(np.arange(count), 4), (total, count))
    flat = np.zeros(vertices, dtype=bool) if flat is None else flat
    border = (_sums(beside) < 2) | flat[ends[:, 0]]
    between = _scaled(np.where(border, 1.0, 0.5), halfway) + _scaled(np.where(border, 0.0, 0.25), beside) @ middle
    kept = _corners(faces, ends, border, middle, halfway, flat)
    stencil = scipy.sparse.csr_array(scipy.sparse.vstack([kept, between, middle]))
    centres = vertices + total + np.arange(count)
    after, before = vertices + edge_of, vertices + np.roll(edge_of, 1, axis=1)
    parts = [np.stack([faces[:, k], after[:, k], centres, before[:, k]], axis=1) for k in range(4)]
    return stencil, np.stack(parts, axis=1).reshape(-1, 4).astype(np.int32)


def _edges(faces: Indices) -> tuple[Indices, NDArray[np.intp]]:
    """(e, 2) ends of the edges, and (f, 4) the edge from each corner to the next."""
    both = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ends, edge_of = np.unique(np.sort(both, axis=1), axis=0, return_inverse=True)
    return ends, edge_of.reshape(faces.shape)


def _corners(
    faces: Indices,
    ends: Indices,
    border: NDArray[np.bool_],
    middle: "scipy.sparse.csr_array",
    halfway: "scipy.sparse.csr_array",
    flat: NDArray[np.bool_],
) -> "scipy.sparse.csr_array":
    """(v, v) where the old vertices go: (F + 2 R + (n - 3) P) / n inside, (R + P) / 2 on a border; flat ones stay."""
    vertices, count, total = len(flat), len(faces), len(ends)
    faces_at = _incidence(faces.ravel(), np.repeat(np.arange(count), 4), (vertices, count))
    edges_at = _incidence(ends.ravel(), np.repeat(np.arange(total), 2), (vertices, total))
    open_at = edges_at @ scipy.sparse.diags_array(border.astype(float))
    outside = _sums(open_at) > 0
    valence = np.maximum(_sums(edges_at), 1.0)
    meeting = np.maximum(_sums(faces_at), 1.0)
    inner = np.where(outside, 0.0, 1.0 / valence)
    outer = np.where(outside & ~flat, 0.5 / np.maximum(_sums(open_at), 1.0), 0.0)
    stays = np.where(flat, 1.0, np.where(outside, 0.5, 1.0 - 3.0 / valence))
    return (
        _scaled(inner / meeting, faces_at @ middle)
        + _scaled(2 * inner / valence, edges_at @ halfway)
        + _scaled(outer, open_at @ halfway)
        + scipy.sparse.diags_array(stays)
    ).tocsr()


def _incidence(
    rows: NDArray[np.generic], columns: NDArray[np.generic], shape: tuple[int, int]
) -> "scipy.sparse.csr_array":
    return scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=shape)


def _sums(matrix: "scipy.sparse.csr_array") -> NDArray[np.float64]:
    return np.asarray(matrix.sum(axis=1)).ravel()


def _scaled(factors: NDArray[np.float64], matrix: "scipy.sparse.csr_array") -> "scipy.sparse.csr_array":
    return scipy.sparse.diags_array(factors) @ matrix
