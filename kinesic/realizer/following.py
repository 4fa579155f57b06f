"""Gaze and posture that follow people, beneath the blocks of a scene.

The followed gaze is a held posture of the role `look`, like that of an ended `gazeShift`: gestures and nods add to it,
a gaze of a block replaces it, and the head returns to it afterwards. A change of it is a smooth step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import (
    MIN_TRANSITION,
    extend_controls,
    knot_at,
    largest_limit_ratios,
    trim_final_rest,
    widen_limits,
)
from kinesic.planning.certify import compute_peak_duties
from kinesic.planning.clearance import MIN_LAG_RESERVE, scan_clearance
from kinesic.planning.torso import compute_torso_turn
from kinesic.realizer.conflicts import MAX_DUTY
from kinesic.realizer.follow_steps import FOLLOWING_PREFIX, TRUNK_CHAINS, FollowStep, fit_step
from kinesic.realizer.held import last_held, smooth_step, trunk_hinges
from kinesic.realizer.occupancy import Occupancy, Role, held_angles
from kinesic.realizer.release import motion_from_knot
from kinesic.realizer.scene import Scene

UNCHANGED_ANGLE = 1e-4  # [rad] smaller changes of an angle are ignored
FOLLOWED_ROLES: tuple[Role, ...] = (
    "look",
    "trunk",
)  # gaze and posture, which follow people between blocks
MAX_LIMIT_RATIO = 1.0 + 1e-6  # largest accepted ratio of velocity, acceleration or jerk to its limit
NOD_DOWN_DURATION = 0.3  # [s] downward half of a nod
NOD_UP_DURATION = 0.36  # [s] upward half of a nod


def follow(scene: Scene, turns: HeldTurns | None, now: float) -> Scene:
    """Move head and trunk smoothly to a followed gaze or posture.

    Args:
        scene: scene, advanced to `now`.
        turns: rotations to hold; None returns a followed gaze and posture to rest.
        now: global time [s]; the motion changes at `scene.first_change(now)` at the earliest.

    Returns:
        The unchanged scene while a block uses the same role, or if no step keeps limits and clearance.
    """
    if turns is not None:
        return _follow_role(
            scene, "look" if turns.kind == "look" else "trunk", held_angles(turns, scene.setup.robot), now
        )
    for role in FOLLOWED_ROLES:
        if _find_followed(scene, role) is not None:
            scene = _follow_role(scene, role, np.zeros(len(scene.setup.limits.lower)), now)
    return scene


def nod(scene: Scene, angle: float, now: float) -> Scene:
    """Add one nod of the head to the motion.

    Args:
        scene: scene, advanced to `now`.
        angle: [rad] downward.
        now: global time [s]; the motion changes at `scene.first_change(now)` at the earliest.

    Returns:
        The unchanged scene while a block nods or shakes the head, or if the nod violates limits or clearance.
    """
    change = _Change.of(scene, now)
    end = change.begin + NOD_DOWN_DURATION + NOD_UP_DURATION
    if any("sign" in entry.roles and entry.begin < end and entry.end > change.begin for entry in scene.occupancy):
        return scene
    offset = held_angles(HeldTurns("look", Turn(tilt=angle)), scene.setup.robot)
    middle = change.begin + NOD_DOWN_DURATION
    times = change.times(end)
    shape = smooth_step(times, change.begin, middle) - smooth_step(times, middle, end)
    added = change.fits(shape[:, None] * offset)
    return scene if added is None else replace(scene, motion=added)


def find_final_posture(motion: Trajectory, robot: Robot) -> tuple[Occupancy, ...]:
    """Return the head and trunk posture at the end of a motion.

    It counts as a followed gaze, so that the next gaze replaces it instead of adding to it.
    """
    hinges = trunk_hinges(robot)
    offset = np.where(hinges, motion.controls[-1] - robot.skeleton.rest, 0.0)
    if np.abs(offset).max() < UNCHANGED_ANGLE:
        return ()
    return (Occupancy(_name("look"), frozenset({"look"}), hinges, *(4 * (motion.start,)), sealed(offset)),)


def is_looking_elsewhere(scene: Scene, now: float) -> bool:
    """Return whether a block determines the gaze at a time [s]."""
    return _uses(scene, "look", now)


@dataclass(frozen=True, eq=False)
class _Change:
    """Change of a scene's motion from a knot on."""

    scene: Scene
    knot: int  # first knot that may change

    @classmethod
    def of(cls, scene: Scene, now: float) -> "_Change":
        return cls(scene, knot_at(scene.first_change(now) - scene.motion.start))

    @property
    def begin(self) -> float:
        """Global time [s] of the first knot that may change."""
        return self.scene.motion.start + self.knot * KNOT_INTERVAL

    def times(self, end: float) -> Floats:
        """Return the times [s] of the control points until an end time.

        Their shape is (k + 3,). They reach the motion's end at least.
        """
        pieces = knot_at(end - self.scene.motion.start) + MIN_TRANSITION
        count = max(len(self.scene.motion.controls), pieces + MIN_TRANSITION)
        return np.asarray(self.scene.motion.start + (np.arange(count) - MIN_TRANSITION) * KNOT_INTERVAL)

    def fits(self, added: Floats) -> Trajectory | None:
        """Return the motion with added offsets, or None if it is infeasible.

        A feasible motion keeps limits, clearance and drive duty.

        Args:
            added: (k + 3, n) [rad] offsets of control points.
        """
        motion, setup = self.scene.motion, self.scene.setup
        controls = extend_controls(motion.controls, len(added)) + added
        moved = np.flatnonzero(np.abs(added).max(axis=0) > 0.0)
        limits = widen_limits(setup.limits)
        if (largest_limit_ratios(controls[self.knot :, moved], limits.part(moved)) > MAX_LIMIT_RATIO).any():
            return None
        changed = replace(motion, controls=sealed(trim_final_rest(controls)))
        _, clearance = scan_clearance(motion_from_knot(changed.controls, self.knot), setup.distances)
        near = clearance.distances[clearance.worst] < setup.robot.min_clearance + MIN_LAG_RESERVE
        return None if near or self._overloads(changed, moved.tolist()) else changed

    def _overloads(self, changed: Trajectory, moved: Sequence[int]) -> bool:
        """Return whether the changed motion causes or increases a drive's overload.

        Only motions of the trunk are checked.
        """
        motion, setup = self.scene.motion, self.scene.setup
        if not set(moved) & set(setup.robot.joints("torso")):
            return False
        before = extend_controls(motion.controls, len(changed.controls))
        peaks, earlier = (
            compute_peak_duties(motion_from_knot(controls, self.knot), setup) for controls in (changed.controls, before)
        )
        return bool(((peaks > MAX_DUTY) & (peaks > earlier)).any())


def _follow_role(scene: Scene, role: Role, offset: Floats, now: float) -> Scene:
    """Move gaze or posture (`role`) to an offset (n,) [rad] from rest."""
    change = _Change.of(scene, now)
    if _uses(scene, role, change.begin) or (scene.replans and _is_used_later(scene, role, change.begin)):
        return scene
    robot, hinges = scene.setup.robot, trunk_hinges(scene.setup.robot)
    past = [entry for entry in scene.occupancy if entry.end <= change.begin or _is_followed(entry)]
    difference = np.where(hinges, offset - last_held(role, past, hinges), 0.0)
    difference = _within_range(change, difference)
    if np.abs(difference).max() < UNCHANGED_ANGLE:
        return scene
    steps = _steps(change, difference, robot)
    if steps is None:
        return scene
    times = change.times(max(step.end for step in steps))
    added = np.zeros((len(times), len(difference)))
    for step in steps:
        joints = list(robot.joints(step.chain))
        added[:, joints] = step.progress(times)[:, None] * difference[joints]
    added *= _fraction_beneath_blocks(scene, role, change.begin, times)[:, None]
    motion = change.fits(added)
    if motion is None:
        return scene
    kept = tuple(entry for entry in scene.lasting if not entry.holds(role))
    total = last_held(role, past, hinges) + difference
    if np.abs(total).max() > UNCHANGED_ANGLE:
        kept += (Occupancy(_name(role), frozenset({role}), hinges, *(4 * (change.begin,)), sealed(total)),)
    following = tuple(step for step in scene.following if step.end > change.begin)
    return replace(scene, motion=motion, lasting=kept, following=(*following, *steps))


def _steps(change: _Change, difference: Floats, robot: Robot) -> list[FollowStep] | None:
    """Return the comfortable steps of neck and torso, or None."""
    steps = []
    for chain in TRUNK_CHAINS:
        turn = compute_torso_turn(robot, chain, difference)
        if np.abs(turn).max(initial=0.0) < UNCHANGED_ANGLE:
            continue
        step = fit_step(chain, turn, change.begin, change.scene.following)
        if step is None:
            return None
        steps.append(step)
    return steps or None


def _within_range(change: _Change, difference: Floats) -> Floats:
    """Clip an offset (n,) [rad] to the joint ranges.

    The offset applies to the rest of the motion.
    """
    limits, rest = change.scene.setup.limits, change.scene.motion.controls[change.knot :]
    rest = rest if len(rest) else change.scene.motion.controls[-1:]
    low, high = limits.lower - rest.min(axis=0), limits.upper - rest.max(axis=0)
    return np.asarray(np.clip(difference, np.minimum(low, 0.0), np.maximum(high, 0.0)))


def _fraction_beneath_blocks(scene: Scene, role: Role, begin: float, times: Floats) -> Floats:
    """Return the weight (m,) of a followed posture at times (m,) [s].

    It is zero while a later behaviour of a block uses the role.
    """
    fraction = np.ones(len(times))
    for entry in _entries(scene, role):
        if entry.begin >= begin:
            used = smooth_step(times, entry.begin, entry.ready)
            if not entry.is_held:
                used = used - smooth_step(times, entry.relax, entry.end)
            fraction = fraction * (1.0 - used)
    return fraction


def _entries(scene: Scene, role: Role) -> Sequence[Occupancy]:
    """Return the occupancies of running blocks in a role."""
    return [entry for running in scene.playing for entry in running.occupancy if role in entry.roles]


def _uses(scene: Scene, role: Role, time: float) -> bool:
    """Return whether a running block uses a role at a time [s]."""
    return any(entry.begin < time < entry.end for entry in _entries(scene, role))


def _is_used_later(scene: Scene, role: Role, time: float) -> bool:
    return any(entry.end > time for entry in _entries(scene, role))


def _find_followed(scene: Scene, role: Role) -> Occupancy | None:
    return next((entry for entry in scene.lasting if entry.behaviour == _name(role)), None)


def _is_followed(entry: Occupancy) -> bool:
    return entry.behaviour.startswith(FOLLOWING_PREFIX)


def _name(role: Role) -> str:
    return f"{FOLLOWING_PREFIX}{role}"
