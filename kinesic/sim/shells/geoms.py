"""Puts a shell into MuJoCo's model, in place of capsules, servos and rods."""

from collections.abc import Mapping

import mujoco
import numpy as np

from kinesic.body.robot import Robot
from kinesic.sim.model import capsule_name
from kinesic.sim.shells.shell import Corners, SegmentShell, Shell

GROUP = 2  # of shapes that are only seen
INVISIBLE = (0.0, 0.0, 0.0, 0.0)
Colour = tuple[float, ...]


def add_shell(spec: mujoco.MjSpec, robot: Robot, shell: Shell, *, colours: Mapping[str, Colour], joint: Colour) -> None:
    """Draws a robot in its shell: it weighs nothing, and what it hides is no longer drawn.

    Args:
        spec: that grows.
        robot: whose model it describes.
        shell: of the robot.
        colours: segment -> colour of its housing.
        joint: colour of what is dark.
    """
    for segment in robot.skeleton.segments:
        for k in range(len(segment.capsules)):
            spec.geom(capsule_name(segment.name, k)).rgba = INVISIBLE
    for name in robot.skeleton.names:
        spec.geom(f"{name}_servo").rgba = INVISIBLE
    for name, surface in shell.segments.items():
        for kind, corners, colour in (("shell", surface.shell, colours[name]), ("joint", surface.joint, joint)):
            if len(corners):
                _add_surface(spec, name, f"{name}_{kind}", _part(surface, corners), colour)


def _part(surface: SegmentShell, corners: Corners) -> SegmentShell:
    """The vertices that some triangles need, alone."""
    used, placed = np.unique(corners, return_inverse=True)
    triangles = placed.reshape(-1, 3).astype(np.uint16)
    return SegmentShell(surface.vertices[used], surface.normals[used], triangles, triangles[:0])


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
        group=GROUP,
        mass=0,
        contype=0,
        conaffinity=0,
    )
