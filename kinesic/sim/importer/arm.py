"""Which hinges of an arm are shoulder, elbow and wrist: found by geometry, never by name."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.importer.hinge_row import HingeRow, common_point, distances, foot, nearest_to_line, unit_vector

MOST_GIRDLE = 3  # hinges before the shoulder
SHOULDERS = (2, 3, 4)  # hinges of a shoulder
MOST_WRIST = 3  # hinges after the elbow, the forearm's twist included; what follows belongs to the fingers
LENGTHWISE = 0.7  # cosine to its bone from which a hinge is a twist
SHORTEST_BONE = 0.02  # [m] of a bone


@dataclass(frozen=True)
class Split:
    """Positions in the row of an arm's hinges."""

    girdle: int  # so many before the shoulder
    shoulder: int  # so many hinges of the shoulder; then comes one elbow
    wrist: int  # so many behind the elbow, the forearm's twist included

    @property
    def elbow(self) -> int:
        """Position of the elbow."""
        return self.girdle + self.shoulder

    @property
    def hinges(self) -> int:
        """Of the arm, without the fingers."""
        return self.elbow + 1 + self.wrist


@dataclass(frozen=True, eq=False)
class Centres:
    """Where an arm's joints are in one pose [m]."""

    shoulder: Floats  # (3,)
    elbow: Floats  # (3,)
    wrist: Floats  # (3,)
    anchors: Floats  # (s, 3) of the shoulder's hinges
    axes: Floats  # (s, 3) unit, of the same

    @property
    def upper(self) -> Floats:
        """(3,) unit, along the upper arm."""
        return unit_vector(self.elbow - self.shoulder)

    @property
    def fore(self) -> Floats:
        """(3,) unit, along the forearm."""
        return unit_vector(self.wrist - self.elbow)

    @property
    def miss(self) -> float:
        """Mean distance of the shoulder's axes from its centre [m]."""
        return float(distances(self.shoulder, self.anchors, self.axes).mean())

    @property
    def lengths(self) -> tuple[float, float]:
        """Of upper arm and forearm [m]."""
        return float(np.linalg.norm(self.elbow - self.shoulder)), float(np.linalg.norm(self.wrist - self.elbow))


def splits(count: int) -> list[Split]:
    """Lists all ways to divide an arm's hinges into girdle, shoulder, elbow and wrist."""
    return [
        Split(girdle, shoulder, min(count - girdle - shoulder - 1, MOST_WRIST))
        for girdle in range(MOST_GIRDLE + 1)
        for shoulder in SHOULDERS
        if girdle + shoulder < count
    ]


def centres(limb: HingeRow, split: Split) -> Centres:
    """Finds shoulder, elbow and wrist in the limb's pose."""
    e = split.elbow
    arm, behind = slice(split.girdle, e), slice(e + 1, split.hinges)
    shoulder = common_point(limb.anchors[arm], limb.axes[arm], limb.anchors[e - 1])
    twist = _twist(limb, split, shoulder)
    if twist is None:
        elbow = foot(shoulder, limb.anchors[e], limb.axes[e])
    else:
        elbow = nearest_to_line(limb.anchors[e], limb.axes[e], limb.anchors[twist], limb.axes[twist])
    tip = limb.centre + (limb.centre - elbow) if not split.wrist else limb.anchors[split.hinges - 1]
    if split.wrist == 1 and abs(unit_vector(limb.centre - elbow) @ limb.axes[e + 1]) > LENGTHWISE:
        tip = limb.centre + (limb.centre - elbow)
    wrist = common_point(limb.anchors[behind], limb.axes[behind], tip) if split.wrist else tip
    return Centres(shoulder, elbow, wrist, limb.anchors[arm], limb.axes[arm])


def _twist(limb: HingeRow, split: Split, shoulder: Floats) -> int | None:
    """The last shoulder hinge along the upper arm (a T-pose has two candidates)."""
    along = unit_vector(limb.anchors[split.elbow] - shoulder)
    rows = [k for k in range(split.girdle, split.elbow) if abs(limb.axes[k] @ along) > LENGTHWISE]
    return rows[-1] if rows else None


def likeness(limb: HingeRow, split: Split) -> float:
    """Scores how much a split looks like a human arm: about 3 for a good one, below 2 doubtful."""
    at = centres(limb, split)
    upper, fore = at.lengths
    if min(upper, fore) < SHORTEST_BONE:
        return -np.inf
    arm = slice(split.girdle, split.elbow)
    twist = _twist(limb, split, at.shoulder) is not None
    across = float(np.abs(limb.axes[arm, 1]).max())
    return (
        -6.0 * at.miss / (upper + fore)
        + 1.5 * (1.0 - abs(float(limb.axes[split.elbow] @ at.upper)))
        + min(upper / fore, fore / upper)
        + 0.6 * (split.shoulder >= 3)
        + 0.4 * across
        + 0.4 * twist
        - 0.6 * split.girdle
        - 0.3 * (split.shoulder > 3)
    )
