"""The whole figure as data: head, hands and clothes as one mesh, and which frames of the rig move each vertex.

`configs/faces/head.npz` and `body.npz` hold it; `kinesic.face.assets.bake_body` made the second. The mesh stands in the
source's A pose, in our frame, with the origin between the eyes.
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
from kinesic.face.assets.chart import vertex_chart
from kinesic.face.assets.clothes import COVERED, below_neckline, garments
from kinesic.face.assets.mesh import PARTS, Indices, Mesh, load_head, refine, seal_whole
from kinesic.face.assets.rig import FRAMES, PLACE
from kinesic.face.display import DisplayError

BODY = CONFIGS / "faces" / "body.npz"
POSITION_STEP = 5e-5  # [m] of the file's positions
CROP, FULL = 0.013, 0.7  # [m] that hair stands off, so far over the hairline in the chart's unit
FRAMES_PER_VERTEX = 8  # frames that move a vertex at most


@dataclass(frozen=True, eq=False)
class DressedPerson:
    """A dressed person."""

    mesh: Mesh
    weights: "scipy.sparse.csr_array"  # (v, frames) they add up to 1
    centres: Mapping[str, Floats]  # segment -> (3,) [m] its joint
    angles: Mapping[str, float]  # hinge -> [rad] where the skeleton stands as the mesh does

    @cached_property
    def hair(self) -> Floats:
        """(v,) [m] that hair stands off the scalp."""
        over = np.clip(vertex_chart(self.mesh)[:, 3] / FULL, 0.0, 1.0)
        return sealed(CROP * np.sqrt(over) * (self.mesh.parts == PARTS.index("skin")))

    def subdivided(self) -> "DressedPerson":
        """The same figure with every face cut into four."""
        stencil, _ = refine(self.mesh.faces, len(self.mesh.positions))
        return replace(self, mesh=self.mesh.subdivided(), weights=scipy.sparse.csr_array(stencil @ self.weights))


@cache
def load_figure(path: Path = BODY) -> DressedPerson:
    """Reads the figure from its files.

    Raises:
        DisplayError: a file is missing, or no figure.
    """
    try:
        with path.open("rb") as packed, np.load(packed) as file:
            return _figure(load_head("female"), {name: file[name] for name in file.files})
    except FileNotFoundError:
        raise DisplayError(f"{path}: no such file; it is part of kinesic: install kinesic again") from None
    except (OSError, ValueError, KeyError, IndexError, TypeError, EOFError, BadZipFile) as error:
        raise DisplayError(f"{path}: not a body that kinesic.face.assets.bake_body wrote: {error}") from None


def _figure(head: Mesh, data: Mapping[str, NDArray[Any]]) -> DressedPerson:
    """Puts the head on the body, and dresses it."""
    centres = dict(zip(map(str, data["segments"]), map(sealed, data["centres"]), strict=True))
    count = len(data["positions"])
    below = Mesh(
        positions=sealed(data["positions"] * POSITION_STEP),
        faces=seal_whole(data["hands"].astype(np.int32)),
        parts=seal_whole(np.zeros(count, dtype=np.uint8)),
        shapes=head.shapes,
        deltas=scipy.sparse.csc_array((3 * count, len(head.shapes))),
        eyes=head.eyes,
        tips=sealed(np.zeros(count)),
        plain=sealed(np.zeros((count, 4))),
    )
    skin = int((head.parts == PARTS.index("skin")).sum())
    weights = np.zeros((len(data["places"]), len(FRAMES)))
    np.put_along_axis(weights, data["places"].astype(np.intp), data["weights"] / 255.0, axis=1)
    stiff = np.zeros((len(head.positions) - skin, len(FRAMES)))
    stiff[:, PLACE["skullbase"]] = 1.0
    seen = ~(below_neckline(head.positions, centres)[head.faces] < -COVERED).all(axis=1)
    top = replace(head, faces=seal_whole(head.faces[seen]), plain=sealed(np.zeros((len(head.positions), 4))))
    pieces = [(top, np.concatenate([weights[:skin], stiff]))]
    pieces += [(piece, weights[skin:]) for piece in (below, *_clothes(below, data["suit"].astype(np.int32), centres))]
    mesh, moved = _joined([_used(*piece) for piece in pieces])
    angles = dict(zip(map(str, data["hinges"]), data["angles"].tolist(), strict=True))
    return DressedPerson(mesh, moved, centres, angles)


def _clothes(below: Mesh, suit: Indices, centres: Mapping[str, Floats]) -> Iterator[Mesh]:
    """Cuts garments out of the suit, with the faces that any of their cloth lies on."""
    normals = replace(below, faces=suit).normals(below.positions)
    for garment in garments(below.positions, centres):
        look = [*np.sqrt(garment.colour), garment.gloss]
        yield replace(
            below,
            positions=sealed(below.positions + normals * garment.offset[:, None]),
            faces=seal_whole(suit[(garment.beyond[suit] < 0.0).any(axis=1)]),
            parts=seal_whole(np.full(len(below.parts), PARTS.index("cloth"), dtype=np.uint8)),
            tips=sealed(garment.beyond),
            plain=sealed(np.tile(look, (len(below.parts), 1))),
        )


def _used(mesh: Mesh, weights: Floats) -> tuple[Mesh, Floats]:
    """Leaves out vertices without faces."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    rows = (3 * used[:, None] + np.arange(3)).ravel()
    assert mesh.plain is not None  # a piece of a figure has it
    kept = replace(
        mesh,
        positions=sealed(mesh.positions[used]),
        faces=seal_whole(faces.reshape(mesh.faces.shape).astype(np.int32)),
        parts=seal_whole(mesh.parts[used]),
        deltas=scipy.sparse.csc_array(mesh.deltas.tocsr()[rows]),
        tips=sealed(mesh.tips[used]),
        plain=sealed(mesh.plain[used]),
    )
    return kept, weights[used]


def _joined(pieces: Sequence[tuple[Mesh, Floats]]) -> tuple[Mesh, "scipy.sparse.csr_array"]:
    """Puts pieces into one mesh, and their weights into one matrix."""
    meshes = [mesh for mesh, _ in pieces]
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    whole = replace(
        meshes[0],
        positions=sealed(np.concatenate([mesh.positions for mesh in meshes])),
        faces=seal_whole(
            np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]).astype(np.int32)
        ),
        parts=seal_whole(np.concatenate([mesh.parts for mesh in meshes])),
        deltas=scipy.sparse.csc_array(scipy.sparse.vstack([mesh.deltas for mesh in meshes])),
        tips=sealed(np.concatenate([mesh.tips for mesh in meshes])),
        plain=sealed(np.concatenate([mesh.plain for mesh in meshes if mesh.plain is not None])),
    )
    return whole, scipy.sparse.csr_array(np.concatenate([weights for _, weights in pieces]))
