"""Performance as a glTF scene: skeleton nodes, meshes and an animation.

Nodes carry the names of segments. The scene has glTF's axes, y up and z forward. One root node rotates kinesic's frame
into it, so that all nodes below are in metres in kinesic's frame. There are `KEY_FRAME_RATE` key frames a second;
players interpolate between them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kinesic.bml.block import Speech
from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.files.gltf import GltfFile
from kinesic.files.output_file import new_file
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.face_track import compute_faces
from kinesic.planning.plan import Plan
from kinesic.report.gltf.capsule_mesh import capsule_mesh, join_surfaces
from kinesic.report.gltf.drawn_face import add_drawn_face
from kinesic.report.gltf.skin import add_skin
from kinesic.report.segment_motion import segment_motions, smooth_quaternions
from kinesic.sim.part_colours import PART_COLOURS, RodPart, shell_parts
from kinesic.sim.shells.shell import SegmentShell
from kinesic.sim.shells.variant import find_shell
from kinesic.version import __version__

SCENE_SUFFIX = ".glb"  # file suffix of binary glTF scenes
VOICE_SUFFIX = ".wav"  # file suffix of the speech sound next to a scene
KEY_FRAME_RATE = 30.0  # [Hz] rate of the animation's key frames
FRAME_QUATERNION = [-0.5, -0.5, -0.5, 0.5]  # rotation (x, y, z, w) from kinesic's axes x, y, z to glTF's z, x, y
# Linear RGBA colours of light housings and dark parts.
SURFACE_COLOURS = ([0.78, 0.80, 0.83, 1.0], [0.16, 0.19, 0.24, 1.0])  # linear RGBA of pale housings, and of dark joints
HAND_PARTS: tuple[RodPart, ...] = ("l_hand", "r_hand")  # parts drawn in their own `PART_COLOURS`
MIN_TRANSLATION = 1e-9  # [m] smaller translations of a segment are not animated
MIN_END_GAP = 0.01  # smallest time between the last two key frames, in key frame intervals


@dataclass(frozen=True, eq=False)
class SceneMotion:
    """Postures and faces at the key frames of a glTF scene."""

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    units: Sequence[Mapping[str, float]]  # m action units -> 0..1


def save_scene(plan: Plan, path: Path, *, force: bool) -> Path:
    """Write the planned motion as a glTF scene and return its path.

    The face is included if the robot has one.

    Raises:
        ConfigError: the path is a folder, a link or, unless forced, an existing file.
    """
    times = key_times(plan.duration)
    motion = SceneMotion(times, plan.trajectory.sample(times)[0], compute_faces(plan, times))
    with new_file(path, force=force) as fresh:
        write_scene(plan.setup.robot, motion, fresh)
    return path


def save_performed(performance: DryRun, path: Path, *, force: bool) -> Path:
    """Write the twin's motion as a glTF scene with the planned face.

    Raises:
        ConfigError: the path is a folder, a link or, unless forced, an existing file.
    """
    measured = performance.measured
    times = key_times(performance.duration)
    angles = np.stack([np.interp(times, measured.times, column) for column in measured.angles.T], axis=1)
    motion = SceneMotion(times, angles, compute_faces(performance.plan, times))
    with new_file(path, force=force) as fresh:
        write_scene(performance.plan.setup.robot, motion, fresh)
    return path


def save_voice(plan: Plan, scene: Path, *, force: bool) -> Path | None:
    """Write a plan's speech as WAV next to a scene file.

    Sound and animation begin together: sample 0 is heard at second 0 of the animation.

    Returns:
        Path of the scene with the suffix .wav; None for a plan without audible speech.

    Raises:
        ConfigError: the path is a folder, a link, a recording of the plan or, unless forced, an existing file.
    """
    speech = sound(plan)
    if speech is None:
        return None
    path = scene.with_suffix(VOICE_SUFFIX)
    if path.resolve() in _list_recordings(plan):
        raise ConfigError(f"{path}: the voice would replace the recording; give --out another name")
    with new_file(path, force=force) as fresh:
        write_wav(speech, fresh)
    return path


def _list_recordings(plan: Plan) -> set[Path]:
    """Return the paths of a plan's speech recordings, with suffix .wav."""
    scripts = (action.script for timed in plan.timeline.timed if isinstance(action := timed.behaviour.action, Speech))
    return {each.recording.path.with_suffix(VOICE_SUFFIX).resolve() for each in scripts if each.recording is not None}


def is_scene(path: Path | None) -> bool:
    """Return whether a path has the suffix of a glTF scene."""
    return path is not None and path.suffix.lower() == SCENE_SUFFIX


def key_times(duration: float) -> Floats:
    """Return distinct key frame times from 0 to the end, (m,) [s].

    There are `KEY_FRAME_RATE` a second.
    """
    return np.append(np.arange(max(np.ceil(duration * KEY_FRAME_RATE - MIN_END_GAP), 1.0)) / KEY_FRAME_RATE, duration)


def write_scene(robot: Robot, motion: SceneMotion, path: Path) -> None:
    """Write a robot's motion as glTF, with its skin, shell or capsules."""
    file = GltfFile(f"kinesic {__version__}")
    nodes = _add_skeleton(file, robot)
    channels = _Channels(file, motion.times)
    _move_skeleton(channels, nodes, robot, motion.angles)
    if robot.skin is None:
        _add_surfaces(file, nodes, robot)
        face = add_drawn_face(file, nodes, robot, motion.units)
        if face is not None and face.weights.size:
            channels.add(face.node, "weights", face.weights.ravel())
    else:
        skin = add_skin(file, nodes, robot)
        for node, rotations in skin.turns(motion.angles, motion.units):
            channels.add(node, "rotation", smooth_quaternions(rotations))
        channels.add(skin.face, "weights", skin.weights(motion.units).ravel())
    file.add("animations", name="performance", channels=channels.rows, samplers=channels.samplers)
    file.write(path)


def _add_skeleton(file: GltfFile, robot: Robot) -> list[int]:
    """Add a glTF node per segment and return the nodes in order."""
    nodes: list[int] = []
    children: dict[int, list[int]] = {}
    world = file.add("nodes", name=robot.name, rotation=FRAME_QUATERNION)
    for segment, (parent, origin, _) in zip(robot.skeleton.segments, robot.skeleton.steps, strict=True):
        nodes.append(file.add("nodes", name=segment.name, translation=origin.tolist()))
        children.setdefault(world if parent < 0 else nodes[parent], []).append(nodes[-1])
    for node, below in children.items():
        file.entry("nodes", node)["children"] = below
    file.show(world)
    return nodes


class _Channels:
    """Channels of one glTF animation, all with the same times."""

    def __init__(self, file: GltfFile, times: Floats) -> None:
        self._file = file
        self._times = file.numbers(times, bounds=True)
        self.rows: list[dict[str, object]] = []
        self.samplers: list[dict[str, object]] = []

    def add(self, node: int, path: str, values: Floats) -> None:
        """Animate a node's property, with one row of values per time."""
        output = self._file.numbers(values)
        self.samplers.append({"input": self._times, "output": output, "interpolation": "LINEAR"})
        if path != "weights":
            self._file.entry("nodes", node)[path] = values[0].tolist()  # where it is without the animation
        self.rows.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})


def _move_skeleton(channels: _Channels, nodes: list[int], robot: Robot, angles: Floats) -> None:
    """Animate the nodes of all segments except the root."""
    for motion, (parent, origin, _) in zip(segment_motions(robot, angles), robot.skeleton.steps, strict=True):
        if parent < 0:
            continue
        channels.add(nodes[motion.segment], "rotation", motion.rotations)
        if np.abs(motion.translations - origin).max() > MIN_TRANSLATION:
            channels.add(nodes[motion.segment], "translation", motion.translations)


def _add_surfaces(file: GltfFile, nodes: list[int], robot: Robot) -> None:
    """Add shell or capsule meshes to the segments' nodes."""
    shell = find_shell(robot)
    parts = shell_parts(robot)
    light, dark = (_add_material(file, colour) for colour in SURFACE_COLOURS)
    hands = {part: _add_material(file, _linear(PART_COLOURS[part])) for part in HAND_PARTS if part in parts.values()}
    limbs = {name for chain, members in robot.chains.items() if chain != "torso" for name in members}
    for node, segment in zip(nodes, robot.skeleton.segments, strict=True):
        name = segment.name
        if shell is not None:
            materials = [hands.get(parts[name], light), dark]
            primitives = _shell_primitives(file, shell.segments[name], materials) if name in shell.segments else []
        elif segment.capsules:
            surface = join_surfaces([capsule_mesh(capsule) for capsule in segment.capsules])
            attributes = _attributes(file, surface.positions, surface.normals)
            primitives = [
                _primitive(file, attributes, surface.corners, hands.get(parts[name], light if name in limbs else dark))
            ]
        else:
            primitives = []
        if primitives:
            file.entry("nodes", node)["mesh"] = file.add("meshes", name=name, primitives=primitives)


def _add_material(file: GltfFile, colour: Sequence[float]) -> int:
    return file.add("materials", pbrMetallicRoughness={"baseColorFactor": list(colour), "metallicFactor": 0.0})


def _linear(colour: Sequence[float]) -> list[float]:
    """Convert an sRGB colour with opacity to linear RGBA."""
    *rgb, opacity = colour
    return [*(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in rgb), opacity]


def _shell_primitives(file: GltfFile, surface: SegmentShell, materials: list[int]) -> list[dict[str, object]]:
    """Return the glTF primitives of a housing's light and dark parts."""
    normals = surface.normals / np.linalg.norm(surface.normals, axis=1, keepdims=True)
    attributes = _attributes(file, surface.vertices, normals)
    kinds = zip((surface.shell, surface.joint), materials, strict=True)
    return [_primitive(file, attributes, corners, material) for corners, material in kinds if len(corners)]


def _attributes(file: GltfFile, positions: Floats, normals: Floats) -> dict[str, int]:
    return {
        "POSITION": file.numbers(positions, target="vertices", bounds=True),
        "NORMAL": file.numbers(normals, target="vertices"),
    }


def _primitive(
    file: GltfFile, attributes: dict[str, int], corners: NDArray[np.integer], material: int
) -> dict[str, object]:
    indices = file.numbers(corners.ravel(), "u4", "indices")
    return {"attributes": attributes, "indices": indices, "material": material}
