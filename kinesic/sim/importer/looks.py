"""Meshes of an imported robot, as triangles of its bodies.

Only files inside the robot's folder are read. Files that are not read are reported with the reason.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from xml.etree import ElementTree

import mujoco
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.sim.importer.mesh_file import Triangles
from kinesic.sim.importer.mesh_reader import MeshReader
from kinesic.sim.importer.model_tree import Surface
from kinesic.sim.importer.reading.robot_files import RobotFiles

DARK_LUMINANCE = 0.35  # luminance below which a shape is drawn dark
POINT_RADIUS = 1e-3  # [m] radius of the ball that marks the position of a mesh


@dataclass(frozen=True, eq=False)
class Looks:
    """Visible surfaces of an imported robot's bodies, with notes on omitted meshes."""

    surfaces: Mapping[int, tuple[Surface, ...]] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()


def load_looks(
    files: RobotFiles,
    describe: Callable[[ElementTree.Element, RobotFiles], mujoco.MjSpec],
    compiled: Callable[[mujoco.MjSpec], mujoco.MjModel],
) -> Looks:
    """Read the meshes of a robot, if it has any.

    Args:
        files: XML of the robot.
        describe: Function that makes a MuJoCo specification from XML.
        compiled: Function that compiles a specification without its meshes.
    """
    spec = describe(_keep_visuals(files), files)
    named = {mesh.name: mesh for mesh in spec.meshes}
    mesh_geoms = [geom for geom in spec.geoms if geom.type == mujoco.mjtGeom.mjGEOM_MESH and geom.meshname in named]
    visual_geoms = [geom for geom in mesh_geoms if not geom.contype and not geom.conaffinity]
    reader = MeshReader(files.path)
    meshes_to_place: list[tuple[str, Triangles, bool]] = []
    for k, geom in enumerate(visual_geoms or mesh_geoms):
        mesh = named[geom.meshname]
        triangles = reader.read(files.meshes[mesh.file], mesh)
        if triangles is not None:
            meshes_to_place.append((f"look_{k}", triangles, _is_dark(spec, geom)))
            _make_point(geom, f"look_{k}")
    if not meshes_to_place:
        return Looks({}, tuple(reader.notes))
    model = compiled(spec)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return Looks(_place_surfaces(model, data, meshes_to_place), tuple(reader.notes))


def _make_point(geom: mujoco.MjsGeom, name: str) -> None:
    """Replace a mesh geom by a massless point, which marks its position."""
    geom.name, geom.meshname, geom.material = name, "", ""
    geom.type, geom.size = mujoco.mjtGeom.mjGEOM_SPHERE, [POINT_RADIUS, 0, 0]
    geom.mass, geom.contype, geom.conaffinity = 0.0, 0, 0


def _keep_visuals(files: RobotFiles) -> ElementTree.Element:
    """Return the robot's XML, extended so that MuJoCo keeps URDF visuals."""
    if not files.is_urdf:
        return files.root
    root = deepcopy(files.root)
    extension = root.find("mujoco")
    extension = ElementTree.SubElement(root, "mujoco") if extension is None else extension
    compiler = extension.find("compiler")
    compiler = ElementTree.SubElement(extension, "compiler") if compiler is None else compiler
    compiler.set("discardvisual", "false")
    return root


def _is_dark(spec: mujoco.MjSpec, geom: mujoco.MjsGeom) -> bool:
    paint = spec.material(geom.material) if geom.material else None
    red, green, blue = np.array(geom.rgba if paint is None else paint.rgba)[:3]
    return bool(0.3 * red + 0.6 * green + 0.1 * blue < DARK_LUMINANCE)


def _place_surfaces(
    model: mujoco.MjModel, data: mujoco.MjData, meshes_to_place: list[tuple[str, Triangles, bool]]
) -> dict[int, tuple[Surface, ...]]:
    """Return surfaces in world coordinates, by MuJoCo body id."""
    placed_surfaces: dict[int, tuple[Surface, ...]] = {}
    for name, triangles, dark in meshes_to_place:
        geom = model.geom(name).id
        vertices = triangles.vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        body = int(model.geom_bodyid[geom])
        placed_surfaces[body] = (
            *placed_surfaces.get(body, ()),
            Surface(Triangles(sealed(vertices), triangles.corners), dark),
        )
    return placed_surfaces
