"""Robots with fewer or more joints, derived from the supplied robots."""

from collections.abc import Iterator

import msgspec

from kinesic.body.config import locate_config
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import HingeTable, MountTable, RobotFile

# (body, chain) pairs that are removed from upper22 one after another.
REMOVABLE_PARTS = (("skullbase", "neck"), ("vl5", "torso"), ("l_sternoclavicular", "clavicles"))
FOREARM_ENDINGS = ("_elbow_twisting", "_wrist_flexion", "_wrist_pivot")  # name endings of joints distal to the elbow
FINGER_SERVO = "xc330_t181"  # servo that drives a joint in place of a linkage


def make_robots() -> Iterator[Robot]:
    """Yield robots with increasing numbers of joints.

    They are upper22 without parts and whole, upper36, and upper36 with all joints driven. The smallest has only
    shoulders and elbows.
    """
    path = locate_config("robot", "upper22")
    file = read_robot(path, RobotFile)
    files = [file]
    for body, chain in REMOVABLE_PARTS:
        files.insert(0, _without(files[0], body, chain))
    files.insert(
        0, _without_joints(files[0], {hinge.name for hinge in files[0].hinge if hinge.name.endswith(FOREARM_ENDINGS)})
    )
    yield from (Robot.of(robot_from_tables(table, path)) for table in files)
    path = locate_config("robot", "upper36")
    whole = read_robot(path, RobotFile)
    yield from (Robot.of(robot_from_tables(table, path)) for table in (whole, _with_all_driven(whole)))


def _without(file: RobotFile, body: str, chain: str) -> RobotFile:
    """Return a robot file without one chain and one body's joints."""
    chains = {name: [part for part in bodies if part != body] for name, bodies in file.chains.items() if name != chain}
    reduced = _without_joints(file, {hinge.name for hinge in file.hinge if hinge.body == body})
    return msgspec.structs.replace(reduced, chains=chains)


def _without_joints(file: RobotFile, names: set[str]) -> RobotFile:
    """Remove the named joints from a robot file."""
    remaining = [hinge for hinge in file.hinge if hinge.name not in names]
    rest = {name: angle for name, angle in file.rest.items() if name not in names}
    return msgspec.structs.replace(file, hinge=remaining, rest=rest)


def _with_all_driven(file: RobotFile) -> RobotFile:
    """Give each coupled joint a servo of its own."""
    drives = [
        HingeTable(
            joint.name,
            joint.body,
            joint.axis,
            joint.range_deg,
            servo=FINGER_SERVO,
            mount=MountTable("l_elbow", (0, 0, -0.1)),
        )
        for joint in file.coupling
    ]
    return msgspec.structs.replace(file, hinge=[*file.hinge, *drives], coupling=[])
