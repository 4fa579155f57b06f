"""Program that builds a robot's shell and writes it to NAME.npz.

The shell is built from the robot's TOML file and stored next to it. Run
`python -m kinesic.sim.shells.bake upper22 my_robot.toml` after a change of a robot's shape. Without a current shell the
robot is drawn with its capsules, unless it extends a robot that has one.
"""

import sys

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Segment
from kinesic.sim.shells.distance import DistanceField, gradient
from kinesic.sim.shells.housing import design_plain_housing, housings
from kinesic.sim.shells.part import LINE_WIDTH, Housing
from kinesic.sim.shells.shell import SHELL_SUFFIX, SegmentShell, Shell, fingerprint, write_shell
from kinesic.sim.shells.surface import cut, triangulate


def bake_shell(robot: Robot) -> Shell:
    """Build the shell of a robot."""
    return Shell({name: make_surface(housing) for name, housing in housings(robot)}, fingerprint(robot))


def bake_segment(robot: Robot, segment: Segment) -> SegmentShell:
    """Build the surface of one segment from its shapes and servos alone."""
    return make_surface(design_plain_housing(robot, segment))


def make_surface(housing: Housing) -> SegmentShell:
    """Triangulate a housing and separate its light and dark triangles."""
    lower, upper = housing.extreme_points.min(axis=0) - 0.02, housing.extreme_points.max(axis=0) + 0.02
    mesh = triangulate(housing.solid, lower, upper, most=housing.triangles)
    edges = [shifted for line in housing.lines for shifted in _list_edges(line)]
    mesh = cut(mesh, housing.solid, [*([] if housing.dark is None else [housing.dark]), *edges])
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    dark = np.zeros(len(middles), dtype=bool) if housing.dark is None else housing.dark(middles) < 0.0
    for line in housing.lines:
        dark |= np.abs(line(middles)) < LINE_WIDTH / 2
    normals = gradient(housing.solid, mesh.vertices)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    corners = mesh.triangles.astype(np.uint16)
    return SegmentShell(sealed(mesh.vertices), sealed(normals), corners[~dark], corners[dark])


def _list_edges(line: DistanceField) -> tuple[DistanceField, DistanceField]:
    return lambda points: line(points) - LINE_WIDTH / 2, lambda points: line(points) + LINE_WIDTH / 2


def main(names: list[str]) -> None:
    """Build and write the shells of robots given by name or file."""
    for name in names:
        robot = Robot.load(name, calibrated=False)
        shell, out = bake_shell(robot), robot.path.with_suffix(SHELL_SUFFIX)
        write_shell(shell, out)
        count = sum(len(surface.triangles) for surface in shell.segments.values())
        sys.stdout.write(f"{out}: {len(shell.segments)} surfaces, {count} triangles, {out.stat().st_size} bytes\n")


if __name__ == "__main__":
    main(sys.argv[1:])
