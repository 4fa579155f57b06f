"""Kinematic chains: joints of ordered hinges, linked by bones.

Closed-form solutions need twist axes exactly along their bones, and no redundant hinges. Real robots deviate from
that by degrees and centimetres. `idealise` keeps joint centres and hinges, so that the angles of its chain are a good
initial guess for the real arm, which inverse kinematics then refines.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import rotation_about
from kinesic.body.skeleton import Hinge, Skeleton

TWIST_ALIGNMENT = 0.8  # Minimum |cosine| between axis and bone at which a joint's last hinge counts as twist hinge
ALIGNMENT_TOLERANCE = 1e-9  # Largest sine, or 1 - cosine, of the angle between an aligned axis and its bone
MAX_SWING_HINGES = 2  # Largest number of non-twist hinges per joint; further hinges are dropped


@dataclass(frozen=True, eq=False)
class ChainJoint:
    """Hinges with one common centre, and the bone to the next joint."""

    name: str  # name of the joint's segment
    hinges: tuple[Hinge, ...]  # hinges of the joint, nearest to the base first
    bone: Floats  # (3,) [m] vector in the segment to the next joint's centre; from the last joint to the palm


@dataclass(frozen=True, eq=False)
class Chain:
    """Kinematic chain of joints from its base outward.

    Its last bone ends at the palm.

    Frames: `base` is the parent segment of the chain; positions named `..._in_base` are in its frame.
    """

    name: str
    base: str
    origin_in_base: Floats  # (3,) [m] centre of the first joint
    joints: tuple[ChainJoint, ...]
    indices: tuple[int, ...]  # hinge indices in the skeleton's joint order
    palm: Floats  # (3,) unit normal of the palm, in the last segment

    @classmethod
    def of(cls, skeleton: Skeleton, name: str, segments: tuple[str, ...], *, along: Floats, palm: Floats) -> "Chain":
        """Create the kinematic chain of consecutive segments of a skeleton.

        Args:
            skeleton: the robot's skeleton.
            name: name of the chain.
            segments: names from the base outward; each segment is the parent of the next.
            along: (3,) [m] the last bone (wrist to palm) in the last segment.
            palm: (3,) direction of the palm's normal, in the last segment.
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
        """Lower angle limits of the chain's hinges (k,) [rad]."""
        return sealed([hinge.lower for joint in self.joints for hinge in joint.hinges])

    @cached_property
    def upper(self) -> Floats:
        """Upper angle limits of the chain's hinges (k,) [rad]."""
        return sealed([hinge.upper for joint in self.joints for hinge in joint.hinges])

    @cached_property
    def rest(self) -> Floats:
        """Rest angles of the chain's hinges (k,) [rad]."""
        return sealed([hinge.rest for joint in self.joints for hinge in joint.hinges])

    @cached_property
    def lengths(self) -> Floats:
        """Lengths of the chain's bones (joints,) [m]."""
        return sealed([np.linalg.norm(joint.bone) for joint in self.joints])

    def frames(self, angles: Floats) -> tuple[Floats, Floats]:
        """Compute the chain's forward kinematics in the base frame.

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
                rotation = rotation @ rotation_about(hinge.axis, angles[k])
                k += 1
            rotations[j] = rotation
            centres[j + 1] = centres[j] + rotation @ joint.bone
        return rotations, centres

    def hand(self, angles: Floats) -> Floats:
        """Return the position of the wrist (3,) [m] in the base frame."""
        return np.array(self.frames(angles)[1][-2])


def idealise(chain: Chain) -> Chain:
    """Align twist hinges with their bones and drop redundant hinges.

    The last hinge of a joint is aligned if it is nearly parallel to the bone. If more than two other hinges swing the
    bone, those most parallel to it are dropped and keep their angles. An ideal chain is returned unchanged.
    """
    kept_indices: list[int] = []
    joints: list[ChainJoint] = []
    all_indices = iter(chain.indices)
    for joint in chain.joints:
        indices = [next(all_indices) for _ in joint.hinges]
        hinges = _select_essential_hinges(_with_aligned_twist(joint))
        names = {hinge.name for hinge in hinges}
        kept_indices += [index for index, hinge in zip(indices, joint.hinges, strict=True) if hinge.name in names]
        joints.append(joint if hinges == joint.hinges else replace(joint, hinges=hinges))
    if all(new is old for new, old in zip(joints, chain.joints, strict=True)):
        return chain
    return replace(chain, joints=tuple(joints), indices=tuple(kept_indices))


def _with_aligned_twist(joint: ChainJoint) -> ChainJoint:
    length = float(np.linalg.norm(joint.bone))
    if not joint.hinges or length == 0.0:
        return joint
    along, last = joint.bone / length, joint.hinges[-1]
    cosine = float(last.axis @ along)
    if abs(cosine) < TWIST_ALIGNMENT or float(np.linalg.norm(np.cross(last.axis, along))) < ALIGNMENT_TOLERANCE:
        return joint
    twist = replace(last, axis=sealed(np.sign(cosine) * along))
    return replace(joint, hinges=(*joint.hinges[:-1], twist))


def _select_essential_hinges(joint: ChainJoint) -> tuple[Hinge, ...]:
    """Keep at most two non-twist hinges, and the aligned twist hinge."""
    hinges, bone = joint.hinges, joint.bone
    twists = bool(hinges) and _alignment(hinges[-1], bone) > 1.0 - ALIGNMENT_TOLERANCE
    swings = list(hinges[:-1] if twists else hinges)
    while len(swings) > MAX_SWING_HINGES:
        swings.remove(max(swings, key=lambda hinge: _alignment(hinge, bone)))
    if len(swings) + twists == len(hinges):
        return hinges
    return (*swings, hinges[-1]) if twists else tuple(swings)


def _alignment(hinge: Hinge, bone: Floats) -> float:
    return abs(float(hinge.axis @ bone)) / max(float(np.linalg.norm(bone)), 1e-12)
