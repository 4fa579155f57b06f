"""Calibration of a robot that is moved by hand.

First the robot is held in its zero posture, which gives the zeros. Then every hinge is turned, in positive direction
first, which gives the directions, and through its full range: where a hinge stops before the end of its range in the
robot's file, the range is narrowed.
"""

import json
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.calibration import Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_RADIAN, TICKS_PER_TURN
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.manifest import Manifest

DIRECTION_THRESHOLD = np.radians(8.0)  # [rad] smallest rotation from the zero posture that shows a hinge's direction
STOP_TOLERANCE = np.radians(3.0)  # [rad] distance from a configured limit within which the limit counts as reached
MIN_RANGE_FRACTION = 0.6  # Fraction of the configured range that must be covered before a measured end counts
MAX_TANDEM_OFFSET = 12  # [ticks] largest position difference between the servos of one hinge

Signs = NDArray[np.int64]
# Words for motion along +-x, +-y, +-z
DIRECTION_WORDS = (("forward", "backward"), ("to its left", "to its right"), ("up", "down"))
MIN_MOTION_RATIO = 0.5  # least tip motion / lever length, or axis component, to describe a direction
FORWARD_AXIS = np.array([1.0, 0.0, 0.0])  # Unit vector forward in the world
UP_AXIS = np.array([0.0, 0.0, 1.0])  # Unit vector upward in the world


@dataclass(frozen=True, eq=False)
class Travel:
    """Range and direction of each servo's motion since the zero posture.

    Arrays are in manifest order.
    """

    zeros: Ticks  # (m,) [ticks] positions in the zero posture, maybe turns away from 0
    present: Ticks  # (m,) [ticks] present positions relative to `zeros`
    lowest: Ticks  # (m,) [ticks] lowest positions relative to `zeros`
    highest: Ticks  # (m,) [ticks] highest positions relative to `zeros`
    directions: Signs  # (m,) sign of the first rotation; 0: not rotated yet

    @classmethod
    def begin(cls, positions: Ticks) -> "Travel":
        """Start recording in the zero posture, at positions (m,) [ticks]."""
        nothing = np.zeros(len(positions), dtype=np.int64)
        return cls(positions.copy(), nothing, nothing, nothing, nothing)

    def with_positions(self, positions: Ticks, manifest: Manifest) -> "Travel":
        """Return the travel extended by measured positions (m,) [ticks]."""
        present = positions - self.zeros
        far = np.abs(present) >= DIRECTION_THRESHOLD * TICKS_PER_RADIAN * reductions(manifest)
        return replace(
            self,
            present=present,
            lowest=np.minimum(self.lowest, present),
            highest=np.maximum(self.highest, present),
            directions=np.where((self.directions == 0) & far, np.sign(present), self.directions),
        )


@dataclass(frozen=True)
class HingeCalibration:
    """Measurements of one hinge, in degrees of hinge rotation."""

    hinge: str
    ids: tuple[int, ...]
    zero_ticks: int  # [ticks] servo position in the zero posture
    direction: int  # 1: servo and hinge rotate alike, -1: opposite, 0: unknown
    present: float  # [deg] present angle
    lowest: float  # [deg] lowest angle that was reached
    highest: float  # [deg] highest angle that was reached
    lower: float  # [deg] lower limit in the robot's file
    upper: float  # [deg] upper limit in the robot's file

    @property
    def is_whole(self) -> bool:
        """Whether the hinge was turned through its whole configured range."""
        short = float(np.degrees(STOP_TOLERANCE))
        return self.direction != 0 and self.lowest <= self.lower + short and self.highest >= self.upper - short

    @property
    def range(self) -> tuple[float, float] | None:
        """Measured range [deg] if narrower than the configured one, or None.

        None if the full range was reached, or too little of it was seen.
        """
        width, short = self.upper - self.lower, float(np.degrees(STOP_TOLERANCE))
        if self.direction == 0 or self.is_whole or self.highest - self.lowest < MIN_RANGE_FRACTION * width:
            return None
        lowest = self.lower if self.lowest <= self.lower + short else round(self.lowest, 1)
        highest = self.upper if self.highest >= self.upper - short else round(self.highest, 1)
        return lowest, highest


def reductions(manifest: Manifest) -> Floats:
    """Return unsigned servo revolutions per hinge revolution (m,)."""
    return sealed([abs(member.turns) for member in manifest.members])


def measure_hinges(travel: Travel, manifest: Manifest, robot: Robot) -> tuple[HingeCalibration, ...]:
    """Return the measurements of all hinges, in joint order.

    The first servo of a tandem represents it.
    """
    return tuple(_mark(joint, travel, manifest, robot) for joint in range(len(robot.skeleton.hinges)))


def _mark(joint: int, travel: Travel, manifest: Manifest, robot: Robot) -> HingeCalibration:
    places = [k for k, member in enumerate(manifest.members) if member.joint == joint]
    first, hinge = places[0], robot.skeleton.hinges[joint]
    member = manifest.members[first]
    direction = int(travel.directions[first])
    sign = direction or (1 if member.turns > 0 else -1)
    scale = float(np.degrees(1.0 / (sign * abs(member.turns) * TICKS_PER_RADIAN)))
    ends = sorted((float(travel.lowest[first]) * scale, float(travel.highest[first]) * scale))
    return HingeCalibration(
        hinge=hinge.name,
        ids=tuple(manifest.members[k].id for k in places),
        zero_ticks=int(travel.zeros[first]) % TICKS_PER_TURN,
        direction=direction,
        present=float(travel.present[first]) * scale,
        lowest=ends[0],
        highest=ends[1],
        lower=float(np.degrees(hinge.lower)),
        upper=float(np.degrees(hinge.upper)),
    )


def calibration(travel: Travel, manifest: Manifest, robot: Robot, before: Calibration) -> Calibration:
    """Make the calibration of a robot from its measured travel.

    Args:
        travel: measured motion.
        manifest: servos of the robot.
        robot: robot without calibration.
        before: previous calibration, whose directions and ranges are kept for hinges that were not turned.

    Raises:
        ConfigError: a range exceeds one servo turn or excludes the rest posture, or a tandem disagrees; one line each.
    """
    hinges = measure_hinges(travel, manifest, robot)
    inverted_before = {member.hinge: member.turns < 0 for member in manifest.members} | before.inverted
    inverted = {mark.hinge: mark.direction < 0 if mark.direction else inverted_before[mark.hinge] for mark in hinges}
    ranges = before.range_deg | {mark.hinge: mark.range for mark in hinges if mark.direction}
    lines = [line for mark in hinges if (line := _fault(mark, inverted[mark.hinge], travel, manifest, robot))]
    if lines:
        raise ConfigError("\n".join(lines))
    return Calibration(
        robot=robot.name,
        zero_ticks={mark.hinge: mark.zero_ticks for mark in hinges},
        inverted=inverted,
        range_deg={hinge: ends for hinge, ends in ranges.items() if ends is not None},
    )


def _fault(mark: HingeCalibration, inverted: bool, travel: Travel, manifest: Manifest, robot: Robot) -> str:
    where = f"{mark.hinge} (servo {', '.join(str(servo) for servo in mark.ids)})"
    lower, upper = mark.range or (mark.lower, mark.upper)
    places = [k for k, member in enumerate(manifest.members) if member.hinge == mark.hinge]
    offset = np.ptp((travel.zeros[places] + TICKS_PER_TURN // 2 - mark.zero_ticks) % TICKS_PER_TURN)
    if offset > MAX_TANDEM_OFFSET:
        return f"{where}: its servos differ by {offset} ticks; loosen one horn and align it with the other"
    turns = abs(manifest.members[places[0]].turns) * (-1 if inverted else 1)
    ends = sorted(mark.zero_ticks + turns * TICKS_PER_TURN / 360.0 * angle for angle in (lower, upper))
    if ends[0] < 0 or ends[1] > TICKS_PER_TURN - 1:
        needed = f"{ends[0]:.0f}..{ends[1]:.0f} ticks"
        return f"{where}: {lower:g}..{upper:g} deg would be {needed}, beyond one turn; remount its horn nearer to 2048"
    rest = float(np.degrees(robot.skeleton.hinges[robot.skeleton.joint(mark.hinge)].rest))
    if not lower <= rest <= upper:
        range_text = f"goes {lower:g}..{upper:g} deg"
        return f"{where}: {range_text}, which excludes its rest of {rest:g} deg; free the hinge, or change [rest]"
    return ""


def calibration_text(measured: Calibration, robot: Robot) -> str:
    """Return a calibration as TOML text."""
    lines = [
        f"# Written by `kinesic servos calibrate`; overrides {robot.path.name} by hinge name.",
        f"robot = {json.dumps(measured.robot)}",
        "",
        "[zero_ticks]  # servo position at hinge angle 0",
        *(f"{json.dumps(hinge)} = {ticks}" for hinge, ticks in measured.zero_ticks.items()),
        "",
        "[inverted]  # whether servo and hinge rotate in opposite directions",
        *(f"{json.dumps(hinge)} = {json.dumps(inverted)}" for hinge, inverted in measured.inverted.items()),
    ]
    if measured.range_deg:
        lines += ["", "[range_deg]  # measured ranges smaller than those of the robot's file"]
        lines += [
            f"{json.dumps(hinge)} = [{lowest:g}, {highest:g}]"
            for hinge, (lowest, highest) in measured.range_deg.items()
        ]
    return "\n".join(lines) + "\n"


def describe_positive_direction(robot: Robot, joint: int) -> str:
    """Describe the motion of a hinge in positive direction.

    The motion begins in the zero posture.
    """
    skeleton = robot.skeleton
    hinge = skeleton.hinges[joint]
    zero_frames = skeleton.zero_frames
    segment = skeleton.segment(hinge.segment)
    axis = zero_frames.rotations[segment] @ hinge.axis
    lever = _tip(robot, hinge.segment) - zero_frames.origins[segment]
    moved = np.cross(axis, lever)
    if np.linalg.norm(moved) > MIN_MOTION_RATIO * np.linalg.norm(lever):
        return f"{hinge.segment} goes {_word(moved)}"
    if abs(axis @ FORWARD_AXIS) > MIN_MOTION_RATIO:
        return f"top of {hinge.segment} turns {_word(np.cross(axis, UP_AXIS))}"
    return f"front of {hinge.segment} turns {_word(np.cross(axis, FORWARD_AXIS))}"


def _tip(robot: Robot, name: str) -> Floats:
    """Return the centre (3,) [m] of a segment's capsules in zero posture."""
    skeleton, frames = robot.skeleton, robot.skeleton.zero_frames
    k = skeleton.segment(name)
    ends = [end for capsule in skeleton.segments[k].capsules for end in (capsule.start, capsule.end)]
    middle = np.mean(ends, axis=0) if ends else np.zeros(3)
    return np.asarray(frames.origins[k] + frames.rotations[k] @ middle)


def _word(direction: Floats) -> str:
    k = int(np.abs(direction).argmax())
    return DIRECTION_WORDS[k][int(direction[k] < 0)]
