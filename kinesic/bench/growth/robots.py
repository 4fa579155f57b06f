"""Robots of fewer and of more hinges than any that comes with kinesic, made of those."""

from collections.abc import Iterator

import msgspec

from kinesic.body.config import locate
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import HingeTable, MountTable, RobotFile

PARTS = (("skullbase", "neck"), ("vl5", "torso"), ("l_sternoclavicular", "clavicles"))  # that a body can do without
FOREARMS = ("_elbow_twisting", "_wrist_flexion", "_wrist_pivot")  # ends of names of hinges behind the elbow
FINGER = "xc330_t181"  # the servo that turns a joint in place of a linkage


def robots() -> Iterator[Robot]:
    """Yields robots with more and more hinges: upper22 without parts and whole, upper36, and all its joints driven.

    The least of them has shoulders and elbows alone.
    """
    path = locate("robot", "upper22")
    file = read_robot(path, RobotFile)
    made = [file]
    for body, chain in PARTS:
        made.insert(0, _without(made[0], body, chain))
    made.insert(0, _stiffened(made[0], {hinge.name for hinge in made[0].hinge if hinge.name.endswith(FOREARMS)}))
    yield from (Robot.of(robot_from_tables(each, path)) for each in made)
    path = locate("robot", "upper36")
    whole = read_robot(path, RobotFile)
    yield from (Robot.of(robot_from_tables(each, path)) for each in (whole, _driven(whole)))


def _without(file: RobotFile, body: str, chain: str) -> RobotFile:
    """Makes the hinges of a body stiff."""
    chains = {name: [each for each in bodies if each != body] for name, bodies in file.chains.items() if name != chain}
    stiff = _stiffened(file, {hinge.name for hinge in file.hinge if hinge.body == body})
    return msgspec.structs.replace(stiff, chains=chains)


def _stiffened(file: RobotFile, names: set[str]) -> RobotFile:
    """Makes some hinges stiff."""
    left = [hinge for hinge in file.hinge if hinge.name not in names]
    rest = {name: angle for name, angle in file.rest.items() if name not in names}
    return msgspec.structs.replace(file, hinge=left, rest=rest)


def _driven(file: RobotFile) -> RobotFile:
    """Gives each joint that follows another one a servo of its own."""
    drives = [
        HingeTable(
            each.name, each.body, each.axis, each.range_deg, servo=FINGER, mount=MountTable("l_elbow", (0, 0, -0.1))
        )
        for each in file.coupling
    ]
    return msgspec.structs.replace(file, hinge=[*file.hinge, *drives], coupling=[])
