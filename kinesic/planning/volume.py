"""The gesture volume in the world: the box of sectors goes along with the torso's own key (thesis 8.7).

Its orientation is that of the torso, its size goes with the distance from the first vertebra that moves to the
shoulders' girdle: 1 on a rigid trunk, less on a spine of several hinges that bends. The lean that reaching adds
moves no target.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import UPRIGHT, axes
from kinesic.planning.arm_postures import turned
from kinesic.planning.turning import set_turn


@dataclass(frozen=True, eq=False)
class Volume:
    """The box of sectors, relative to that of the upright torso."""

    pivot: Floats  # (3,) [m] in the world: the torso's first joint
    rotation: Floats  # (3, 3)
    scale: float  # length of the torso over its length upright

    def placed(self, reach: Reach) -> Reach:
        """A reach that was written for the upright torso, in the world."""
        return turned(reach, self.rotation, self.pivot, self.pivot, self.scale)


@lru_cache(maxsize=64)
def volume(robot: Robot, turn: Turn) -> Volume | None:
    """The box of a torso's own key; None for an upright torso, or none; remembered, for it often stays as it is."""
    if turn == UPRIGHT or not robot.joints("torso"):
        return None
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array(axes(turn)), angles)
    names = robot.chains["torso"]
    first, last = robot.skeleton.segment(names[0]), robot.skeleton.segment(names[-1])
    girdle = robot.skeleton.segment(robot.arms["l"].base)
    moved, upright = robot.skeleton.frames(angles), robot.skeleton.resting
    now, before = (float(np.linalg.norm(f.origins[girdle] - f.origins[first])) for f in (moved, upright))
    return Volume(moved.origins[first], moved.rotations[last], now / before)
