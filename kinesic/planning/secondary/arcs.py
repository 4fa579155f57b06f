"""Dips and leans of the head during its turns."""

from collections.abc import Iterator, Sequence
from math import radians

import numpy as np

from kinesic.body.robot import Robot
from kinesic.expressivity.idle import Span
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.offset_bumps import CONTROL_LEAD, OffsetBump
from kinesic.planning.torso import set_turn

MIN_TURN_ANGLE = radians(6.0)  # [rad] smallest head turn that gets a dip and a lean
MIN_TURN_TIME = 0.2  # [s] shortest head turn that gets a dip and a lean
DIP_FRACTIONS = (0.06, 0.16)  # range of the head's dip angle / turn angle
LEAN_FRACTIONS = (-0.04, 0.14)  # range of the head's lean angle / turn angle, positive towards the side of the turn
MAX_ARC_ANGLE = radians(4.0)  # [rad] largest dip or lean of the head
PEAK_FRACTIONS = (0.35, 0.6)  # range of the time of the largest dip, as a fraction of the turn's duration
MIN_TURN_VELOCITY = radians(2.0)  # [rad/s] velocity above which the head counts as turning


def make_head_arcs(
    motion: Trajectory, taken: Sequence[Span], amount: float, robot: Robot, chance: np.random.Generator
) -> Iterator[OffsetBump]:
    """Yield offsets that let the head dip and lean while it turns.

    Args:
        motion: with the turns.
        taken: spans of requested nods and shakes [s], which stay unchanged.
        amount: 0 none .. 1 like a person.
        robot: without a neck there are no arcs.
        chance: random generator.
    """
    if amount == 0.0 or not robot.joints("neck"):
        return
    for begin, end, turn in find_head_turns(motion, robot):
        offsets = np.zeros(len(robot.skeleton.hinges))
        dip, lean = (
            amount * min(abs(turn) * float(chance.uniform(*fractions)), MAX_ARC_ANGLE)
            for fractions in (DIP_FRACTIONS, LEAN_FRACTIONS)
        )
        set_turn(robot, "neck", np.array([0.0, dip, -np.sign(turn) * lean]), offsets)
        peak = begin + float(chance.uniform(*PEAK_FRACTIONS)) * (end - begin)
        if not any(a < end and begin < b for a, b in taken):
            yield OffsetBump(begin, peak, end, offsets)


def find_head_turns(motion: Trajectory, robot: Robot) -> Iterator[tuple[float, float, float]]:
    """Yield start [s], end [s] and angle [rad] of head turns.

    Turns to the left are positive.
    """
    hinges = [
        joint
        for chain in ("torso", "neck")
        for joint in robot.joints(chain)
        if "torsion" in robot.skeleton.names[joint]
    ]
    torsion = motion.controls[:, hinges].sum(axis=1)
    sides = np.sign(np.where(np.abs(np.diff(torsion)) > MIN_TURN_VELOCITY * KNOT_INTERVAL, np.diff(torsion), 0.0))
    edges = np.flatnonzero(np.diff(np.concatenate([[0.0], sides, [0.0]])))
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        turn = float(torsion[last] - torsion[first])
        if sides[first] and abs(turn) >= MIN_TURN_ANGLE and (last - first) * KNOT_INTERVAL >= MIN_TURN_TIME:
            yield (
                motion.start + (first - CONTROL_LEAD) * KNOT_INTERVAL,
                motion.start + (last - CONTROL_LEAD) * KNOT_INTERVAL,
                turn,
            )
