"""Whole figure: head, hands and clothes as one mesh with skinning weights.

The data are in `configs/faces/head.npz` and `body.npz`, which `kinesic.face.assets.bake_body` wrote. The mesh stands in
the source's A pose, in kinesic's frame, with the origin between the eyes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import CONFIGS
from kinesic.face.assets.chart import compute_vertex_chart
from kinesic.face.assets.clothes import COVERED_DEPTH, cut_garments, measure_neckline_distance
from kinesic.face.assets.mesh import MESH_PARTS, Indices, Mesh, build_subdivision, load_head, seal_integers
from kinesic.face.assets.rig import FRAME_INDICES, SKINNING_FRAMES
from kinesic.face.display import DisplayError

BODY_FILE = CONFIGS / "faces" / "body.npz"
POSITION_STEP = 5e-5  # [m] resolution of positions in the file
HAIR_HEIGHT = 0.013  # [m] full distance of hair from the scalp
HAIR_RAMP = 0.7  # [eye distances] height over the hairline at which hair reaches HAIR_HEIGHT
MAX_FRAMES_PER_VERTEX = 8  # skinning frames per vertex


@dataclass(frozen=True, eq=False)
class DressedPerson:
    """Mesh of a dressed person, with clothes and skinning weights."""

    mesh: Mesh
    weights: "scipy.sparse.csr_array"  # (v, frames) sum to 1 per vertex
    centres: Mapping[str, Floats]  # segment -> (3,) [m] position of its joint
    angles: Mapping[str, float]  # hinge -> [rad] pose of the skeleton in which the mesh was made

    @cached_property
    def hair(self) -> Floats:
        """(v,) distance of hair from the scalp [m]."""
        over = np.clip(compute_vertex_chart(self.mesh)[:, 3] / HAIR_RAMP, 0.0, 1.0)
        return sealed(HAIR_HEIGHT * np.sqrt(over) * (self.mesh.parts == MESH_PARTS.index("skin")))

    def subdivided(self) -> "DressedPerson":
        """Return the figure with each face divided into four."""
        stencil, _ = build_subdivision(self.mesh.faces, len(self.mesh.positions))
        return replace(self, mesh=self.mesh.subdivided(), weights=scipy.sparse.csr_array(stencil @ self.weights))


@cache
def load_figure(path: Path = BODY_FILE) -> DressedPerson:
    """Read the whole figure from the head and body files.

    Raises:
        DisplayError: a file is missing or invalid.
    """
    try:
        with path.open("rb") as packed, np.load(packed) as file:
            return _assemble_figure(load_head("female"), {name: file[name] for name in file.files})
    except FileNotFoundError:
        raise DisplayError(f"{path}: no such file; it is part of kinesic: install kinesic again") from None
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, BadZipFile) as error:
        raise DisplayError(f"{path}: not a body that kinesic.face.assets.bake_body wrote: {error}") from None


def _assemble_figure(head: Mesh, data: Mapping[str, NDArray[Any]]) -> DressedPerson:
    """Attach the head to the body and add the clothes."""
    centres = dict(zip(map(str, data["segments"]), map(sealed, data["centres"]), strict=True))
    count = len(data["positions"])
    below = Mesh(
        positions=sealed(data["positions"] * POSITION_STEP),
        faces=seal_integers(data["hands"].astype(np.int32)),
        parts=seal_integers(np.zeros(count, dtype=np.uint8)),
        shapes=head.shapes,
        deltas=scipy.sparse.csc_array((3 * count, len(head.shapes))),
        eyes=head.eyes,
        tips=sealed(np.zeros(count)),
        plain=sealed(np.zeros((count, 4))),
    )
    skin = int((head.parts == MESH_PARTS.index("skin")).sum())
    weights = np.zeros((len(data["places"]), len(SKINNING_FRAMES)))
    np.put_along_axis(weights, data["places"].astype(np.intp), data["weights"] / 255.0, axis=1)
    stiff = np.zeros((len(head.positions) - skin, len(SKINNING_FRAMES)))
    stiff[:, FRAME_INDICES["skullbase"]] = 1.0
    seen = ~(measure_neckline_distance(head.positions, centres)[head.faces] < -COVERED_DEPTH).all(axis=1)
    top = replace(head, faces=seal_integers(head.faces[seen]), plain=sealed(np.zeros((len(head.positions), 4))))
    pieces = [(top, np.concatenate([weights[:skin], stiff]))]
    pieces += [
        (piece, weights[skin:]) for piece in (below, *_cut_clothes(below, data["suit"].astype(np.int32), centres))
    ]
    mesh, moved = _join_pieces([_drop_unused(*piece) for piece in pieces])
    angles = dict(zip(map(str, data["hinges"]), data["angles"].tolist(), strict=True))
    return DressedPerson(mesh, moved, centres, angles)


def _cut_clothes(below: Mesh, suit: Indices, centres: Mapping[str, Floats]) -> Iterator[Mesh]:
    """Yield the garments, each with all faces that touch its cloth."""
    normals = replace(below, faces=suit).normals(below.positions)
    for garment in cut_garments(below.positions, centres):
        look = [*np.sqrt(garment.colour), garment.gloss]
        yield replace(
            below,
            positions=sealed(below.positions + normals * garment.offset[:, None]),
            faces=seal_integers(suit[(garment.beyond[suit] < 0.0).any(axis=1)]),
            parts=seal_integers(np.full(len(below.parts), MESH_PARTS.index("cloth"), dtype=np.uint8)),
            tips=sealed(garment.beyond),
            plain=sealed(np.tile(look, (len(below.parts), 1))),
        )


def _drop_unused(mesh: Mesh, weights: Floats) -> tuple[Mesh, Floats]:
    """Remove mesh vertices without faces."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    rows = (3 * used[:, None] + np.arange(3)).ravel()
    assert mesh.plain is not None  # set for all pieces of a figure
    reduced = replace(
        mesh,
        positions=sealed(mesh.positions[used]),
        faces=seal_integers(faces.reshape(mesh.faces.shape).astype(np.int32)),
        parts=seal_integers(mesh.parts[used]),
        deltas=scipy.sparse.csc_array(mesh.deltas.tocsr()[rows]),
        tips=sealed(mesh.tips[used]),
        plain=sealed(mesh.plain[used]),
    )
    return reduced, weights[used]


def _join_pieces(pieces: Sequence[tuple[Mesh, Floats]]) -> tuple[Mesh, "scipy.sparse.csr_array"]:
    """Join meshes into one mesh, and their weights into one matrix."""
    meshes = [mesh for mesh, _ in pieces]
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    whole = replace(
        meshes[0],
        positions=sealed(np.concatenate([mesh.positions for mesh in meshes])),
        faces=seal_integers(
            np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]).astype(np.int32)
        ),
        parts=seal_integers(np.concatenate([mesh.parts for mesh in meshes])),
        deltas=scipy.sparse.csc_array(scipy.sparse.vstack([mesh.deltas for mesh in meshes])),
        tips=sealed(np.concatenate([mesh.tips for mesh in meshes])),
        plain=sealed(np.concatenate([mesh.plain for mesh in meshes if mesh.plain is not None])),
    )
    return whole, scipy.sparse.csr_array(np.concatenate([weights for _, weights in pieces]))
