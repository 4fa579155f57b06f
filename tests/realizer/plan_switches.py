"""Small motions on which a running block changes to a new plan."""

from dataclasses import replace

import numpy as np

from kinesic.motion.trajectory import Trajectory
from kinesic.planning.plan import Plan
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.replan import _PlanSwitch

HINGE_COUNT = 22
NECK = 3  # index of a neck hinge whose rest angle is 0
NO_HINGES = np.zeros(HINGE_COUNT, dtype=np.bool_)


def motion(count: int = 100, *, start: float = 0.0, **angles: float) -> Trajectory:
    """Return a motion at rest, with constant angles [rad] of hinges `h3`."""
    controls = np.zeros((count, HINGE_COUNT))
    for name, angle in angles.items():
        controls[:, int(name[1:])] = angle
    return Trajectory(controls, 0.0, start)


def use(id: str, *roles: str, begin=0.0, ready=0.1, relax=0.2, end=0.3, offset=None) -> Occupancy:
    return Occupancy(id, frozenset(roles), NO_HINGES, begin, ready, relax, end, offset)


def merged(*, zero=0.5, layer=None, occupancy=(), syncs=(), dropped=()) -> MergedMotion:
    layer = motion() if layer is None else layer
    return MergedMotion(motion(), zero, layer, tuple(occupancy), tuple(syncs), tuple(dropped), ())


def switched(plan: Plan, **changes) -> _PlanSwitch:
    """Return a transition at knot 20 of a motion that starts with its plan."""
    playing = changes.pop("playing", merged(zero=plan.trajectory.zero))
    whole = _PlanSwitch(motion(), 20, playing, plan.trajectory.zero, (), plan, ())
    return replace(whole, **changes)
