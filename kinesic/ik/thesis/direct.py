"""Spring relaxation by solving linear systems (variant of thesis method 2).

The thesis integrates in time. But the springs of a chain only know their neighbours, so the correction that brings
all of them to rest together is one tridiagonal system (extended position-based dynamics: Macklin et al. 2016). It
has no step and no damping to choose.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.springs import MIN_SPRING_LENGTH
from kinesic.ik.thesis.task import Rest, Task

SPRING_COMPLIANCE = 1e-3  # regularisation of the spring equations for collinear bones


def balance_springs(task: Task) -> Rest:
    """Relax all masses by linear systems until bones have rest lengths.

    With the stretch c_j of bone j, its direction u_j and weights w = 1 / m (0 at the pinned ends), each step solves
    (w_j + w_j+1 + a / k_j) l_j - w_j u_j.u_j-1 l_j-1 - w_j+1 u_j.u_j+1 l_j+1 = c_j
    for the pulls l and moves mass i by w_i (l_i u_i - l_i-1 u_i-1).
    """
    weights = 1.0 / task.masses
    weights[0] = weights[-1] = 0.0
    springs = task.springs
    points = np.vstack([task.points[:-1], task.target])
    energy, done = springs.energy(springs.forces(points)), 0
    while energy > task.effort.threshold and done < task.effort.iterations and not task.arrived(points):
        points = points + _correction(points, task, weights)
        energy, done = springs.energy(springs.forces(points)), done + 1
    return Rest(points, done, energy)


def _correction(points: Floats, task: Task, weights: Floats) -> Floats:
    """Return point displacements (n + 1, 3) [m] towards the rest lengths."""
    bones = np.diff(points, axis=0)
    lengths = np.maximum(np.sqrt((bones * bones).sum(axis=1)), MIN_SPRING_LENGTH)
    along = bones / lengths[:, None]
    neighbours = -weights[1:-1] * (along[:-1] * along[1:]).sum(axis=1)
    system = np.diag(weights[:-1] + weights[1:] + SPRING_COMPLIANCE / task.stiffness)
    system += np.diag(neighbours, 1) + np.diag(neighbours, -1)
    pulls = np.linalg.solve(system, lengths - task.rests)[:, None] * along
    moves: Floats = np.zeros_like(points)
    moves[:-1] += pulls
    moves[1:] -= pulls
    return weights[:, None] * moves
