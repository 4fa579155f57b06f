"""Hands that point at something keep to it when other blocks move the trunk below them.

When what other blocks do with the trunk has changed, they point again, or the sender is told that they do not.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Hand
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import LEAST, SAME, keep_limits, knot_at, lengthen, roomy, shorten
from kinesic.planning.arm_postures import with_arms
from kinesic.planning.certify import duties
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.plan import Plan
from kinesic.planning.postures import aim_from_shoulder
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import STILL, Occupancy
from kinesic.realizer.overlay import rise
from kinesic.realizer.release import from_knot
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene

FULL = 1.0  # of a drive's duty
PARTS = (1.0, 0.8, 0.5)  # of what an arm should turn, until it is clear of the body
ASTRAY = np.radians(2.0)  # by which a hand may point farther past its aim than without other blocks


@dataclass(frozen=True, eq=False)
class PointingHand:
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
        frames, arm = robot.skeleton.frames(angles), robot.arm(self.side)
        line, wanted = frames.rotations[arm.wrist] @ arm.palm.position, self.aim - frames.origins[arm.wrist]
        return float(np.arctan2(np.linalg.norm(np.cross(line, wanted)), line @ wanted))

    def arm(self, angles: Floats, robot: Robot) -> Floats:
        """(n,) [rad] the posture with the arm that points, on the trunk as it is."""
        if self.hand.reach is None:
            return angles
        reach = aim_from_shoulder(self.hand.reach, self.aim, self.side, angles, robot)
        return with_arms(angles, {self.side: self.hand}, {self.side: reach}, robot)


def pointing_hands(plan: Plan) -> tuple[PointingHand, ...]:
    """The hands that point in a plan."""
    return tuple(
        PointingHand(id, side, hand, hand.aim)
        for frame in plan.keyframes.frames
        for id, sync in frame.syncs
        if sync == "stroke"
        for side, hand in frame.hands.items()
        if f"{side}_hand" in plan.keyframes.uses[id] and hand.aim is not None
    )


def correct_pointing(
    motion: Trajectory,
    time: float,
    one: PointingHand,
    stroke: float,
    busy: Occupancy,
    others: Sequence[Occupancy],
    setup: Setup,
) -> Trajectory | None:
    """The motion with an arm that points again in its stroke, and from there until it relaxes, or as far as it can.

    Args:
        motion: within the limits and clear of the body.
        time: [s] from which it may change, at the next knot.
        one: the hand.
        stroke: [s] at which it points.
        busy: what its behaviour needs.
        others: what else the motion does; other works of the hand stay as they are.
        setup: the robot.

    Returns:
        None where servos cannot, or the body would come too near to itself.
    """
    robot, limits = setup.robot, roomy(setup.limits)
    posture = motion.sample(np.array([stroke]))[0][0]
    change = one.arm(posture, robot) - posture
    time, stroke, busy = time - motion.start, stroke - motion.start, busy.later(-motion.start)
    same = [other.later(-motion.start) for other in others if f"{one.side}_hand" in other.roles]
    begin = max([busy.begin, time, *(other.relax for other in same if other.ready < stroke)])
    end = min([busy.end, *(other.ready for other in same if other.ready > stroke)])
    count = max(len(motion.controls), ceil(end / STEP) + 3 * LEAST)
    times = np.asarray((np.arange(count) - LEAST) * STEP, dtype=np.float64)
    share = rise(times, begin, stroke - LEAST * STEP) * (1.0 - rise(times, busy.relax, end))
    first, last = knot_at(begin), min(ceil(end / STEP) + LEAST, count - LEAST)
    for part in PARTS if last - first >= LEAST else ():
        found = np.array(lengthen(motion.controls, count))
        for hinge in np.flatnonzero(np.abs(change) > SAME).tolist():
            column = keep_limits(found[:, hinge] + part * share * change[hinge], first, last, limits, hinge)
            found[:, hinge] = found[:, hinge] if column is None else column
        if _clear(found, motion, first, last, setup):
            return replace(motion, controls=sealed(shorten(found)))
    return None


def _clear(found: Floats, motion: Trajectory, first: int, last: int, setup: Setup) -> bool:
    """Whether nothing comes too near or is overloaded between two knots."""
    after, before = (
        from_knot(lengthen(controls, len(found))[: last + LEAST], first) for controls in (found, motion.controls)
    )
    peaks = duties(after, setup)
    if (peaks > np.maximum(FULL, duties(before, setup))).any():
        return False
    least = setup.robot.least_clearance + LAG_RESERVE
    return float(scan_clearance(after, setup.distances)[1].distances.min()) >= least


def aim_again(before: Scene, scene: Scene, now: float) -> Scene:
    """Has hands that point keep to it, where the motion was so changed that they miss by more than `ASTRAY`.

    Args:
        before: with the motion as it was; of a block that has just begun, or is improved, its own plan counts.
        scene: with the motion as it is.
        now: [s] global time.

    Returns:
        The scene in which arms are turned back to what they point at in strokes to come; it says a warning for each
        that servos cannot turn so far, or not without coming too near to the body.
    """
    for staged in scene.playing if scene.motion is not before.motion else ():
        for one in pointing_hands(staged.ready.plan):
            scene = _one(before, scene, staged.id, one, now)
    return scene


def _one(before: Scene, scene: Scene, block: str, one: PointingHand, now: float) -> Scene:
    staged = scene.find(block)
    busy = next((each for each in staged.busy if each.behaviour == one.behaviour), None) if staged else None
    if staged is None or staged.merged is None or busy is None:
        return scene
    time = staged.zero + staged.times[one.behaviour]["stroke"]
    change, usual = scene.first_change(now), _usual(before, staged, one, time)
    if time <= change or _miss(scene.motion, time, one, scene) <= usual + ASTRAY:
        return scene
    others = [*scene.busy_but(block), *(each for each in staged.busy if each is not busy)]
    found = correct_pointing(scene.motion, change, one, time, busy, others, scene.setup)
    if found is not None and _miss(found, time, one, scene) < _miss(scene.motion, time, one, scene):
        scene = _with(scene, staged, one.behaviour, found)
    left = _miss(scene.motion, time, one, scene)
    if left <= usual + ASTRAY:
        return scene
    text = f"its hand points {np.degrees(left):.0f} deg past its target: other blocks move the trunk meanwhile"
    notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block}:{one.behaviour}", text)
    return scene.say(staged.warning(notice, now))


def _usual(before: Scene, staged: RunningBlock, one: PointingHand, time: float) -> float:
    """By how much a hand pointed past its aim before, or does in its own plan [rad]."""
    earlier, plan = before.find(staged.id), staged.ready.plan
    if earlier is not None and earlier.merged is not None and earlier.ready.plan is plan:
        return _miss(before.motion, time, one, before)
    asked = next(sync.planned for sync in plan.syncs if (sync.behaviour, sync.sync) == (one.behaviour, "stroke"))
    return _miss(plan.trajectory, plan.trajectory.zero + asked, one, before)


def _miss(motion: Trajectory, time: float, one: PointingHand, scene: Scene) -> float:
    return one.miss(motion.sample(np.array([time]))[0][0], scene.setup.robot)


def _with(scene: Scene, staged: RunningBlock, behaviour: str, motion: Trajectory) -> Scene:
    """The scene with another motion, whose difference is the behaviour's of a block."""
    if staged.merged is None:
        return replace(scene, motion=motion)
    layer = staged.merged.layer
    count = max(len(motion.controls), len(scene.motion.controls), len(layer.controls))
    own, was, after = (lengthen(each.controls, count) for each in (layer, scene.motion, motion))
    change = after - was
    moved = np.abs(change).max(axis=0) > STILL
    needs = [
        replace(each, hinges=each.hinges | moved) if each.behaviour == behaviour else each
        for each in staged.merged.busy
    ]
    merged = replace(
        staged.merged, trajectory=motion, layer=replace(layer, controls=sealed(own + change)), busy=tuple(needs)
    )
    return replace(scene, motion=motion).put(replace(staged, merged=merged))
