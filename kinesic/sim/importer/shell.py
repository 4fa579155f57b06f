"""Shell of an imported robot from its meshes or capsules."""

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.robot import Robot
from kinesic.sim.importer.convert import Mapped
from kinesic.sim.importer.mesh_file import Triangles, simplify
from kinesic.sim.importer.model_tree import Surface
from kinesic.sim.importer.segments import assign_parts, lay_out_segments
from kinesic.sim.shells.bake import bake_segment
from kinesic.sim.shells.shell import SegmentShell, Shell, fingerprint

MAX_SEGMENT_TRIANGLES = 3000  # largest number of triangles per segment
MAX_ROBOT_TRIANGLES = 30_000  # largest number of triangles of a robot's shell
DEGENERATE_AREA = 1e-11  # [m^2] twice the area below which a triangle is removed
CREASE_COSINE = 0.6  # cosine of the angle between face normals below which an edge is sharp


def build_imported_shell(mapped: Mapped, robot: Robot) -> Shell | None:
    """Create the shell of an imported robot, or return None.

    Args:
        mapped: Converted robot.
        robot: The same robot, read from its TOML file.

    Returns:
        None if the imported file has no readable meshes.
    """
    layout = lay_out_segments(mapped.figure, mapped.hinges)
    carried = assign_parts(mapped.figure, layout, mapped.hinges)
    surfaces_by_segment = {
        name: mapped.figure.tree.merge_parts(parts).surfaces for name, parts in carried.items() if parts
    }
    if not any(surfaces_by_segment.values()):
        return None
    max_triangles = min(MAX_SEGMENT_TRIANGLES, MAX_ROBOT_TRIANGLES // max(len(surfaces_by_segment), 1))
    surfaces: dict[str, SegmentShell] = {}
    for segment in robot.skeleton.segments:
        if meshes := surfaces_by_segment.get(segment.name):
            surfaces[segment.name] = _join_surfaces(meshes, layout.origins[segment.name], max_triangles)
        elif segment.capsules:
            surfaces[segment.name] = bake_segment(robot, segment)
    return Shell(surfaces, fingerprint(robot))


def _join_surfaces(surfaces: tuple[Surface, ...], origin: Floats, max_triangles: int) -> SegmentShell:
    """Merge the surfaces of one segment into a mesh.

    Args:
        surfaces: in world coordinates at zero angles.
        origin: (3,) [m] of the segment in the world; vertices of the mesh are relative to it.
        max_triangles: total number to which surfaces are simplified.
    """
    total = sum(len(surface.mesh.corners) for surface in surfaces)
    vertices, normals, start = list[Floats](), list[Floats](), 0
    light, dark = list[Indices](), list[Indices]()
    for surface in surfaces:
        budget = max(max_triangles * len(surface.mesh.corners) // total, 1) if total > max_triangles else max_triangles
        places, directions, corners = split_creases(simplify(surface.mesh, budget))
        vertices.append(places - origin)
        normals.append(directions)
        (dark if surface.dark else light).append(corners + start)
        start += len(places)
    group_normals = (np.concatenate([*normal, np.empty((0, 3))]).astype(np.uint16) for normal in (light, dark))
    return SegmentShell(sealed(np.concatenate(vertices)), sealed(np.concatenate(normals)), *group_normals)


def split_creases(mesh: Triangles) -> tuple[Floats, Floats, Indices]:
    """Split vertices at sharp edges and compute vertex normals.

    Returns:
        Vertices (v, 3) [m], normals (v, 3) and triangles (t, 3).
    """
    a, b, c = (mesh.vertices[mesh.corners[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    flat = np.linalg.norm(areas, axis=1) < DEGENERATE_AREA
    if flat.any():
        return split_creases(Triangles(mesh.vertices, mesh.corners[~flat]))
    faces = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-12)
    vertex, face = mesh.corners.ravel(), np.repeat(np.arange(len(mesh.corners)), 3)
    group = _assign_normals(vertex, faces[face])
    keys, placed = np.unique(np.stack([vertex, group], axis=1), axis=0, return_inverse=True)
    placed = placed.ravel()
    sums = np.stack([np.bincount(placed, areas[face][:, k], len(keys)) for k in range(3)], axis=1)
    normals = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-12)
    return sealed(mesh.vertices[keys[:, 0]]), sealed(normals), placed.reshape(-1, 3)


def _assign_normals(vertex: Indices, faces: Floats) -> Indices:
    """Assign each triangle corner to a group of similar normals.

    A corner joins the first group whose first face normal is within the crease angle.
    """
    normals_by_vertex: dict[int, list[Floats]] = {}
    group_indices = np.zeros(len(vertex), dtype=np.intp)
    for k, vertex_index in enumerate(vertex.tolist()):
        group_normals = normals_by_vertex.setdefault(vertex_index, [])
        matches = [j for j, normal in enumerate(group_normals) if float(normal @ faces[k]) > CREASE_COSINE]
        if not matches:
            group_normals.append(faces[k])
        group_indices[k] = matches[0] if matches else len(group_normals) - 1
    return group_indices
