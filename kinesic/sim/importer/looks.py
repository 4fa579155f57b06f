"""What a foreign robot looks like: the mesh files that its MJCF or URDF names, as triangles of its bodies.

Only files inside the robot's folder are read, and of what is not read the importer tells why.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.config import ConfigError
from kinesic.sim.importer.mesh_file import FORMATS, Triangles, read_mesh, simplify
from kinesic.sim.importer.model_tree import Surface
from kinesic.sim.importer.reading.model_text import MeshReference
from kinesic.sim.importer.reading.robot_files import RobotFiles

MOST_FILES = 300
MOST_BYTES = 200_000_000  # of all mesh files together
MOST_TRIANGLES = 3000  # of one mesh, before meshes of a segment are joined
DARK = 0.35  # luminance below which a shape is dark
POINT = 1e-3  # [m] radius of what stands for a mesh while its place is found


@dataclass(frozen=True, eq=False)
class Looks:
    """What could be read: body -> surfaces, in the pose of the file; and what could not."""

    surfaces: Mapping[int, tuple[Surface, ...]] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()


def load_looks(
    files: RobotFiles,
    describe: Callable[[ElementTree.Element, RobotFiles], mujoco.MjSpec],
    compiled: Callable[[mujoco.MjSpec], mujoco.MjModel],
) -> Looks:
    """Read the meshes of a robot, if it has any.

    Args:
        files: of the robot.
        describe: makes a description of a robot's XML.
        compiled: makes a model of a description, without its meshes.
    """
    spec = describe(_with_looks(files), files)
    named = {mesh.name: mesh for mesh in spec.meshes}
    shown = [geom for geom in spec.geoms if geom.type == mujoco.mjtGeom.mjGEOM_MESH and geom.meshname in named]
    unsolid = [geom for geom in shown if not geom.contype and not geom.conaffinity]
    reader = _Reader(files.path)
    wanted: list[tuple[str, Triangles, bool]] = []
    for k, geom in enumerate(unsolid or shown):
        mesh = named[geom.meshname]
        triangles = reader.read(files.meshes[mesh.file])
        if triangles is not None:
            wanted.append((f"look_{k}", _scaled(triangles, mesh), _is_dark(spec, geom)))
            _make_point(geom, f"look_{k}")
    if not wanted:
        return Looks({}, tuple(reader.left_out))
    model = compiled(spec)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return Looks(_placed(model, data, wanted), tuple(reader.left_out))


def _make_point(geom: mujoco.MjsGeom, name: str) -> None:
    """Lets a ball without weight stand where a mesh does."""
    geom.name, geom.meshname, geom.material = name, "", ""
    geom.type, geom.size = mujoco.mjtGeom.mjGEOM_SPHERE, [POINT, 0, 0]
    geom.mass, geom.contype, geom.conaffinity = 0.0, 0, 0


def _with_looks(files: RobotFiles) -> ElementTree.Element:
    """Return the robot's XML with visuals, which MuJoCo drops by default."""
    if not files.is_urdf:
        return files.root
    root = deepcopy(files.root)
    extension = root.find("mujoco")
    extension = ElementTree.SubElement(root, "mujoco") if extension is None else extension
    compiler = extension.find("compiler")
    compiler = ElementTree.SubElement(extension, "compiler") if compiler is None else compiler
    compiler.set("discardvisual", "false")
    return root


class _Reader:
    """Read files of one robot, each once."""

    def __init__(self, path: Path) -> None:
        self.left_out: list[str] = []
        self._folder, self._bytes = path.parent.resolve(), 0
        self._known: dict[MeshReference, Triangles | None] = {}

    def read(self, mesh: MeshReference) -> Triangles | None:
        if mesh not in self._known:
            try:
                self._known[mesh] = self._read(mesh)
            except (ConfigError, OSError, RuntimeError) as error:  # the last of links that form a circle
                self._known[mesh] = None
                self.left_out.append(str(error))
        return self._known[mesh]

    def _read(self, mesh: MeshReference) -> Triangles:
        if not mesh.file:
            raise ConfigError(f"mesh {mesh.name}: without a file; only {' and '.join(FORMATS)} files are drawn")
        if len(self._known) >= MOST_FILES:
            raise ConfigError(f"{mesh.file}: more than {MOST_FILES} mesh files")
        path = self._find(mesh)
        self._bytes += path.stat().st_size
        if self._bytes > MOST_BYTES:
            raise ConfigError(f"{mesh.file}: more than {MOST_BYTES // 1_000_000} MB of meshes")
        return simplify(read_mesh(path, folder=self._folder), MOST_TRIANGLES)

    def _find(self, mesh: MeshReference) -> Path:
        """Find the file whose path best matches the end of a reference."""
        parts = Path(mesh.file.replace("\\", "/").rsplit("://", maxsplit=1)[-1]).parts
        for k in range(len(parts)):
            for start in (self._folder / mesh.below, self._folder):
                place = start.joinpath(*parts[k:]).resolve()
                if place.is_relative_to(self._folder) and place.is_file():
                    return place
        folder = self._folder.name
        raise ConfigError(f"{mesh.file}: not in the folder {folder}; copy it there, or the robot's file above it")


def _scaled(triangles: Triangles, mesh: mujoco.MjsMesh) -> Triangles:
    """Moves the triangles of a mesh file to where the model has them: scaled, and in the mesh's own frame."""
    scale, turn = np.array(mesh.scale), np.empty(9)
    mujoco.mju_quat2Mat(turn, np.array(mesh.refquat))
    places = (triangles.vertices * scale - np.array(mesh.refpos)) @ turn.reshape(3, 3)
    corners = triangles.corners if np.prod(scale) > 0 else triangles.corners[:, ::-1]
    return Triangles(sealed(places), corners)


def _is_dark(spec: mujoco.MjSpec, geom: mujoco.MjsGeom) -> bool:
    paint = spec.material(geom.material) if geom.material else None
    red, green, blue = np.array(geom.rgba if paint is None else paint.rgba)[:3]
    return bool(0.3 * red + 0.6 * green + 0.1 * blue < DARK)


def _placed(
    model: mujoco.MjModel, data: mujoco.MjData, wanted: list[tuple[str, Triangles, bool]]
) -> dict[int, tuple[Surface, ...]]:
    """Surfaces by body, in the world."""
    found: dict[int, tuple[Surface, ...]] = {}
    for name, triangles, dark in wanted:
        geom = model.geom(name).id
        places = triangles.vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        body = int(model.geom_bodyid[geom])
        found[body] = (*found.get(body, ()), Surface(Triangles(sealed(places), triangles.corners), dark))
    return found
