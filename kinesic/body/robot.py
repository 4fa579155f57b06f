"""The robot: one description from which IK chains, the MuJoCo model, limits and the servo map all come."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.config import locate
from kinesic.body.servo import Drive
from kinesic.body.skeleton import Skeleton

Side = Literal["l", "r"]
SIDES: tuple[Side, Side] = ("l", "r")
SPEED_SHARE = 0.8  # of the no-load speed that a plan may use


@dataclass(frozen=True, eq=False)
class Mount:
    """A drive and where its servos sit (they carry weight)."""

    drive: Drive
    segment: str
    position: Floats  # (3,) [m] in the segment


@dataclass(frozen=True)
class Exclusion:
    """Two segments whose distance does not count, and why."""

    pair: frozenset[str]
    why: str


@dataclass(frozen=True, eq=False)
class Site:
    """A named point on a segment."""

    segment: str
    position: Floats  # (3,) [m] in the segment
    facing: Floats  # (3,) unit, in the segment


@dataclass(frozen=True, eq=False)
class Robot:
    """A humanoid upper body with servos."""

    name: str
    path: Path
    skeleton: Skeleton
    mounts: tuple[Mount, ...]  # one per hinge, in joint order
    chains: Mapping[str, tuple[str, ...]]  # "torso", "neck", "l_arm", "r_arm" -> segments from the base outward
    sites: Mapping[str, Site]  # at least "l_palm", "r_palm", "eyes"
    exclusions: tuple[Exclusion, ...]
    least_clearance: float  # [m]
    targets: Mapping[str, Floats]  # named points (3,) [m] in the world

    @classmethod
    def load(cls, name: str | Path = "upper22") -> "Robot":
        """Reads a robot by its name in `configs/robots/`, or from a TOML file.

        Raises:
            ConfigError: there is no such robot, or its file is wrong.
        """
        from kinesic.body.robot_file import read_robot  # noqa: PLC0415 - the file's schema builds a Robot

        return read_robot(locate("robot", name))

    @cached_property
    def drives(self) -> tuple[Drive, ...]:
        """In joint order."""
        return tuple(mount.drive for mount in self.mounts)

    @cached_property
    def speed_limits(self) -> Floats:
        """(n,) [rad/s] that a plan may use."""
        return sealed([SPEED_SHARE * drive.no_load for drive in self.drives])

    @cached_property
    def arms(self) -> Mapping[Side, Chain]:
        """Chains from the collar bone to the hand."""
        return {side: self._arm(side) for side in SIDES}

    def _arm(self, side: Side) -> Chain:
        palm = self.sites[f"{side}_palm"]
        segments = self.chains[f"{side}_arm"]
        return Chain.of(self.skeleton, f"{side}_arm", segments, along=palm.position, palm=palm.facing)

    def joints(self, chain: str) -> tuple[int, ...]:
        """Indices of a chain's hinges in joint order; empty for a chain that the robot lacks."""
        return self.skeleton.joints_of(self.chains.get(chain, ()))

    @cached_property
    def arm_length(self) -> float:
        """Shoulder centre to wrist with the arm straight [m]: the unit of gesture space."""
        return float(self.arms["l"].lengths[-3:-1].sum())

    @cached_property
    def gesture_origin(self) -> Floats:
        """(3,) [m] in the world: body midline, depth of the shoulders, height of the elbows, arms hanging."""
        frames = self.skeleton.frames(np.zeros(len(self.skeleton.hinges)))
        shoulder, elbow = self.chains["l_arm"][-3:-1]
        x = frames.origins[self.skeleton.segment(shoulder)][0]
        z = frames.origins[self.skeleton.segment(elbow)][2]
        return sealed([x, 0.0, z])

    @cached_property
    def counted_pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of segments whose distance counts: all but parent with child and the listed exclusions."""
        segments = self.skeleton.segments
        excluded = {exclusion.pair for exclusion in self.exclusions}
        return tuple(
            (a.name, b.name)
            for k, a in enumerate(segments)
            for b in segments[k + 1 :]
            if b.parent != a.name and a.parent != b.name and frozenset((a.name, b.name)) not in excluded
        )
