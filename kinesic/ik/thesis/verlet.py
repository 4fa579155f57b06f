"""Relaxation of masses by Stoermer-Verlet integration (thesis Algorithm 1).

Method 1 draws the end effector by an outer force f = k (T - E), and the springs draw the rest. The thesis's text prints
f = -k (T - E), which would push the hand away; its Algorithm 1 has the sign used here. Method 2 puts the end effector
on its target at once, and the springs bring the joints along.
"""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.springs import Springs
from kinesic.ik.thesis.task import Effort, Rest, Task

DIVERGENCE_LIMIT = 1e6  # [chain lengths] sum of forces / stiffness above which integration has diverged


def swing_to_rest(
    springs: Springs, points: Floats, *, damping: float | None, effort: Effort, arrived: Callable[[Floats], bool]
) -> Rest:
    """Integrate damped masses until the spring forces vanish.

    The scheme is x' = x + (1 - c) (x - x_before) + dt^2 f / m. The thesis writes it without c, but undamped masses
    swing for ever; its damping factor beta of eq. 7.3.3 enters as c = beta dt / m.

    Args:
        springs: the system.
        points: (p, 3) initial positions, at rest.
        damping: c; None: as recommended.
        effort: when to stop.
        arrived: receives the points before each step; True ends the loop.
    """
    step, loss = springs.recommended_settings
    dt = step if effort.step is None else effort.step
    kept = 1.0 - (loss if damping is None else damping)
    gain = (dt * dt / springs.masses)[:, None]
    now = before = np.array(points)
    forces = springs.forces(now)
    energy, done = springs.energy(forces), 0
    while effort.threshold < energy < DIVERGENCE_LIMIT and done < effort.iterations and not arrived(now):
        now, before = now + kept * (now - before) + gain * forces, now
        forces = springs.forces(now)
        energy, done = springs.energy(forces), done + 1
    return Rest(now, done, energy)


def swing_pinned(task: Task) -> Rest:
    """Relax a chain with its hand fixed at the target (method 2)."""
    start = np.vstack([task.points[:-1], task.target])
    return swing_to_rest(task.springs, start, damping=task.damping, effort=task.effort, arrived=task.arrived)


def draw_by_force(task: Task) -> Rest:
    """Pull a chain's free hand to the target by force (method 1).

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
