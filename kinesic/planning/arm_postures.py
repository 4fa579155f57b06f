"""Inverse kinematics of the arms at key postures (thesis 8.6 and 8.7).

The reach sets the hand's target, openness the elbow's swivel, and effort the shoulder's posture. Many keys are solved
in one call, ignoring collisions. If a posture collides, it is corrected, and later keys are solved again from there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.keyframes import Hand
from kinesic.ik.arm.passive_shoulder import carry_shoulder
from kinesic.ik.arm.refine import refine_posture, true_arm
from kinesic.ik.keys import ArmMode, Key, ReachLimits, pose_keys
from kinesic.planning.collision import clear_hands
from kinesic.planning.torso import aim_from_shoulder, turn_reach

MAX_SWIVEL_CHANGE = float(np.radians(25))  # [rad] largest elbow swivel change for palm and pointing directions
MAX_HINGE_STEP = float(np.radians(110))  # [rad] hinge rotation between keys above which the elbow keeps its swivel
OPEN_SWIVEL = float(np.radians(78))  # [rad] elbow swivel at openness 1; above this, elbows rise and palms turn
# Limits on elbow and hinge changes between two keys.
REACH_LIMITS = ReachLimits(MAX_SWIVEL_CHANGE, MAX_HINGE_STEP, OPEN_SWIVEL)
MAX_KEYS_PER_CALL = 64  # largest number of keys solved together before collisions are checked


def with_arms(angles: Floats, hands: Mapping[Side, Hand], reaches: Mapping[Side, Reach | None], robot: Robot) -> Floats:
    """Return a posture with some arms moved to their targets.

    Args:
        angles: (n,) [rad] posture with the torso in place; arms start from here.
        hands: hands of the arms to be solved.
        reaches: targets of these hands in the world; None: rest.
        robot: the robot.

    Returns:
        (n,) [rad]. Openness turns the elbow from its hanging position to `OPEN_SWIVEL`, with priority over the palm.
    """
    solved, frames = angles.copy(), robot.body_frames(angles)
    for side, hand in hands.items():
        arm_key = ArmKey.of(robot, side, hand, reaches[side], frames)
        solved = solve_keys(robot, side, [arm_key], solved[None], path_start=None)[0][0]
    return solved


@dataclass(frozen=True, eq=False)
class ArmKey:
    """Inverse kinematics target of an arm at a key posture."""

    key: Key
    reach: Reach | None = None  # hand target in the world; None: at rest, or unchanged

    @classmethod
    def of(cls, robot: Robot, side: Side, hand: Hand, reach: Reach | None, frames: Frames) -> "ArmKey":
        """Convert a requested hand pose or rest pose to an arm target.

        A hand pose is converted to the axes of the segment that carries the arm.

        Args:
            robot: with the arm.
            side: of the hand.
            hand: requested pose.
            reach: of the hand in the world; None: rest.
            frames: of the body, torso in place.
        """
        chain = robot.arms[side]
        if reach is None:
            return cls(Key(ArmMode.REST, robot.skeleton.rest[list(chain.indices)]))
        base = robot.skeleton.segment(chain.base)
        in_base = turn_reach(reach, frames.rotations[base].T, frames.origins[base], np.zeros(3))
        rest = lift_shoulder(robot, side, carry_shoulder(chain, in_base.position, hand.effort), hand.lift)
        return cls(Key(ArmMode.REACH, rest, in_base, hand.openness, hand.passing), reach)

    @classmethod
    def same(cls, robot: Robot, side: Side, hand: Hand) -> "ArmKey":
        """Make a key at which the arm keeps its previous posture."""
        return cls(Key(ArmMode.STILL, robot.skeleton.rest[list(robot.arms[side].indices)], passing=hand.passing))


def solve_keys(
    robot: Robot, side: Side, keys: Sequence[ArmKey], postures: Floats, *, path_start: Floats | None
) -> tuple[Floats, Floats]:
    """Solve the inverse kinematics of one arm at successive keys.

    Args:
        robot: with the arm.
        side: of the arm.
        keys: in their order; a single one if the ideal arm differs from the true one.
        postures: (m, n) [rad] of these keys with their torsos in place; the first has the current arm.
        path_start: (k,) [rad] arm at the start of the current hand path; None: the hand is on no path.

    Returns:
        (m, n) [rad] postures with this arm, and (m, k) [rad] arm at the start of the path after each key.
    """
    chain, joints = robot.arms[side], list(robot.arm(side).joints)
    indices, solved = list(chain.indices), postures.copy()
    solution = pose_keys(
        chain, [arm_key.key for arm_key in keys], REACH_LIMITS, start=postures[0, indices], path_start=path_start
    )
    beginnings = solution.beginnings
    for k, arm_key in enumerate(keys):
        if arm_key.key.mode is ArmMode.REST:
            solved[k, joints] = robot.skeleton.rest[joints]
    solved[:, indices] = solution.angles
    for k, arm_key in enumerate(keys):
        if arm_key.reach is None or true_arm(robot, side).exact:
            continue
        near = postures[k].copy()
        if arm_key.key.passing and path_start is not None:
            near[indices] = path_start
        swivel = None if np.isnan(solution.swivels[k]) else float(solution.swivels[k])
        solved[k] = refine_posture(robot, side, structs.replace(arm_key.reach, swivel=swivel), solved[k], near=near)
        if not (arm_key.key.passing and path_start is not None):
            beginnings[k] = solved[k, indices]
    return solved, beginnings


def lift_shoulder(robot: Robot, side: Side, rest: Floats, lift: float) -> Floats:
    """Raise the shoulder of an arm posture by an angle.

    Args:
        robot: with the arm.
        side: of the arm.
        rest: (k,) [rad] posture of the arm.
        lift: [rad].

    Returns:
        (k,) [rad] within the joint limits; unchanged without a hinge that lifts the shoulder.
    """
    if not lift:
        return rest
    raised, chain = np.array(rest), robot.arms[side]
    raised[[joint in robot.arm(side).shoulder_lift_joints for joint in chain.indices]] += lift
    return sealed(np.clip(raised, chain.lower, chain.upper))


@dataclass(frozen=True, eq=False)
class ArmsTask:
    """Targets of both hands at one key."""

    hands: Mapping[Side, Hand]  # hands with a key
    keys: Mapping[Side, ArmKey]  # inverse kinematics targets of the arms of these hands
    targets: Mapping[Side, Reach | None]  # targets of these hands in the world
    keyed: Sequence[bool]  # whether each hinge has a key

    @property
    def aiming(self) -> bool:
        """Whether a hand must point from its shoulder towards a target.

        Its reach is then known only after the previous key is solved.
        """
        return any(hand.aim is not None for hand in self.hands.values())

    def aimed(self, posture: Floats, robot: Robot) -> "ArmsTask":
        """Return the task with hands that point from the actual shoulder positions.

        Args:
            posture: (n,) [rad] with the shoulders.
            robot: the robot.
        """
        keys, targets, frames = dict(self.keys), dict(self.targets), robot.body_frames(posture)
        for side, hand in self.hands.items():
            if hand.aim is None or hand.reach is None:
                continue
            shoulder = frames.origins[robot.arm(side).shoulder]
            targets[side] = aim_from_shoulder(hand.reach, hand.aim, side, shoulder, robot)
            if keys[side].reach is not None:
                keys[side] = ArmKey.of(robot, side, hand, targets[side], frames)
        return replace(self, keys=keys, targets=targets)

    @property
    def reaches(self) -> bool:
        """Whether any hand has a position target."""
        return any(hand.reach is not None for hand in self.hands.values())


def solve_arms(
    tasks: Sequence[ArmsTask], bodies: Floats, robot: Robot, distances: Distances
) -> tuple[Floats, list[Mapping[Side, Reach | None]]]:
    """Solve collision-free postures of both arms at all keys.

    Args:
        tasks: of the keys, in their order.
        bodies: (m, n) [rad] postures with torso, head and fingers in place and arms at rest.
        robot: the robot.
        distances: self-distances of the robot.

    Returns:
        (m, n) [rad] within the joint limits, and the target of each hand in the world.
    """
    angles, path_starts = np.array(bodies), dict[Side, Floats]()
    targets: list[Mapping[Side, Reach | None]] = []
    max_count = MAX_KEYS_PER_CALL if all(true_arm(robot, side).exact for side in robot.sides) else 1
    first, count = 0, max_count
    while first < len(tasks):
        next_tasks = _list_independent_keys(tasks, first, count, angles[first], robot)
        rows, beginnings = _solved(next_tasks, angles[first : first + len(next_tasks)], path_starts, robot)
        collision_row = _cleared(next_tasks, rows, robot, distances)
        solved_count = len(rows) if collision_row is None else collision_row + 1
        angles[first : first + solved_count] = rows[:solved_count]
        for side in robot.sides:
            _carry(side, next_tasks[:solved_count], rows[:solved_count], beginnings, path_starts, robot)
            arm = list(robot.arm(side).joints)
            angles[first + solved_count :, arm] = rows[solved_count - 1, arm]
        targets += [task.targets for task in next_tasks[:solved_count]]
        first += solved_count
        count = min(2 * count, max_count) if collision_row is None else 1
    return angles, targets


def _list_independent_keys(
    tasks: Sequence[ArmsTask], first: int, count: int, posture: Floats, robot: Robot
) -> list[ArmsTask]:
    """Return the next keys whose arm postures can be solved together.

    These are at most `count`, and end before the next task with a pointing hand after the first one. The target of a
    pointing hand depends on the posture at the key before; that of the first task is set here.

    Args:
        tasks: of all keys.
        first: index of the next task.
        count: largest number of tasks.
        posture: (n,) [rad] current posture.
        robot: the robot.
    """
    next_task, others = tasks[first], tasks[first + 1 : first + count]
    aiming = next((k for k, task in enumerate(others) if task.aiming), len(others))
    return [next_task.aimed(posture, robot) if next_task.aiming else next_task, *others[:aiming]]


def _solved(
    tasks: Sequence[ArmsTask], postures: Floats, path_starts: Mapping[Side, Floats], robot: Robot
) -> tuple[Floats, Mapping[Side, Floats]]:
    """Solve the inverse kinematics of both arms, ignoring collisions.

    Returns:
        (m, n) [rad] postures, and the arm at the start of each hand's path.
    """
    rows, beginnings = postures.copy(), dict[Side, Floats]()
    for side in robot.sides:
        arm = np.array(robot.arm(side).joints)
        rows_of_side = [k for k, task in enumerate(tasks) if side in task.keys]
        if not rows_of_side:
            continue
        keys = [tasks[k].keys[side] for k in rows_of_side]
        solution, beginnings[side] = solve_keys(robot, side, keys, rows[rows_of_side], path_start=path_starts.get(side))
        latest = np.searchsorted(rows_of_side, np.arange(len(rows)), side="right") - 1  # otherwise the arm stays
        met = np.flatnonzero(latest >= 0)
        rows[met[:, None], arm] = solution[latest[met, None], arm]
    return robot.skeleton.clamp(rows), beginnings


def _cleared(tasks: Sequence[ArmsTask], rows: Floats, robot: Robot, distances: Distances) -> int | None:
    """Correct the first posture with too little or too much hand clearance.

    Hands keep the hover distance from the body, or approach the part that they touch. The posture changes in place.

    Returns:
        Index of that key; None if no posture changed.
    """
    reaching = [k for k, task in enumerate(tasks) if task.reaches]
    if not reaching:
        return None
    for k, gaps in zip(reaching, distances.gaps(rows[reaching]), strict=True):
        collision_row = clear_hands(rows[k], tasks[k].hands, robot, distances, gaps)
        if not np.array_equal(collision_row, rows[k]):
            rows[k] = robot.skeleton.clamp(collision_row)
            return k
    return None


def _carry(
    side: Side,
    tasks: Sequence[ArmsTask],
    rows: Floats,
    beginnings: Mapping[Side, Floats],
    path_starts: dict[Side, Floats],
    robot: Robot,
) -> None:
    """Store the arm posture at the start of the current hand path.

    Off a path, it is the latest posture of the arm.
    """
    rows_of_side = [k for k, task in enumerate(tasks) if side in task.keys]
    if rows_of_side:
        on_path = tasks[rows_of_side[-1]].hands[side].passing and (side in path_starts or len(rows_of_side) > 1)
        arm = list(robot.arms[side].indices)
        path_starts[side] = beginnings[side][len(rows_of_side) - 1] if on_path else rows[rows_of_side[-1], arm]
