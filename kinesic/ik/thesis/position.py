"""Method 2: the end effector is put on its target at once, and the springs bring the joints along (Algorithm 1)."""

import numpy as np

from kinesic.ik.thesis.springs import Springs
from kinesic.ik.thesis.task import Rest, Task
from kinesic.ik.thesis.verlet import swing_to_rest


def swing_pinned(task: Task) -> Rest:
    """Lets a chain swing to rest between its base and its target."""
    bones = len(task.rests)
    springs = Springs.between(
        [(k, k + 1) for k in range(bones)],
        rests=task.rests,
        stiffness=task.stiffness,
        masses=task.masses,
        pinned={0, bones},
    )
    start = np.vstack([task.points[:-1], task.target])
    return swing_to_rest(springs, start, damping=task.damping, effort=task.effort, arrived=task.arrived)
