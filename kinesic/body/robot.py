"""Robot model: description, drives, arms, fingers and collision pairs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from itertools import combinations
from pathlib import Path
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.calibration import calibration_path
from kinesic.body.chain import Chain, idealise
from kinesic.body.config import CONFIGS, locate_config
from kinesic.body.description import Description, Site
from kinesic.body.html_view import NotebookView
from kinesic.body.robot_file import read_description
from kinesic.body.servo import Drives
from kinesic.body.skeleton import Coupling, Frames, Hinge
from kinesic.body.source_joints import SourceJoints

Side = Literal["l", "r"]
SIDES: tuple[Side, Side] = ("l", "r")  # sides of the body, as in hinge names
OTHER_SIDE: Mapping[Side, Side] = {"l": "r", "r": "l"}  # opposite side of the body
SIDE_NAMES: Mapping[Side, str] = {"l": "left", "r": "right"}  # side -> word for messages
PartName = Literal["torso", "head", "l_hand", "r_hand"]  # body parts that behaviours move
# kinematic chain that moves each body part
PART_CHAINS: Mapping[PartName, str] = {"torso": "torso", "l_hand": "l_arm", "r_hand": "r_arm", "head": "neck"}
SHOULDER_LIFT_SUFFIX = "sternoclavicular_abduct"  # Suffix of the names of hinges that raise a shoulder


@dataclass(frozen=True, eq=False)
class FingerTip:
    """Sphere at the tip of a finger."""

    segment: int  # index of the finger's last segment
    place: Floats  # (3,) [m] centre, in the segment
    radius: float  # [m]


@dataclass(frozen=True, eq=False)
class RobotArm:
    """One arm of a robot's skeleton."""

    segments: tuple[str, ...]  # segments from the base outward; the last three are upper arm, forearm and hand
    joints: tuple[int, ...]  # hinge indices, in joint order
    shoulder: int  # index of the upper arm's segment; its origin is the shoulder's centre
    elbow: int  # index of the forearm's segment
    wrist: int  # index of the hand's segment
    palm: Site  # centre and normal of the palm
    shoulder_lift_joints: tuple[int, ...]  # hinges that raise the shoulder
    fingers: tuple[int, ...]  # hinges of the fingers, in joint order
    bodies: frozenset[str]  # names of its bodies in `Robot.bodies`

    @property
    def all_joints(self) -> tuple[int, ...]:
        """Hinge indices of the arm, then of its fingers."""
        return (*self.joints, *self.fingers)

    @classmethod
    def of(cls, robot: Description, side: Side) -> "RobotArm":
        """Make the arm on one side of a robot."""
        skeleton, segments = robot.skeleton, robot.chains[f"{side}_arm"]
        shoulder, elbow, wrist = (skeleton.segment(name) for name in segments[-3:])
        joints = skeleton.joints_of(segments)
        shoulder_lift_joints = tuple(k for k in joints if skeleton.names[k].endswith(SHOULDER_LIFT_SUFFIX))
        fingers = skeleton.joints_of(robot.chains.get(f"{side}_fingers", ()))
        bodies = frozenset((*segments, f"{side}_fingers"))
        palm = robot.sites[f"{side}_palm"]
        return cls(segments, joints, shoulder, elbow, wrist, palm, shoulder_lift_joints, fingers, bodies)


@dataclass(frozen=True, eq=False)
class Robot(Description, NotebookView):
    """Humanoid robot: its description and derived data."""

    @classmethod
    def load(cls, name: str | Path = "upper22", *, calibrated: bool = True) -> "Robot":
        """Read a robot by its configured name or from a TOML file.

        A robot of this package without a calibration is the same object at each call.

        Args:
            name: name or path.
            calibrated: apply its calibration, if there is one.

        Raises:
            ConfigError: the robot is unknown, or its file is invalid.
        """
        path = locate_config("robot", name)
        if path.parent == CONFIGS / "robots" and not (calibrated and calibration_path(path).exists()):
            return _load_packaged(path)
        return cls.of(read_description(path, calibrated=calibrated))

    @classmethod
    def of(cls, description: Description) -> "Robot":
        """Make a robot from its description."""
        return cls(**{field.name: getattr(description, field.name) for field in fields(description)})

    def __str__(self) -> str:
        """Return a one-line summary: name, hinges, servos, arm length."""
        driven = sum(mount.drive.count for mount in self.mounts)
        return f"robot {self.name}: {len(self.mounts)} hinges, {driven} drives, arms of {self.arm_length:.2f} m"

    def __repr__(self) -> str:
        return f"<{self}>"

    @cached_property
    def drives(self) -> Drives:
        """Drives of all hinges, in joint order."""
        return Drives(mount.drive for mount in self.mounts)

    @cached_property
    def source_joints(self) -> SourceJoints:
        """Conversion to names, signs and zeros of the imported file's joints."""
        return SourceJoints.of(self.skeleton, self.sources)

    @cached_property
    def velocity_limits(self) -> Floats:
        """Maximum planned velocities (n,) [rad/s]."""
        return self.drives.speed

    @cached_property
    def arms(self) -> Mapping[Side, Chain]:
        """Idealised chains from the collar bone to the hand, by side."""
        return {side: self._chain(side) for side in SIDES}

    def _chain(self, side: Side) -> Chain:
        arm = self.arm(side)
        chain = Chain.of(self.skeleton, f"{side}_arm", arm.segments, along=arm.palm.position, palm=arm.palm.facing)
        return idealise(chain)

    @cached_property
    def sides(self) -> tuple[Side, ...]:
        """Sides with an arm that moves."""
        return tuple(side for side in SIDES if self.skeleton.joints_of(self.chains.get(f"{side}_arm", ())))

    def arm(self, side: Side) -> RobotArm:
        """Return the skeleton's arm on one side.

        `arms` has its idealised chain. An arm that the robot lacks has segments, but no hinges.
        """
        return self._robot_arms[side]

    @cached_property
    def _robot_arms(self) -> Mapping[Side, RobotArm]:
        return {side: RobotArm.of(self, side) for side in SIDES}

    def joints(self, chain: str) -> tuple[int, ...]:
        """Return the hinge indices of a chain, in joint order.

        The tuple is empty for a chain that the robot lacks.
        """
        return self._joints.get(chain, ())

    @cached_property
    def _joints(self) -> Mapping[str, tuple[int, ...]]:
        return {chain: self.skeleton.joints_of(segments) for chain, segments in self.chains.items()}

    def part_joints(self, part: PartName) -> tuple[int, ...]:
        """Return the hinge indices of a body part, in joint order.

        A hand includes its arm and fingers.
        """
        fingers = self.joints(f"{part[0]}_fingers") if part.endswith("_hand") else ()
        return (*self.joints(PART_CHAINS[part]), *fingers)

    def fingers(self, side: Side) -> tuple[str, ...]:
        """List the names of a hand's finger segments, empty without fingers."""
        return self.chains.get(f"{side}_fingers", ())

    @cached_property
    def finger_segments(self) -> frozenset[int]:
        """Indices of the finger segments of both hands."""
        return frozenset(self.skeleton.segment(name) for side in SIDES for name in self.fingers(side))

    def body_frames(self, angles: Floats) -> Frames:
        """Compute the world frames of all segments except fingers.

        The angles are (..., n) [rad]; the frames of finger segments are undefined.
        """
        return self.skeleton.frames(angles, without=self.finger_segments)

    def finger_tips(self, side: Side) -> Mapping[str, FingerTip]:
        """Return the fingertips of a hand, by finger name.

        The names are those in the hinge names of the fingers.
        """
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
        for segment, finger in turned:  # the last segment of a finger overwrites the others
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
        """Distance from shoulder to wrist of the straight arm [m].

        It is the unit of gesture space.
        """
        return float(self.arms["l"].lengths[-3:-1].sum())

    @cached_property
    def gesture_origin(self) -> Floats:
        """Origin of gesture space (3,) [m] in the world.

        It lies in the body's midline at shoulder depth, at the height of the elbows of hanging arms.
        """
        origins = self.skeleton.zero_frames.origins
        arm = self.arm("l")
        return sealed([origins[arm.shoulder][0], 0.0, origins[arm.elbow][2]])

    @cached_property
    def bodies(self) -> Mapping[str, tuple[str, ...]]:
        """Segments of each body in collision checks, by body name.

        The fingers of a hand form one body with the name of their chain.
        """
        fingers = {f"{side}_fingers": self.fingers(side) for side in SIDES if self.fingers(side)}
        together = {name for names in fingers.values() for name in names}
        absent = {name for side in SIDES if side not in self.sides for name in self.chains.get(f"{side}_arm", ())}
        shapeless = {s.name for s in self.skeleton.segments if s.name in absent and not s.capsules}
        return {s.name: (s.name,) for s in self.skeleton.segments if s.name not in together | shapeless} | fingers

    @cached_property
    def counted_pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of bodies whose distance the collision check measures.

        Pairs of parent and child, and the listed exclusions, do not count.
        """
        parents = {segment.name: segment.parent for segment in self.skeleton.segments}
        excluded = {exclusion.pair for exclusion in self.exclusions}
        excluded |= {frozenset((name, parents[name] or "")) for name in self.bodies if name in parents}
        return tuple(pair for pair in combinations(self.bodies, 2) if frozenset(pair) not in excluded)


@lru_cache(maxsize=8)
def _load_packaged(path: Path) -> Robot:
    """Read a robot of this package as described, once per process.

    Caches keyed by a robot thus stay valid for all setups.
    """
    return Robot.of(read_description(path, calibrated=False))
