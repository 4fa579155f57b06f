"""Poses by geometry: the angles at which an arm hangs, whatever the pose of its file."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from kinesic.body.arrays import Floats, sealed
from kinesic.sim.importer.arm import Split, centres
from kinesic.sim.importer.hinge_row import HingeRow, unit_vector

STARTS = 10
ROUNDS = 60
SLACK = 1e-9  # [rad] so that a hinge without room has a box
NEARLY = 1.02  # times the least cost: the first of equals is taken
ELBOW_WEIGHT = 0.5  # the elbow's axis beside the directions of the bones
HAND_WEIGHT = 0.1
CHOOSING, FINE = 0.1, 0.05  # per radian away from the pose of the file, to choose; from the chosen one, to refine
CALM = 3.0  # times that for forearm and wrist, which hardly move the bones
OUTSIDE_WEIGHT = 0.3  # per radian outside its range
CENTRED = 0.05  # of its range: an elbow whose middle is nearer to straight bends both ways
FULL_TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class HangingPose:
    """Directions that an arm should have."""

    upper: Floats  # (3,) unit, along the upper arm
    fore: Floats  # (3,) unit, along the forearm
    hinge: Floats  # (3,) unit, about which the elbow bends


@dataclass(frozen=True, eq=False)
class Ranges:
    """Ranges of an arm's hinges, about the pose of the file."""

    lower: Floats  # (k,) [rad], -inf where none is told
    upper: Floats  # (k,) [rad]
    strict: bool  # never leave them


@dataclass(frozen=True, eq=False)
class Posed:
    """Angles and how well they serve."""

    angles: Floats  # (k,) [rad] from the pose of the file
    off: float  # [rad] of the worse of both bones from its wish


def elbow_sense(limb: HingeRow, split: Split, lower: float, upper: float) -> float:
    """Finds in which sense an elbow bends: +1 by positive angles, -1 by negative ones, 0 when its range says neither.

    Args:
        limb: of the arm, in any pose.
        split: of its hinges.
        lower: [rad] of the elbow's range, from this pose; -inf where none is told.
        upper: [rad]
    """
    at, axis = centres(limb, split), limb.axes[split.elbow]
    fore = at.fore - axis * (axis @ at.fore)
    upper_arm = at.upper - axis * (axis @ at.upper)
    straight = float(np.arctan2(axis @ np.cross(fore, upper_arm), fore @ upper_arm))
    low, high = lower - straight, upper - straight
    if not np.isfinite([low, high]).all():
        return 0.0
    turns = FULL_TURN * np.round((low + high) / 2 / FULL_TURN)
    middle = (low + high) / 2 - turns
    return float(np.sign(middle)) if abs(middle) > CENTRED * (high - low) else 0.0


def pose_arm(limb: HingeRow, split: Split, wish: HangingPose, ranges: Ranges, first: list[Floats]) -> Posed:
    """Finds angles that bring an arm nearest to a wish, close to the pose of its file where that leaves a choice.

    Args:
        limb: in the pose of the file.
        split: of its hinges.
        wish: directions of its bones.
        ranges: of its hinges.
        first: (k,) [rad] angles to begin with, before random ones.
    """
    model = _Arm(limb, split, wish, ranges)
    random = np.random.default_rng(0)
    low, high = (np.clip(side, -np.pi, np.pi) for side in (ranges.lower, ranges.upper))
    starts = [*first, np.zeros(len(low)), *(random.uniform(low, high) for _ in range(STARTS))]
    bounds = (ranges.lower - SLACK, ranges.upper + SLACK) if ranges.strict else (-np.inf, np.inf)
    found = [
        least_squares(
            model.residuals, np.clip(start, *bounds), bounds=bounds, max_nfev=ROUNDS, args=(CHOOSING, model.home)
        )
        for start in starts
    ]
    least = min(one.cost for one in found)
    chosen = next(one.x for one in found if one.cost <= NEARLY * least)
    fine = least_squares(
        model.residuals, np.clip(chosen, *bounds), bounds=bounds, max_nfev=ROUNDS, args=(FINE, chosen)
    ).x
    best = fine if ranges.strict else _unwound(fine, ranges)
    return Posed(sealed(best), model.off(best))


def _unwound(angles: Floats, ranges: Ranges) -> Floats:
    """The same pose with each hinge turned by whole turns to where it is nearest to the middle of its range."""
    bounded = np.isfinite(ranges.lower)
    middle = np.where(bounded, np.where(bounded, ranges.lower, 0.0) + np.where(bounded, ranges.upper, 0.0), 0.0) / 2
    found: Floats = angles - FULL_TURN * np.round((angles - middle) / FULL_TURN)
    return found


class _Arm:
    """What is wanted of an arm as residuals."""

    def __init__(self, limb: HingeRow, split: Split, wish: HangingPose, ranges: Ranges) -> None:
        self._limb, self._split, self._wish, self._ranges = limb, split, wish, ranges
        e = split.elbow
        self._sense = elbow_sense(limb, split, ranges.lower[e], ranges.upper[e]) or _forward(limb, split)
        self._calm = np.where(np.arange(len(ranges.lower)) > split.elbow, CALM, 1.0)
        self.home = np.clip(np.zeros(len(ranges.lower)), ranges.lower, ranges.upper)

    def residuals(self, angles: Floats, stay: float, home: Floats) -> Floats:
        """(m,) for (k,) angles [rad]."""
        wish, split = self._wish, self._split
        pose = self._limb.turned(angles)
        at = centres(pose, split)
        low, high = self._ranges.lower, self._ranges.upper
        outside = np.maximum(angles - high, 0.0) + np.maximum(low - angles, 0.0)
        rows = [
            at.upper - wish.upper,
            at.fore - wish.fore,
            ELBOW_WEIGHT * (self._sense * pose.axes[split.elbow] - wish.hinge),
            stay * self._calm * (angles - home),
            OUTSIDE_WEIGHT * outside,
        ]
        if split.wrist:
            rows.append(HAND_WEIGHT * (unit_vector(pose.centre - at.wrist) - wish.fore))
        return np.concatenate(rows)

    def off(self, angles: Floats) -> float:
        """[rad] of the worse bone."""
        at = centres(self._limb.turned(angles), self._split)
        cosines = [at.upper @ self._wish.upper, at.fore @ self._wish.fore]
        return float(np.arccos(np.clip(min(cosines), -1.0, 1.0)))


def _forward(limb: HingeRow, split: Split) -> float:
    """The sense in which the elbow bends forward in the pose of the file."""
    at, axis = centres(limb, split), limb.axes[split.elbow]
    return 1.0 if np.cross(axis, at.fore)[0] >= 0 else -1.0
