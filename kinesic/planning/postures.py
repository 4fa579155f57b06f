"""Turns key frames into joint angles: the torso first, then both arms (thesis 8.6)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import CHAINS, SIDES, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.keyframes import Hand, KeyFrame, KeyFrames
from kinesic.expressivity.turns import turn_angles
from kinesic.ik.torso import lean_torso
from kinesic.motion.keys import LEAST_GAP, PLAIN_PASSAGE, KeyPassage, KeyPosture
from kinesic.planning.arm_postures import ArmKey, ArmsTask, solve_arms
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
    leans = [_lean(frame, robot) for frame in keyframes.frames]
    bodies = _bodies(keyframes, leans, robot)
    tasks = list(_tasks(keyframes, leans, bodies, robot))
    angles, wanted = solve_arms(tasks, bodies, robot, distances)
    last = len(tasks) - 1
    solved = [
        KeyPosture(
            frame.time,
            sealed(row),
            tuple(task.keyed),
            frame.syncs,
            _passages(frame, robot),
            _firm(frame) or k in (0, last),
        )
        for k, (frame, task, row) in enumerate(zip(keyframes.frames, tasks, angles, strict=True))
    ]
    misses = _misses(keyframes, wanted, angles, robot)
    return Postures((*_beginning(solved, keyframes.timeline.start, robot), *solved), misses)


def _bodies(keyframes: KeyFrames, leans: Sequence[Floats], robot: Robot) -> Floats:
    """(m, n) [rad] fingers, torso and head of every key; arms at rest."""
    bodies = np.tile(robot.skeleton.rest, (len(keyframes.frames), 1))
    for frame, lean, body in zip(keyframes.frames, leans, bodies, strict=True):
        set_fingers(body, frame.time, keyframes.fingers, robot)
        _set_torso(body, frame, lean, robot)
    return bodies


def _tasks(keyframes: KeyFrames, leans: Sequence[Floats], bodies: Floats, robot: Robot) -> Iterator[ArmsTask]:
    """What the arms do in every key."""
    held: dict[Side, tuple[Hand, Floats]] = {}  # last target of each hand, and the torso [rad] at which it was met
    leaning = np.any(leans, axis=1).tolist() if leans else []
    frames, torsos = robot.body_frames(bodies), bodies[:, list(robot.joints("torso"))]
    for k, frame in enumerate(keyframes.frames):
        keyed = _keyed(frame, robot, any(leaning[max(0, k - 1) : k + 2]), ends=k in (0, len(leans) - 1))
        body = Frames(frames.rotations[k], frames.origins[k])
        hands = {side: hand for side, hand in frame.hands.items() if keyed[robot.arm(side).joints[0]]}
        wanted = {side: _in_world(hand, frame, robot) for side, hand in hands.items()}
        keys = {
            side: ArmKey.same(robot, side, hand)
            if side in held and _same_hand(hand, held[side][0]) and np.array_equal(torsos[k], held[side][1])
            else ArmKey.of(robot, side, hand, wanted[side], body)
            for side, hand in hands.items()
        }
        held |= {side: (hand, torsos[k]) for side, hand in hands.items()}
        yield ArmsTask(hands, keys, wanted, keyed)


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
    flags: list[bool] = keyed.tolist()
    return flags


def _firm(frame: KeyFrame) -> bool:
    """Whether anything but hands on their paths has a key here."""
    passing = {f"{side}_hand" for side, hand in frame.hands.items() if hand.passing}
    return bool(frame.syncs) or not frame.given <= passing


def _passages(frame: KeyFrame, robot: Robot) -> tuple[KeyPassage, ...]:
    """How each hinge passes a frame: as its part does; parts that follow others, as these do."""
    others = next((frame.passages[part] for part in CHAINS if part in frame.passages), PLAIN_PASSAGE)
    found = [others] * len(robot.skeleton.hinges)
    for part, chain in CHAINS.items():
        for hinge in robot.joints(chain):
            found[hinge] = frame.passages.get(part, others)
    return tuple(found)


def _set_torso(angles: Floats, frame: KeyFrame, lean_angles: Floats, robot: Robot) -> None:
    """Torso from its key plus the lean; the neck turns back, so that the head stays level (thesis 8.6)."""
    torso = np.array(turn_angles(frame.torso)) + lean_angles
    set_turn(robot, "torso", torso, angles)
    set_turn(robot, "neck", np.array(turn_angles(frame.head)) - torso_turn(robot, "torso", angles), angles)


def _in_world(hand: Hand, frame: KeyFrame, robot: Robot) -> Reach | None:
    """A reach in the world: the gesture box turns with the torso's own key (thesis 8.7), never with the lean."""
    if hand.reach is None:
        return None
    box = volume(robot, frame.torso)
    return hand.reach if box is None else box.placed(hand.reach)


def _misses(
    keyframes: KeyFrames, wanted: Sequence[Mapping[Side, Reach | None]], angles: Floats, robot: Robot
) -> Mapping[str, float]:
    """Credits what is left of each reach, in postures (m, n) [rad], to the behaviours that move its hand."""
    misses: dict[str, float] = {}
    origins = robot.body_frames(angles).origins
    for k, (frame, reaches) in enumerate(zip(keyframes.frames, wanted, strict=True)):
        for side, reach in reaches.items():
            if reach is None:
                continue
            miss = float(np.linalg.norm(origins[k, robot.arm(side).wrist] - reach.position))
            for behaviour, _ in frame.syncs:
                if f"{side}_hand" in keyframes.uses[behaviour]:
                    misses[behaviour] = max(miss, misses.get(behaviour, 0.0))
    return misses
