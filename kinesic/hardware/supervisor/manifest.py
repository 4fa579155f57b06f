"""Lists what must hang on the wires of a robot: every servo with its model, hinge, limits and registers."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import ceil, degrees, isnan, radians

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.muscle import NAME as MUSCLE
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN, Drive
from kinesic.hardware.bus.bounds import Span
from kinesic.hardware.bus.bus import Servo
from kinesic.hardware.protocol.models import BY_NUMBER, Model
from kinesic.hardware.protocol.registers import SPEED, TICK, Mode, Register
from kinesic.hardware.protocol.servo_map import HingeServos, ServoMap
from kinesic.hardware.protocol.ticks import Scale

MARGIN = 40  # [ticks] beyond a hinge's range that its servo still takes, as joints hang a little outside at times
NO_ALIAS = 255  # SECONDARY_ID of a servo that obeys its own id alone
AS_MADE = (Register.MOVING_THRESHOLD, Register.PWM_SLOPE)
REST = radians(5.0)  # from rest, within which a limb may go limp
SHUTDOWN = 52  # electrical shock, overload, overheating; not voltage, which a brisk move may pull down


@dataclass(frozen=True)
class Member:
    """One servo of a robot: where it hangs, what it turns, and how far."""

    bus: str
    servo: Servo
    hinge: str
    joint: int
    zero: int  # [ticks] where the hinge's angle is 0
    turns: float  # signed servo turns per hinge turn
    lower: int  # [ticks] of the hinge's range
    upper: int
    speed: float  # [rad/s] of the servo without load
    gains: tuple[int, int]  # position P and D
    full: float  # [ticks] of error at which it gives full power

    @property
    def id(self) -> int:
        """Its id on its bus."""
        return self.servo.id

    @property
    def model(self) -> Model:
        """Model of the servo."""
        return self.servo.model

    @property
    def span(self) -> tuple[int, int]:
        """[ticks] that its goals may have: the hinge's range and a margin."""
        return goal_span(self.lower, self.upper)

    @property
    def lasting(self) -> Mapping[Register, int]:
        """Values that its EEPROM must hold; its position limits depend on the present ones."""
        return {
            Register.RETURN_DELAY_TIME: 0,
            Register.DRIVE_MODE: 0,
            Register.OPERATING_MODE: Mode.POSITION.value,
            Register.SECONDARY_ID: NO_ALIAS,
            Register.HOMING_OFFSET: 0,
            Register.SHUTDOWN: SHUTDOWN,
            **{r: self.model.starts(r) for r in AS_MADE if self.model.has(r)},
        }

    @property
    def passing(self) -> Mapping[Register, int]:
        """Values that its RAM must hold while it has torque; a reboot resets all, a watchdog the profile."""
        pace = min(ceil(self.speed / SPEED), self.model.starts(Register.VELOCITY_LIMIT))
        return {
            Register.POSITION_P_GAIN: self.gains[0],
            Register.POSITION_D_GAIN: self.gains[1],
            Register.POSITION_I_GAIN: 0,
            Register.FEEDFORWARD_1ST_GAIN: 0,
            Register.FEEDFORWARD_2ND_GAIN: 0,
            Register.PROFILE_ACCELERATION: 0,  # an acceleration would brake at every goal of a stream
            Register.PROFILE_VELOCITY: pace,
        }


@dataclass(frozen=True, eq=False)
class Manifest:
    """All servos of a robot, bus by bus, and what the host must know of its hinges."""

    robot: str
    bauds: Mapping[str, int]  # [bit/s] by bus
    members: tuple[Member, ...]
    rest: Floats  # (n,) [rad] in joint order
    lower: Floats  # (n,) [rad]
    upper: Floats  # (n,) [rad]
    chains: tuple[frozenset[int], ...]  # joints that hold together when one of them fails

    @classmethod
    def of(cls, robot: Robot) -> "Manifest":
        """Makes the manifest of a robot with servos on wires.

        Raises:
            ConfigError: the robot has no [[bus]], its tables are wrong, or a servo is none that the bus knows.
        """
        wiring = ServoMap.of(robot)
        if all(drive.servo.name == MUSCLE for drive in robot.drives):
            raise ConfigError(f"{robot.name} has no servos: it is drawn, not built; leave servos out of --on")
        if not wiring.buses:
            raise ConfigError(f"{robot.path}: no [[bus]], so that no servo can be reached; see docs/my-robot.md")
        placed = [(servos, robot.skeleton.joint(servos.hinge)) for servos in wiring.servos]
        members = [
            member
            for bus in wiring.buses
            for servos, joint in placed
            if servos.bus == bus.name
            for member in _members(robot, servos, joint)
        ]
        joined = frozenset().union(*(robot.joints(chain) for chain in robot.chains))
        loose = [frozenset({joint}) for joint in range(len(robot.drives)) if joint not in joined]
        return cls(
            robot=robot.name,
            bauds={bus.name: bus.baud for bus in wiring.buses},
            members=tuple(members),
            rest=robot.skeleton.rest,
            lower=robot.skeleton.lower,
            upper=robot.skeleton.upper,
            chains=(*(frozenset(robot.joints(chain)) for chain in robot.chains), *loose),
        )

    @cached_property
    def joints(self) -> NDArray[np.intp]:
        """(m,) the joint that each member turns."""
        return np.array([member.joint for member in self.members], dtype=np.intp)

    @cached_property
    def scale(self) -> Scale:
        """Ticks of members against angles of their joints."""
        return Scale(
            zeros=sealed([member.zero for member in self.members]),
            turns=sealed([member.turns for member in self.members]),
        )

    @cached_property
    def spans(self) -> tuple[Floats, Floats]:
        """(m,) least and (m,) largest goal [ticks]."""
        lower, upper = zip(*(member.span for member in self.members), strict=True)
        return sealed(lower), sealed(upper)

    @cached_property
    def speeds(self) -> Floats:
        """(m,) [ticks/s] that goals may move at most."""
        return sealed([member.speed / TICK for member in self.members])

    @cached_property
    def full(self) -> Floats:
        """(m,) [ticks] of error at which each servo gives full power."""
        return sealed([member.full for member in self.members])

    def angles(self, ticks: Floats, *, whole: bool = False) -> Floats:
        """Converts (m,) ticks to (n,) [rad]; tandems are averaged, and joints of which nothing is known are NaN."""
        return self.means(self.scale.angles(ticks), whole=whole)

    def means(self, values: Floats, *, whole: bool = False) -> Floats:
        """Averages (m,) values over the servos of each joint (n,); NaN where nothing is known.

        Args:
            values: NaN where nothing is known.
            whole: whether all are known, which saves looking.
        """
        if whole:
            return self._shares @ values
        known = np.isfinite(values)
        count = len(self.rest)
        sums = np.bincount(self.joints[known], weights=values[known], minlength=count)
        numbers = np.bincount(self.joints[known], minlength=count)
        return np.where(numbers > 0, sums / np.maximum(numbers, 1), np.nan)

    @cached_property
    def _shares(self) -> Floats:
        """(n, m) by which `means` weighs the servos of each joint; NaN for a joint without one."""
        mine = (self.joints == np.arange(len(self.rest))[:, None]).astype(np.float64)
        number = mine.sum(axis=1, keepdims=True)
        return np.where(number > 0, mine / np.maximum(number, 1), np.nan)


def raised_joints(manifest: Manifest, angles: Floats) -> tuple[str, ...]:
    """Names the joints that are not near rest, each with its angle; of one that is not known, it says so.

    Args:
        manifest: of the servos.
        angles: (n,) [rad]; NaN where nobody knows.
    """
    lines: list[str] = []
    for joint in sorted({member.joint for member in manifest.members}):
        name = next(member.hinge for member in manifest.members if member.joint == joint)
        rest, angle = degrees(manifest.rest[joint]), degrees(angles[joint])
        if isnan(angle):
            lines.append(f"{name} (silent)")
        elif abs(angle - rest) > degrees(REST):
            lines.append(f"{name} at {angle:.0f} deg (rest: {rest:.0f})")
    return tuple(lines)


def goal_span(lower: int, upper: int) -> Span:
    """Returns the least and the largest goal [ticks] of a hinge's range: with a margin, within one turn."""
    return max(0, lower - MARGIN), min(TICKS_PER_TURN - 1, upper + MARGIN)


def _members(robot: Robot, servos: HingeServos, joint: int) -> list[Member]:
    drive: Drive = robot.drives[joint]
    model = BY_NUMBER.get(drive.servo.model)
    if model is None:
        where = f"{robot.path}: {servos.hinge}: servo {drive.servo.name}"
        known = ", ".join(sorted(known.name for known in BY_NUMBER.values()))
        raise ConfigError(f"{where} has model number {drive.servo.model}, must be one of the X series: {known}")
    hinge = robot.skeleton.hinges[joint]
    turns = -servos.reduction if servos.inverted else servos.reduction
    scale = Scale(sealed([servos.zero_ticks]), sealed([turns]))
    ends = sorted(int(tick) for tick in scale.ticks(np.array([[hinge.lower], [hinge.upper]])).ravel())
    return [
        Member(
            bus=servos.bus,
            servo=Servo(servo, model, goal_span(ends[0], ends[1])),
            hinge=servos.hinge,
            joint=joint,
            zero=servos.zero_ticks,
            turns=turns,
            lower=ends[0],
            upper=ends[1],
            speed=drive.no_load * drive.reduction,
            gains=(round(drive.servo.p_gain), round(drive.servo.d_gain)),
            full=drive.reduction / (drive.gain * TICK),
        )
        for servo in servos.ids
    ]
