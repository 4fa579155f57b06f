"""The shell of a foreign robot: its own meshes, in the segments that kinesic moves; smooth housings for the others."""

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.robot import Robot
from kinesic.sim.importer.convert import Mapped
from kinesic.sim.importer.mesh_file import Triangles, simplify
from kinesic.sim.importer.model_tree import Surface
from kinesic.sim.importer.segments import carried_parts, lay_out_segments
from kinesic.sim.shells.bake import bake_segment
from kinesic.sim.shells.shell import SegmentShell, Shell, fingerprint

MOST_TRIANGLES = 3000  # of one segment
ALL_TRIANGLES = 30_000  # of a robot
FLAT = 1e-11  # [m^2] twice the area of a triangle that is none
CREASE = 0.6  # cosine of the angle between neighbours from which an edge is sharp


def own_shell(found: Mapped, robot: Robot) -> Shell | None:
    """Makes the shell of a robot that was imported; None where its file has no meshes that could be read.

    Args:
        found: what was imported.
        robot: the same one, as its TOML is read.
    """
    where = lay_out_segments(found.figure, found.hinges)
    carried = carried_parts(found.figure, where, found.hinges)
    seen = {name: found.figure.tree.lump(parts).surfaces for name, parts in carried.items() if parts}
    if not any(seen.values()):
        return None
    most = min(MOST_TRIANGLES, ALL_TRIANGLES // max(len(seen), 1))
    surfaces: dict[str, SegmentShell] = {}
    for segment in robot.skeleton.segments:
        if meshes := seen.get(segment.name):
            surfaces[segment.name] = _joined(meshes, where.origins[segment.name], most)
        elif segment.capsules:
            surfaces[segment.name] = bake_segment(robot, segment)
    return Shell(surfaces, fingerprint(robot))


def _joined(surfaces: tuple[Surface, ...], origin: Floats, most: int) -> SegmentShell:
    """Surfaces in the world as one in its segment, with as many triangles as may be."""
    total = sum(len(surface.mesh.corners) for surface in surfaces)
    vertices, normals, start = list[Floats](), list[Floats](), 0
    light, dark = list[Indices](), list[Indices]()
    for surface in surfaces:
        share = max(most * len(surface.mesh.corners) // total, 1) if total > most else most
        places, directions, corners = creased(simplify(surface.mesh, share))
        vertices.append(places - origin)
        normals.append(directions)
        (dark if surface.dark else light).append(corners + start)
        start += len(places)
    kinds = (np.concatenate([*kind, np.empty((0, 3))]).astype(np.uint16) for kind in (light, dark))
    return SegmentShell(sealed(np.concatenate(vertices)), sealed(np.concatenate(normals)), *kinds)


def creased(mesh: Triangles) -> tuple[Floats, Floats, Indices]:
    """Gives vertices and their normals, several where edges are sharp, and the corners of triangles."""
    a, b, c = (mesh.vertices[mesh.corners[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    flat = np.linalg.norm(areas, axis=1) < FLAT
    if flat.any():
        return creased(Triangles(mesh.vertices, mesh.corners[~flat]))
    faces = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-12)
    vertex, face = mesh.corners.ravel(), np.repeat(np.arange(len(mesh.corners)), 3)
    group = _groups(vertex, faces[face])
    keys, placed = np.unique(np.stack([vertex, group], axis=1), axis=0, return_inverse=True)
    placed = placed.ravel()
    sums = np.stack([np.bincount(placed, areas[face][:, k], len(keys)) for k in range(3)], axis=1)
    normals = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-12)
    return sealed(mesh.vertices[keys[:, 0]]), sealed(normals), placed.reshape(-1, 3)


def _groups(vertex: Indices, faces: Floats) -> Indices:
    """Which normal of its vertex each corner takes: that of the first face there that is nearly as its own is."""
    known: dict[int, list[Floats]] = {}
    found = np.zeros(len(vertex), dtype=np.intp)
    for k, place in enumerate(vertex.tolist()):
        kinds = known.setdefault(place, [])
        alike = [j for j, kind in enumerate(kinds) if float(kind @ faces[k]) > CREASE]
        if not alike:
            kinds.append(faces[k])
        found[k] = alike[0] if alike else len(kinds) - 1
    return found
