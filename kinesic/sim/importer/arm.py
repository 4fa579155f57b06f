"""Assignment of an arm's hinges to shoulder, elbow and wrist by geometry."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.importer.hinge_row import (
    HingeRow,
    distances,
    find_common_point,
    find_nearest_on_line,
    foot,
    unit_vector,
)

MAX_GIRDLE_HINGES = 3  # largest number of collar-bone hinges before the shoulder
SHOULDER_HINGE_COUNTS = (2, 3, 4)  # possible numbers of hinges of a shoulder
MAX_WRIST_HINGES = 3  # largest number of hinges after the elbow, with the forearm's twist; others are fingers
MIN_TWIST_COSINE = 0.7  # |cosine| between an axis and its bone above which the hinge is a twist
HAND_LENGTH_RATIO = 0.45  # length of an assumed hand / length of the forearm
WRIST_FRACTION = 1.0 / (1.0 + HAND_LENGTH_RATIO)  # assumed distance elbow to wrist / distance elbow to tip
TWIST_FRACTIONS = (0.5, 0.95)  # bounds of distance elbow to twist hinge / elbow to tip, for a twist hinge at the wrist
MIN_BONE_LENGTH = 0.02  # [m] shortest bone in an accepted division of an arm's hinges


@dataclass(frozen=True)
class Split:
    """Division of an arm's hinges into girdle, shoulder, elbow and wrist."""

    girdle: int  # number of hinges before the shoulder
    shoulder: int  # number of shoulder hinges, followed by one elbow
    wrist: int  # number of hinges after the elbow, including the forearm's twist

    @property
    def elbow(self) -> int:
        """Index of the elbow hinge in the arm's chain."""
        return self.girdle + self.shoulder

    @property
    def hinges(self) -> int:
        """Number of hinges of the arm without fingers."""
        return self.elbow + 1 + self.wrist


@dataclass(frozen=True, eq=False)
class Centres:
    """Joint centres [m] and shoulder axes of an arm in one pose."""

    shoulder: Floats  # (3,)
    elbow: Floats  # (3,)
    wrist: Floats  # (3,)
    anchors: Floats  # (s, 3) points on the shoulder's axes
    axes: Floats  # (s, 3) unit vectors of the shoulder's axes

    @property
    def upper(self) -> Floats:
        """Unit vector (3,) along the upper arm."""
        return unit_vector(self.elbow - self.shoulder)

    @property
    def fore(self) -> Floats:
        """Unit vector (3,) along the forearm."""
        return unit_vector(self.wrist - self.elbow)

    @property
    def miss(self) -> float:
        """Mean distance [m] of the shoulder's axes from its centre."""
        return float(distances(self.shoulder, self.anchors, self.axes).mean())

    @property
    def lengths(self) -> tuple[float, float]:
        """Lengths [m] of upper arm and forearm."""
        return float(np.linalg.norm(self.elbow - self.shoulder)), float(np.linalg.norm(self.wrist - self.elbow))


def splits(count: int) -> list[Split]:
    """List the possible divisions of hinges into girdle, shoulder, elbow and wrist."""
    return [
        Split(girdle, shoulder, min(count - girdle - shoulder - 1, MAX_WRIST_HINGES))
        for girdle in range(MAX_GIRDLE_HINGES + 1)
        for shoulder in SHOULDER_HINGE_COUNTS
        if girdle + shoulder < count
    ]


def centres(limb: HingeRow, split: Split) -> Centres:
    """Compute the shoulder, elbow and wrist centres of a posed limb."""
    e = split.elbow
    arm, wrist_hinges = slice(split.girdle, e), slice(e + 1, split.hinges)
    shoulder = find_common_point(limb.anchors[arm], limb.axes[arm], limb.anchors[e - 1])
    twist = _find_twist(limb, split, shoulder)
    if twist is None:
        elbow = foot(shoulder, limb.anchors[e], limb.axes[e])
    else:
        elbow = find_nearest_on_line(limb.anchors[e], limb.axes[e], limb.anchors[twist], limb.axes[twist])
    has_twist = split.wrist == 1 and abs(unit_vector(limb.centre - elbow) @ limb.axes[e + 1]) > MIN_TWIST_COSINE
    tip = limb.anchors[split.hinges - 1] if split.wrist else elbow
    if has_twist or not split.wrist:
        tip = _find_rigid_wrist(limb, elbow, tip)
    wrist = find_common_point(limb.anchors[wrist_hinges], limb.axes[wrist_hinges], tip) if split.wrist else tip
    return Centres(shoulder, elbow, wrist, limb.anchors[arm], limb.axes[arm])


def _find_rigid_wrist(limb: HingeRow, elbow: Floats, twist: Floats) -> Floats:
    """Estimate the wrist (3,) [m] of an arm with a fixed hand.

    The centre of a twist hinge near the middle of forearm and hand is taken. Otherwise the hand is a fraction of the
    length to the tip. A part without shapes is assumed to end as far beyond its centre as it begins before it.
    """
    if limb.tip is None:
        return np.asarray(2 * limb.centre - elbow)
    whole = limb.tip - elbow
    length = float(np.linalg.norm(whole))
    along = float((twist - elbow) @ unit_vector(whole))
    fraction = along / length if TWIST_FRACTIONS[0] * length < along < TWIST_FRACTIONS[1] * length else WRIST_FRACTION
    return np.asarray(elbow + fraction * whole)


def _find_twist(limb: HingeRow, split: Split, shoulder: Floats) -> int | None:
    """Return the index of the last shoulder hinge along the upper arm.

    None if no shoulder hinge is. A T-pose has two candidates.
    """
    bone_direction = unit_vector(limb.anchors[split.elbow] - shoulder)
    rows = [k for k in range(split.girdle, split.elbow) if abs(limb.axes[k] @ bone_direction) > MIN_TWIST_COSINE]
    return rows[-1] if rows else None


def likeness(limb: HingeRow, split: Split) -> float:
    """Score the similarity of an arm's hinge division to a human arm.

    A good split scores about 3, a doubtful one below 2, one with too short bones -inf.
    """
    joint_centres = centres(limb, split)
    upper, fore = joint_centres.lengths
    if min(upper, fore) < MIN_BONE_LENGTH:
        return -np.inf
    arm = slice(split.girdle, split.elbow)
    twist = _find_twist(limb, split, joint_centres.shoulder) is not None
    across = float(np.abs(limb.axes[arm, 1]).max())
    return (
        -6.0 * joint_centres.miss / (upper + fore)
        + 1.5 * (1.0 - abs(float(limb.axes[split.elbow] @ joint_centres.upper)))
        + min(upper / fore, fore / upper)
        + 0.6 * (split.shoulder >= 3)
        + 0.4 * across
        + 0.4 * twist
        - 0.6 * split.girdle
        - 0.3 * (split.shoulder > 3)
    )
