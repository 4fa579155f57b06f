"""The robot: the one description from which IK chains, the MuJoCo model, limits and the servo map are made."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, idealise
from kinesic.body.config import locate
from kinesic.body.description import Description, Site
from kinesic.body.robot_file import read_description
from kinesic.body.servo import Drives
from kinesic.body.skeleton import Coupling, Frames, Hinge

Side = Literal["l", "r"]
SIDES: tuple[Side, Side] = ("l", "r")
OTHER_SIDE: Mapping[Side, Side] = {"l": "r", "r": "l"}
SIDE_NAMES: Mapping[Side, str] = {"l": "left", "r": "right"}
PartName = Literal["torso", "head", "l_hand", "r_hand"]  # what a behaviour moves
CHAINS: Mapping[PartName, str] = {"torso": "torso", "l_hand": "l_arm", "r_hand": "r_arm", "head": "neck"}
LIFTING = "sternoclavicular_abduct"  # how the name of a hinge ends that raises a shoulder


@dataclass(frozen=True, eq=False)
class FingerTip:
    """The ball at the end of a finger."""

    segment: int  # index of the finger's last segment
    place: Floats  # (3,) [m] of its centre, in the segment
    radius: float  # [m]


@dataclass(frozen=True, eq=False)
class RobotArm:
    """One arm in the skeleton of a robot."""

    segments: tuple[str, ...]  # from the base outward; the last three are upper arm, forearm and hand
    joints: tuple[int, ...]  # its hinges, in joint order
    shoulder: int  # index of the upper arm's segment, whose origin is the shoulder's centre
    elbow: int  # index of the forearm's segment
    wrist: int  # index of the hand's segment
    palm: Site
    lifting: tuple[int, ...]  # its hinges that raise the shoulder
    fingers: tuple[int, ...]  # the hinges of its fingers, in joint order
    bodies: frozenset[str]  # its segments, and its fingers as `Robot.bodies` has them

    @property
    def moving(self) -> tuple[int, ...]:
        """All hinges that the hand needs: those of the arm and of the fingers."""
        return (*self.joints, *self.fingers)

    @classmethod
    def of(cls, robot: Description, side: Side) -> "RobotArm":
        """The arm of one side."""
        skeleton, segments = robot.skeleton, robot.chains[f"{side}_arm"]
        shoulder, elbow, wrist = (skeleton.segment(name) for name in segments[-3:])
        joints = skeleton.joints_of(segments)
        lifting = tuple(k for k in joints if skeleton.names[k].endswith(LIFTING))
        fingers = skeleton.joints_of(robot.chains.get(f"{side}_fingers", ()))
        bodies = frozenset((*segments, f"{side}_fingers"))
        palm = robot.sites[f"{side}_palm"]
        return cls(segments, joints, shoulder, elbow, wrist, palm, lifting, fingers, bodies)


@dataclass(frozen=True, eq=False)
class Robot(Description):
    """A humanoid upper body with servos: what is written about it, and what follows."""

    @classmethod
    def load(cls, name: str | Path = "upper22", *, calibrated: bool = True) -> "Robot":
        """Reads a robot by its name in `configs/robots/`, or from a TOML file.

        Args:
            name: or path.
            calibrated: with its calibration laid over it, if there is one.

        Raises:
            ConfigError: there is no such robot, or its file is wrong.
        """
        return cls.of(read_description(locate("robot", name), calibrated=calibrated))

    @classmethod
    def of(cls, description: Description) -> "Robot":
        """The robot that a description describes."""
        return cls(**{field.name: getattr(description, field.name) for field in fields(description)})

    @cached_property
    def drives(self) -> Drives:
        """The drives of all hinges, in joint order."""
        return Drives(mount.drive for mount in self.mounts)

    @cached_property
    def speed_limits(self) -> Floats:
        """(n,) [rad/s] that a plan may use."""
        return self.drives.speed

    @cached_property
    def arms(self) -> Mapping[Side, Chain]:
        """Chains from the collar bone to the hand, as closed forms want them."""
        return {side: self._chain(side) for side in SIDES}

    def _chain(self, side: Side) -> Chain:
        arm = self.arm(side)
        chain = Chain.of(self.skeleton, f"{side}_arm", arm.segments, along=arm.palm.position, palm=arm.palm.facing)
        return idealise(chain)

    def arm(self, side: Side) -> RobotArm:
        """Finds an arm in the skeleton; `arms` has its chain."""
        return self._robot_arms[side]

    @cached_property
    def _robot_arms(self) -> Mapping[Side, RobotArm]:
        return {side: RobotArm.of(self, side) for side in SIDES}

    def joints(self, chain: str) -> tuple[int, ...]:
        """Finds the indices of a chain's hinges in joint order; none for a chain that the robot lacks."""
        return self._joints.get(chain, ())

    @cached_property
    def _joints(self) -> Mapping[str, tuple[int, ...]]:
        return {chain: self.skeleton.joints_of(segments) for chain, segments in self.chains.items()}

    def part_joints(self, part: PartName) -> tuple[int, ...]:
        """Finds the indices of the hinges that move with a part; a hand takes arm and fingers."""
        fingers = self.joints(f"{part[0]}_fingers") if part.endswith("_hand") else ()
        return (*self.joints(CHAINS[part]), *fingers)

    def fingers(self, side: Side) -> tuple[str, ...]:
        """Lists the segments of a hand's fingers; none of a hand without."""
        return self.chains.get(f"{side}_fingers", ())

    @cached_property
    def finger_segments(self) -> frozenset[int]:
        """Indices of the segments of both hands' fingers."""
        return frozenset(self.skeleton.segment(name) for side in SIDES for name in self.fingers(side))

    def body_frames(self, angles: Floats) -> Frames:
        """Solves the forward kinematics (..., n) [rad] of all segments but the fingers, whose frames are anything."""
        return self.skeleton.frames(angles, without=self.finger_segments)

    def finger_tips(self, side: Side) -> Mapping[str, FingerTip]:
        """Finds the tips of a hand's fingers by their names, which are those in the names of their turns."""
        return self._finger_tips[side]

    @cached_property
    def _finger_tips(self) -> Mapping[Side, Mapping[str, FingerTip]]:
        return {side: dict(self._tips(side)) for side in SIDES}

    def _tips(self, side: Side) -> Iterator[tuple[str, FingerTip]]:
        fingers = self.fingers(side)
        turns: tuple[Hinge | Coupling, ...] = (*self.skeleton.hinges, *self.skeleton.couplings)
        turned = sorted(
            (self.skeleton.segment(turn.segment), turn.name.split("_")[1]) for turn in turns if turn.segment in fingers
        )
        for segment, finger in turned:  # of the segments of one finger the last wins
            ends = [
                (end, capsule.radius)
                for capsule in self.skeleton.segments[segment].capsules
                for end in (capsule.start, capsule.end)
            ]
            if ends:
                place, radius = max(ends, key=lambda end: float(np.linalg.norm(end[0])))
                yield finger, FingerTip(segment, place, radius)

    @cached_property
    def arm_length(self) -> float:
        """Shoulder centre to wrist with the arm straight [m]: the unit of gesture space."""
        return float(self.arms["l"].lengths[-3:-1].sum())

    @cached_property
    def gesture_origin(self) -> Floats:
        """(3,) [m] in the world: body midline, depth of the shoulders, height of the elbows, arms hanging."""
        origins = self.skeleton.straight.origins
        arm = self.arm("l")
        return sealed([origins[arm.shoulder][0], 0.0, origins[arm.elbow][2]])

    @cached_property
    def bodies(self) -> Mapping[str, tuple[str, ...]]:
        """What can come near one another: segments, and the fingers of each hand as one body, by its chain's name."""
        fingers = {f"{side}_fingers": self.fingers(side) for side in SIDES if self.fingers(side)}
        together = {name for names in fingers.values() for name in names}
        return {s.name: (s.name,) for s in self.skeleton.segments if s.name not in together} | fingers

    @cached_property
    def counted_pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of bodies whose distance counts: all but parent with child and the listed exclusions."""
        parents = {segment.name: segment.parent for segment in self.skeleton.segments}
        excluded = {exclusion.pair for exclusion in self.exclusions}
        excluded |= {frozenset((name, parents[name] or "")) for name in self.bodies if name in parents}
        return tuple(pair for pair in combinations(self.bodies, 2) if frozenset(pair) not in excluded)
