"""Recognition of spine, head and arm joints in captured skeletons."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Side
from kinesic.capture.reading.text import CaptureError
from kinesic.capture.skeleton_motion import CapturedJoint

MIN_BONE_LENGTH = 1e-3  # bone length / longest bone length, up to which a bone counts as having no length
MAX_SIDE_DIFFERENCE = 0.03  # largest relative difference of left and right bone lengths
BONE_RATIOS = (0.7, 1.4)  # accepted range of upper-arm length / forearm length
ARM_JOINTS = 3  # number of joints of an arm: shoulder, elbow and wrist
MAX_LIMB_BONES = 5  # largest number of bones followed from the chest: girdle and clavicle, arm and hand

_SIDE_WORD = re.compile(r"(left|right)|(?:^|_|\.)([lr])(?:_|\.|$)|^([lr])(?=[A-Z])|(Lf|Rt)$", re.IGNORECASE)


@dataclass(frozen=True)
class BodyJoints:
    """Names of the spine, head and arm joints of a skeleton."""

    hips: str  # lower end of the spine
    neck: str  # upper end of the spine
    head: str
    arms: Mapping[Side, tuple[str, str, str]]  # shoulder, elbow and wrist
    guess: str = ""  # sentence about joints recognised by bone lengths; empty: all recognised by name


@dataclass(frozen=True)
class _Family:
    """Joint names of one skeleton naming convention.

    Names of arm joints hold a placeholder for the side.
    """

    spine: tuple[str, str, str]  # hips, neck and head
    arm: tuple[str, str, str]  # shoulder, elbow and wrist
    sides: tuple[str, str]  # words for the left and the right side


HUMAN_SIDES = ("Left", "Right")  # words for left and right in joint names
LETTER_SIDES = ("L", "R")  # letters for left and right in joint names
NAMING_FAMILIES = (  # naming conventions, the more specific ones first, because names overlap
    _Family(("JtRoot", "JtNeckA", "JtSkullA"), ("JtShoulder{}", "JtElbow{}", "JtWrist{}"), ("Lf", "Rt")),
    _Family(("Hips", "Neck1", "Head"), ("{}Arm", "{}ForeArm", "{}Hand"), HUMAN_SIDES),
    _Family(("Hips", "Neck", "Head"), ("{}Arm", "{}ForeArm", "{}Hand"), HUMAN_SIDES),
    _Family(("Hips", "Neck", "Head"), ("{}Shoulder", "{}Elbow", "{}Wrist"), HUMAN_SIDES),
    _Family(("Hip", "Neck", "Head"), ("{}Shoulder", "{}Forearm", "{}Hand"), LETTER_SIDES),
    _Family(("lowerback", "lowerneck", "head"), ("{}humerus", "{}radius", "{}wrist"), ("l", "r")),
    _Family(("pelvis", "neck", "head"), ("{}_shoulder", "{}_elbow", "{}_wrist"), ("left", "right")),
    _Family(("pelvis", "neck_01", "head"), ("upperarm_{}", "lowerarm_{}", "hand_{}"), ("l", "r")),
    _Family(("hips", "neck", "head"), ("upper_arm.{}", "forearm.{}", "hand.{}"), LETTER_SIDES),
    _Family(("hips", "neck", "head"), ("{}UpperArm", "{}LowerArm", "{}Hand"), ("left", "right")),
)


def find_body_joints(skeleton: Sequence[CapturedJoint], source: str) -> BodyJoints:
    """Find the spine, head and arm joints of a skeleton.

    Names before a colon, such as `mixamorig:`, are ignored. Skeletons of no known family are recognised by geometry:
    two arms of equal bones leave the chest, and the names of their joints tell left from right.

    Raises:
        CaptureError: the skeleton has no two arms, or their sides are unknown.
    """
    full_names = {joint.name.rpartition(":")[2]: joint.name for joint in skeleton}
    for family in NAMING_FAMILIES:
        arms = {
            side: (family.arm[0].format(word), family.arm[1].format(word), family.arm[2].format(word))
            for side, word in zip(SIDES, family.sides, strict=True)
        }
        if full_names.keys() >= {*family.spine, *arms["l"], *arms["r"]}:
            hips, neck, head = (full_names[name] for name in family.spine)
            named: dict[Side, tuple[str, str, str]] = {
                side: (full_names[names[0]], full_names[names[1]], full_names[names[2]]) for side, names in arms.items()
            }
            return BodyJoints(hips, neck, head, named)
    return _find_by_geometry(skeleton, source)


def _find_by_geometry(skeleton: Sequence[CapturedJoint], source: str) -> BodyJoints:
    children: dict[str | None, list[CapturedJoint]] = {}
    for joint in skeleton:
        children.setdefault(joint.parent, []).append(joint)
    shortest = MIN_BONE_LENGTH * max(float(np.linalg.norm(joint.offset)) for joint in skeleton)
    for fork in reversed(skeleton):  # the chest is farther from the root than the hips
        limbs = [_find_arm(_follow_bones(joint, children, shortest)) for joint in children.get(fork.name, [])]
        arms = _match_arms(limbs)
        is_arm = [any(limb is arm for arm in arms) for limb in limbs]
        others = [joint for joint, is_limb in zip(children.get(fork.name, []), is_arm, strict=True) if not is_limb]
        if not arms or not others:
            continue
        named: dict[Side, tuple[str, str, str]] = {}
        for arm in arms:
            side = _side_of([joint.name for joint in arm])
            if side is not None:
                shoulder, elbow, wrist = arm
                named[side] = (shoulder.name, elbow.name, wrist.name)
        if len(named) < len(SIDES):
            raise CaptureError(
                f"{source}: the names of its arm joints do not tell left from right ({arms[0][-1].name[:40]})"
            )
        neck, head = _find_neck_and_head(others[0], children)
        hips = next(joint.name for joint in skeleton if joint.parent is None)
        return BodyJoints(hips, neck, head, named, f"arms recognised by bone lengths, from {fork.name}")
    raise CaptureError(f"{source}: its skeleton has no known names of hips, neck, head and arms, nor two equal arms")


def _follow_bones(
    joint: CapturedJoint, children: Mapping[str | None, list[CapturedJoint]], shortest: float
) -> list[CapturedJoint]:
    """Return the joints at the far ends of a limb's bones.

    Bones of zero length are merged with the one before. At a fork, the longest bone is followed.
    """
    bones: list[CapturedJoint] = []
    current: CapturedJoint | None = joint
    while current is not None and len(bones) < MAX_LIMB_BONES:
        if float(np.linalg.norm(current.offset)) > shortest:
            bones.append(current)
        elif bones:
            bones[-1] = current
        following = children.get(current.name, [])
        current = max(following, key=lambda child: float(np.linalg.norm(child.offset)), default=None)
    return bones


def _find_arm(bones: Sequence[CapturedJoint]) -> list[CapturedJoint]:
    """Return a limb's shoulder, elbow and wrist, or an empty list.

    Upper arm and forearm are the longest two successive bones with a ratio in `BONE_RATIOS`.
    """
    lengths = _lengths(bones)
    least, most = BONE_RATIOS
    starts = [k for k in range(1, len(bones) - 1) if least <= lengths[k] / lengths[k + 1] <= most]
    best = max(starts, key=lambda k: float(lengths[k] + lengths[k + 1]), default=None)
    return [] if best is None else list(bones[best - 1 : best - 1 + ARM_JOINTS])


def _match_arms(limbs: Sequence[list[CapturedJoint]]) -> tuple[list[CapturedJoint], ...]:
    """Return the first two arms with equal bone lengths, or ()."""
    arms = [limb for limb in limbs if limb]
    for k, first in enumerate(arms):
        for second in arms[k + 1 :]:
            if _are_equal(_lengths(first), _lengths(second)):
                return first, second
    return ()


def _are_equal(first: Floats, second: Floats) -> bool:
    return bool((np.abs(first - second) <= MAX_SIDE_DIFFERENCE * np.maximum(first, second)).all())


def _lengths(bones: Sequence[CapturedJoint]) -> Floats:
    return np.array([np.linalg.norm(bone.offset) for bone in bones])


def _side_of(names: Sequence[str]) -> Side | None:
    """Return the body side stated in joint names, or None."""
    for name in names:
        match = _SIDE_WORD.search(name.rpartition(":")[2])
        if match is not None:
            return "l" if next(word for word in match.groups() if word)[0].lower() == "l" else "r"
    return None


def _find_neck_and_head(start: CapturedJoint, children: Mapping[str | None, list[CapturedJoint]]) -> tuple[str, str]:
    """Return the names of the neck joint `start` and the head joint.

    The head is the neck's first child, or the neck itself if it has no child.
    """
    following = children.get(start.name, [])
    return start.name, following[0].name if following else start.name
