"""Joint angles of key frames: torso first, then both arms (thesis 8.6)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import PART_CHAINS, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.keyframes import Hand, KeyFrame, KeyFrames
from kinesic.expressivity.turns import add_turns, rest_head_turn, rest_turn, turn_angles
from kinesic.ik.torso import lean_torso
from kinesic.motion.keys import MIN_GAP, PLAIN_PASSAGE, KeyPassage, KeyPosture
from kinesic.planning.arm_postures import ArmKey, ArmsTask, solve_arms
from kinesic.planning.finger_postures import set_fingers
from kinesic.planning.torso import compute_torso_turn, find_gesture_volume, set_turn


@dataclass(frozen=True, eq=False)
class Postures:
    """Key postures of a block, with each behaviour's distance from its target."""

    postures: tuple[KeyPosture, ...]
    misses: Mapping[str, float]  # largest distance of the hand from its target [m], by behaviour id


def solve_postures(keyframes: KeyFrames, robot: Robot, distances: Distances) -> Postures:
    """Solve the angles of all keyed body parts in every key frame.

    Hands keep the hover distance from the body and from each other. An unreachable target gives the best posture;
    `misses` has the remaining distance.
    """
    leans = [_lean(frame, robot) for frame in keyframes.frames]
    bodies = _bodies(keyframes, leans, robot)
    tasks = list(_tasks(keyframes, leans, bodies, robot))
    angles, targets = solve_arms(tasks, bodies, robot, distances)
    last = len(tasks) - 1
    solved = [
        KeyPosture(
            frame.time,
            sealed(row),
            tuple(task.keyed),
            frame.syncs,
            _passages(frame, robot),
            _is_exact(frame) or k in (0, last),
        )
        for k, (frame, task, row) in enumerate(zip(keyframes.frames, tasks, angles, strict=True))
    ]
    misses = _misses(keyframes, targets, angles, robot)
    return Postures((*_beginning(solved, keyframes.timeline.start, robot), *solved), misses)


def _bodies(keyframes: KeyFrames, leans: Sequence[Floats], robot: Robot) -> Floats:
    """Return all key frames' postures (m, n) [rad], with resting arms.

    Fingers, torso and head are in place.
    """
    bodies = np.tile(robot.skeleton.rest, (len(keyframes.frames), 1))
    for frame, lean, body in zip(keyframes.frames, leans, bodies, strict=True):
        set_fingers(body, frame.time, keyframes.fingers, robot)
        _set_torso(body, frame, lean, robot)
    return bodies


def _tasks(keyframes: KeyFrames, leans: Sequence[Floats], bodies: Floats, robot: Robot) -> Iterator[ArmsTask]:
    """Yield the hand targets and keyed hinges of each key frame."""
    held: dict[Side, tuple[Hand, Floats]] = {}  # last target of each hand, and torso angles [rad] at that time
    leaning = np.any(leans, axis=1).tolist() if leans else []
    frames, torsos = robot.body_frames(bodies), bodies[:, list(robot.joints("torso"))]
    for k, frame in enumerate(keyframes.frames):
        keyed = _keyed(frame, robot, any(leaning[max(0, k - 1) : k + 2]), ends=k in (0, len(leans) - 1))
        body = Frames(frames.rotations[k], frames.origins[k])
        hands = {side: frame.hands[side] for side in robot.sides if keyed[robot.arm(side).joints[0]]}
        targets = {side: _in_world(hand, frame, robot) for side, hand in hands.items()}
        keys = {
            side: ArmKey.same(robot, side, hand)
            if side in held and _same_hand(hand, held[side][0]) and np.array_equal(torsos[k], held[side][1])
            else ArmKey.of(robot, side, hand, targets[side], body)
            for side, hand in hands.items()
        }
        held |= {side: (hand, torsos[k]) for side, hand in hands.items()}
        yield ArmsTask(hands, keys, targets, keyed)


def _beginning(solved: list[KeyPosture], start: float, robot: Robot) -> list[KeyPosture]:
    """Return a rest key at block start, unless a key exists there."""
    if not solved or solved[0].time <= start + MIN_GAP:
        return []
    return [KeyPosture(start, robot.skeleton.rest, (True,) * len(robot.skeleton.hinges))]


def _lean(frame: KeyFrame, robot: Robot) -> Floats:
    """Compute the torso lean (3,) [rad] that makes distant targets reachable."""
    targets = {
        side: hand.reach.position
        for side, hand in frame.hands.items()
        if hand.reach is not None and hand.aim is None and f"{side}_hand" in frame.posed_parts
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
    here, there = ((pose.touch, pose.tip) for pose in (hand, before))
    return (
        hand.reach.swivel == before.reach.swivel
        and here == there
        and all(a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs)
    )


def _keyed(frame: KeyFrame, robot: Robot, leaning: bool, *, ends: bool) -> list[bool]:
    """Flag the hinges that have a key in this frame.

    These are the hinges of given parts and those that follow a leaning torso, or all hinges if `ends`.
    """
    keyed = np.full(len(robot.skeleton.hinges), ends)
    torso = ends or leaning or "torso" in frame.given
    if torso:
        keyed[list(robot.joints("torso"))] = True
    if ends or "head" in frame.given or (torso and "head" in frame.posed_parts):
        keyed[list(robot.joints("neck"))] = True
    for side in robot.sides:
        hand = frame.hands[side]
        holding = hand.reach is not None and (leaning or (torso and hand.aim is not None))
        if ends or f"{side}_hand" in frame.given or (holding and f"{side}_hand" in frame.posed_parts):
            keyed[list(robot.arm(side).joints)] = True
    flags: list[bool] = keyed.tolist()
    return flags


def _is_exact(frame: KeyFrame) -> bool:
    """Return whether the motion must pass exactly through a key."""
    passing = {f"{side}_hand" for side, hand in frame.hands.items() if hand.passing}
    return bool(frame.syncs) or not frame.given <= passing


def _passages(frame: KeyFrame, robot: Robot) -> tuple[KeyPassage, ...]:
    """Return each hinge's passage (tension, easing) through a key frame.

    Hinges without a part of their own pass it like other parts.
    """
    others = next((frame.passages[part] for part in PART_CHAINS if part in frame.passages), PLAIN_PASSAGE)
    passages = [others] * len(robot.skeleton.hinges)
    for part, chain in PART_CHAINS.items():
        for hinge in robot.joints(chain):
            passages[hinge] = frame.passages.get(part, others)
    return tuple(passages)


def _set_torso(angles: Floats, frame: KeyFrame, lean_angles: Floats, robot: Robot) -> None:
    """Set trunk and neck angles from the key frame and lean.

    The neck turns back, so that the head stays level (thesis 8.6).
    """
    torso = np.array(turn_angles(frame.torso)) + turn_angles(rest_turn(robot, "torso")) + lean_angles
    set_turn(robot, "torso", torso, angles)
    head = np.array(turn_angles(frame.head)) + turn_angles(rest_head_turn(robot))
    set_turn(robot, "neck", head - compute_torso_turn(robot, "torso", angles), angles)


def _in_world(hand: Hand, frame: KeyFrame, robot: Robot) -> Reach | None:
    """Convert a hand target to world coordinates.

    The gesture volume rotates with the torso's own key (thesis 8.7) and with the standing posture of the trunk, not
    with the lean. A pointing hand does not follow the standing posture, as its target is in the world.
    """
    if hand.reach is None:
        return None
    turn = frame.torso if hand.aim is not None else add_turns(frame.torso, rest_turn(robot, "torso"))
    box = find_gesture_volume(robot, turn)
    return hand.reach if box is None else box.placed(hand.reach)


def _misses(
    keyframes: KeyFrames, targets: Sequence[Mapping[Side, Reach | None]], angles: Floats, robot: Robot
) -> Mapping[str, float]:
    """Compute each behaviour's largest distance [m] from hand to target.

    Args:
        keyframes: with the behaviours.
        targets: targets of the hands at each frame.
        angles: (m, n) [rad] solved postures.
        robot: the robot.
    """
    misses: dict[str, float] = {}
    origins = robot.body_frames(angles).origins
    for k, (frame, reaches) in enumerate(zip(keyframes.frames, targets, strict=True)):
        for side, reach in reaches.items():
            if reach is None:
                continue
            miss = float(np.linalg.norm(origins[k, robot.arm(side).wrist] - reach.position))
            for behaviour, _ in frame.syncs:
                if f"{side}_hand" in keyframes.uses[behaviour]:
                    misses[behaviour] = max(miss, misses.get(behaviour, 0.0))
    return misses
