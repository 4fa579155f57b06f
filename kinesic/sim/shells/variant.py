"""Shell of a robot whose file extends that of another robot.

Segments that both describe alike have the surface of the extended robot. The others are built from the description.
"""

from collections.abc import Iterator
from functools import lru_cache

from kinesic.body.robot import Robot
from kinesic.body.robot_extension import find_extended
from kinesic.sim.shells.shell import Shell, describe_segments, fingerprint, load_shell

CACHED_VARIANTS = 4  # shells of variants kept in memory


def find_shell(robot: Robot) -> Shell | None:
    """Return the shell that is drawn on a robot, or None.

    It is read from the robot's own file, or adapted from that of the robot which it extends.

    Raises:
        ConfigError: a file is broken.
    """
    shell = load_shell(robot)
    if shell is not None or robot.skin is not None or not robot.path.is_file():
        return shell
    return _adapt_extended(robot)


@lru_cache(maxsize=CACHED_VARIANTS)
def _adapt_extended(robot: Robot) -> Shell | None:
    path = find_extended(robot.path)
    if path is None:
        return None
    extended = Robot.load(path, calibrated=False)
    shell = find_shell(extended)
    return None if shell is None else adapt_shell(shell, extended, robot)


def adapt_shell(shell: Shell, extended: Robot, robot: Robot) -> Shell:
    """Adapt the shell of a robot to another robot that extends it.

    Surfaces are built anew where the robots differ.

    Args:
        shell: shell of the extended robot.
        extended: robot whose file the other one extends.
        robot: robot that gets the shell.
    """
    old, new = describe_segments(extended), describe_segments(robot)
    changed = {name for name in old.keys() | new.keys() if old.get(name) != new.get(name)}
    if not changed:
        return Shell(shell.segments, fingerprint(robot))
    # slow to import, and unused by robots with a shell of their own
    from kinesic.sim.shells.bake import make_surface  # noqa: PLC0415
    from kinesic.sim.shells.housing import housings  # noqa: PLC0415

    redrawn = {surface for name in changed for side in (extended, robot) for surface in _touch(side, name)}
    surfaces = {name: surface for name, surface in shell.segments.items() if name in new and name not in redrawn}
    for name, housing in housings(robot):
        if name not in surfaces:
            surfaces[name] = make_surface(housing)
    return Shell({name: surfaces[name] for name in new if name in surfaces}, fingerprint(robot))


def _touch(robot: Robot, name: str) -> Iterator[str]:
    """Yield the segments whose surfaces a changed segment affects."""
    segments = {segment.name: segment for segment in robot.skeleton.segments}
    moving = {hinge.segment for hinge in robot.skeleton.hinges}
    moving |= {coupling.segment for coupling in robot.skeleton.couplings}
    if name not in segments:
        return
    yield from (child.name for child in segments.values() if child.parent == name)
    carrier: str | None = name
    while carrier is not None:
        yield carrier
        if carrier in moving and carrier != name:
            return
        carrier = segments[carrier].parent
