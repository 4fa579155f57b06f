"""A robot without its couplings, as physics takes it: what they turn stands straight and belongs to what carries it."""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule, Segment


def uncouple(robot: Robot) -> Robot:
    """Folds segments that only couplings turn into those before them.

    What they weigh is a hundredth of what a drive feels of its own rotor, so that nothing but time is lost.
    """
    skeleton = robot.skeleton
    if not skeleton.couplings:
        return robot
    driven = {hinge.segment for hinge in skeleton.hinges}
    folded = {coupling.segment for coupling in skeleton.couplings} - driven
    home: dict[str, tuple[str, Floats]] = {}  # where each segment is kept, and where its origin is there
    kept: dict[str, Segment] = {}
    for segment in skeleton.segments:
        if segment.name in folded and segment.parent is not None:
            carrier, place = home[segment.parent]
            home[segment.name] = carrier, place + segment.origin_in_parent
            kept[carrier] = _carrying(kept[carrier], segment, home[segment.name][1])
        else:
            home[segment.name] = segment.name, np.zeros(3)
            kept[segment.name] = segment
            if segment.parent is not None:
                carrier, place = home[segment.parent]
                origin = sealed(place + segment.origin_in_parent)
                kept[segment.name] = replace(segment, parent=carrier, origin_in_parent=origin)
    return replace(
        robot,
        skeleton=replace(skeleton, segments=tuple(kept.values()), couplings=()),
        mounts=tuple(
            replace(m, segment=home[m.segment][0], position=sealed(home[m.segment][1] + m.position))
            for m in robot.mounts
        ),
        sites={
            name: replace(s, segment=home[s.segment][0], position=sealed(home[s.segment][1] + s.position))
            for name, s in robot.sites.items()
        },
        chains={name: tuple(part for part in parts if part in kept) for name, parts in robot.chains.items()},
    )


def _carrying(carrier: Segment, part: Segment, place: Floats) -> Segment:
    """A segment together with a part that is fixed to it."""
    capsules = (Capsule(sealed(place + c.start), sealed(place + c.end), c.radius) for c in part.capsules)
    return replace(carrier, mass=carrier.mass + part.mass, capsules=(*carrier.capsules, *capsules))
