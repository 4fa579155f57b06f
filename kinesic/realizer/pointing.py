"""Hands that point at something keep to it when other blocks move the trunk below them."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Hand
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import LEAST, SAME, kept, knot_at, lengthened, roomy, shortened
from kinesic.planning.arm_postures import with_arms
from kinesic.planning.certify import duties
from kinesic.planning.clearance import LAG_RESERVE, scan
from kinesic.planning.plan import Plan
from kinesic.planning.postures import aimed
from kinesic.planning.setup import Facts
from kinesic.realizer.adding import rise
from kinesic.realizer.busy import Busy
from kinesic.realizer.release import tail

FULL = 1.0  # of a drive's duty
PARTS = (1.0, 0.8, 0.5)  # of what an arm should turn, until it is clear of the body


@dataclass(frozen=True, eq=False)
class Pointed:
    """A hand that points in the stroke of a behaviour."""

    behaviour: str
    side: Side
    hand: Hand
    aim: Floats  # (3,) [m] in the world

    def miss(self, angles: Floats, robot: Robot) -> float:
        """Angle between the line from the wrist along the hand and that from the wrist to the aim [rad].

        Args:
            angles: (n,) [rad] of the whole robot.
            robot: whose hand it is.
        """
        frames, palm = robot.skeleton.frames(angles), robot.sites[f"{self.side}_palm"]
        wrist = robot.skeleton.segment(robot.chains[f"{self.side}_arm"][-1])
        line, wanted = frames.rotations[wrist] @ palm.position, self.aim - frames.origins[wrist]
        return float(np.arctan2(np.linalg.norm(np.cross(line, wanted)), line @ wanted))

    def arm(self, angles: Floats, robot: Robot) -> Floats:
        """(n,) [rad] the posture with the arm that points, on the trunk as it is."""
        if self.hand.reach is None:
            return angles
        reach = aimed(self.hand.reach, self.aim, self.side, angles, robot)
        return with_arms(angles, {self.side: self.hand}, {self.side: reach}, robot)


def pointed(plan: Plan) -> tuple[Pointed, ...]:
    """The hands that point in a plan."""
    return tuple(
        Pointed(id, side, hand, hand.aim)
        for frame in plan.keyframes.frames
        for id, sync in frame.syncs
        if sync == "stroke"
        for side, hand in frame.hands.items()
        if f"{side}_hand" in plan.keyframes.uses[id] and hand.aim is not None
    )


def corrected(
    motion: Trajectory, time: float, one: Pointed, stroke: float, busy: Busy, others: Sequence[Busy], facts: Facts
) -> Trajectory | None:
    """The motion with an arm that points again in its stroke, and from there until it relaxes, or as far as it can.

    Args:
        motion: within the limits and clear of the body.
        time: [s] performance time from which it may change, at the next knot.
        one: the hand.
        stroke: [s] performance time.
        busy: what its behaviour needs.
        others: what else the motion does; other works of the hand stay as they are.
        facts: the robot.

    Returns:
        None where servos cannot, or the body would come too near to itself.
    """
    robot, limits = facts.robot, roomy(facts.limits)
    posture = motion.sample(np.array([stroke]))[0][0]
    change = one.arm(posture, robot) - posture
    same = [other for other in others if f"{one.side}_hand" in other.roles]
    begin = max([busy.begin, time, *(other.relax for other in same if other.ready < stroke)])
    end = min([busy.end, *(other.ready for other in same if other.ready > stroke)])
    count = max(len(motion.controls), ceil(end / STEP) + 3 * LEAST)
    times = np.asarray((np.arange(count) - LEAST) * STEP, dtype=np.float64)
    share = rise(times, begin, stroke - LEAST * STEP) * (1.0 - rise(times, busy.relax, end))
    first, last = knot_at(begin), min(ceil(end / STEP) + LEAST, count - LEAST)
    for part in PARTS if last - first >= LEAST else ():
        found = np.array(lengthened(motion.controls, count))
        for hinge in np.flatnonzero(np.abs(change) > SAME).tolist():
            column = kept(found[:, hinge] + part * share * change[hinge], first, last, limits, hinge)
            found[:, hinge] = found[:, hinge] if column is None else column
        if _clear(found, motion, first, last, facts):
            return Trajectory(sealed(shortened(found)), motion.zero)
    return None


def _clear(found: Floats, motion: Trajectory, first: int, last: int, facts: Facts) -> bool:
    """Whether nothing comes too near or is overloaded between two knots."""
    after, before = (
        tail(Trajectory(lengthened(controls, len(found))[: last + LEAST], 0.0), first * STEP)
        for controls in (found, motion.controls)
    )
    peaks = duties(after, facts)
    if (peaks > np.maximum(FULL, duties(before, facts))).any():
        return False
    least = facts.robot.least_clearance + LAG_RESERVE
    return float(scan(after, facts.distances)[1].distances.min()) >= least
