"""Shell design: solids, dark regions and panel lines of each segment.

All of it follows from the description: shapes and servos are enclosed, limbs taper from joint to joint, the trunk is as
wide and as deep at each height as its shapes, and the head has a front that fits a curved screen. Segments without a
hinge between them have one common surface, that of the segment nearest to the root.
"""

from collections.abc import Iterator

from kinesic.body.robot import SIDES, Robot
from kinesic.body.skeleton import Segment
from kinesic.sim.shells.distance import blended_union
from kinesic.sim.shells.limbs import finger, hand, limb
from kinesic.sim.shells.part import BLEND_RADIUS, TRIANGLE_BUDGET, Housing, ShellPart, enclose_capsule, enclose_in_box
from kinesic.sim.shells.trunk import head, trunk


def housings(robot: Robot) -> Iterator[tuple[str, Housing]]:
    """Yield name and housing of each segment with its own surface."""
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


def design_plain_housing(robot: Robot, segment: Segment) -> Housing:
    """Return a smooth housing around a segment's shapes and servos."""
    part = ShellPart(robot, segment)
    solids = [*(enclose_capsule(c) for c in part.capsules), *(enclose_in_box(servo) for servo in part.servos)]
    return Housing(blended_union(solids, BLEND_RADIUS), None, (), part.extreme_points, TRIANGLE_BUDGET["limb"])
