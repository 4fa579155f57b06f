"""Arcs: a head that turns aside dips and leans a little on its way, and does not go straight from pose to pose."""

from collections.abc import Iterator, Sequence
from math import radians

import numpy as np

from kinesic.body.robot import Robot
from kinesic.expressivity.idle import Span
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.secondary.swells import CONTROL_LEAD, Swell
from kinesic.planning.torso import set_turn

LEAST_TURN, LEAST_TIME = radians(6.0), 0.2  # [rad] and [s] of a turn that is worth an arc
DIP, LEAN = (0.06, 0.16), (-0.04, 0.14)  # of a turn, that the head goes down, and leans to where it turns
LARGEST_BEND = radians(4.0)  # of both
LOWEST_AT = 0.35, 0.6  # share of the time, at which it is lowest
MOVING = radians(2.0)  # [rad/s] of a head that turns


def arcs(
    motion: Trajectory, taken: Sequence[Span], amount: float, robot: Robot, chance: np.random.Generator
) -> Iterator[Swell]:
    """Bends the ways of the head.

    Args:
        motion: in which it turns.
        taken: when a document asks nods and shakes of it, which stay as they are [s].
        amount: 0 not at all .. 1 as people do.
        robot: of the motion; one without a neck has no arcs.
        chance: how far.
    """
    if amount == 0.0 or not robot.joints("neck"):
        return
    for begin, end, turn in head_turns(motion, robot):
        away = np.zeros(len(robot.skeleton.hinges))
        dip, lean = (amount * min(abs(turn) * float(chance.uniform(*share)), LARGEST_BEND) for share in (DIP, LEAN))
        set_turn(robot, "neck", np.array([0.0, dip, -np.sign(turn) * lean]), away)
        peak = begin + float(chance.uniform(*LOWEST_AT)) * (end - begin)
        if not any(a < end and begin < b for a, b in taken):
            yield Swell(begin, peak, end, away)


def head_turns(motion: Trajectory, robot: Robot) -> Iterator[tuple[float, float, float]]:
    """Finds when the head turns to one side for a while: from, to [s] and how far [rad], + left."""
    hinges = [
        joint
        for chain in ("torso", "neck")
        for joint in robot.joints(chain)
        if "torsion" in robot.skeleton.names[joint]
    ]
    torsion = motion.controls[:, hinges].sum(axis=1)
    sides = np.sign(np.where(np.abs(np.diff(torsion)) > MOVING * STEP, np.diff(torsion), 0.0))
    edges = np.flatnonzero(np.diff(np.concatenate([[0.0], sides, [0.0]])))
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        turn = float(torsion[last] - torsion[first])
        if sides[first] and abs(turn) >= LEAST_TURN and (last - first) * STEP >= LEAST_TIME:
            yield motion.start + (first - CONTROL_LEAD) * STEP, motion.start + (last - CONTROL_LEAD) * STEP, turn
