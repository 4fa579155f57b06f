"""Joint positions of a chain by masses and springs (thesis 7.3.1).

Everything inside is in units of the chain's length, so that the result does not depend on the unit of the skeleton.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi, sqrt

from kinesic.ik.angles import cosine_sine
from kinesic.ik.scalar3 import Vector, across, clamp_to_reach, cross, minus, norm, plus, scaled, unit

TOLERANCE = 1e-6  # [stiffness x chain length] total spring force at rest
MAX_ITERATIONS = 300  # largest number of iterations
SWIVEL_ITERATIONS = 16  # iterations after which a single free mass no longer changes its side
DAMPING_FRACTION = 0.75  # damping / theoretical optimum, because bends add slower modes
PARALLEL_SINE = 1e-4  # sine of the angle below which bones count as collinear
NUDGE_DISTANCE = 0.02  # [chain lengths] sideways displacement that bends a straight chain


@dataclass(frozen=True)
class Settled:
    """Spring masses after relaxation."""

    points: tuple[Vector, ...]  # [m] n + 1 positions; the first mass is fixed at the base, the last one at the target
    iterations: int
    energy: float  # sum of the forces on the free masses, in units of stiffness x chain length


def settle_masses(
    points: Sequence[Vector], lengths: Sequence[float], target: Vector, *, rounds: int = MAX_ITERATIONS
) -> Settled:
    """Relax a chain of unit masses between base and target.

    Stiffness and damping are those of heavy-ball theory for the springs' Laplacian; they depend on the number of
    bones alone, so nothing has to be tuned.

    Args:
        points: [m] n + 1 joint centres to begin with; the first stays.
        lengths: [m] n rest lengths.
        target: [m] of the last point; clamped to the sum of the lengths.
        rounds: after which they are left where they are.
    """
    size = sum(lengths)
    base, pinned = points[0], clamp_to_reach(target, points[0], size)
    rests = [length / size for length in lengths]
    masses = [scaled(minus(point, base), 1.0 / size) for point in points]
    masses[-1] = scaled(minus(pinned, base), 1.0 / size)
    masses = _bent(masses)
    stiffness, momentum = _tuned(len(rests))
    before, energy, iterations = list(masses), 0.0, 0
    for iterations in range(rounds + 1):
        forces = _forces(masses, rests)
        energy = sum(norm(force) for force in forces)
        if energy < TOLERANCE or iterations == rounds:
            break
        for i, force in enumerate(forces, 1):
            now = masses[i]
            masses[i] = plus(now, plus(scaled(minus(now, before[i]), momentum), scaled(force, stiffness)))
            before[i] = now
    ends = [plus(base, scaled(mass, size)) for mass in masses[1:-1]]
    return Settled((base, *ends, pinned), iterations, energy)


def _tuned(bones: int) -> tuple[float, float]:
    """Return stiffness x dt^2 and momentum of the optimal heavy-ball method."""
    slow, fast = (sqrt(2.0 - 2.0 * cosine_sine(pi * bends / bones)[0]) for bends in (1, bones - 1))
    share = (fast - slow) / (fast + slow)
    return 4.0 / ((fast + slow) * (fast + slow)), 1.0 - DAMPING_FRACTION * (1.0 - share * share)


def _forces(masses: Sequence[Vector], rests: Sequence[float]) -> list[Vector]:
    """Return the spring forces on the free masses, per stiffness."""
    pulls = []
    for near, far, rest in zip(masses, masses[1:], rests, strict=False):
        stretch = minus(far, near)
        length = norm(stretch)
        pulls.append(scaled(stretch, 1.0 - rest / length) if length > 0.0 else (0.0, 0.0, -rest))
    return [minus(after, before) for before, after in pairwise(pulls)]


def _bent(masses: list[Vector]) -> list[Vector]:
    """Return the masses, displaced sideways if they are collinear."""
    line = unit(minus(masses[-1], masses[0]))
    if line == (0.0, 0.0, 0.0):
        line = unit(minus(masses[1], masses[0]))
    if any(norm(cross(line, minus(mass, masses[0]))) > PARALLEL_SINE for mass in masses[1:-1]):
        return masses
    sag = across((0.0, 0.0, -1.0), line)
    aside = unit(sag if norm(sag) > PARALLEL_SINE else across((-1.0, 0.0, 0.0), line))
    return [masses[0], *(plus(mass, scaled(aside, NUDGE_DISTANCE)) for mass in masses[1:-1]), masses[-1]]
