"""Masses joined by springs, whatever their pattern: Hooke's law, and the step that settles them fastest.

Lengths are in units of the chain, time in units that the stiffness and the masses set.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats

SHORT = 10  # masses that move; least mean iterations for these
STEP_SHARES = (1.0, 0.84)  # of the theory's time step, short and long; nearer, pressed long rows swing for ever
DAMPING_SHARES = (0.75, 0.5)  # of its damping: bends swing slower than the stretching that the theory sees
NO_LENGTH = 1e-12  # a spring pressed to nothing keeps a finite force


@dataclass(frozen=True, eq=False)
class Springs:
    """p masses and m springs."""

    incidence: Floats  # (m, p) each row -1 at the spring's near mass and +1 at its far one
    rests: Floats  # (m,) lengths at which the springs are at rest
    stiffness: Floats  # (m,)
    masses: Floats  # (p,)
    free: Flags  # (p,) the masses that may move

    @classmethod
    def between(
        cls, pairs: list[tuple[int, int]], *, rests: Floats, stiffness: Floats, masses: Floats, pinned: set[int]
    ) -> "Springs":
        """Joins pairs of masses by springs; the pinned masses stay where they are."""
        incidence = np.zeros((len(pairs), len(masses)))
        for row, (near, far) in enumerate(pairs):
            incidence[row, near], incidence[row, far] = -1.0, 1.0
        return cls(incidence, rests, stiffness, masses, np.array([mass not in pinned for mass in range(len(masses))]))

    def forces(self, points: Floats) -> Floats:
        """Sums the forces on each mass, (p, 3) (eq. 7.3.1 and 7.3.2); zero on the pinned ones."""
        stretches = self.incidence @ points
        lengths = np.sqrt((stretches * stretches).sum(axis=1))
        pulls = (self.stiffness * (1.0 - self.rests / np.maximum(lengths, NO_LENGTH)))[:, None] * stretches
        forces: Floats = -(self.incidence.T @ pulls)
        forces[~self.free] = 0.0
        return forces

    def energy(self, forces: Floats) -> float:
        """Sums the sizes of the forces, per unit of mean stiffness: what Algorithm 1 calls energy."""
        return float(np.sqrt((forces * forces).sum(axis=1)).sum() / self.stiffness.mean())

    @property
    def advised(self) -> tuple[float, float]:
        """Time step and share of speed lost per step in use: the theoretical ones, cut, and more so for long chains."""
        long = int(self.free.sum()) > SHORT
        step, loss = self.pace
        return STEP_SHARES[long] * step, DAMPING_SHARES[long] * loss

    @cached_property
    def pace(self) -> tuple[float, float]:
        """Time step and share of speed lost per step at which the slowest and the fastest swing settle alike.

        Heavy-ball theory for the springs' Laplacian, whose extreme eigenvalues are m and L:
        dt^2 = 4 / (sqrt L + sqrt m)^2, loss = 1 - ((sqrt L - sqrt m) / (sqrt L + sqrt m))^2.
        For n like springs between two pins m = 2 - 2 cos(pi / n) and L = 2 - 2 cos(pi (n - 1) / n).
        """
        scaled = np.sqrt(self.stiffness)[:, None] * self.incidence[:, self.free] / np.sqrt(self.masses[self.free])
        if not scaled.size:
            return 1.0, 1.0
        values = np.sqrt(np.maximum(0.0, np.linalg.eigvalsh(scaled.T @ scaled)))
        slow, fast = float(values[0]), float(values[-1])
        return 2.0 / (fast + slow), 1.0 - ((fast - slow) / (fast + slow)) ** 2
