"""Lets masses swing to rest by Stoermer-Verlet integration (eq. 7.3.6): the loop of Algorithm 1, by both its methods.

Method 1 draws the end effector by an outer force f = k (T - E), and the springs draw the rest. The thesis's text prints
f = -k (T - E), which would push the hand away; its Algorithm 1 has the sign used here. Method 2 puts the end effector
on its target at once, and the springs bring the joints along.
"""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.springs import Springs
from kinesic.ik.thesis.task import Effort, Rest, Task

EXPLODED = 1e6  # in chain lengths: the step lies beyond the stability bound


def swing_to_rest(
    springs: Springs, points: Floats, *, damping: float | None, effort: Effort, arrived: Callable[[Floats], bool]
) -> Rest:
    """Integrates x' = x + (1 - c) (x - x_before) + dt^2 f / m until the forces are gone.

    The thesis writes the scheme without c, but undamped masses swing for ever; its damping factor beta of eq. 7.3.3
    enters as c = beta dt / m.

    Args:
        springs: the system.
        points: (p, 3) to begin with, standing still.
        damping: c; None: as advised.
        effort: when to stop.
        arrived: told the points before each step, ends the loop early.
    """
    step, loss = springs.advised
    dt = step if effort.step is None else effort.step
    kept = 1.0 - (loss if damping is None else damping)
    gain = (dt * dt / springs.masses)[:, None]
    now = before = np.array(points)
    forces = springs.forces(now)
    energy, done = springs.energy(forces), 0
    while effort.threshold < energy < EXPLODED and done < effort.iterations and not arrived(now):
        now, before = now + kept * (now - before) + gain * forces, now
        forces = springs.forces(now)
        energy, done = springs.energy(forces), done + 1
    return Rest(now, done, energy)


def swing_pinned(task: Task) -> Rest:
    """Lets a chain swing to rest between its base and its target (method 2)."""
    start = np.vstack([task.points[:-1], task.target])
    return swing_to_rest(task.springs, start, damping=task.damping, effort=task.effort, arrived=task.arrived)


def draw_by_force(task: Task) -> Rest:
    """Draws the free end of a chain to its target (method 1).

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
