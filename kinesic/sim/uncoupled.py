"""Robot without coupled joints, as used by the physics."""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule, Segment


def uncouple(robot: Robot) -> Robot:
    """Return the robot with coupled segments merged into their parents.

    Only segments without a hinge of their own are merged.
    Their inertia is a hundredth of the reflected rotor inertia of a drive, so the error is negligible.
    """
    skeleton = robot.skeleton
    if not skeleton.couplings:
        return robot
    driven = {hinge.segment for hinge in skeleton.hinges}
    folded = {coupling.segment for coupling in skeleton.couplings} - driven
    locations: dict[
        str, tuple[str, Floats]
    ] = {}  # segment -> containing segment, and the position [m] of its origin there
    kept: dict[str, Segment] = {}
    for segment in skeleton.segments:
        if segment.name in folded and segment.parent is not None:
            carrier, place = locations[segment.parent]
            locations[segment.name] = carrier, place + segment.origin_in_parent
            kept[carrier] = _merge_fixed_part(kept[carrier], segment, locations[segment.name][1])
        else:
            locations[segment.name] = segment.name, np.zeros(3)
            kept[segment.name] = segment
            if segment.parent is not None:
                carrier, place = locations[segment.parent]
                origin = sealed(place + segment.origin_in_parent)
                kept[segment.name] = replace(segment, parent=carrier, origin_in_parent=origin)
    return replace(
        robot,
        skeleton=replace(skeleton, segments=tuple(kept.values()), couplings=()),
        mounts=tuple(
            replace(m, segment=locations[m.segment][0], position=sealed(locations[m.segment][1] + m.position))
            for m in robot.mounts
        ),
        sites={
            name: replace(s, segment=locations[s.segment][0], position=sealed(locations[s.segment][1] + s.position))
            for name, s in robot.sites.items()
        },
        chains={name: tuple(part for part in parts if part in kept) for name, parts in robot.chains.items()},
    )


def _merge_fixed_part(carrier: Segment, part: Segment, place: Floats) -> Segment:
    """Return a segment merged with a part that is fixed to it."""
    capsules = (Capsule(sealed(place + c.start), sealed(place + c.end), c.radius) for c in part.capsules)
    return replace(carrier, mass=carrier.mass + part.mass, capsules=(*carrier.capsules, *capsules))
