"""Correction of pointing hands while other blocks move the trunk.

The sender is warned if an arm cannot compensate for the trunk.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Hand
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import (
    MIN_TRANSITION,
    SAME_ANGLE,
    extend_controls,
    keep_limits,
    knot_at,
    trim_final_rest,
    widen_limits,
)
from kinesic.planning.arm_postures import with_arms
from kinesic.planning.certify import compute_peak_duties
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.impact_limits import find_worst_excess
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.torso import aim_from_shoulder
from kinesic.realizer.held import smooth_step
from kinesic.realizer.occupancy import MOTION_TOLERANCE, Occupancy
from kinesic.realizer.release import motion_from_knot
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene

MAX_DUTY = 1.0  # largest accepted duty of a drive, as a fraction of full PWM
CORRECTION_FACTORS = (1.0, 0.8, 0.5)  # fractions of the full correction, tried until one is free of collisions
POINTING_TOLERANCE = np.radians(2.0)  # [rad] largest accepted increase of the pointing error in a scene


@dataclass(frozen=True, eq=False)
class PointingHand:
    """Hand that points at a target in the stroke of a behaviour."""

    behaviour: str
    side: Side
    hand: Hand
    aim: Floats  # (3,) [m] in the world

    def miss(self, angles: Floats, robot: Robot) -> float:
        """Return the pointing error [rad], as seen from the wrist.

        Args:
            angles: (n,) [rad] of the whole robot.
            robot: robot of the hand.
        """
        frames, arm = robot.skeleton.frames(angles), robot.arm(self.side)
        line, to_aim = frames.rotations[arm.wrist] @ arm.palm.position, self.aim - frames.origins[arm.wrist]
        return float(np.arctan2(np.linalg.norm(np.cross(line, to_aim)), line @ to_aim))

    def arm(self, angles: Floats, robot: Robot) -> Floats:
        """Return the posture (n,) [rad] with the arm aimed at its target.

        The trunk stays as in the given posture.
        """
        if self.hand.reach is None:
            return angles
        shoulder = robot.body_frames(angles).origins[robot.arm(self.side).shoulder]
        reach = aim_from_shoulder(self.hand.reach, self.aim, self.side, shoulder, robot)
        return with_arms(angles, {self.side: self.hand}, {self.side: reach}, robot)


@dataclass(frozen=True, eq=False)
class PointingStroke:
    """Stroke of a pointing hand in a motion, with its time."""

    pointer: PointingHand
    time: float  # [s] time of the stroke in the motion
    occupancy: Occupancy  # occupancy of the pointing behaviour

    def miss(self, motion: Trajectory, robot: Robot) -> float:
        """Return the pointing error [rad] at the stroke time of a motion."""
        return self.pointer.miss(motion.at(self.time).angles, robot)


def pointing_hands(plan: Plan) -> tuple[PointingHand, ...]:
    """Return each hand that aims at a target in a stroke.

    A hand occurs once per stroke.
    """
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
    """Turn an arm so that its hand points at its target again.

    The correction covers the stroke up to its relax point and is reduced if necessary.

    Args:
        motion: motion within limits and without collisions.
        time: time [s] from which it may change, rounded up to a knot.
        stroke: stroke of the hand.
        others: other occupancies of the motion; other behaviours of the hand stay unchanged.
        setup: setup with the robot.

    Returns:
        The corrected motion, or None if it would exceed limits or collide.
    """
    robot, limits = setup.robot, widen_limits(setup.limits)
    posture = motion.at(stroke.time).angles
    change = stroke.pointer.arm(posture, robot) - posture
    at, occupancy = stroke.time - motion.start, stroke.occupancy.shifted(-motion.start)
    same = [other.shifted(-motion.start) for other in others if f"{stroke.pointer.side}_hand" in other.roles]
    begin = max([occupancy.begin, time - motion.start, *(other.relax for other in same if other.ready < at)])
    end = min([occupancy.end, *(other.ready for other in same if other.ready > at)])
    count = max(len(motion.controls), ceil(end / KNOT_INTERVAL) + 3 * MIN_TRANSITION)
    times = np.asarray((np.arange(count) - MIN_TRANSITION) * KNOT_INTERVAL, dtype=np.float64)
    weight = smooth_step(times, begin, at - MIN_TRANSITION * KNOT_INTERVAL) * (
        1.0 - smooth_step(times, occupancy.relax, end)
    )
    first, last = knot_at(begin), ceil(end / KNOT_INTERVAL) + MIN_TRANSITION
    for factor in CORRECTION_FACTORS if last - first >= MIN_TRANSITION else ():
        controls = np.array(extend_controls(motion.controls, count))
        for hinge in np.flatnonzero(np.abs(change) > SAME_ANGLE).tolist():
            column = keep_limits(controls[:, hinge] + factor * weight * change[hinge], first, last, limits, hinge)
            controls[:, hinge] = controls[:, hinge] if column is None else column
        if _is_feasible(controls, motion, first, last, setup):
            return replace(motion, controls=sealed(trim_final_rest(controls)))
    return None


def _is_feasible(corrected: Floats, motion: Trajectory, first: int, last: int, setup: Setup) -> bool:
    """Return whether a corrected motion is feasible between two knots.

    It must avoid collisions, drive overload and contacts beyond the policy.
    """
    after, before = (
        motion_from_knot(extend_controls(controls, len(corrected))[: last + MIN_TRANSITION], first)
        for controls in (corrected, motion.controls)
    )
    peaks = compute_peak_duties(after, setup)
    if (peaks > np.maximum(MAX_DUTY, compute_peak_duties(before, setup))).any():
        return False
    if find_worst_excess(after, before, setup) is not None:
        return False
    min_clearance = setup.robot.min_clearance + LAG_RESERVE
    return float(scan_clearance(after, setup.distances)[1].distances.min()) >= min_clearance


def restore_pointing(before: Scene, scene: Scene, now: float) -> Scene:
    """Correct all hands whose pointing error grew by more than `POINTING_TOLERANCE`.

    Args:
        before: scene before the change; for a started or refined block, the block's own plan is the reference.
        scene: scene after the change.
        now: global time [s].

    Returns:
        The scene with corrected arms in future strokes, and a warning for each hand that cannot be corrected
        completely.
    """
    for running in scene.playing if scene.motion is not before.motion else ():
        for pointer in pointing_hands(running.prepared.plan):
            scene = _restore_hand(before, scene, running.id, pointer, now)
    return scene


def _restore_hand(before: Scene, scene: Scene, block: str, pointer: PointingHand, now: float) -> Scene:
    running, robot = scene.find(block), scene.setup.robot
    occupancy = running.occupancy if running is not None else ()
    stroke_entry = next((entry for entry in occupancy if entry.behaviour == pointer.behaviour), None)
    if running is None or running.merged is None or stroke_entry is None:
        return scene
    stroke = PointingStroke(pointer, running.zero + running.times[pointer.behaviour]["stroke"], stroke_entry)
    change, usual = scene.first_change(now), _reference_miss(before, running, stroke)
    if stroke.time <= change or stroke.miss(scene.motion, robot) <= usual + POINTING_TOLERANCE:
        return scene
    others = [*scene.occupancy_without(block), *(entry for entry in occupancy if entry is not stroke_entry)]
    corrected = correct_pointing(scene.motion, change, stroke, others, scene.setup)
    if corrected is not None and stroke.miss(corrected, robot) < stroke.miss(scene.motion, robot):
        scene = _with_motion(scene, running, pointer.behaviour, corrected)
    miss = stroke.miss(scene.motion, robot)
    if miss <= usual + POINTING_TOLERANCE:
        return scene
    text = f"its hand points {np.degrees(miss):.0f} deg off its target, because other blocks move the trunk"
    notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block}:{pointer.behaviour}", text)
    return scene.with_feedback(running.warning(notice, now))


def _reference_miss(before: Scene, running: RunningBlock, stroke: PointingStroke) -> float:
    """Return a stroke's pointing error [rad] before the scene changed.

    For a started or refined block it is that of its plan.
    """
    earlier, plan, robot = before.find(running.id), running.prepared.plan, before.setup.robot
    if earlier is not None and earlier.merged is not None and earlier.prepared.plan is plan:
        return stroke.miss(before.motion, robot)
    name = (stroke.pointer.behaviour, "stroke")
    planned = next(sync.planned for sync in plan.syncs if (sync.behaviour, sync.sync) == name)
    return replace(stroke, time=plan.trajectory.zero + planned).miss(plan.trajectory, robot)


def _with_motion(scene: Scene, running: RunningBlock, behaviour: str, motion: Trajectory) -> Scene:
    """Replace the scene's motion and assign the change to a behaviour."""
    if running.merged is None:
        return replace(scene, motion=motion)
    layer = running.merged.layer
    count = max(len(motion.controls), len(scene.motion.controls), len(layer.controls))
    layer_controls, old_controls, new_controls = (
        extend_controls(entry.controls, count) for entry in (layer, scene.motion, motion)
    )
    change = new_controls - old_controls
    moved = np.abs(change).max(axis=0) > MOTION_TOLERANCE
    occupancy = tuple(
        replace(entry, hinges=entry.hinges | moved) if entry.behaviour == behaviour else entry
        for entry in running.merged.occupancy
    )
    layer = replace(layer, controls=sealed(layer_controls + change))
    merged = replace(running.merged, trajectory=motion, layer=layer, occupancy=occupancy)
    return replace(scene, motion=motion).with_block(replace(running, merged=merged))
