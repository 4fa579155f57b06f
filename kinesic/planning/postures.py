"""Turns key frames into joint angles: the torso first, then both arms (thesis 8.6)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import CHAINS, SIDES, Robot, Side
from kinesic.expressivity.keyframes import Hand, KeyFrame, KeyFrames
from kinesic.expressivity.turns import axes
from kinesic.ik.torso import lean_torso
from kinesic.motion.keys import LEAST_GAP, PLAIN, KeyPosture, Passage
from kinesic.planning.arm_postures import turn_reach, with_arms
from kinesic.planning.collision import clear_hands
from kinesic.planning.finger_postures import set_fingers
from kinesic.planning.torso import set_turn, torso_turn, volume


@dataclass(frozen=True, eq=False)
class Postures:
    """A block as joint angles."""

    postures: tuple[KeyPosture, ...]
    misses: Mapping[str, float]  # behaviour id -> how far its hand stays from what was asked, at worst [m]


def postures(keyframes: KeyFrames, robot: Robot, distances: Distances) -> Postures:
    """Solves every key frame for the parts that have a key in it.

    Hands keep the hover distance of `collision` from the body and from one another; an unreachable target
    becomes the best posture, and `misses` says by how much.
    """
    solved: list[KeyPosture] = []
    misses: dict[str, float] = {}
    leans = [_lean(frame, robot) for frame in keyframes.frames]
    angles = np.array(robot.skeleton.rest)
    holding: dict[Side, _Holding] = {}
    for k, frame in enumerate(keyframes.frames):
        leaning = any(bool(np.any(leans[j])) for j in range(max(0, k - 1), min(len(leans), k + 2)))
        keyed = _keyed(frame, robot, leaning, ends=k in (0, len(leans) - 1))
        angles = angles.copy()
        set_fingers(angles, frame.time, keyframes.fingers, robot)
        _set_torso(angles, frame, leans[k], robot)
        hands = {side: hand for side, hand in frame.hands.items() if keyed[robot.arm(side).joints[0]]}
        wanted = {side: _in_world(hand, side, frame, angles, robot) for side, hand in hands.items()}
        torso = angles[list(robot.joints("torso"))]
        for side in hands.keys() & holding.keys():
            if holding[side].still(hands[side], torso):
                angles[list(robot.arm(side).joints)] = holding[side].arm
        moved = {side for side in hands if side not in holding or not holding[side].still(hands[side], torso)}
        before = {side: holding[side].began for side in holding}
        angles = with_arms(angles, {side: hands[side] for side in hands if side in moved}, wanted, robot, before)
        angles = robot.skeleton.clamp(clear_hands(angles, hands, robot, distances))
        holding |= {side: _Holding.of(side, hand, angles, robot, holding.get(side)) for side, hand in hands.items()}
        _note_misses(misses, keyframes, k, wanted, angles, robot)
        firm = _firm(frame) or k in (0, len(leans) - 1)
        solved.append(KeyPosture(frame.time, sealed(angles), tuple(keyed), frame.syncs, _passages(frame, robot), firm))
    return Postures((*_beginning(solved, keyframes.timeline.start, robot), *solved), misses)


@dataclass(frozen=True, eq=False)
class _Holding:
    """The last target of a hand, and the arm that meets it."""

    hand: Hand
    torso: Floats  # [rad]
    arm: Floats  # [rad]
    began: Floats  # [rad] the arm; on a path, as it was in the key before the path

    @classmethod
    def of(cls, side: Side, hand: Hand, angles: Floats, robot: Robot, before: "_Holding | None") -> "_Holding":
        """One hand of a posture (n,) [rad], after what it was holding."""
        torso, arm = angles[list(robot.joints("torso"))], angles[list(robot.arm(side).joints)]
        began = before.began if hand.passing and before else angles[list(robot.arms[side].indices)]
        return cls(hand, torso, arm, began)

    def still(self, hand: Hand, torso: Floats) -> bool:
        """Whether the target is the same again: then the arm stays as it is, however it came there."""
        return _same_hand(hand, self.hand) and bool(np.array_equal(torso, self.torso))


def _beginning(solved: list[KeyPosture], start: float, robot: Robot) -> list[KeyPosture]:
    """The rest pose at the block's start, when nothing moves so early."""
    if not solved or solved[0].time <= start + LEAST_GAP:
        return []
    return [KeyPosture(start, robot.skeleton.rest, (True,) * len(robot.skeleton.hinges))]


def _lean(frame: KeyFrame, robot: Robot) -> Floats:
    """(3,) [rad] torsion, tilt and roll that the hands need on top of the torso's own key."""
    targets = {
        side: hand.reach.position
        for side, hand in frame.hands.items()
        if hand.reach is not None and hand.aim is None and f"{side}_hand" in frame.known
    }
    return np.array(lean_torso(robot, targets)) if targets else np.zeros(3)


def _same_hand(hand: Hand, before: Hand) -> bool:
    if hand.reach is None or before.reach is None:
        return hand.reach is before.reach
    if hand.aim is not before.aim:
        return False
    if (hand.openness, hand.effort, hand.lift) != (before.openness, before.effort, before.lift):
        return False
    pairs = (
        (hand.reach.position, before.reach.position),
        (hand.reach.pointing, before.reach.pointing),
        (hand.reach.palm, before.reach.palm),
    )
    here, there = ((each.touch, each.tip) for each in (hand, before))
    return (
        hand.reach.swivel == before.reach.swivel
        and here == there
        and all(a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs)
    )


def _keyed(frame: KeyFrame, robot: Robot, leaning: bool, *, ends: bool) -> list[bool]:
    """Hinges with a key in this frame: those of given parts, and those that follow a leaning torso."""
    keyed = np.full(len(robot.skeleton.hinges), ends)
    torso = ends or leaning or "torso" in frame.given
    if torso:
        keyed[list(robot.joints("torso"))] = True
    if ends or "head" in frame.given or (torso and "head" in frame.known):
        keyed[list(robot.joints("neck"))] = True
    for side in SIDES:
        hand = frame.hands[side]
        holding = hand.reach is not None and (leaning or (torso and hand.aim is not None))
        if ends or f"{side}_hand" in frame.given or (holding and f"{side}_hand" in frame.known):
            keyed[list(robot.arm(side).joints)] = True
    return [bool(key) for key in keyed]


def _firm(frame: KeyFrame) -> bool:
    """Whether anything but hands on their paths has a key here."""
    passing = {f"{side}_hand" for side, hand in frame.hands.items() if hand.passing}
    return bool(frame.syncs) or not frame.given <= passing


def _passages(frame: KeyFrame, robot: Robot) -> tuple[Passage, ...]:
    """How each hinge passes a frame: as its part does; parts that follow others, as these do."""
    others = next((frame.passages[part] for part in CHAINS if part in frame.passages), PLAIN)
    found = [others] * len(robot.skeleton.hinges)
    for part, chain in CHAINS.items():
        for hinge in robot.joints(chain):
            found[hinge] = frame.passages.get(part, others)
    return tuple(found)


def _set_torso(angles: Floats, frame: KeyFrame, lean_angles: Floats, robot: Robot) -> None:
    """Torso from its key plus the lean; the neck turns back, so that the head stays level (thesis 8.6)."""
    torso = np.array(axes(frame.torso)) + lean_angles
    set_turn(robot, "torso", torso, angles)
    set_turn(robot, "neck", np.array(axes(frame.head)) - torso_turn(robot, "torso", angles), angles)


def _in_world(hand: Hand, side: Side, frame: KeyFrame, angles: Floats, robot: Robot) -> Reach | None:
    """A reach in the world, with the torso as it then is.

    The gesture box turns with the torso's own key (thesis 8.7), never with the lean; an arm that points does so
    from where its shoulder has come to.
    """
    if hand.reach is None:
        return None
    if hand.aim is not None:
        return aim_from_shoulder(hand.reach, hand.aim, side, angles, robot)
    box = volume(robot, frame.torso)
    return hand.reach if box is None else box.placed(hand.reach)


def aim_from_shoulder(reach: Reach, aim: Floats, side: Side, angles: Floats, robot: Robot) -> Reach:
    """Turns a reach so that it points at its aim from where the shoulder has come to.

    Args:
        reach: from where the shoulder rests, in the world.
        aim: (3,) [m] in the world.
        side: of the hand.
        angles: (n,) [rad] of the whole robot.
        robot: whose hand it is.
    """
    shoulder = robot.arm(side).shoulder
    resting = robot.skeleton.resting.origins[shoulder]
    centre = robot.body_frames(angles).origins[shoulder]
    rotation = scipy.spatial.transform.Rotation.align_vectors((aim - centre)[None], (aim - resting)[None])[
        0
    ].as_matrix()
    return turn_reach(reach, rotation, resting, centre)


def _note_misses(
    misses: dict[str, float],
    keyframes: KeyFrames,
    k: int,
    wanted: Mapping[Side, Reach | None],
    angles: Floats,
    robot: Robot,
) -> None:
    """Credits what is left of each reach to the behaviours that move this hand."""
    reaches = {side: reach for side, reach in wanted.items() if reach is not None}
    if not reaches:
        return
    origins = robot.body_frames(angles).origins
    for side, reach in reaches.items():
        miss = float(np.linalg.norm(origins[robot.arm(side).wrist] - reach.position))
        for behaviour, _ in keyframes.frames[k].syncs:
            if f"{side}_hand" in keyframes.uses[behaviour]:
                misses[behaviour] = max(miss, misses.get(behaviour, 0.0))
