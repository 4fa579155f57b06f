"""Solves the arms of postures: hands by reaches, elbows by openness, shoulders by effort (thesis 8.6 and 8.7).

Many keys take one call. Whether a posture is clear of the body shows only once it is there, and where it is not, the
arm that gives way is where the next key begins. Most postures are clear: so keys are solved as if all were, and those
behind one that was not are solved once more.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.keyframes import Hand
from kinesic.ik.arm.refine import refine_posture, true_arm
from kinesic.ik.arm.shoulder_elbow import carry_shoulder
from kinesic.ik.keys import ArmMode, Key, ReachManner, pose_keys
from kinesic.planning.collision import clear_hands
from kinesic.planning.torso import aim_from_shoulder, turn_reach

WIDEST_SWING = float(np.radians(25))  # that an elbow swings aside for the palm and the pointing of its hand
LEAP = float(np.radians(110))  # of a hinge from key to key: an arm that turns over has no time left for its word
OPEN = float(np.radians(78))  # swivel at openness 1: beyond, elbows rise more than they go out, and palms turn over
MANNER = ReachManner(WIDEST_SWING, LEAP, OPEN)
MOST_AT_ONCE = 64  # keys of a call


def with_arms(angles: Floats, hands: Mapping[Side, Hand], reaches: Mapping[Side, Reach | None], robot: Robot) -> Floats:
    """Solves some arms of a posture.

    Args:
        angles: (n,) [rad] the posture, its torso in place; arms start from here.
        hands: whose arms are solved, and in which manner.
        reaches: of these hands, in the world; None rests.
        robot: the robot.

    Returns:
        (n,) [rad]. Openness turns the elbow from where the hand lets it hang to `OPEN`, the hand's palm
        notwithstanding.
    """
    solved, frames = angles.copy(), robot.body_frames(angles)
    for side, hand in hands.items():
        asked = ArmKey.of(robot, side, hand, reaches[side], frames)
        solved = solve_keys(robot, side, [asked], solved[None], began=None)[0][0]
    return solved


@dataclass(frozen=True, eq=False)
class ArmKey:
    """What an arm does in a key."""

    key: Key
    reach: Reach | None = None  # of its hand in the world; None where it rests or stays

    @classmethod
    def of(cls, robot: Robot, side: Side, hand: Hand, reach: Reach | None, frames: Frames) -> "ArmKey":
        """The key of a hand, with the torso as it is in these frames; None of a reach rests."""
        chain = robot.arms[side]
        if reach is None:
            return cls(Key(ArmMode.REST, robot.skeleton.rest[list(chain.indices)]))
        base = robot.skeleton.segment(chain.base)
        in_base = turn_reach(reach, frames.rotations[base].T, frames.origins[base], np.zeros(3))
        rest = lift_shoulder(robot, side, carry_shoulder(chain, in_base.position, hand.effort), hand.lift)
        return cls(Key(ArmMode.REACH, rest, in_base, hand.openness, hand.passing), reach)

    @classmethod
    def same(cls, robot: Robot, side: Side, hand: Hand) -> "ArmKey":
        """The key of a hand whose target is the same again: its arm stays as it is, however it came there."""
        return cls(Key(ArmMode.STILL, robot.skeleton.rest[list(robot.arms[side].indices)], passing=hand.passing))


def solve_keys(
    robot: Robot, side: Side, keys: Sequence[ArmKey], postures: Floats, *, began: Floats | None
) -> tuple[Floats, Floats]:
    """Solves an arm for each of its keys, in one call.

    Args:
        robot: whose arm it is.
        side: of the arm.
        keys: in their order; one alone where the ideal arm is not the true one.
        postures: (m, n) [rad] of these keys, their torsos in place; the arm of the first is where it has come to.
        began: (k,) [rad] the arm when the path began that its hand is on; None where it is on none.

    Returns:
        (m, n) [rad] the postures with this arm, and (m, k) [rad] the arm when the path began that the hand is then on.
    """
    chain, joints = robot.arms[side], list(robot.arm(side).joints)
    indices, solved = list(chain.indices), postures.copy()
    found = pose_keys(chain, [each.key for each in keys], MANNER, now=postures[0, indices], began=began)
    beginnings = found.beginnings
    for k, asked in enumerate(keys):
        if asked.key.mode is ArmMode.REST:
            solved[k, joints] = robot.skeleton.rest[joints]
    solved[:, indices] = found.angles
    for k, asked in enumerate(keys):
        if asked.reach is None or true_arm(robot, side).exact:
            continue
        near = postures[k].copy()
        if asked.key.passing and began is not None:
            near[indices] = began
        turn = None if np.isnan(found.swivels[k]) else float(found.swivels[k])
        solved[k] = refine_posture(robot, side, structs.replace(asked.reach, swivel=turn), solved[k], near=near)
        if not (asked.key.passing and began is not None):
            beginnings[k] = solved[k, indices]
    return solved, beginnings


def lift_shoulder(robot: Robot, side: Side, rest: Floats, lift: float) -> Floats:
    """Raises the rest of a collar bone.

    Args:
        robot: whose arm it is.
        side: of the arm.
        rest: (k,) [rad] posture whose collar bone stays where it can.
        lift: [rad].

    Returns:
        (k,) [rad] inside the ranges; the same where the arm has no hinge that lifts its shoulder.
    """
    if not lift:
        return rest
    raised, chain = np.array(rest), robot.arms[side]
    raised[[joint in robot.arm(side).lifting for joint in chain.indices]] += lift
    return sealed(np.clip(raised, chain.lower, chain.upper))


@dataclass(frozen=True, eq=False)
class ArmsTask:
    """What both arms do in a key."""

    hands: Mapping[Side, Hand]  # that have a key
    keys: Mapping[Side, ArmKey]  # of these
    wanted: Mapping[Side, Reach | None]  # of these, in the world
    keyed: Sequence[bool]  # hinges with a key

    @property
    def aiming(self) -> bool:
        """Whether a hand points from where its shoulder has come to, so that its reach shows only on the way."""
        return any(hand.aim is not None for hand in self.hands.values())

    def aimed(self, posture: Floats, robot: Robot) -> "ArmsTask":
        """The same, reaching from where the arms have come to: (n,) [rad]."""
        keys, wanted, frames = dict(self.keys), dict(self.wanted), robot.body_frames(posture)
        for side, hand in self.hands.items():
            if hand.aim is None or hand.reach is None:
                continue
            shoulder = frames.origins[robot.arm(side).shoulder]
            wanted[side] = aim_from_shoulder(hand.reach, hand.aim, side, shoulder, robot)
            if keys[side].reach is not None:
                keys[side] = ArmKey.of(robot, side, hand, wanted[side], frames)
        return replace(self, keys=keys, wanted=wanted)

    @property
    def reaches(self) -> bool:
        """Whether a hand is anywhere but at rest."""
        return any(hand.reach is not None for hand in self.hands.values())


def solve_arms(
    tasks: Sequence[ArmsTask], bodies: Floats, robot: Robot, distances: Distances
) -> tuple[Floats, list[Mapping[Side, Reach | None]]]:
    """Solves the arms of every key, clear of the body.

    Args:
        tasks: of the keys, in their order.
        bodies: (m, n) [rad] postures whose torso, head and fingers are in place, and whose arms rest.
        robot: the robot.
        distances: its self-distance.

    Returns:
        (m, n) [rad] inside the ranges, and what each hand was to reach in the world.
    """
    angles, began = np.array(bodies), dict[Side, Floats]()
    wanted: list[Mapping[Side, Reach | None]] = []
    most = MOST_AT_ONCE if all(true_arm(robot, side).exact for side in SIDES) else 1
    done, count = 0, most
    while done < len(tasks):
        ahead = _ahead(tasks, done, count, angles[done], robot)
        rows, beginnings = _solved(ahead, angles[done : done + len(ahead)], began, robot)
        clear = _cleared(ahead, rows, robot, distances)
        good = len(rows) if clear is None else clear + 1
        angles[done : done + good] = rows[:good]
        for side in SIDES:
            _carry(side, ahead[:good], rows[:good], beginnings, began, robot)
            arm = list(robot.arm(side).joints)
            angles[done + good :, arm] = rows[good - 1, arm]
        wanted += [task.wanted for task in ahead[:good]]
        done += good
        count = min(2 * count, most) if clear is None else 1
    return angles, wanted


def _ahead(tasks: Sequence[ArmsTask], done: int, count: int, posture: Floats, robot: Robot) -> list[ArmsTask]:
    """The next keys, `count` at most, from a posture (n,) [rad]; none but the first aims."""
    first, rest = tasks[done], tasks[done + 1 : done + count]
    aiming = next((k for k, task in enumerate(rest) if task.aiming), len(rest))
    return [first.aimed(posture, robot) if first.aiming else first, *rest[:aiming]]


def _solved(
    tasks: Sequence[ArmsTask], postures: Floats, began: Mapping[Side, Floats], robot: Robot
) -> tuple[Floats, Mapping[Side, Floats]]:
    """Both arms as if nothing were in their way: (m, n) [rad], and where the path began that each hand is on."""
    rows, beginnings = postures.copy(), dict[Side, Floats]()
    for side in SIDES:
        arm = np.array(robot.arm(side).joints)
        own = [k for k, task in enumerate(tasks) if side in task.keys]
        if not own:
            continue
        keys = [tasks[k].keys[side] for k in own]
        found, beginnings[side] = solve_keys(robot, side, keys, rows[own], began=began.get(side))
        latest = np.searchsorted(own, np.arange(len(rows)), side="right") - 1  # keys without this hand keep its arm
        met = np.flatnonzero(latest >= 0)
        rows[met[:, None], arm] = found[latest[met, None], arm]
    return robot.skeleton.clamp(rows), beginnings


def _cleared(tasks: Sequence[ArmsTask], rows: Floats, robot: Robot, distances: Distances) -> int | None:
    """Moves the first arms that are in the way of the body, in place; the key in which that was, or None."""
    reaching = [k for k, task in enumerate(tasks) if task.reaches]
    if not reaching:
        return None
    for k, gaps in zip(reaching, distances.gaps(rows[reaching]), strict=True):
        clear = clear_hands(rows[k], tasks[k].hands, robot, distances, gaps)
        if not np.array_equal(clear, rows[k]):
            rows[k] = robot.skeleton.clamp(clear)
            return k
    return None


def _carry(
    side: Side,
    tasks: Sequence[ArmsTask],
    rows: Floats,
    beginnings: Mapping[Side, Floats],
    began: dict[Side, Floats],
    robot: Robot,
) -> None:
    """Notes where the path began that a hand is on after these keys."""
    own = [k for k, task in enumerate(tasks) if side in task.keys]
    if own:
        on_path = tasks[own[-1]].hands[side].passing and (side in began or len(own) > 1)
        arm = list(robot.arms[side].indices)
        began[side] = beginnings[side][len(own) - 1] if on_path else rows[own[-1], arm]
