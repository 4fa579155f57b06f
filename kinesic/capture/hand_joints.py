"""Recognition of finger joints in captured skeletons, and hand poses from them."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Side
from kinesic.capture.clip import HandTrack
from kinesic.capture.skeleton_motion import CapturedJoint
from kinesic.expressivity.lexicon.hand_shapes import FINGER_NAMES, Finger

FULL_BEND = float(np.radians(75.0))  # [rad] mean angle between successive bones of a closed finger
MIN_BONE = 1e-6  # shortest accepted bone, in the unit of the file
MIN_JOINTS = 2  # fewest joints of a finger whose bend can be measured

_FINGER_WORDS: tuple[tuple[Finger, re.Pattern[str]], ...] = (
    ("thumb", re.compile(r"thumb|finger_?0", re.IGNORECASE)),
    ("index", re.compile(r"index|finger_?1|fore_?finger", re.IGNORECASE)),
    ("middle", re.compile(r"mid|finger_?2", re.IGNORECASE)),
    ("ring", re.compile(r"ring|finger_?3", re.IGNORECASE)),
    ("pinky", re.compile(r"little|pinky|finger_?4", re.IGNORECASE)),
)


def find_fingers(skeleton: Sequence[CapturedJoint], wrist: str) -> Mapping[Finger, tuple[str, ...]]:
    """Return the joint names of each finger below a wrist, knuckles first.

    Fingers are recognised by name. The result is empty if index, middle or little finger is missing.
    """
    children: dict[str | None, list[str]] = {}
    for joint in skeleton:
        children.setdefault(joint.parent, []).append(joint.name)
    fingers: dict[Finger, tuple[str, ...]] = {}
    pending = list(children.get(wrist, []))
    while pending:
        name = pending.pop(0)
        finger = next((finger for finger, word in _FINGER_WORDS if word.search(name.rpartition(":")[2])), None)
        if finger is None:
            pending.extend(children.get(name, []))
        elif finger not in fingers:
            fingers[finger] = _follow_chain(name, children)
    return fingers if fingers.keys() >= {"index", "middle", "pinky"} else {}


def _follow_chain(name: str, children: Mapping[str | None, list[str]]) -> tuple[str, ...]:
    """Return a joint and its first descendants in order."""
    chain = [name]
    while children.get(chain[-1]):
        chain.append(children[chain[-1]][0])
    return tuple(chain)


def measure_hand_pose(
    positions: Mapping[str, Floats], chest: Floats, wrist: str, fingers: Mapping[Finger, tuple[str, ...]], side: Side
) -> HandTrack | None:
    """Return a hand's direction, palm normal and finger extension over time.

    Args:
        positions: (m, 3) joint positions by name.
        chest: (m, 3, 3) chest frames.
        wrist: name of the wrist joint.
        fingers: joint names of each finger, from `find_fingers`.
        side: of the hand.

    Returns:
        None if the hand has no fingers, or their knuckles coincide.
    """
    if not fingers:
        return None
    start = positions[wrist]
    knuckles = {finger: positions[names[0]] - start for finger, names in fingers.items()}
    along = knuckles["index"] + knuckles["middle"] + knuckles["pinky"]
    across = knuckles["pinky"] - knuckles["index"]
    normal = np.cross(across, along) if side == "l" else np.cross(along, across)
    lengths = np.linalg.norm(along, axis=1), np.linalg.norm(normal, axis=1)
    if not min(float(length.min()) for length in lengths) > MIN_BONE:
        return None
    pointing, palm = (
        np.einsum("tji,tj->ti", chest, vectors / length[:, None])
        for vectors, length in zip((along, normal), lengths, strict=True)
    )
    straight = [_measure_extension(positions, wrist, fingers.get(finger, ())) for finger in FINGER_NAMES]
    return HandTrack(sealed(pointing), sealed(palm), sealed(np.stack(straight, axis=1)))


def _measure_extension(positions: Mapping[str, Floats], wrist: str, names: Sequence[str]) -> Floats:
    """Return the extension (m,) of a finger, 0 closed to 1 straight.

    A finger with fewer than `MIN_JOINTS` joints counts as straight.
    """
    if len(names) < MIN_JOINTS:
        return np.ones(len(positions[wrist]))
    bones = np.diff([positions[name] for name in (wrist, *names)], axis=0)
    squares = np.sum(bones * bones, axis=2)
    is_bone = squares.min(axis=1) > MIN_BONE**2
    bones, squares = bones[is_bone], squares[is_bone]
    if len(bones) < MIN_JOINTS:
        return np.ones(len(positions[wrist]))
    dots = np.sum(bones[1:] * bones[:-1], axis=2)
    sines = np.sqrt(np.maximum(squares[1:] * squares[:-1] - dots**2, 0.0))
    extension: Floats = np.clip(1.0 - np.arctan2(sines, dots).mean(axis=0) / FULL_BEND, 0.0, 1.0)
    return extension
