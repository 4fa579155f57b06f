"""Calibrates a robot that is moved by hand: where zero is, which way each servo turns, how far it goes.

First the robot is held in its zero posture: that gives the zeros. Then every hinge is turned, the positive way first:
that gives the directions; and through all its range: where that ends short of the robot's file, the range is narrowed.
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

FIRST = np.radians(8.0)  # [rad] of a hinge by which its first way is seen
SHORT = np.radians(3.0)  # [rad] by which a hand may miss a stop
LEAST = 0.6  # share of a range that must be seen before its end is believed to be a stop
TANDEM = 12  # [ticks] that the servos of one hinge may stand apart

Ways = NDArray[np.int64]
WORDS = (("forward", "backward"), ("to its left", "to its right"), ("up", "down"))  # x, y, z of the robot
CLEAR = 0.5  # share of the lever that must move for the words to be about the part itself
FRONT, TOP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Travel:
    """How each servo has been turned since the zero posture, by members of the manifest."""

    zeros: Ticks  # (m,) [ticks], of any turn
    here: Ticks  # (m,) [ticks] from zero
    least: Ticks  # (m,) [ticks] from zero
    most: Ticks  # (m,) [ticks] from zero
    ways: Ways  # (m,) the sign of the first turn; 0: not turned yet

    @classmethod
    def begin(cls, positions: Ticks) -> "Travel":
        """Begins in the zero posture, at (m,) [ticks]."""
        nothing = np.zeros(len(positions), dtype=np.int64)
        return cls(positions.copy(), nothing, nothing, nothing, nothing)

    def seen(self, positions: Ticks, manifest: Manifest) -> "Travel":
        """Adds one more look at (m,) positions [ticks], which count turns without torque."""
        here = positions - self.zeros
        far = np.abs(here) >= FIRST * TICKS_PER_RADIAN * reductions(manifest)
        return replace(
            self,
            here=here,
            least=np.minimum(self.least, here),
            most=np.maximum(self.most, here),
            ways=np.where((self.ways == 0) & far, np.sign(here), self.ways),
        )


@dataclass(frozen=True)
class HingeCalibration:
    """What is known of one hinge, in degrees of the hinge."""

    hinge: str
    ids: tuple[int, ...]
    zero_ticks: int
    way: int  # 1: as the hinge, -1: against it, 0: not seen
    here: float
    least: float
    most: float
    lower: float  # of the robot's file
    upper: float

    @property
    def whole(self) -> bool:
        """Whether it was turned through all its range."""
        short = float(np.degrees(SHORT))
        return self.way != 0 and self.least <= self.lower + short and self.most >= self.upper - short

    @property
    def range(self) -> tuple[float, float] | None:
        """[deg] where it ended short of its file; None where it did not, or was not turned far enough to tell."""
        width, short = self.upper - self.lower, float(np.degrees(SHORT))
        if self.way == 0 or self.whole or self.most - self.least < LEAST * width:
            return None
        least = self.lower if self.least <= self.lower + short else round(self.least, 1)
        most = self.upper if self.most >= self.upper - short else round(self.most, 1)
        return least, most


def reductions(manifest: Manifest) -> Floats:
    """Returns (m,) servo turns per hinge turn, without sign."""
    return sealed([abs(member.turns) for member in manifest.members])


def marks(travel: Travel, manifest: Manifest, robot: Robot) -> tuple[HingeCalibration, ...]:
    """Returns what is known of each hinge, in joint order; a tandem is judged by its first servo."""
    return tuple(_mark(joint, travel, manifest, robot) for joint in range(len(robot.skeleton.hinges)))


def _mark(joint: int, travel: Travel, manifest: Manifest, robot: Robot) -> HingeCalibration:
    places = [k for k, member in enumerate(manifest.members) if member.joint == joint]
    first, hinge = places[0], robot.skeleton.hinges[joint]
    member = manifest.members[first]
    way = int(travel.ways[first])
    sign = way or (1 if member.turns > 0 else -1)
    scale = float(np.degrees(1.0 / (sign * abs(member.turns) * TICKS_PER_RADIAN)))
    ends = sorted((float(travel.least[first]) * scale, float(travel.most[first]) * scale))
    return HingeCalibration(
        hinge=hinge.name,
        ids=tuple(manifest.members[k].id for k in places),
        zero_ticks=int(travel.zeros[first]) % TICKS_PER_TURN,
        way=way,
        here=float(travel.here[first]) * scale,
        least=ends[0],
        most=ends[1],
        lower=float(np.degrees(hinge.lower)),
        upper=float(np.degrees(hinge.upper)),
    )


def calibration(travel: Travel, manifest: Manifest, robot: Robot, before: Calibration) -> Calibration:
    """Makes the calibration of a robot from what was seen.

    Args:
        travel: all that was seen.
        manifest: of the robot.
        robot: as its file has it, without calibration.
        before: from which hinges that were not turned keep their direction and range.

    Raises:
        ConfigError: a range leaves the servo's turn, does not hold the rest posture, or a tandem disagrees; one line
            each.
    """
    found = marks(travel, manifest, robot)
    known = {member.hinge: member.turns < 0 for member in manifest.members} | before.inverted
    inverted = {mark.hinge: mark.way < 0 if mark.way else known[mark.hinge] for mark in found}
    ranges = before.range_deg | {mark.hinge: mark.range for mark in found if mark.way}
    lines = [line for mark in found if (line := _fault(mark, inverted[mark.hinge], travel, manifest, robot))]
    if lines:
        raise ConfigError("\n".join(lines))
    return Calibration(
        robot=robot.name,
        zero_ticks={mark.hinge: mark.zero_ticks for mark in found},
        inverted=inverted,
        range_deg={hinge: ends for hinge, ends in ranges.items() if ends is not None},
    )


def _fault(mark: HingeCalibration, inverted: bool, travel: Travel, manifest: Manifest, robot: Robot) -> str:
    where = f"{mark.hinge} (servo {', '.join(str(servo) for servo in mark.ids)})"
    lower, upper = mark.range or (mark.lower, mark.upper)
    places = [k for k, member in enumerate(manifest.members) if member.hinge == mark.hinge]
    apart = np.ptp((travel.zeros[places] + TICKS_PER_TURN // 2 - mark.zero_ticks) % TICKS_PER_TURN)
    if apart > TANDEM:
        return f"{where}: its servos stand {apart} ticks apart; loosen one horn and set it as the other"
    turns = abs(manifest.members[places[0]].turns) * (-1 if inverted else 1)
    ends = sorted(mark.zero_ticks + turns * TICKS_PER_TURN / 360.0 * angle for angle in (lower, upper))
    if ends[0] < 0 or ends[1] > TICKS_PER_TURN - 1:
        need = f"{ends[0]:.0f}..{ends[1]:.0f} ticks"
        return (
            f"{where}: {lower:g}..{upper:g} deg would be {need}, beyond one turn; set its horn on anew, nearer to 2048"
        )
    rest = float(np.degrees(robot.skeleton.hinges[robot.skeleton.joint(mark.hinge)].rest))
    if not lower <= rest <= upper:
        goes = f"goes {lower:g}..{upper:g} deg"
        return f"{where}: {goes}, which does not hold its rest of {rest:g} deg; free it, or change [rest]"
    return ""


def calibration_text(found: Calibration, robot: Robot) -> str:
    """Writes the TOML of a calibration."""
    lines = [
        f"# Written by `kinesic servos calibrate`; laid over {robot.path.name} by the names of hinges.",
        f"robot = {json.dumps(found.robot)}",
        "",
        "[zero_ticks]  # where the servo stands when the hinge's angle is 0",
        *(f"{json.dumps(hinge)} = {ticks}" for hinge, ticks in found.zero_ticks.items()),
        "",
        "[inverted]  # whether the servo turns against the hinge",
        *(f"{json.dumps(hinge)} = {json.dumps(inverted)}" for hinge, inverted in found.inverted.items()),
    ]
    if found.range_deg:
        lines += ["", "[range_deg]  # where the hinge ends short of the robot's file"]
        lines += [f"{json.dumps(hinge)} = [{least:g}, {most:g}]" for hinge, (least, most) in found.range_deg.items()]
    return "\n".join(lines) + "\n"


def positive_way(robot: Robot, joint: int) -> str:
    """Says what moves, and where to, when a hinge of the zero posture turns the positive way."""
    skeleton = robot.skeleton
    hinge = skeleton.hinges[joint]
    straight = skeleton.straight
    segment = skeleton.segment(hinge.segment)
    axis = straight.rotations[segment] @ hinge.axis
    lever = _tip(robot, hinge.segment) - straight.origins[segment]
    moved = np.cross(axis, lever)
    if np.linalg.norm(moved) > CLEAR * np.linalg.norm(lever):
        return f"{hinge.segment} goes {_word(moved)}"
    if abs(axis @ FRONT) > CLEAR:
        return f"the top of {hinge.segment} turns {_word(np.cross(axis, TOP))}"
    return f"the front of {hinge.segment} turns {_word(np.cross(axis, FRONT))}"


def _tip(robot: Robot, name: str) -> Floats:
    """(3,) [m] the middle of a segment's own capsules, in the world."""
    skeleton, frames = robot.skeleton, robot.skeleton.straight
    k = skeleton.segment(name)
    ends = [end for capsule in skeleton.segments[k].capsules for end in (capsule.start, capsule.end)]
    middle = np.mean(ends, axis=0) if ends else np.zeros(3)
    return np.asarray(frames.origins[k] + frames.rotations[k] @ middle)


def _word(direction: Floats) -> str:
    k = int(np.abs(direction).argmax())
    return WORDS[k][int(direction[k] < 0)]
