"""Reader of skeletal animations in glTF 2.0 files (.glb and .gltf)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from kinesic.body.arrays import Floats, sealed
from kinesic.capture.reading.gltf_file import (
    Animation,
    GltfArrays,
    Interpolation,
    LoadBuffer,
    Node,
    get_item,
    read_scene,
)
from kinesic.capture.reading.text import MAX_FRAMES, MAX_JOINTS, CaptureError, check_numbers, check_times
from kinesic.capture.skeleton_motion import AXIS_CHANNELS, ROTATION_CHANNEL, CapturedJoint, CapturedMotion

SAMPLING_RATE = 60.0  # [Hz] rate at which the key frames of an animation are sampled
MAX_SAMPLES = 600_000  # largest number of frames x animated properties
MIN_LENGTH = 1e-6  # shortest accepted quaternion or matrix column
MATRIX_SIZE = 16  # number of entries of a node's matrix


@dataclass(frozen=True, eq=False)
class _Skeleton:
    """Nodes of a glTF file as skeleton joints."""

    joints: tuple[CapturedJoint, ...]  # parents first
    names: Sequence[str]  # unique joint names in the order of the nodes
    scales: Mapping[str, float]  # scale of the axes in which each joint lies


@dataclass(frozen=True, eq=False)
class _Track:
    """Key frames of one property of a joint."""

    keys: Floats  # (m,) [s] times of the key frames
    values: Floats  # (m, k), or (3 m, k) of a cubic spline: incoming slope, value and outgoing slope
    interpolation: Interpolation


Tracks = Mapping[tuple[str, str], _Track]  # by joint and property


def read_gltf(
    data: bytes, source: str, load_buffer: LoadBuffer
) -> tuple[tuple[CapturedJoint, ...], CapturedMotion, tuple[str, ...]]:
    """Read the nodes and the first animation of a glTF file.

    Args:
        data: content of the file.
        source: name of the file, for messages.
        load_buffer: returns the bytes of a buffer by its URI.

    Returns:
        Joints with parents first, motion, and guesses.

    Raises:
        CaptureError: the data is not glTF, or has no animation of joints.
    """
    arrays = read_scene(data, source, load_buffer)
    animations = arrays.scene.animations
    if not animations:
        raise CaptureError(f"{source}: it has no animation")
    skeleton = _make_skeleton(arrays.scene.nodes, source)
    place = f"{source}: animation {animations[0].name[:40]!r}"
    motion = _sample(_read_tracks(animations[0], skeleton, arrays, place), skeleton, place)
    is_one_of_many = len(animations) > 1
    guesses = (f"first of {len(animations)} animations: {animations[0].name[:40]!r}",) if is_one_of_many else ()
    return skeleton.joints, motion, guesses


def _make_skeleton(nodes: Sequence[Node], source: str) -> _Skeleton:
    parents = _find_parents(nodes, source)
    names: list[str] = []
    for k, node in enumerate(nodes):
        names.append(node.name if node.name and node.name not in names else f"{node.name}#{k}")
    joints: list[CapturedJoint] = []
    scales: dict[str, float] = {}
    waiting = [(k, 1.0) for k in reversed(range(len(nodes))) if k not in parents]
    while waiting:
        k, above = waiting.pop()
        offset, rotation, scale = _rest_of(nodes[k], f"{source}: nodes[{k}]")
        parent = names[parents[k]] if k in parents else None
        joints.append(CapturedJoint(names[k], parent, sealed(above * offset), sealed(rotation.as_rotvec())))
        scales[names[k]] = above
        waiting += [(child, above * scale) for child in reversed(nodes[k].children)]
    if len(joints) < len(nodes):
        raise CaptureError(f"{source}: a node is its own ancestor")
    return _Skeleton(tuple(joints), names, scales)


def _find_parents(nodes: Sequence[Node], source: str) -> Mapping[int, int]:
    if len(nodes) > MAX_JOINTS:
        raise CaptureError(f"{source}: {len(nodes)} nodes; at most {MAX_JOINTS} are read")
    parents: dict[int, int] = {}
    for k, node in enumerate(nodes):
        for child in node.children:
            get_item(nodes, child, f"{source}: child {child} of nodes[{k}]")
            if child in parents:
                raise CaptureError(f"{source}: nodes[{child}] has two parents")
            parents[child] = k
    return parents


def _rest_of(node: Node, place: str) -> tuple[Floats, Rotation, float]:
    """Return a node's translation, rotation and mean scale without animation."""
    if node.matrix is None:
        numbers = check_numbers(np.array([*node.translation, *node.rotation, *node.scale]), place)
        if np.linalg.norm(numbers[3:7]) < MIN_LENGTH:
            raise CaptureError(f"{place}: its rotation is a quaternion of zero length")
        return numbers[:3], Rotation.from_quat(numbers[3:7]), _average(np.abs(numbers[7:]))
    if len(node.matrix) != MATRIX_SIZE:
        raise CaptureError(f"{place}: its matrix has {len(node.matrix)} numbers; it needs {MATRIX_SIZE}")
    matrix = check_numbers(np.array(node.matrix), place).reshape(4, 4).T
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    axes = matrix[:3, :3] / np.maximum(lengths, MIN_LENGTH)
    if not np.linalg.det(axes) > MIN_LENGTH:
        raise CaptureError(f"{place}: its matrix is mirrored or singular")
    return matrix[:3, 3], Rotation.from_matrix(axes), _average(lengths)


def _average(scales: Floats) -> float:
    """Return the geometric mean of scales along three axes."""
    return float(np.prod(np.cbrt(scales)))


def _read_tracks(animation: Animation, skeleton: _Skeleton, arrays: GltfArrays, place: str) -> Tracks:
    tracks: dict[tuple[str, str], _Track] = {}
    for channel in animation.channels:
        path, node = channel.target.path, channel.target.node
        if node is None or path not in ("rotation", "translation"):
            continue
        name = get_item(skeleton.names, node, f"{place}: node {node}")
        sampler = get_item(animation.samplers, channel.sampler, f"{place}: sampler {channel.sampler}")
        keys = arrays.read(sampler.input, "SCALAR")[:, 0]
        values = arrays.read(sampler.output, "VEC4" if path == "rotation" else "VEC3")
        values_per_key = 3 if sampler.interpolation == "CUBICSPLINE" else 1
        if len(values) != values_per_key * len(keys) or not (np.diff(keys) > 0.0).all():
            raise CaptureError(f"{place}: {path} of {name[:40]!r} needs increasing times with a value for each")
        tracks[name, path] = _Track(keys, values, sampler.interpolation)
    if not tracks:
        raise CaptureError(f"{place}: it moves no joint")
    return tracks


def _sample(tracks: Tracks, skeleton: _Skeleton, place: str) -> CapturedMotion:
    """Sample the rotations and translations of all animated joints."""
    first = min(track.keys[0] for track in tracks.values())
    duration = max(track.keys[-1] for track in tracks.values()) - first
    count = int(min(duration * SAMPLING_RATE + 1e-6, MAX_FRAMES)) + 1
    times = np.arange(count) / SAMPLING_RATE
    check_times(times, place)
    if count * len(tracks) > MAX_SAMPLES:
        raise CaptureError(f"{place}: {count} frames of {len(tracks)} animated properties are too many; cut the file")
    columns: dict[tuple[str, str], slice] = {}
    blocks: list[Floats] = []
    width = 0
    for joint in skeleton.joints:
        translation, rotation = (tracks.get((joint.name, path)) for path in ("translation", "rotation"))
        if translation is not None:
            blocks.append(skeleton.scales[joint.name] * _interpolate(first + times, translation) - joint.offset)
            for kind in AXIS_CHANNELS:
                columns[joint.name, kind] = slice(width, width := width + 1)
        if rotation is not None:
            turns = Rotation.from_rotvec(-joint.turn) * _rotate(
                first + times, rotation, f"{place}: {joint.name[:40]!r}"
            )
            blocks.append(turns.as_rotvec())
            columns[joint.name, ROTATION_CHANNEL] = slice(width, width := width + 3)
    return CapturedMotion(sealed(times), columns, sealed(np.concatenate(blocks, axis=1)), {})


def _rotate(times: Floats, track: _Track, place: str) -> Rotation:
    """Return rotations at times, from the quaternions of a track.

    Raises:
        CaptureError: a quaternion has zero length.
    """
    is_spherical = track.interpolation == "LINEAR" and len(track.keys) > 1
    quaternions = track.values if is_spherical else _interpolate(times, track)
    if np.linalg.norm(quaternions, axis=1).min() < MIN_LENGTH:
        raise CaptureError(f"{place}: a rotation is a quaternion of zero length")
    rotations = Rotation.from_quat(quaternions)
    return Slerp(track.keys, rotations)(np.clip(times, track.keys[0], track.keys[-1])) if is_spherical else rotations


def _interpolate(times: Floats, track: _Track) -> Floats:
    """Interpolate the values of a track (m, k), constant beyond the ends."""
    keys, values = track.keys, track.values
    is_cubic = track.interpolation == "CUBICSPLINE"
    incoming, points, outgoing = (values[k::3] for k in range(3)) if is_cubic else (values, values, values)
    if len(keys) == 1:
        return np.repeat(points, len(times), axis=0)
    inside = np.clip(times, keys[0], keys[-1])
    index = np.clip(np.searchsorted(keys, inside, side="right") - 1, 0, len(keys) - 2)
    interval = (keys[index + 1] - keys[index])[:, None]
    u = (inside - keys[index])[:, None] / interval
    before, after = points[index], points[index + 1]
    if track.interpolation == "STEP":
        return np.where(u < 1.0, before, after)
    if not is_cubic:
        return before + u * (after - before)
    curve: Floats = (
        (2.0 * u**3 - 3.0 * u**2 + 1.0) * before
        + (u**3 - 2.0 * u**2 + u) * interval * outgoing[index]
        + (3.0 * u**2 - 2.0 * u**3) * after
        + (u**3 - u**2) * interval * incoming[index + 1]
    )
    return curve
