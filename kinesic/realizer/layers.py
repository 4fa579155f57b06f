"""One block's motion laid over what runs: movements of the trunk add up, hands go from one work to the next."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.transition import SAME, excesses, lengthened
from kinesic.planning.setup import Facts
from kinesic.realizer.adding import added
from kinesic.realizer.busy import ARMS, arm
from kinesic.realizer.handing import handed
from kinesic.realizer.work import Failed, Work

KEPT = 1.0 + 1e-6  # share of a limit


def laid(work: Work, facts: Facts, limits: Limits) -> Floats | Failed:
    """Both together, at rest in the end.

    Args:
        work: what is laid over what.
        facts: the robot.
        limits: of its hinges.

    Returns:
        (k + 3, n) [rad] control points, the same as what runs until the cut; or a behaviour that has no way.
    """
    arms = {hinge: role for role in ARMS for hinge in arm(role, facts.robot)}
    names = facts.robot.skeleton.names
    found = added(work, np.isin(np.arange(len(names)), list(arms)), limits, names)
    if isinstance(found, Failed):
        return found
    columns = [found[:, hinge] for hinge in range(found.shape[1])]
    for hinge, role in arms.items():
        column = handed(work, role, hinge, limits)
        if isinstance(column, Failed):
            return column
        columns[hinge] = column
    count = max(map(len, columns)) + 1
    whole = np.stack([np.pad(column, (0, count - len(column)), mode="edge") for column in columns], axis=1)
    changed = np.flatnonzero((np.abs(whole - lengthened(work.base, count)) > SAME).any(axis=0))
    over = changed[excesses(whole[work.cut :, changed], limits.part(changed)) > KEPT]
    if len(over):
        return work.blamed(f"{names[over[0]]} cannot do both within its limits")
    return whole
