"""Paths of hands that become smaller than asked, because servos cannot follow them in their time."""

from collections.abc import Sequence
from math import inf

import numpy as np

from kinesic.bml.block import Block, Notice, NoticeType, Timed
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.keys import KeyPosture

SMALLER_TO_WARN = 0.1  # share of the length of a path


def smaller(
    block: Block, postures: Sequence[KeyPosture], frames: KeyFrames, motion: Conditioned, robot: Robot
) -> list[Notice]:
    """A warning for each behaviour with a hand whose path is cut by more than a tenth.

    Args:
        block: that is planned.
        postures: that the motion was to pass.
        frames: of the block.
        motion: what became of them.
        robot: whose hands.
    """
    if all(posture.firm for posture in postures):
        return []
    asked = robot.skeleton.frames(np.array([posture.angles for posture in postures])).origins
    planned = robot.skeleton.frames(motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]).origins
    found = []
    for timed in frames.timeline.timed:
        cut, name = 0.0, timed.behaviour.id
        for side in SIDES:
            if f"{side}_hand" in frames.uses.get(name, ()):
                rows = _on_path(postures, timed, robot, side)
                hand = robot.skeleton.segment(robot.chains[f"{side}_arm"][-1])
                whole = _length(asked[rows, hand])
                cut = max(cut, 1.0 - _length(planned[rows, hand]) / whole) if whole else cut
        if cut > SMALLER_TO_WARN:
            text = f"its path is made {100 * cut:.0f} % smaller: servos cannot follow it in its time"
            found.append(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text))
    return found


def _on_path(postures: Sequence[KeyPosture], timed: Timed, robot: Robot, side: Side) -> list[int]:
    """The keys of a hand on a path in a stroke, with those at its ends; none without a path."""
    start, end = (timed.times.get(sync, inf) for sync in ("strokeStart", "strokeEnd"))
    arm = robot.joints(f"{side}_arm")[0]
    rows = [k for k, posture in enumerate(postures) if posture.keyed[arm] and start <= posture.time <= end]
    return [] if all(postures[k].firm for k in rows) else rows


def _length(path: Floats) -> float:
    """Of a path (m, 3) [m]."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
