"""Contacts with people during a planned motion: forces, energy and closing gaps.

Figures are those of a model with `FORCE_MARGIN`. They are not safety-rated and replace no risk assessment.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.body.impact_policy import ENERGY_ROW, ImpactPolicy, force_rows, read_impact_limits
from kinesic.planning.impact_limits import knot_times
from kinesic.planning.plan import Plan

SAMPLES_PER_WINDOW = 4096  # knots whose contacts are computed together, which bounds the memory
CLAMP_GAP = 0.025  # [m] gap between bodies in which a finger is clamped
CLAMP_RATE = 20  # [Hz] sampling rate of gaps between bodies that may clamp a finger
MIN_CLOSING = 1e-4  # [m] smallest decrease of a closing gap between two samples
GAP_STEP = 1e-5  # [rad] step of the finite differences of gaps
MIN_LEVER = 1e-3  # [m/rad] smallest effect of a hinge on a gap that it closes


@dataclass(frozen=True, eq=False)
class WorstContact:
    """Largest contact force on a body region, or energy, in a motion."""

    value: float  # force [N], or energy [J]
    time: float  # [s] performance time
    segment: str  # segment of the worst point


@dataclass(frozen=True, eq=False)
class ClosingGap:
    """Closing gap between two bodies with the largest clamping force.

    The gap is smaller than `CLAMP_GAP`.
    """

    force: float  # [N] force at which the weakest hinge gives way
    time: float  # [s] performance time
    pair: tuple[str, str]  # names of the two bodies
    gap: float  # [m] distance between the bodies


@dataclass(frozen=True, eq=False)
class ImpactFigures:
    """Contacts of a planned motion with a person, sampled at its knots."""

    plan: Plan
    times: Floats  # (m,) [s] performance time
    regions: tuple[str, ...]  # (r,) parts of a person's body
    forces: Floats  # (m, r) [N] worst force on each part
    energies: Floats  # (m,) [J] kinetic energy of the worst point
    points: Indices  # (m, r + 1) index of the worst point, the last column for the energy

    @property
    def policy(self) -> ImpactPolicy | None:
        """Policy whose limits the plan keeps, None without limits."""
        return self.plan.setup.policy

    @cached_property
    def worst(self) -> Mapping[str, WorstContact]:
        """Largest force on each region and largest energy, by name."""
        values = np.column_stack([self.forces, self.energies])
        rows = values.argmax(axis=0)
        return {
            name: WorstContact(float(values[row, k]), float(self.times[row]), self._owner(int(self.points[row, k])))
            for k, (name, row) in enumerate(zip((*self.regions, ENERGY_ROW), rows.tolist(), strict=True))
        }

    def _owner(self, point: int) -> str:
        impacts = self.plan.setup.impacts
        return "" if impacts is None else impacts.owners[point]

    @cached_property
    def largest_gap(self) -> ClosingGap | None:
        """Closing gap with the largest clamping force, or None without one."""
        return find_closing_gap(self.plan)


def measure_impacts(plan: Plan) -> ImpactFigures | None:
    """Measure contacts of a planned motion, or return None without a model."""
    setup, trajectory = plan.setup, plan.trajectory
    if setup.impacts is None:
        return None
    regions = read_impact_limits().regions if setup.policy is None else setup.policy.regions
    rows, times = force_rows(regions), np.append(knot_times(trajectory), trajectory.end)
    surveys = []
    for begin in range(0, len(times), SAMPLES_PER_WINDOW):
        angles, velocities, _ = trajectory.sample(times[begin : begin + SAMPLES_PER_WINDOW])
        surveys.append(setup.impacts.survey(angles, velocities, rows))
    values = np.vstack([survey.values for survey in surveys])
    points = np.vstack([survey.points for survey in surveys])
    return ImpactFigures(plan, times, tuple(regions), values[:, :-1], values[:, -1] ** 2, points)


def find_closing_gap(plan: Plan) -> ClosingGap | None:
    """Find the closing gap that clamps a finger with the largest force.

    The weakest hinge gives way at its stall torque. The force follows from the change of the gap with each hinge.
    Neighbouring bodies are not checked.
    """
    setup, trajectory = plan.setup, plan.trajectory
    times = np.arange(trajectory.start, trajectory.end, 1.0 / CLAMP_RATE)
    angles = trajectory.angles(times)
    gaps = setup.distances.gaps(angles)
    closing = np.argwhere((gaps[1:] < CLAMP_GAP) & (gaps[1:] < gaps[:-1] - MIN_CLOSING))
    closing[:, 0] += 1
    stall, count = setup.robot.drives.stall, angles.shape[1]
    worst: ClosingGap | None = None
    for row in np.unique(closing[:, 0]).tolist():
        pairs = closing[closing[:, 0] == row, 1]
        moved = np.repeat(angles[row][None], count, axis=0) + GAP_STEP * np.eye(count)
        levers = np.abs(setup.distances.gaps(moved)[:, pairs] - gaps[row, pairs]) / GAP_STEP
        forces = np.where(levers > MIN_LEVER, stall[:, None] / np.maximum(levers, MIN_LEVER), np.inf).min(axis=0)
        largest = int(forces.argmax())
        if np.isfinite(forces[largest]) and (worst is None or forces[largest] > worst.force):
            pair = setup.robot.counted_pairs[int(pairs[largest])]
            worst = ClosingGap(float(forces[largest]), float(times[row]), pair, float(gaps[row, pairs[largest]]))
    return worst
