"""Point masses joined by springs, with recommended time step and damping.

Lengths are in units of the chain, time in units that the stiffness and the masses set.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats

TUNED_MASSES = 10  # largest number of free masses of a chain that counts as short
STEP_FRACTIONS = (1.0, 0.84)  # time step / recommended step of `Springs.pace`, for short and long chains
DAMPING_FRACTIONS = (0.75, 0.5)  # damping / recommended damping of `Springs.pace`, for short and long chains
MIN_SPRING_LENGTH = 1e-12  # [chain lengths] lower bound on spring lengths in divisions


@dataclass(frozen=True, eq=False)
class Springs:
    """Network of p point masses and m springs."""

    incidence: Floats  # (m, p) each row -1 at the spring's near mass and +1 at its far one
    rests: Floats  # (m,) lengths at which the springs are at rest
    stiffness: Floats  # (m,)
    masses: Floats  # (p,)
    free: Flags  # (p,) the masses that may move

    @classmethod
    def between(
        cls, pairs: list[tuple[int, int]], *, rests: Floats, stiffness: Floats, masses: Floats, pinned: set[int]
    ) -> "Springs":
        """Make springs between pairs of masses, some of them pinned."""
        incidence = np.zeros((len(pairs), len(masses)))
        for row, (near, far) in enumerate(pairs):
            incidence[row, near], incidence[row, far] = -1.0, 1.0
        return cls(incidence, rests, stiffness, masses, np.array([mass not in pinned for mass in range(len(masses))]))

    def forces(self, points: Floats) -> Floats:
        """Return the force on each mass, (p, 3) (eq. 7.3.1 and 7.3.2)."""
        stretches = self.incidence @ points
        lengths = np.sqrt((stretches * stretches).sum(axis=1))
        pulls = (self.stiffness * (1.0 - self.rests / np.maximum(lengths, MIN_SPRING_LENGTH)))[:, None] * stretches
        forces: Floats = -(self.incidence.T @ pulls)
        forces[~self.free] = 0.0
        return forces

    def energy(self, forces: Floats) -> float:
        """Return summed force magnitudes / mean stiffness (Algorithm 1)."""
        return float(np.sqrt((forces * forces).sum(axis=1)).sum() / self.stiffness.mean())

    @property
    def recommended_settings(self) -> tuple[float, float]:
        """Recommended time step and damping: fractions of `pace`, by mass count."""
        long = int(self.free.sum()) > TUNED_MASSES
        step, loss = self.pace
        return STEP_FRACTIONS[long] * step, DAMPING_FRACTIONS[long] * loss

    @cached_property
    def pace(self) -> tuple[float, float]:
        """Time step and damping of fastest convergence in heavy-ball theory.

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
