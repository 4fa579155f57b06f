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
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import CONFIGS
from kinesic.face.assets.clothes import COVERED_DEPTH, cut_garments, measure_neckline_distance
from kinesic.face.assets.hair import Locks, grow_locks, measure_painted_hair
from kinesic.face.assets.hair_styles import HAIR_STYLES
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.mesh import MESH_PARTS, Indices, Mesh, build_subdivision, load_head, seal_integers
from kinesic.face.assets.rig import FRAME_INDICES, SKINNING_FRAMES
from kinesic.face.display import DisplayError

BODY_FILE = CONFIGS / "faces" / "body.npz"
POSITION_STEP = 5e-5  # [m] resolution of positions in the file
FIGURE_HAIR = replace(
    HAIR_STYLES["female"], roots=460, hairline_roots=30, steps=6, width=(0.20, 0.20)
)  # hair with fewer locks than in a portrait
SHOULDER_PASSES = 16  # number of smoothing iterations over the clothes' skinning weights around the shoulders
SHOULDER_REACH = 0.15  # [m] distance from a shoulder within which weights are smoothed
SHOULDER_RAMP = 0.08  # [m] width of the transition from smoothed to unsmoothed weights
TUCK_DEPTH = 0.009  # [m] distance by which skin under the clothes is moved inward
TUCK_RAMP = 0.014  # [m] distance below the neckline over which `TUCK_DEPTH` is reached
COLLAR_RAMP = 0.045  # [m] distance below the neckline within which the clothes are pulled to the neck
COLLAR_GAP = 0.0015  # [m] distance of the suit from the neck at the neckline; the shirt lies outside the suit
COLLAR_NEIGHBOURS = 4  # number of nearest skin points that are averaged for the neck's surface
MAX_FRAMES_PER_VERTEX = 8  # largest number of skinning frames that move a vertex


@dataclass(frozen=True, eq=False)
class DressedPerson:
    """Mesh of a dressed person, with clothes and skinning weights."""

    mesh: Mesh
    weights: "scipy.sparse.csr_array"  # (v, frames) skinning weights; each row sums to 1
    centres: Mapping[str, Floats]  # segment -> (3,) [m] position of its joint
    angles: Mapping[str, float]  # hinge -> [rad] pose of the skeleton in which the mesh was made

    @cached_property
    def hair(self) -> Floats:
        """Distance (v,) [m] of the painted hair from the scalp."""
        return measure_painted_hair(self.mesh)

    @property
    def locks(self) -> Locks:
        """Locks of hair in the head's frame of the bind pose."""
        return _grow_locks()

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


@cache
def _grow_locks() -> Locks:
    return grow_locks(load_head("female"), FIGURE_HAIR)


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
    weights[skin:] = _smooth_shoulders(weights[skin:], data["suit"].astype(np.int32), below.positions, centres)
    stiff = np.zeros((len(head.positions) - skin, len(SKINNING_FRAMES)))
    stiff[:, FRAME_INDICES["skullbase"]] = 1.0
    seen = ~(measure_neckline_distance(head.positions, centres)[head.faces] < -COVERED_DEPTH).all(axis=1)
    top = replace(head, faces=seal_integers(head.faces[seen]), plain=sealed(np.zeros((len(head.positions), 4))))
    pieces = [(_tuck_skin(top, centres), np.concatenate([weights[:skin], stiff]))]
    pieces += [
        (piece, weights[skin:]) for piece in (below, *_cut_clothes(below, data["suit"].astype(np.int32), centres, top))
    ]
    mesh, moved = _join_pieces([_drop_unused(*piece) for piece in pieces])
    angles = dict(zip(map(str, data["hinges"]), data["angles"].tolist(), strict=True))
    return DressedPerson(mesh, moved, centres, angles)


def _cut_clothes(below: Mesh, suit: Indices, centres: Mapping[str, Floats], top: Mesh) -> Iterator[Mesh]:
    """Yield each garment's mesh, without faces wholly outside its border."""
    below = replace(below, positions=_fit_collar(below.positions, np.unique(suit), centres, top))
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


def _smooth_shoulders(weights: Floats, suit: Indices, points: Floats, centres: Mapping[str, Floats]) -> Floats:
    """Smooth the skinning weights of the clothes around armpits and shoulders."""
    ends = np.concatenate([np.stack([suit[:, k], suit[:, (k + 1) % 4]], axis=1) for k in range(4)])
    both = np.concatenate([ends, ends[:, ::-1]])
    joined = scipy.sparse.csr_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(len(points), len(points)))
    valence = np.asarray(joined.sum(axis=1)).ravel()
    away = np.min([np.linalg.norm(points - centres[f"{side}_shoulder"], axis=1) for side in "lr"], axis=0)
    below_collar = np.clip(-measure_neckline_distance(points, centres) / COLLAR_RAMP, 0.0, 1.0)
    amount = 0.5 * np.clip((SHOULDER_REACH - away) / SHOULDER_RAMP, 0.0, 1.0) * below_collar * (valence > 0)
    smooth = weights.copy()
    for _ in range(SHOULDER_PASSES):
        smooth += amount[:, None] * ((joined @ smooth) / np.maximum(valence, 1.0)[:, None] - smooth)
    weakest = np.argsort(-smooth, axis=1)[:, MAX_FRAMES_PER_VERTEX:]
    np.put_along_axis(smooth, weakest, 0.0, axis=1)
    return _round_weights(smooth / np.maximum(smooth.sum(axis=1, keepdims=True), 1e-9))


def _round_weights(weights: Floats) -> Floats:
    """Round skinning weights to multiples of 1/255, keeping row sums."""
    whole = np.rint(255.0 * weights)
    rows, strongest = np.arange(len(whole)), whole.argmax(axis=1)
    whole[rows, strongest] += 255.0 * weights.sum(axis=1).round() - whole.sum(axis=1)
    return np.asarray(whole / 255.0)


def _fit_collar(points: Floats, suit: Indices, centres: Mapping[str, Floats], top: Mesh) -> Floats:
    """Return (v, 3) positions [m] with the neckline pulled to the neck."""
    skin = top.vertices("skin")
    skin = skin[np.isin(skin, top.faces)]
    near = suit[measure_neckline_distance(points[suit], centres) > -COLLAR_RAMP]
    _, which = scipy.spatial.cKDTree(top.positions[skin]).query(points[near], COLLAR_NEIGHBOURS)
    normals = top.normals(top.positions)[skin]
    normals = normals[which].mean(axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    gap = ((points[near] - top.positions[skin][which].mean(axis=1)) * normals).sum(axis=1)
    ramp = np.clip(1.0 + measure_neckline_distance(points[near], centres) / COLLAR_RAMP, 0.0, 1.0)
    moved = points.copy()
    moved[near] -= (ramp * np.maximum(gap - COLLAR_GAP, 0.0))[:, None] * normals
    return sealed(moved)


def _tuck_skin(top: Mesh, centres: Mapping[str, Floats]) -> Mesh:
    """Move the skin under the shirt inward, so that none shows through."""
    inside = np.clip(-measure_neckline_distance(top.positions, centres) / TUCK_RAMP, 0.0, 1.0)
    inside *= top.parts == MESH_PARTS.index("skin")
    return replace(top, positions=sealed(top.positions - TUCK_DEPTH * inside[:, None] * top.normals(top.positions)))


def _drop_unused(mesh: Mesh, weights: Floats) -> tuple[Mesh, Floats]:
    """Remove vertices without faces from a mesh and its skinning weights."""
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
