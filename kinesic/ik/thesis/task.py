"""Input and result of the spring relaxation methods, in chain lengths."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.springs import MIN_SPRING_LENGTH, Springs


@dataclass(frozen=True)
class Effort:
    """Tolerances and iteration limits of the solver, in chain lengths."""

    tolerance: float = 1e-3  # distance from hand to target at which the reach is done; 0: only forces count
    threshold: float = 1e-6  # epsilon of Algorithm 1: sum of the forces per stiffness at which masses are at rest
    iterations: int = 300  # largest number of iterations in one relaxation
    rounds: int = 20  # largest number of rounds: relaxation and limits (Algorithm 3) or skeleton (Algorithm 2)
    step: float | None = None  # time step of the integration, mass and stiffness being 1; None: derived

    def __post_init__(self) -> None:
        if not (self.tolerance >= 0.0 and self.threshold >= 0.0 and self.iterations >= 0 and self.rounds >= 1):
            raise ValueError(f"{self}: rounds must be at least 1, tolerance, threshold and iterations at least 0")
        if self.step is not None and not self.step > 0.0:
            raise ValueError(f"step is {self.step}; it must be above zero, or None to derive it")


@dataclass(frozen=True, eq=False)
class Task:
    """Chain of masses and springs with a target for its hand."""

    points: Floats  # (n + 1, 3) initial positions
    target: Floats  # (3,) within reach
    rests: Floats  # (n,) lengths of the bones; their sum is 1
    stiffness: Floats  # (n,)
    masses: Floats  # (n + 1,)
    damping: float | None  # see `BallChain.damping`
    effort: Effort

    @cached_property
    def springs(self) -> Springs:
        """Springs of all bones, with base and hand pinned."""
        bones = len(self.rests)
        return Springs.between(
            [(k, k + 1) for k in range(bones)],
            rests=self.rests,
            stiffness=self.stiffness,
            masses=self.masses,
            pinned={0, bones},
        )

    def arrived(self, points: Floats) -> bool:
        """Return whether the hand is on target with bones at rest length."""
        bones = points[1:] - points[:-1]
        lengths = np.sqrt((bones * bones).sum(axis=1))
        hand = points[0] + (self.rests / np.maximum(lengths, MIN_SPRING_LENGTH)) @ bones
        away = hand - self.target
        return float(away @ away) <= self.effort.tolerance**2


@dataclass(frozen=True, eq=False)
class Rest:
    """Result of a relaxation: mass positions, iterations and remaining energy."""

    points: Floats  # (p, 3) in units of the chain
    iterations: int
    energy: float  # sum of the forces, per stiffness and length of the chain


RelaxationMethod = Callable[[Task], Rest]
