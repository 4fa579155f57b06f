"""The design of a robot's shells: which solids make up each segment, what of it is dark, and where its lines are.

Everything is derived from the description: shapes and servos are enclosed, limbs are tapered from joint to joint, the
trunk is as wide and as deep at each height as its shapes, the head has a front on which a curved screen can sit.
Segments that no hinge parts share one surface, that of the one nearest to the root.
"""

from collections.abc import Iterator

from kinesic.body.robot import SIDES, Robot
from kinesic.body.skeleton import Segment
from kinesic.sim.shells.distance import blended_union
from kinesic.sim.shells.limbs import finger, hand, limb
from kinesic.sim.shells.part import BLEND, BUDGET, Housing, ShellPart, boxed, own_shape
from kinesic.sim.shells.trunk import head, trunk


def housings(robot: Robot) -> Iterator[tuple[str, Housing]]:
    """Yields the housing of each segment that has one."""
    moving = {hinge.segment for hinge in robot.skeleton.hinges}
    moving |= {coupling.segment for coupling in robot.skeleton.couplings}
    skull = robot.chains.get("neck", ("",))[-1]
    fingers = {name for side in SIDES for name in robot.fingers(side)}
    hands = {robot.arm(side).segments[-1]: side for side in SIDES}
    arms = {name for side in SIDES for name in robot.arm(side).segments}
    for segment in robot.skeleton.segments:
        part = ShellPart(robot, segment)
        if not segment.capsules and not part.servos:
            continue
        if segment.name in fingers:
            yield segment.name, finger(part)
        elif segment.name in hands:
            yield segment.name, hand(part, robot.sites[f"{hands[segment.name]}_palm"].facing)
        elif segment.name in arms:
            yield segment.name, limb(part)
        elif segment.name == skull:
            yield segment.name, head(part)
        elif segment.parent is None or segment.name in moving:
            yield segment.name, trunk(part, moving | arms)


def plain_housing(robot: Robot, segment: Segment) -> Housing:
    """Encloses shapes and servos of a segment as they are, flowing into one another."""
    part = ShellPart(robot, segment)
    solids = [*(own_shape(c) for c in part.capsules), *(boxed(servo) for servo in part.servos)]
    return Housing(blended_union(solids, BLEND), None, (), part.held, BUDGET["limb"])
