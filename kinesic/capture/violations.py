"""Violations of a robot's limits by a motion."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.capture.derivatives import differentiate
from kinesic.capture.robot_motion import SAMPLE_RATE
from kinesic.planning.setup import Setup

LimitName = Literal["position", "velocity", "acceleration", "jerk", "duty", "torque", "clearance"]

MAX_RATIO = 1.001  # largest value / limit that counts as satisfied
CLEARANCE_UNIT = 0.01  # [m] missing clearance that adds 1 to the ratio of a violation
SAMPLES_PER_WINDOW = 4096  # samples whose torques are computed together, which bounds the memory


@dataclass(frozen=True)
class Violation:
    """Largest violation of one limit by a joint or segment pair."""

    limit: LimitName
    part: str  # joint, or pair of segments
    time: float  # [s] time of the largest violation
    ratio: float  # largest value / limit; for a clearance 1 + missing clearance / `CLEARANCE_UNIT`
    fraction: float  # fraction of samples that violate the limit

    def __str__(self) -> str:
        return (
            f"{self.limit} of {self.part}: {self.ratio:.2f} times the limit at {self.time:.2f} s, "
            f"{100 * self.fraction:.1f} % of the time"
        )


def find_violations(angles: Floats, setup: Setup) -> tuple[Violation, ...]:
    """Return a sampled motion's limit violations, the largest ratio first.

    Velocities, accelerations and jerks are mean values over one, two and three intervals: a motion through the samples
    exceeds them at least once. The duty limit of each joint assumes its largest load; torques are those of the motion.

    Args:
        angles: (m, n) [rad].
        setup: robot, limits, dynamics and distances.
    """
    limits, names = setup.limits, setup.robot.skeleton.names
    velocity, acceleration, jerk = differentiate(angles)
    middle, half = (limits.upper + limits.lower) / 2.0, (limits.upper - limits.lower) / 2.0
    torques = _torque_duties(angles, velocity, acceleration, setup)
    ratios: tuple[tuple[LimitName, Floats], ...] = (
        ("position", np.abs(angles - middle) / np.maximum(half, 1e-9)),
        ("velocity", np.abs(velocity) / limits.speed),
        ("acceleration", np.abs(acceleration) / limits.acceleration),
        ("jerk", np.abs(jerk) / limits.jerk),
        ("duty", np.abs(limits.inertial * acceleration + limits.viscous * velocity) / limits.duty),
        ("torque", torques),
    )
    violations = [violation for limit, values in ratios for violation in _list_violations(limit, names, values)]
    violations += _find_near_pairs(angles, setup)
    return tuple(sorted(violations, key=lambda violation: -violation.ratio))


def _list_violations(limit: LimitName, names: Sequence[str], ratios: Floats) -> list[Violation]:
    is_beyond = ratios > MAX_RATIO
    worst = ratios.argmax(axis=0)
    return [
        Violation(
            limit, names[k], float(worst[k]) / SAMPLE_RATE, float(ratios[worst[k], k]), float(is_beyond[:, k].mean())
        )
        for k in np.flatnonzero(is_beyond.any(axis=0)).tolist()
    ]


def _torque_duties(angles: Floats, velocity: Floats, acceleration: Floats, setup: Setup) -> Floats:
    """Return drive duties (m, n), fractions of full PWM, by inverse dynamics."""
    duties = np.empty_like(angles)
    for begin in range(0, len(angles), SAMPLES_PER_WINDOW):
        rows = slice(begin, begin + SAMPLES_PER_WINDOW)
        torques = setup.dynamics.torques(angles[rows], velocity[rows], acceleration[rows])
        duties[rows] = np.abs(torques / setup.robot.drives.stall + velocity[rows] * setup.limits.viscous)
    return duties


def _find_near_pairs(angles: Floats, setup: Setup) -> list[Violation]:
    clearance, required = setup.distances.clearance(angles), setup.robot.min_clearance
    near = np.flatnonzero(clearance.distances < required)
    worst: dict[tuple[str, str], int] = {}
    counts: dict[tuple[str, str], int] = {}
    for k in near[np.argsort(clearance.distances[near], kind="stable")].tolist():
        pair = clearance.pairs[k]
        worst.setdefault(pair, k)
        counts[pair] = counts.get(pair, 0) + 1
    return [
        Violation(
            "clearance",
            f"{first} to {second}",
            k / SAMPLE_RATE,
            1.0 + (required - float(clearance.distances[k])) / CLEARANCE_UNIT,
            counts[first, second] / len(angles),
        )
        for (first, second), k in worst.items()
    ]
