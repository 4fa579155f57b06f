"""A limb as inverse kinematics sees it: joints in a row, each an ordered list of hinges and the bone that leaves it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import about
from kinesic.body.skeleton import Hinge, Skeleton


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
        """Forward kinematics in the frame of the base.

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
        """(3,) [m] the wrist's centre in the frame of the base, for (k,) [rad]."""
        return np.array(self.frames(angles)[1][-2])
