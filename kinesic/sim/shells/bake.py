"""Bakes the shell of a robot: reads its TOML, writes NAME.npz beside it.

Run by whoever changes a robot's shape, as `python -m kinesic.sim.shells.bake upper22 my_robot.toml`; nothing imports
this at run time. Until then the robot is drawn as its capsules.
"""

import sys

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Segment
from kinesic.sim.shells.distance import DistanceField, gradient
from kinesic.sim.shells.housing import housings, plain_housing
from kinesic.sim.shells.part import LINE, Housing
from kinesic.sim.shells.shell import SUFFIX, SegmentShell, Shell, fingerprint, write_shell
from kinesic.sim.shells.surface import cut, mesh_of


def bake_shell(robot: Robot) -> Shell:
    """Makes the shell of a robot."""
    return Shell({name: _surface(housing) for name, housing in housings(robot)}, fingerprint(robot))


def bake_segment(robot: Robot, segment: Segment) -> SegmentShell:
    """Makes the surface of one segment, of its shapes and servos alone."""
    return _surface(plain_housing(robot, segment))


def _surface(housing: Housing) -> SegmentShell:
    low, high = housing.held.min(axis=0) - 0.02, housing.held.max(axis=0) + 0.02
    mesh = mesh_of(housing.solid, low, high, most=housing.triangles)
    edges = [shifted for line in housing.lines for shifted in _edges(line)]
    mesh = cut(mesh, housing.solid, [*([] if housing.dark is None else [housing.dark]), *edges])
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    dark = np.zeros(len(middles), dtype=bool) if housing.dark is None else housing.dark(middles) < 0.0
    for line in housing.lines:
        dark |= np.abs(line(middles)) < LINE / 2
    normals = gradient(housing.solid, mesh.vertices)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    corners = mesh.triangles.astype(np.uint16)
    return SegmentShell(sealed(mesh.vertices), sealed(normals), corners[~dark], corners[dark])


def _edges(line: DistanceField) -> tuple[DistanceField, DistanceField]:
    return lambda points: line(points) - LINE / 2, lambda points: line(points) + LINE / 2


def main(names: list[str]) -> None:
    """Bakes the robots of these names or files."""
    for name in names:
        robot = Robot.load(name, calibrated=False)
        shell, out = bake_shell(robot), robot.path.with_suffix(SUFFIX)
        write_shell(shell, out)
        count = sum(len(surface.triangles) for surface in shell.segments.values())
        sys.stdout.write(f"{out}: {len(shell.segments)} surfaces, {count} triangles, {out.stat().st_size} bytes\n")


if __name__ == "__main__":
    main(sys.argv[1:])
