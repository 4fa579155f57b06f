"""Robots of fewer and of more hinges than any that comes with kinesic, made of those."""

from collections.abc import Iterator

import msgspec

from kinesic.body.config import locate
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import HingeTable, MountTable, RobotFile

PARTS = (("skullbase", "neck"), ("vl5", "torso"), ("l_sternoclavicular", "clavicles"))  # that a body can do without
FINGER = "xc330_t181"  # the servo that turns a joint in place of a linkage


def robots() -> Iterator[Robot]:
    """Yields robots with more and more hinges: upper22 without parts and whole, upper36, and all its joints driven."""
    path = locate("robot", "upper22")
    file = read_robot(path, RobotFile)
    made = [file]
    for body, chain in PARTS:
        made.insert(0, _without(made[0], body, chain))
    yield from (Robot.of(robot_from_tables(each, path)) for each in made)
    path = locate("robot", "upper36")
    whole = read_robot(path, RobotFile)
    yield from (Robot.of(robot_from_tables(each, path)) for each in (whole, _driven(whole)))


def _without(file: RobotFile, body: str, chain: str) -> RobotFile:
    """Makes the hinges of a body stiff."""
    chains = {name: [each for each in bodies if each != body] for name, bodies in file.chains.items() if name != chain}
    left = [hinge for hinge in file.hinge if hinge.body != body]
    names = {hinge.name for hinge in left}
    rest = {name: angle for name, angle in file.rest.items() if name in names}
    return msgspec.structs.replace(file, hinge=left, chains=chains, rest=rest)


def _driven(file: RobotFile) -> RobotFile:
    """Gives each joint that follows another one a servo of its own."""
    drives = [
        HingeTable(
            each.name, each.body, each.axis, each.range_deg, servo=FINGER, mount=MountTable("l_elbow", (0, 0, -0.1))
        )
        for each in file.coupling
    ]
    return msgspec.structs.replace(file, hinge=[*file.hinge, *drives], coupling=[])
