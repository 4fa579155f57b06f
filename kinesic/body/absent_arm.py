"""Fixed frames in place of an arm that a robot lacks.

Gesture space, gaze and posture refer to both shoulders. A robot with one arm therefore gets the mirror image of its
segments on the other side, without hinges, mass and shape: nothing moves, collides or is drawn there.
"""

import msgspec

from kinesic.body.robot_mirror import mirror_body, mirror_name, mirror_site
from kinesic.body.robot_schema import MirrorTable, RobotFile

ARM_CHAINS = ("l_arm", "r_arm")  # names of the chains of both arms


def with_absent_arm(file: RobotFile) -> RobotFile:
    """Add fixed segments for the missing arm of a one-armed robot.

    A robot with both arms, or without any, is returned unchanged.
    """
    described = [chain for chain in ARM_CHAINS if chain in file.chains]
    if len(described) != 1 or f"{described[0][0]}_palm" not in file.sites:
        return file
    (chain,) = described
    mirror = MirrorTable("l_", "r_") if chain == "l_arm" else MirrorTable("r_", "l_")
    parents = {body.name: body.parent for body in file.body}
    mirrored = set(file.chains[chain])
    for name in file.chains[chain]:
        while (name := parents.get(name, "")).startswith(mirror.source):
            mirrored.add(name)
    missing = [body for body in file.body if body.name in mirrored and mirror_name(body.name, mirror) not in parents]
    palm = f"{mirror.source}palm"
    return msgspec.structs.replace(
        file,
        body=[
            *file.body,
            *(msgspec.structs.replace(mirror_body(body, mirror), mass=0.0, capsules=[]) for body in missing),
        ],
        chains=file.chains | {mirror_name(chain, mirror): [mirror_name(name, mirror) for name in file.chains[chain]]},
        sites={mirror_name(palm, mirror): mirror_site(file.sites[palm], mirror)} | file.sites,
    )
