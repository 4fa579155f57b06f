"""Where the gaze goes, as directions that eyes can take."""

import numpy as np

from kinesic.bml.block import Gaze, HeadDirectionShift, Timeline
from kinesic.body.arrays import Floats
from kinesic.expressivity.behaviours import stays
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.face.eyes import GazeDirection
from kinesic.expressivity.gaze import STRAIGHT, aim
from kinesic.expressivity.turns import add_turns


def looks(timeline: Timeline, context: BlockContext) -> tuple[GazeDirection, ...]:
    """The gazes of a block, in order; a direction that stays lasts until the next look.

    Args:
        timeline: behaviours with times.
        context: of their block; the eyes of a robot without a neck look straight ahead.
    """
    if not context.robot.joints("neck"):
        return ()
    found: list[GazeDirection] = []
    base = STRAIGHT
    for timed in sorted(timeline.timed, key=lambda each: each.times["start"]):
        action = timed.behaviour.action
        if not isinstance(action, Gaze | HeadDirectionShift):
            continue
        aimed = aim(action, context, base)
        if aimed is not None:
            base = aimed if stays(action) else base
            end = np.inf if stays(action) else timed.times["relax"]
            there = add_turns(aimed.head, aimed.eyes)
            found.append(GazeDirection(timed.times["start"], there.torsion, -there.tilt, end))
    return tuple(found)


def headings(directions: Floats) -> Floats:
    """(m, 2) [rad] left and up of (m, 3) directions in the world."""
    x, y, z = directions.T
    return np.stack([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))], axis=1)
