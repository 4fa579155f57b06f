"""Shell meshes in the MuJoCo model, drawn instead of capsules and servos."""

from collections.abc import Mapping

import mujoco
import numpy as np

from kinesic.body.robot import Robot
from kinesic.sim.model import capsule_name
from kinesic.sim.shells.shell import Corners, SegmentShell, Shell

SHELL_GROUP = 2  # MuJoCo geom group of the shell's meshes
INVISIBLE_COLOUR = (0.0, 0.0, 0.0, 0.0)  # RGBA colour that hides shapes inside the shell
Colour = tuple[float, ...]


def add_shell(spec: mujoco.MjSpec, robot: Robot, shell: Shell, *, colours: Mapping[str, Colour], joint: Colour) -> None:
    """Add a shell's massless meshes and hide all capsules and servos.

    Args:
        spec: Model that is changed.
        robot: Robot of the model.
        shell: Shell of the robot.
        colours: Segment -> colour of its housing.
        joint: Colour of joints and panel lines.
    """
    for segment in robot.skeleton.segments:
        for k in range(len(segment.capsules)):
            spec.geom(capsule_name(segment.name, k)).rgba = INVISIBLE_COLOUR
    for name in robot.skeleton.names:
        spec.geom(f"{name}_servo").rgba = INVISIBLE_COLOUR
    for name, surface in shell.segments.items():
        for kind, corners, colour in (("shell", surface.shell, colours[name]), ("joint", surface.joint, joint)):
            if len(corners):
                _add_surface(spec, name, f"{name}_{kind}", _extract_triangles(surface, corners), colour)


def _extract_triangles(surface: SegmentShell, corners: Corners) -> SegmentShell:
    """Return the given triangles with only the vertices that they use."""
    used_vertices, new_indices = np.unique(corners, return_inverse=True)
    triangles = new_indices.reshape(-1, 3).astype(np.uint16)
    return SegmentShell(surface.vertices[used_vertices], surface.normals[used_vertices], triangles, triangles[:0])


def _add_surface(spec: mujoco.MjSpec, segment: str, name: str, surface: SegmentShell, colour: Colour) -> None:
    faces = surface.shell.astype(np.int32).ravel()
    spec.add_mesh(
        name=name,
        uservert=surface.vertices.ravel(),
        usernormal=surface.normals.ravel(),
        userface=faces,
        userfacenormal=faces,
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    spec.body(segment).add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        rgba=colour,
        group=SHELL_GROUP,
        mass=0,
        contype=0,
        conaffinity=0,
    )
