"""A performance as a glTF scene: the skeleton as nodes, what is drawn on them, and an animation of both.

Nodes carry the names of segments. The scene is glTF's: y up and z forward; one node above all others turns our frame
into it, so that all below it is in metres in ours. Key frames are `KEY_FRAME_RATE` a second; between them players
interpolate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.controller.performance import Performance
from kinesic.files.gltf import GltfFile
from kinesic.files.output_file import new_file
from kinesic.planning.face_track import faces
from kinesic.planning.plan import Plan
from kinesic.report.gltf.capsule_mesh import capsule_mesh, join_surfaces
from kinesic.report.gltf.skin import add_skin
from kinesic.sim.shells.shell import SegmentShell, shell_of
from kinesic.version import __version__

SUFFIX = ".glb"
KEY_FRAME_RATE = 30.0  # [Hz] of key frames
TURNED = [-0.5, -0.5, -0.5, 0.5]  # x, y, z, w: our x, y, z become glTF's z, x, y
COLOURS = ([0.78, 0.80, 0.83, 1.0], [0.16, 0.19, 0.24, 1.0])  # linear: of what moves, of what carries
STILL = 1e-9  # [m]
NEAR = 0.01  # key frames: nearer to the end there is none


@dataclass(frozen=True, eq=False)
class SceneMotion:
    """What a scene shows, at the times of its key frames."""

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    units: Sequence[Mapping[str, float]]  # m action units -> 0..1


def save_scene(plan: Plan, path: Path, *, force: bool) -> Path:
    """Writes what a plan performs, with its face where the robot has one, and returns the path.

    Raises:
        ConfigError: the path is a folder's, a link's or, unless forced, a file's.
    """
    times = key_times(plan.duration)
    motion = SceneMotion(times, plan.trajectory.sample(times)[0], faces(plan, times))
    with new_file(path, force=force) as fresh:
        write_scene(plan.setup.robot, motion, fresh)
    return path


def save_performed(performance: Performance, path: Path, *, force: bool) -> Path:
    """Writes what the twin performed, with the face that was planned, and returns the path.

    Raises:
        ConfigError: the path is a folder's, a link's or, unless forced, a file's.
    """
    measured = performance.measured
    times = key_times(float(measured.times[-1]))
    angles = np.stack([np.interp(times, measured.times, column) for column in measured.angles.T], axis=1)
    motion = SceneMotion(times, angles, faces(performance.plan, times))
    with new_file(path, force=force) as fresh:
        write_scene(performance.plan.setup.robot, motion, fresh)
    return path


def is_scene(path: Path | None) -> bool:
    """Whether a path is one of a glTF scene, by its ending."""
    return path is not None and path.suffix.lower() == SUFFIX


def key_times(duration: float) -> Floats:
    """Gives (m,) [s] the times of key frames: 0, then `KEY_FRAME_RATE` a second, and the end, all apart."""
    return np.append(np.arange(max(np.ceil(duration * KEY_FRAME_RATE - NEAR), 1.0)) / KEY_FRAME_RATE, duration)


def write_scene(robot: Robot, motion: SceneMotion, path: Path) -> None:
    """Writes a motion of a robot: its skin where it has one, else its shell, or its capsules without one."""
    file = GltfFile(f"kinesic {__version__}")
    nodes = _add_skeleton(file, robot)
    channels = _Channels(file, motion.times)
    _move_skeleton(channels, nodes, robot, motion.angles)
    if robot.skin is None:
        _add_surfaces(file, nodes, robot)
    else:
        skin = add_skin(file, nodes, robot)
        for node, rotations in skin.turns(motion.angles, motion.units):
            channels.add(node, "rotation", smooth_quaternions(rotations))
        channels.add(skin.face, "weights", skin.weights(motion.units).ravel())
    file.add("animations", name="performance", channels=channels.rows, samplers=channels.samplers)
    file.write(path)


def _add_skeleton(file: GltfFile, robot: Robot) -> list[int]:
    """Adds a node for each segment, and returns them in the skeleton's order."""
    nodes: list[int] = []
    children: dict[int, list[int]] = {}
    world = file.add("nodes", name=robot.name, rotation=TURNED)
    for segment, (parent, origin, _) in zip(robot.skeleton.segments, robot.skeleton.steps, strict=True):
        nodes.append(file.add("nodes", name=segment.name, translation=origin.tolist()))
        children.setdefault(world if parent < 0 else nodes[parent], []).append(nodes[-1])
    for node, below in children.items():
        file.entry("nodes", node)["children"] = below
    file.show(world)
    return nodes


class _Channels:
    """Channels of one animation, all with the same times."""

    def __init__(self, file: GltfFile, times: Floats) -> None:
        self._file = file
        self._times = file.numbers(times, bounds=True)
        self.rows: list[dict[str, object]] = []
        self.samplers: list[dict[str, object]] = []

    def add(self, node: int, path: str, values: Floats) -> None:
        """Moves a node by a row of values for each time."""
        output = self._file.numbers(values)
        self.samplers.append({"input": self._times, "output": output, "interpolation": "LINEAR"})
        if path != "weights":
            self._file.entry("nodes", node)[path] = values[0].tolist()  # where it is without the animation
        self.rows.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})


def _move_skeleton(channels: _Channels, nodes: list[int], robot: Robot, angles: Floats) -> None:
    """Turns each node as its segment turns in its parent, and shifts it where hinges are beside its origin."""
    stand = robot.skeleton.frames(angles)
    for k, (parent, origin, _) in enumerate(robot.skeleton.steps):
        if parent < 0:
            continue
        back = stand.rotations[:, parent].transpose(0, 2, 1)
        channels.add(nodes[k], "rotation", smooth_quaternions(back @ stand.rotations[:, k]))
        places = np.einsum("mij,mj->mi", back, stand.origins[:, k] - stand.origins[:, parent])
        if np.abs(places - origin).max() > STILL:
            channels.add(nodes[k], "translation", places)


def smooth_quaternions(rotations: Floats) -> Floats:
    """Gives (m, 4) x, y, z, w of (m, 3, 3) rotations, none of them the long way round from the one before."""
    found: Floats = scipy.spatial.transform.Rotation.from_matrix(rotations).as_quat()
    flips = np.where(np.einsum("mi,mi->m", found[1:], found[:-1]) < 0.0, -1.0, 1.0)
    found[1:] *= np.cumprod(flips)[:, None]
    return found


def _add_surfaces(file: GltfFile, nodes: list[int], robot: Robot) -> None:
    """Hangs the shell of each segment on its node, or its capsules."""
    shell = shell_of(robot)
    materials = [
        file.add("materials", pbrMetallicRoughness={"baseColorFactor": colour, "metallicFactor": 0.0})
        for colour in COLOURS
    ]
    limbs = {name for chain, members in robot.chains.items() if chain != "torso" for name in members}
    for node, segment in zip(nodes, robot.skeleton.segments, strict=True):
        name = segment.name
        if shell is not None:
            primitives = _shell_primitives(file, shell.segments[name], materials) if name in shell.segments else []
        elif segment.capsules:
            surface = join_surfaces([capsule_mesh(capsule) for capsule in segment.capsules])
            attributes = _attributes(file, surface.positions, surface.normals)
            primitives = [_primitive(file, attributes, surface.corners, materials[name not in limbs])]
        else:
            primitives = []
        if primitives:
            file.entry("nodes", node)["mesh"] = file.add("meshes", name=name, primitives=primitives)


def _shell_primitives(file: GltfFile, surface: SegmentShell, materials: list[int]) -> list[dict[str, object]]:
    """The housing, and what of it is dark, of the same vertices."""
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
