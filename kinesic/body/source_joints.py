"""Conversion of hinge angles to the joints of an imported robot's file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.skeleton import Skeleton


@dataclass(frozen=True)
class SourceJoint:
    """Joint of an imported file that became a hinge or coupling.

    joint angle = zero + sign * hinge angle
    """

    name: str  # name in the imported file
    sign: float  # 1, or -1 if joint and hinge rotate in opposite directions
    zero: float  # [rad] joint angle at hinge angle 0


@dataclass(frozen=True, eq=False)
class SourceJoints:
    """Linear map from hinge angles to joint angles of an imported file.

    A hinge that the file does not name keeps its own name, sign and zero. Coupled joints of the file follow the hinges.
    """

    names: tuple[str, ...]  # (j,) joint names: one per hinge in joint order, then those of couplings
    hinges: tuple[str, ...]  # names of the hinges, in joint order
    ratios: Floats  # (j, n) joint angle per hinge angle
    offsets: Floats  # (j,) [rad] joint angles at hinge angles 0

    @classmethod
    def of(cls, skeleton: Skeleton, sources: Mapping[str, SourceJoint]) -> "SourceJoints":
        """Make the map of a skeleton.

        Args:
            skeleton: of the robot.
            sources: hinge or coupling -> joint of the imported file.
        """
        count = len(skeleton.hinges)
        rows = np.eye(count)
        joints = [(SourceJoint(name, 1.0, 0.0), row, 0.0) for name, row in zip(skeleton.names, rows, strict=True)]
        joints = [(sources.get(joint.name, joint), row, offset) for joint, row, offset in joints]
        joints += [
            (sources[coupling.name], coupling.ratio * rows[coupling.driver], coupling.offset)
            for coupling in skeleton.couplings
            if coupling.name in sources
        ]
        return cls(
            names=tuple(joint.name for joint, _, _ in joints),
            hinges=skeleton.names,
            ratios=sealed([joint.sign * row for joint, row, _ in joints]),
            offsets=sealed([joint.zero + joint.sign * offset for joint, _, offset in joints]),
        )

    def joint_angles(self, angles: Floats) -> Floats:
        """Return joint angles (..., j) [rad] of hinge angles (..., n)."""
        return sealed(self.joint_rates(angles) + self.offsets)

    def joint_rates(self, rates: Floats) -> Floats:
        """Convert hinge velocities or accelerations to those of imported joints, (..., j)."""
        return sealed(rates @ self.ratios.T)

    def find_hinges(self, names: Sequence[str]) -> Mapping[int, int]:
        """Map hinge indices to table columns named after hinges or joints.

        If a hinge has both names among the columns, the name of its joint counts.
        """
        columns = {name: k for k, name in enumerate(names)}
        pairs = zip(self.names, self.hinges, strict=False)  # coupled joints follow their hinges
        return {
            k: columns.get(joint, columns.get(hinge, -1))
            for k, (joint, hinge) in enumerate(pairs)
            if joint in columns or hinge in columns
        }

    def hinge_angles(self, hinge: int, name: str, values: Floats) -> Floats:
        """Convert a column of joint or hinge angles to hinge angles.

        Args:
            hinge: index in joint order.
            name: of the column, that of the joint or of the hinge.
            values: (m,) [rad] of the column.
        """
        if name != self.names[hinge]:
            return values
        angles: Floats = (values - self.offsets[hinge]) * self.ratios[hinge, hinge]
        return angles
