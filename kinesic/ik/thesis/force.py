"""Method 1: an outer force f = k (T - E) draws the end effector, and the springs draw the rest (Algorithm 1).

The thesis's text prints f = -k (T - E), which would push the hand away; its Algorithm 1 has the sign used here.
"""

import numpy as np

from kinesic.ik.thesis.springs import Springs
from kinesic.ik.thesis.task import Rest, Task
from kinesic.ik.thesis.verlet import swing_to_rest


def draw_by_force(task: Task) -> Rest:
    """Draws the free end of a chain to its target.

    The outer force is that of a spring without length between the end effector and the target, as stiff as the last
    bone: so the loop is that of method 2 with one spring more.
    """
    bones = len(task.rests)
    springs = Springs.between(
        [(k, k + 1) for k in range(bones + 1)],
        rests=np.append(task.rests, 0.0),
        stiffness=np.append(task.stiffness, task.stiffness[-1]),
        masses=np.append(task.masses, 1.0),
        pinned={0, bones + 1},
    )
    rest = swing_to_rest(
        springs,
        np.vstack([task.points, task.target]),
        damping=task.damping,
        effort=task.effort,
        arrived=lambda points: task.arrived(points[:-1]),
    )
    return Rest(rest.points[:-1], rest.iterations, rest.energy)
