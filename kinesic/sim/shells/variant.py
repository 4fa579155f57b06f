"""Shell of a robot that extends a base robot.

Segments keep the surface of the base robot, except those that differ and their neighbours, which get new housings.
"""

from collections.abc import Set
from functools import lru_cache

from kinesic.body.robot import Robot
from kinesic.body.robot_extension import find_extended
from kinesic.sim.shells.shell import Shell, describe_segments, fingerprint, load_shell

CACHED_VARIANTS = 4  # number of adapted shells kept in memory


def find_shell(robot: Robot) -> Shell | None:
    """Return the visible shell of a robot, or None.

    It is read from the robot's own shell file, or adapted from the shell of its base robot. A robot with a skin, or
    without shell and base, has none.

    Raises:
        ConfigError: a file is broken.
    """
    shell = load_shell(robot)
    if shell is not None or robot.skin is not None or not robot.path.is_file():
        return shell
    return _adapt_base_shell(robot)


@lru_cache(maxsize=CACHED_VARIANTS)
def _adapt_base_shell(robot: Robot) -> Shell | None:
    path = find_extended(robot.path)
    if path is None:
        return None
    base = Robot.load(path, calibrated=False)
    shell = find_shell(base)
    return None if shell is None else adapt_shell(shell, base, robot)


def adapt_shell(shell: Shell, base: Robot, robot: Robot) -> Shell:
    """Adapt a base robot's shell to a robot that extends it.

    Args:
        shell: shell of the base robot.
        base: robot whose file the other one extends.
        robot: robot that gets the shell.
    """
    old, new = describe_segments(base), describe_segments(robot)
    changed = {name for name in old.keys() | new.keys() if old.get(name) != new.get(name)}
    if not changed:
        return Shell(shell.segments, fingerprint(robot))
    # slow to import, and unused by robots with a shell of their own
    from kinesic.sim.shells.bake import make_surface  # noqa: PLC0415
    from kinesic.sim.shells.housing import housings  # noqa: PLC0415

    affected = _find_affected(base, changed) | _find_affected(robot, changed)
    surfaces = {name: surface for name, surface in shell.segments.items() if name in new and name not in affected}
    for name, housing in housings(robot):
        if name not in surfaces:
            surfaces[name] = make_surface(housing)
    return Shell({name: surfaces[name] for name in new if name in surfaces}, fingerprint(robot))


def _find_affected(robot: Robot, changed: Set[str]) -> set[str]:
    """Return the names of segments whose housings depend on changed segments.

    A housing reaches to the next segments, and up to the nearest one that a hinge moves.
    """
    segments = {segment.name: segment for segment in robot.skeleton.segments}
    moving = {hinge.segment for hinge in robot.skeleton.hinges}
    moving |= {coupling.segment for coupling in robot.skeleton.couplings}
    affected = {segment.name for segment in segments.values() if segment.parent in changed}
    for name in changed & segments.keys():
        affected.add(name)
        ancestor = segments[name].parent
        while ancestor is not None:
            affected.add(ancestor)
            ancestor = None if ancestor in moving else segments[ancestor].parent
    return affected
