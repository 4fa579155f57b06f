"""Joint angles of a hanging arm, found by geometry from any pose."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.least_squares import Minimum, minimise_squares
from kinesic.sim.importer.arm import Split, centres
from kinesic.sim.importer.hinge_row import HingeRow, unit_vector

RANDOM_STARTS = 10  # number of random start postures of the search
MAX_EVALUATIONS = 60  # largest number of evaluations in one least-squares search
EQUAL_COST_RATIO = 1.02  # cost / least cost up to which a solution from an earlier start is preferred
ELBOW_WEIGHT = 0.5  # weight of the elbow's axis relative to the directions of the bones
HAND_WEIGHT = 0.1  # weight of the hand's direction relative to the directions of the bones
SEARCH_STAY_WEIGHT = 0.1  # [1/rad] weight of the distance from the start pose during the search
REFINEMENT_STAY_WEIGHT = 0.05  # [1/rad] weight of the distance from the chosen solution during refinement
DISTAL_STAY_FACTOR = 3.0  # factor on both stay weights for hinges beyond the elbow, which hardly move the bones
OUTSIDE_WEIGHT = 0.3  # [1/rad] weight of the angle outside a hinge's range
SYMMETRIC_RANGE_FRACTION = 0.05  # |mid-range - straight| / range below which an elbow may bend both ways
FULL_TURN = 2 * np.pi  # [rad] angle of one revolution


@dataclass(frozen=True, eq=False)
class HangingPose:
    """Desired directions of an arm's bones and elbow axis."""

    upper: Floats  # (3,) unit vector along the upper arm
    fore: Floats  # (3,) unit vector along the forearm
    hinge: Floats  # (3,) unit vector of the elbow's axis


@dataclass(frozen=True, eq=False)
class Ranges:
    """Ranges of an arm's hinges relative to its start pose."""

    lower: Floats  # (k,) [rad], -inf if unknown
    upper: Floats  # (k,) [rad], inf if unknown
    strict: bool  # whether angles must stay within the ranges


@dataclass(frozen=True, eq=False)
class Posed:
    """Angles of an arm with the remaining direction error."""

    angles: Floats  # (k,) [rad] relative to the start pose
    off: float  # [rad] larger of the direction errors of both bones


def find_elbow_sense(limb: HingeRow, split: Split, lower: float, upper: float) -> float:
    """Return the sign (+1 or -1) of angles that bend an elbow.

    0 if its range is symmetric around the straight arm, or unknown.

    Args:
        limb: Hinges of the arm in any pose.
        split: Division of its hinges.
        lower: [rad] lower limit of the elbow relative to this pose; -inf if unknown.
        upper: [rad] upper limit of the elbow relative to this pose; inf if unknown.
    """
    at, axis = centres(limb, split), limb.axes[split.elbow]
    fore = at.fore - axis * (axis @ at.fore)  # perpendicular to the axis, so the upper arm need not be
    straight_angle = float(np.arctan2(axis @ np.cross(fore, at.upper), fore @ at.upper))
    lower, upper = lower - straight_angle, upper - straight_angle
    if not np.isfinite([lower, upper]).all():
        return 0.0
    turns = FULL_TURN * np.round((lower + upper) / 2 / FULL_TURN)
    middle = (lower + upper) / 2 - turns
    return float(np.sign(middle)) if abs(middle) > SYMMETRIC_RANGE_FRACTION * (upper - lower) else 0.0


def pose_arm(limb: HingeRow, split: Split, target: HangingPose, ranges: Ranges, first: list[Floats]) -> Posed:
    """Find the angles that bring an arm's bones closest to desired directions.

    Among equivalent solutions the one closest to the start pose is preferred.

    Args:
        limb: Hinges in the start pose.
        split: Division of the hinges.
        target: Desired directions of the bones.
        ranges: Ranges of the hinges.
        first: (k,) [rad] start angles that are tried before random ones.
    """
    model = _Arm(limb, split, target, ranges)
    random = np.random.default_rng(0)
    lower, upper = (np.clip(side, -np.pi, np.pi) for side in (ranges.lower, ranges.upper))
    starts = [*first, np.zeros(len(lower)), *(random.uniform(lower, upper) for _ in range(RANDOM_STARTS))]
    solutions = [model.solve(start, SEARCH_STAY_WEIGHT, model.home) for start in starts]
    least_cost = min(solution.cost for solution in solutions)
    chosen = next(solution.values for solution in solutions if solution.cost <= EQUAL_COST_RATIO * least_cost)
    refined = model.solve(chosen, REFINEMENT_STAY_WEIGHT, chosen).values
    final_angles = refined if ranges.strict else _unwind(refined, ranges)
    return Posed(sealed(final_angles), model.off(final_angles))


def _unwind(angles: Floats, ranges: Ranges) -> Floats:
    """Shift angles [rad] by full turns as close as possible to mid-range."""
    bounded = np.isfinite(ranges.lower)
    middle = np.where(bounded, np.where(bounded, ranges.lower, 0.0) + np.where(bounded, ranges.upper, 0.0), 0.0) / 2
    solutions: Floats = angles - FULL_TURN * np.round((angles - middle) / FULL_TURN)
    return solutions


class _Arm:
    """Least-squares problem of bringing an arm into a desired pose."""

    def __init__(self, limb: HingeRow, split: Split, target: HangingPose, ranges: Ranges) -> None:
        self._limb, self._split, self._target, self._ranges = limb, split, target, ranges
        e = split.elbow
        self._sense = find_elbow_sense(limb, split, ranges.lower[e], ranges.upper[e]) or _find_forward_sense(
            limb, split
        )
        self._stay_factors = np.where(np.arange(len(ranges.lower)) > split.elbow, DISTAL_STAY_FACTOR, 1.0)
        self.home = np.clip(np.zeros(len(ranges.lower)), ranges.lower, ranges.upper)

    def solve(self, start: Floats, stay: float, home: Floats) -> Minimum:
        """Minimise the residuals from a start posture, within the ranges if strict.

        Args:
            start: (k,) [rad] relative to the start pose.
            stay: Weight per radian of the distance from `home`.
            home: (k,) [rad] preferred angles.
        """
        lower, upper = self._ranges.lower, self._ranges.upper
        if not self._ranges.strict:
            lower, upper = np.full_like(lower, -np.inf), np.full_like(upper, np.inf)
        return minimise_squares(
            lambda angles: self.residuals(angles, stay, home),
            np.clip(start, lower, upper),
            bounds=(lower, upper),
            max_evaluations=MAX_EVALUATIONS,
        )

    def residuals(self, angles: Floats, stay: float, home: Floats) -> Floats:
        """Compute the residuals (m,) at angles (k,) [rad].

        Args:
            angles: (k,) [rad] relative to the start pose.
            stay: Weight per radian of the distance from `home`.
            home: (k,) [rad] preferred angles.
        """
        target, split = self._target, self._split
        pose = self._limb.turned(angles)
        at = centres(pose, split)
        lower, upper = self._ranges.lower, self._ranges.upper
        excess = np.maximum(angles - upper, 0.0) + np.maximum(lower - angles, 0.0)
        rows = [
            at.upper - target.upper,
            at.fore - target.fore,
            ELBOW_WEIGHT * (self._sense * pose.axes[split.elbow] - target.hinge),
            stay * self._stay_factors * (angles - home),
            OUTSIDE_WEIGHT * excess,
        ]
        if split.wrist:
            rows.append(HAND_WEIGHT * (unit_vector(pose.centre - at.wrist) - target.fore))
        return np.concatenate(rows)

    def off(self, angles: Floats) -> float:
        """Compute the larger of both bones' direction errors [rad]."""
        at = centres(self._limb.turned(angles), self._split)
        cosines = [at.upper @ self._target.upper, at.fore @ self._target.fore]
        return float(np.arccos(np.clip(min(cosines), -1.0, 1.0)))


def _find_forward_sense(limb: HingeRow, split: Split) -> float:
    """Return the sign, +1 or -1, of rotations that bend the elbow.

    The forearm then moves forward. Valid in the pose of `limb`.
    """
    at, axis = centres(limb, split), limb.axes[split.elbow]
    return 1.0 if np.cross(axis, at.fore)[0] >= 0 else -1.0
