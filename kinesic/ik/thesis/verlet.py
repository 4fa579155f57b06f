"""Lets masses swing to rest by Stoermer-Verlet integration (eq. 7.3.6): the loop of Algorithm 1."""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.springs import Springs
from kinesic.ik.thesis.task import Effort, Rest

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
