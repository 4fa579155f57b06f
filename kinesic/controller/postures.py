"""From key frames to joint angles: the torso first, then both arms (thesis 8.6)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.controller.hover import clear_hands
from kinesic.expressivity.keyframes import Hand, KeyFrame, KeyFrames
from kinesic.ik.pointing import best_swivel
from kinesic.ik.torso import lean

LEAST_GAP = 0.02  # [s] between keys
WIDEST_SWING = np.radians(60)  # that an elbow swings aside for the palm and the pointing of its hand


@dataclass(frozen=True, eq=False)
class Posture:
    """Joint angles at one key time; only `keyed` hinges have a key here, the others pass through."""

    time: float  # [s] block time
    angles: Floats  # (n,) [rad]
    keyed: tuple[bool, ...]  # (n,)
    syncs: tuple[tuple[str, str], ...] = ()  # (behaviour id, sync point)


@dataclass(frozen=True, eq=False)
class Postures:
    """A block as joint angles."""

    postures: tuple[Posture, ...]
    misses: Mapping[str, float]  # behaviour id -> how far its hand stays from what was asked, at worst [m]


def postures(keyframes: KeyFrames, robot: Robot, distances: Distances) -> Postures:
    """Solves every key frame for the parts that it gives.

    Hands keep the hover distance of `hover` from the body and from one another; an unreachable target
    becomes the best posture, and `misses` says by how much.
    """
    solved: list[Posture] = []
    misses: dict[str, float] = {}
    leans = [_lean(frame, robot) for frame in keyframes.frames]
    angles = np.array(robot.skeleton.rest)
    for k, frame in enumerate(keyframes.frames):
        leaning = any(bool(np.any(leans[j])) for j in range(max(0, k - 1), min(len(leans), k + 2)))
        keyed = _keyed(frame, robot, leaning, ends=k in (0, len(leans) - 1))
        angles = angles.copy()
        _set_torso(angles, frame, leans[k], robot)
        asked = {side: _in_world(hand, side, frame, angles, robot) for side, hand in frame.hands.items()}
        wanted = {side: reach for side, reach in asked.items() if keyed[robot.joints(f"{side}_arm")[0]]}
        if k and _same(frame, keyframes.frames[k - 1], leans[k], leans[k - 1]):
            angles = np.array(solved[-1].angles)
        else:
            angles = _arms(angles, wanted, robot)
            angles = clear_hands(angles, wanted, robot, distances, _arms)
        _note_misses(misses, keyframes, k, wanted, angles, robot)
        solved.append(Posture(frame.time, sealed(robot.skeleton.clamp(angles)), tuple(keyed), frame.syncs))
    return Postures((*_beginning(solved, keyframes.timeline.start, robot), *solved), misses)


def _beginning(solved: list[Posture], start: float, robot: Robot) -> list[Posture]:
    """The robot at rest at the block's start, when nothing moves so early."""
    if not solved or solved[0].time <= start + LEAST_GAP:
        return []
    return [Posture(start, robot.skeleton.rest, (True,) * len(robot.skeleton.hinges))]


def _lean(frame: KeyFrame, robot: Robot) -> Floats:
    """(3,) [rad] torsion, tilt and roll that the hands need on top of the torso's own key."""
    targets = {
        side: hand.reach.position for side, hand in frame.hands.items() if hand.reach is not None and hand.aim is None
    }
    return np.array(lean(robot, targets)) if targets else np.zeros(3)


def _same(frame: KeyFrame, before: KeyFrame, lean_now: Floats, lean_before: Floats) -> bool:
    """Whether nothing moves between two frames that a hand or the body is asked to hold."""
    return (
        frame.torso == before.torso
        and frame.head == before.head
        and bool(np.array_equal(lean_now, lean_before))
        and all(_same_hand(frame.hands[side], before.hands[side]) for side in SIDES)
        and frame.given == before.given
    )


def _same_hand(hand: Hand, before: Hand) -> bool:
    if hand.reach is None or before.reach is None:
        return hand.reach is before.reach
    pairs = (
        (hand.reach.position, before.reach.position),
        (hand.reach.pointing, before.reach.pointing),
        (hand.reach.palm, before.reach.palm),
    )
    return hand.reach.swivel == before.reach.swivel and all(
        a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs
    )


def _keyed(frame: KeyFrame, robot: Robot, leaning: bool, *, ends: bool) -> list[bool]:
    """Which hinges have a key in this frame: those of given parts, and those that follow a leaning torso."""
    keyed = np.zeros(len(robot.skeleton.hinges), dtype=bool)
    torso = ends or leaning or "torso" in frame.given
    if torso:
        keyed[list(robot.joints("torso"))] = True
    if torso or "head" in frame.given:
        keyed[list(robot.joints("neck"))] = True
    for side in SIDES:
        hand = frame.hands[side]
        held = hand.reach is not None and (leaning or (torso and hand.aim is not None))
        if ends or held or f"{side}_hand" in frame.given:
            keyed[list(robot.joints(f"{side}_arm"))] = True
    return [bool(key) for key in keyed]


def _set_torso(angles: Floats, frame: KeyFrame, lean_angles: Floats, robot: Robot) -> None:
    """Torso from its key plus the lean; the neck turns back, so that the head stays level (thesis 8.6)."""
    torso = np.array([frame.torso.torsion, frame.torso.tilt, frame.torso.roll]) + lean_angles
    joints = list(robot.joints("torso"))
    lower, upper = robot.skeleton.lower, robot.skeleton.upper
    if joints:
        angles[joints] = np.clip(torso[: len(joints)], lower[joints], upper[joints])
    neck = list(robot.joints("neck"))
    if neck:
        head = np.array([frame.head.torsion, frame.head.tilt, frame.head.roll])[: len(neck)]
        back = angles[joints] if len(joints) == len(neck) else np.zeros(len(neck))
        angles[neck] = np.clip(head - back, lower[neck], upper[neck])


def _in_world(hand: Hand, side: Side, frame: KeyFrame, angles: Floats, robot: Robot) -> Reach | None:
    """The reach in the world, with the torso as it then is.

    The gesture box turns with the torso's own key (thesis 8.7), never with the lean; an arm that points does so
    from where its shoulder has come to.
    """
    if hand.reach is None:
        return None
    if hand.aim is not None:
        return _aimed(hand.reach, hand.aim, side, angles, robot)
    joints = list(robot.joints("torso"))
    if not joints or not any(vars(frame.torso).values()):
        return hand.reach
    upright = np.array(robot.skeleton.rest)
    upright[joints] = np.array([frame.torso.torsion, frame.torso.tilt, frame.torso.roll])[: len(joints)]
    frames = robot.skeleton.frames(robot.skeleton.clamp(upright))
    pivot = frames.origins[robot.skeleton.segment(robot.chains["torso"][0])]
    rotation = frames.rotations[robot.skeleton.segment(robot.chains["torso"][-1])]
    return _turned(hand.reach, rotation, pivot, pivot)


def _aimed(reach: Reach, aim: Floats, side: Side, angles: Floats, robot: Robot) -> Reach:
    """The same reach seen from the shoulder as it is: turned so that what pointed at the aim still does."""
    shoulder = robot.skeleton.segment(robot.chains[f"{side}_arm"][-3])
    resting = robot.skeleton.frames(robot.skeleton.rest).origins[shoulder]
    centre = robot.skeleton.frames(angles).origins[shoulder]
    rotation = Rotation.align_vectors((aim - centre)[None], (aim - resting)[None])[0].as_matrix()
    return _turned(reach, rotation, resting, centre)


def _turned(reach: Reach, rotation: Floats, pivot: Floats, moved: Floats) -> Reach:
    """A reach turned about a pivot, which itself moves."""
    return Reach(
        sealed(moved + rotation @ (reach.position - pivot)),
        None if reach.pointing is None else sealed(rotation @ reach.pointing),
        None if reach.palm is None else sealed(rotation @ reach.palm),
        reach.swivel,
    )


def _arms(angles: Floats, wanted: Mapping[Side, Reach | None], robot: Robot) -> Floats:
    """Both arms for reaches in the world, (n,) [rad]; the start is the posture before."""
    solved = angles.copy()
    frames = robot.skeleton.frames(angles)
    for side, reach in wanted.items():
        chain = robot.arms[side]
        indices = list(chain.indices)
        solved[indices] = (
            chain.rest
            if reach is None
            else best_swivel(
                chain,
                _in_base(reach, frames, robot.skeleton.segment(chain.base)),
                start=angles[indices],
                widest=WIDEST_SWING,
            ).angles
        )
    return solved


def _in_base(reach: Reach, frames: Frames, base: int) -> Reach:
    return _turned(reach, frames.rotations[base].T, frames.origins[base], np.zeros(3))


def hand_in_world(angles: Floats, robot: Robot, side: Side) -> Floats:
    """(3,) [m] the wrist's centre, for (n,) [rad]."""
    wrist = robot.skeleton.segment(robot.chains[f"{side}_arm"][-1])
    return sealed(robot.skeleton.frames(angles).origins[wrist])


def _note_misses(
    misses: dict[str, float],
    keyframes: KeyFrames,
    k: int,
    wanted: Mapping[Side, Reach | None],
    angles: Floats,
    robot: Robot,
) -> None:
    """Credits what is left of each reach to the behaviours that move this hand."""
    for side, reach in wanted.items():
        if reach is None:
            continue
        miss = float(np.linalg.norm(hand_in_world(angles, robot, side) - reach.position))
        for behaviour, _ in keyframes.frames[k].syncs:
            if f"{side}_hand" in keyframes.uses[behaviour]:
                misses[behaviour] = max(miss, misses.get(behaviour, 0.0))
