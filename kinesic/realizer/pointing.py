"""Keeps hands pointing at their targets when other blocks move the trunk below them.

Where an arm cannot make up for the trunk, the sender is warned.
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
from kinesic.motion.transition import FEWEST_PIECES, SAME_ANGLE, keep_limits, knot_at, lengthen, roomy, shorten
from kinesic.planning.arm_postures import with_arms
from kinesic.planning.certify import duties
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.torso import aim_from_shoulder
from kinesic.realizer.held import rise
from kinesic.realizer.occupancy import STILL, Occupancy
from kinesic.realizer.release import from_knot
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene

FULL_DUTY = 1.0  # of a drive's duty
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
        """Measures the angle [rad] by which the hand, seen from the wrist, points past the aim.

        Args:
            angles: (n,) [rad] of the whole robot.
            robot: whose hand it is.
        """
        frames, arm = robot.skeleton.frames(angles), robot.arm(self.side)
        line, to_aim = frames.rotations[arm.wrist] @ arm.palm.position, self.aim - frames.origins[arm.wrist]
        return float(np.arctan2(np.linalg.norm(np.cross(line, to_aim)), line @ to_aim))

    def arm(self, angles: Floats, robot: Robot) -> Floats:
        """Turns the arm so that it points, on the trunk as it is: (n,) [rad]."""
        if self.hand.reach is None:
            return angles
        shoulder = robot.body_frames(angles).origins[robot.arm(self.side).shoulder]
        reach = aim_from_shoulder(self.hand.reach, self.aim, self.side, shoulder, robot)
        return with_arms(angles, {self.side: self.hand}, {self.side: reach}, robot)


@dataclass(frozen=True, eq=False)
class PointingStroke:
    """The moment at which a hand of a motion points."""

    pointer: PointingHand
    time: float  # [s]
    occupancy: Occupancy  # of its behaviour

    def miss(self, motion: Trajectory, robot: Robot) -> float:
        """By how much the hand points past its aim [rad]."""
        return self.pointer.miss(motion.sample(np.array([self.time]))[0][0], robot)


def pointing_hands(plan: Plan) -> tuple[PointingHand, ...]:
    """Finds the hands that point in a plan."""
    return tuple(
        PointingHand(id, side, hand, hand.aim)
        for frame in plan.keyframes.frames
        for id, sync in frame.syncs
        if sync == "stroke"
        for side, hand in frame.hands.items()
        if f"{side}_hand" in plan.keyframes.uses[id] and hand.aim is not None
    )


def correct_pointing(
    motion: Trajectory, time: float, stroke: PointingStroke, others: Sequence[Occupancy], setup: Setup
) -> Trajectory | None:
    """Turns an arm so that its hand points again in its stroke and until it relaxes, or as far as it can.

    Args:
        motion: within the limits and clear of the body.
        time: [s] from which it may change, at the next knot.
        stroke: of the hand.
        others: what else the motion does; other works of the hand stay as they are.
        setup: the robot.

    Returns:
        The motion with the arm turned; None where servos cannot, or the body would come too near to itself.
    """
    robot, limits = setup.robot, roomy(setup.limits)
    posture = motion.sample(np.array([stroke.time]))[0][0]
    change = stroke.pointer.arm(posture, robot) - posture
    at, own = stroke.time - motion.start, stroke.occupancy.later(-motion.start)
    same = [other.later(-motion.start) for other in others if f"{stroke.pointer.side}_hand" in other.roles]
    begin = max([own.begin, time - motion.start, *(other.relax for other in same if other.ready < at)])
    end = min([own.end, *(other.ready for other in same if other.ready > at)])
    count = max(len(motion.controls), ceil(end / STEP) + 3 * FEWEST_PIECES)
    times = np.asarray((np.arange(count) - FEWEST_PIECES) * STEP, dtype=np.float64)
    share = rise(times, begin, at - FEWEST_PIECES * STEP) * (1.0 - rise(times, own.relax, end))
    first, last = knot_at(begin), min(ceil(end / STEP) + FEWEST_PIECES, count - FEWEST_PIECES)
    for part in PARTS if last - first >= FEWEST_PIECES else ():
        found = np.array(lengthen(motion.controls, count))
        for hinge in np.flatnonzero(np.abs(change) > SAME_ANGLE).tolist():
            column = keep_limits(found[:, hinge] + part * share * change[hinge], first, last, limits, hinge)
            found[:, hinge] = found[:, hinge] if column is None else column
        if _clear(found, motion, first, last, setup):
            return replace(motion, controls=sealed(shorten(found)))
    return None


def _clear(found: Floats, motion: Trajectory, first: int, last: int, setup: Setup) -> bool:
    """Whether nothing comes too near or is overloaded between two knots."""
    after, before = (
        from_knot(lengthen(controls, len(found))[: last + FEWEST_PIECES], first)
        for controls in (found, motion.controls)
    )
    peaks = duties(after, setup)
    if (peaks > np.maximum(FULL_DUTY, duties(before, setup))).any():
        return False
    least = setup.robot.least_clearance + LAG_RESERVE
    return float(scan_clearance(after, setup.distances)[1].distances.min()) >= least


def aim_again(before: Scene, scene: Scene, now: float) -> Scene:
    """Turns hands back to their targets where the motion was so changed that they miss by more than `ASTRAY`.

    Args:
        before: with the motion as it was; of a block that has just begun, or is improved, its own plan counts.
        scene: with the motion as it is.
        now: [s] global time.

    Returns:
        The scene in which arms are turned back to what they point at in strokes to come; it says a warning for each
        that servos cannot turn so far, or not without coming too near to the body.
    """
    for running in scene.playing if scene.motion is not before.motion else ():
        for pointer in pointing_hands(running.prepared.plan):
            scene = _aim_one_again(before, scene, running.id, pointer, now)
    return scene


def _aim_one_again(before: Scene, scene: Scene, block: str, pointer: PointingHand, now: float) -> Scene:
    running, robot = scene.find(block), scene.setup.robot
    occupancy = running.occupancy if running is not None else ()
    own = next((each for each in occupancy if each.behaviour == pointer.behaviour), None)
    if running is None or running.merged is None or own is None:
        return scene
    stroke = PointingStroke(pointer, running.zero + running.times[pointer.behaviour]["stroke"], own)
    change, usual = scene.first_change(now), _usual_miss(before, running, stroke)
    if stroke.time <= change or stroke.miss(scene.motion, robot) <= usual + ASTRAY:
        return scene
    others = [*scene.occupancy_without(block), *(each for each in occupancy if each is not own)]
    corrected = correct_pointing(scene.motion, change, stroke, others, scene.setup)
    if corrected is not None and stroke.miss(corrected, robot) < stroke.miss(scene.motion, robot):
        scene = _with_motion(scene, running, pointer.behaviour, corrected)
    miss = stroke.miss(scene.motion, robot)
    if miss <= usual + ASTRAY:
        return scene
    text = f"its hand points {np.degrees(miss):.0f} deg past its target: other blocks move the trunk meanwhile"
    notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block}:{pointer.behaviour}", text)
    return scene.say(running.warning(notice, now))


def _usual_miss(before: Scene, running: RunningBlock, stroke: PointingStroke) -> float:
    """Measures by how much a hand pointed past its aim before this change, or does in its own plan [rad]."""
    earlier, plan, robot = before.find(running.id), running.prepared.plan, before.setup.robot
    if earlier is not None and earlier.merged is not None and earlier.prepared.plan is plan:
        return stroke.miss(before.motion, robot)
    name = (stroke.pointer.behaviour, "stroke")
    planned = next(sync.planned for sync in plan.syncs if (sync.behaviour, sync.sync) == name)
    return replace(stroke, time=plan.trajectory.zero + planned).miss(plan.trajectory, robot)


def _with_motion(scene: Scene, running: RunningBlock, behaviour: str, motion: Trajectory) -> Scene:
    """The scene with another motion, whose difference is due to a behaviour of a block."""
    if running.merged is None:
        return replace(scene, motion=motion)
    layer = running.merged.layer
    count = max(len(motion.controls), len(scene.motion.controls), len(layer.controls))
    own, was, after = (lengthen(each.controls, count) for each in (layer, scene.motion, motion))
    change = after - was
    moved = np.abs(change).max(axis=0) > STILL
    occupancy = tuple(
        replace(each, hinges=each.hinges | moved) if each.behaviour == behaviour else each
        for each in running.merged.occupancy
    )
    layer = replace(layer, controls=sealed(own + change))
    merged = replace(running.merged, trajectory=motion, layer=layer, occupancy=occupancy)
    return replace(scene, motion=motion).with_block(replace(running, merged=merged))
