"""A limb as inverse kinematics sees it: joints in a row, each an ordered list of hinges and the bone that leaves it.

Closed forms want twists exactly along their bones, and no more hinges than aim them. Real robots miss that by degrees
and centimetres. `idealise` keeps centres and hinges, so that its angles are a good guess for the real arm, on which
inverse kinematics finishes.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import about
from kinesic.body.skeleton import Hinge, Skeleton

LENGTHWISE = 0.8  # cosine to its bone from which a joint's last hinge is a twist
EXACT = 1e-9  # sine of the angle below which it lies along the bone already
MOST_SWINGS = 2  # of one joint


@dataclass(frozen=True, eq=False)
class ChainJoint:
    """Hinges with one common centre, and the bone from this centre to the next."""

    name: str  # of the segment
    hinges: tuple[Hinge, ...]  # the first is nearest the base
    bone: Floats  # (3,) [m] in the segment, to the next joint's centre; of the last joint: along the hand


@dataclass(frozen=True, eq=False)
class Chain:
    """Joints from the base outward; the hand is the centre of the last joint.

    Frames: `base` is the segment that the chain hangs on; positions named `..._in_base` are in its frame.
    """

    name: str
    base: str
    origin_in_base: Floats  # (3,) [m] centre of the first joint
    joints: tuple[ChainJoint, ...]
    indices: tuple[int, ...]  # of its hinges in the skeleton's joint order
    palm: Floats  # (3,) unit, direction that the palm faces, in the last segment

    @classmethod
    def of(cls, skeleton: Skeleton, name: str, segments: tuple[str, ...], *, along: Floats, palm: Floats) -> "Chain":
        """Cuts a chain out of a skeleton.

        Args:
            skeleton: the robot.
            name: of the chain.
            segments: names from the base outward, each the parent of the next.
            along: (3,) [m] the last bone (wrist to palm) in the last segment.
            palm: (3,) direction that the palm faces, in the last segment.
        """
        parts = [skeleton.segments[skeleton.segment(segment)] for segment in segments]
        bones = [part.origin_in_parent for part in parts[1:]] + [along]
        joints = tuple(
            ChainJoint(part.name, tuple(h for h in skeleton.hinges if h.segment == part.name), sealed(bone))
            for part, bone in zip(parts, bones, strict=True)
        )
        base = parts[0].parent or ""
        return cls(name, base, parts[0].origin_in_parent, joints, skeleton.joints_of(segments), sealed(palm))

    @cached_property
    def lower(self) -> Floats:
        """(k,) [rad]."""
        return sealed([hinge.lower for joint in self.joints for hinge in joint.hinges])

    @cached_property
    def upper(self) -> Floats:
        """(k,) [rad]."""
        return sealed([hinge.upper for joint in self.joints for hinge in joint.hinges])

    @cached_property
    def rest(self) -> Floats:
        """(k,) [rad]."""
        return sealed([hinge.rest for joint in self.joints for hinge in joint.hinges])

    @cached_property
    def lengths(self) -> Floats:
        """(joints,) [m] of the bones."""
        return sealed([np.linalg.norm(joint.bone) for joint in self.joints])

    def frames(self, angles: Floats) -> tuple[Floats, Floats]:
        """Solves the forward kinematics in the frame of the base.

        Args:
            angles: (k,) [rad] of this chain's hinges.

        Returns:
            Rotations (j, 3, 3) of the joints' segments and centres (j + 1, 3) [m]; the last centre is the palm,
            the one before it the hand (the wrist's centre).
        """
        rotations = np.empty((len(self.joints), 3, 3))
        centres = np.empty((len(self.joints) + 1, 3))
        rotation, centres[0] = np.eye(3), self.origin_in_base
        k = 0
        for j, joint in enumerate(self.joints):
            for hinge in joint.hinges:
                rotation = rotation @ about(hinge.axis, angles[k])
                k += 1
            rotations[j] = rotation
            centres[j + 1] = centres[j] + rotation @ joint.bone
        return rotations, centres

    def hand(self, angles: Floats) -> Floats:
        """Finds the wrist's centre (3,) [m] in the frame of the base, for (k,) [rad]."""
        return np.array(self.frames(angles)[1][-2])


def idealise(chain: Chain) -> Chain:
    """Aligns twist hinges with their bones and drops redundant hinges; an ideal chain is returned unchanged.

    A joint's last hinge near its bone comes to lie along it. Where more than two others swing the bone, the one
    nearest to it is left out, and stays where it is.
    """
    kept: list[int] = []
    joints: list[ChainJoint] = []
    rows = iter(chain.indices)
    for joint in chain.joints:
        indices = [next(rows) for _ in joint.hinges]
        hinges = _aiming(_straightened(joint))
        names = {hinge.name for hinge in hinges}
        kept += [index for index, hinge in zip(indices, joint.hinges, strict=True) if hinge.name in names]
        joints.append(joint if hinges == joint.hinges else replace(joint, hinges=hinges))
    if all(new is old for new, old in zip(joints, chain.joints, strict=True)):
        return chain
    return replace(chain, joints=tuple(joints), indices=tuple(kept))


def _straightened(joint: ChainJoint) -> ChainJoint:
    length = float(np.linalg.norm(joint.bone))
    if not joint.hinges or length == 0.0:
        return joint
    along, last = joint.bone / length, joint.hinges[-1]
    cosine = float(last.axis @ along)
    if abs(cosine) < LENGTHWISE or float(np.linalg.norm(np.cross(last.axis, along))) < EXACT:
        return joint
    twist = replace(last, axis=sealed(np.sign(cosine) * along))
    return replace(joint, hinges=(*joint.hinges[:-1], twist))


def _aiming(joint: ChainJoint) -> tuple[Hinge, ...]:
    """Picks the hinges of a joint that aim its bone: at most two that swing it, and one that twists it."""
    hinges, bone = joint.hinges, joint.bone
    twists = bool(hinges) and _lengthwise(hinges[-1], bone) > 1.0 - EXACT
    swings = list(hinges[:-1] if twists else hinges)
    while len(swings) > MOST_SWINGS:
        swings.remove(max(swings, key=lambda hinge: _lengthwise(hinge, bone)))
    if len(swings) + twists == len(hinges):
        return hinges
    return (*swings, hinges[-1]) if twists else tuple(swings)


def _lengthwise(hinge: Hinge, bone: Floats) -> float:
    return abs(float(hinge.axis @ bone)) / max(float(np.linalg.norm(bone)), 1e-12)
