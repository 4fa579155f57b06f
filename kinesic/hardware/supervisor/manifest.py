"""Expected servos of a robot with their models, hinges, limits and registers."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import ceil, degrees, isnan, radians

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.muscle import MUSCLE_NAME as MUSCLE
from kinesic.body.robot import Robot
from kinesic.body.servo import TICKS_PER_TURN, Drive
from kinesic.hardware.bus.bounds import TickRange
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.device import REPLY_TO_ALL
from kinesic.hardware.protocol.models import Model, control_table_of
from kinesic.hardware.protocol.registers import TICK_ANGLE, VELOCITY_UNIT, Mode, Register
from kinesic.hardware.protocol.servo_map import HingeServos, ServoMap
from kinesic.hardware.protocol.tables import FamilyTable
from kinesic.hardware.protocol.ticks import Scale

GOAL_MARGIN = 40  # [ticks] distance by which goals may exceed a hinge's range, as joints may hang slightly outside
NO_ALIAS = 255  # SECONDARY_ID of a servo without a second id
FACTORY_REGISTERS = (Register.MOVING_THRESHOLD, Register.PWM_SLOPE)  # Registers that keep their factory value
REST_TOLERANCE = radians(5.0)  # [rad] largest distance from the rest posture at which torque may be switched off
SHUTDOWN_MASK = 52  # SHUTDOWN value: electrical shock, overload, overheating; not voltage, which drops in fast motion


@dataclass(frozen=True)
class Member:
    """One servo of a robot: its bus, its hinge and its range."""

    bus: str
    servo: Servo
    hinge: str
    joint: int  # index of the hinge in joint order
    zero: int  # [ticks] position at hinge angle 0
    turns: float  # signed servo revolutions per hinge revolution
    lower: int  # [ticks] lower end of the hinge's range
    upper: int  # [ticks] upper end of the hinge's range
    speed: float  # [rad/s] no-load velocity of the servo
    gains: tuple[int, int]  # position P and D gains
    full: float  # [ticks] position error at full power

    @property
    def id(self) -> int:
        """Id of the servo on its bus."""
        return self.servo.id

    @property
    def model(self) -> Model:
        """Model of the servo."""
        return self.servo.model

    @property
    def span(self) -> tuple[int, int]:
        """Range of the servo's goals [ticks]: the hinge's range plus a margin."""
        return goal_range(self.lower, self.upper)

    @property
    def eeprom_values(self) -> Mapping[Register, int]:
        """Required EEPROM values that do not depend on present register values."""
        return self._storable(
            {
                Register.RETURN_DELAY_TIME: 0,
                Register.DRIVE_MODE: 0,
                Register.OPERATING_MODE: Mode.POSITION.value,
                Register.SECONDARY_ID: NO_ALIAS,
                Register.HOMING_OFFSET: 0,
                Register.SHUTDOWN: SHUTDOWN_MASK,
                **{r: self.model.factory_value(r) for r in FACTORY_REGISTERS},
                **({Register.STATUS_RETURN_LEVEL: REPLY_TO_ALL} if self.model.table is not None else {}),
            }
        )

    @property
    def ram_values(self) -> Mapping[Register, int]:
        """Required RAM values while torque is on.

        A reboot resets all of them, a tripped watchdog the profile.
        """
        pace = min(ceil(self.speed / VELOCITY_UNIT), self.model.factory_value(Register.VELOCITY_LIMIT))
        return self._storable(
            {
                Register.POSITION_P_GAIN: self.gains[0],
                Register.POSITION_D_GAIN: self.gains[1],
                Register.POSITION_I_GAIN: 0,
                Register.FEEDFORWARD_1ST_GAIN: 0,
                Register.FEEDFORWARD_2ND_GAIN: 0,
                Register.PROFILE_ACCELERATION: 0,  # an acceleration limit would brake at every goal of a stream
                Register.PROFILE_VELOCITY: pace,
            }
        )

    def _storable(self, values: Mapping[Register, int]) -> dict[Register, int]:
        """Return the values that the model's registers can hold, without missing registers."""
        model = self.model
        return {register: model.quantise(register, value) for register, value in values.items() if model.has(register)}


@dataclass(frozen=True, eq=False)
class Manifest:
    """All servos of a robot, bus by bus.

    It also holds the data of the robot's hinges.
    """

    robot: str
    bauds: Mapping[str, int]  # [bit/s] baud rate by bus name
    members: tuple[Member, ...]
    rest: Floats  # (n,) [rad] rest posture in joint order
    lower: Floats  # (n,) [rad] lower limit of each joint
    upper: Floats  # (n,) [rad] upper limit of each joint
    chains: tuple[frozenset[int], ...]  # indices of joints that all hold if a servo of one joint fails

    @classmethod
    def of(cls, robot: Robot) -> "Manifest":
        """Make the manifest of a robot from its servo buses.

        Raises:
            ConfigError: the robot has no [[bus]], its tables are invalid, or a servo model is unknown.
        """
        wiring = ServoMap.of(robot)
        if all(drive.servo.name == MUSCLE for drive in robot.drives):
            raise ConfigError(f"{robot.name} has no servos, as it exists only in simulation; leave servos out of --on")
        if not wiring.buses:
            raise ConfigError(f"{robot.path}: no [[bus]], so no servo can be reached; see docs/how-to/build-a-robot.md")
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
    def tables(self) -> Mapping[str, FamilyTable | None]:
        """Control table of the servo family on each bus.

        It is None for the X series with Protocol 2.0.
        """
        return {member.bus: member.model.table for member in self.members}

    @cached_property
    def unwatched(self) -> tuple[str, ...]:
        """Names of the buses whose servos have no bus watchdog."""
        lacking = {member.bus for member in self.members if not member.model.has(Register.BUS_WATCHDOG)}
        return tuple(name for name in self.bauds if name in lacking)

    @cached_property
    def joints(self) -> NDArray[np.intp]:
        """Joint index (m,) of each servo."""
        return np.array([member.joint for member in self.members], dtype=np.intp)

    @cached_property
    def scale(self) -> Scale:
        """Conversion between the servos' ticks and joint angles."""
        return Scale(
            zeros=sealed([member.zero for member in self.members]),
            turns=sealed([member.turns for member in self.members]),
        )

    @cached_property
    def spans(self) -> tuple[Floats, Floats]:
        """Smallest and largest goal [ticks] of each servo, each (m,)."""
        lower, upper = zip(*(member.span for member in self.members), strict=True)
        return sealed(lower), sealed(upper)

    @cached_property
    def velocities(self) -> Floats:
        """Largest velocities (m,) [ticks/s] of the goals."""
        return sealed([member.speed / TICK_ANGLE for member in self.members])

    @cached_property
    def full(self) -> Floats:
        """Position error (m,) [ticks] that causes full motor power, by servo."""
        return sealed([member.full for member in self.members])

    def angles(self, ticks: Floats, *, whole: bool = False) -> Floats:
        """Convert ticks (m,) to joint angles (n,) [rad].

        Servos of a tandem are averaged; joints without a known position are NaN.
        """
        return self.means(self.scale.angles(ticks), whole=whole)

    def means(self, values: Floats, *, whole: bool = False) -> Floats:
        """Average servo values (m,) over the servos of each joint (n,).

        Joints without a known value are NaN.

        Args:
            values: NaN: unknown.
            whole: whether all values are known, which saves the check.
        """
        if whole:
            return self._shares @ values
        is_finite = np.isfinite(values)
        count = len(self.rest)
        sums = np.bincount(self.joints[is_finite], weights=values[is_finite], minlength=count)
        numbers = np.bincount(self.joints[is_finite], minlength=count)
        return np.where(numbers > 0, sums / np.maximum(numbers, 1), np.nan)

    @cached_property
    def _shares(self) -> Floats:
        """Averaging weights (n, m) of `means`.

        NaN for a joint without a servo.
        """
        mine = (self.joints == np.arange(len(self.rest))[:, None]).astype(np.float64)
        number = mine.sum(axis=1, keepdims=True)
        return np.where(number > 0, mine / np.maximum(number, 1), np.nan)


def describe_raised_joints(manifest: Manifest, angles: Floats) -> tuple[str, ...]:
    """Name the joints away from the rest posture, with their angles.

    Joints of unknown angle are named as silent.

    Args:
        manifest: the servos.
        angles: (n,) [rad]; NaN: unknown.
    """
    lines: list[str] = []
    for joint in sorted({member.joint for member in manifest.members}):
        name = next(member.hinge for member in manifest.members if member.joint == joint)
        rest, angle = degrees(manifest.rest[joint]), degrees(angles[joint])
        if isnan(angle):
            lines.append(f"{name} (silent)")
        elif abs(angle - rest) > degrees(REST_TOLERANCE):
            lines.append(f"{name} at {angle:.0f} deg (rest: {rest:.0f})")
    return tuple(lines)


def goal_range(lower: int, upper: int) -> TickRange:
    """Return a hinge's range [ticks] widened by `GOAL_MARGIN`, within one turn."""
    return max(0, lower - GOAL_MARGIN), min(TICKS_PER_TURN - 1, upper + GOAL_MARGIN)


def _members(robot: Robot, servos: HingeServos, joint: int) -> list[Member]:
    drive: Drive = robot.drives[joint]
    model = control_table_of(drive.servo, f"{robot.path}: {servos.hinge}")
    hinge = robot.skeleton.hinges[joint]
    turns = -servos.reduction if servos.inverted else servos.reduction
    scale = Scale(sealed([servos.zero_ticks]), sealed([turns]))
    ends = sorted(int(tick) for tick in scale.ticks(np.array([[hinge.lower], [hinge.upper]])).ravel())
    return [
        Member(
            bus=servos.bus,
            servo=Servo(servo, model, goal_range(ends[0], ends[1])),
            hinge=servos.hinge,
            joint=joint,
            zero=servos.zero_ticks,
            turns=turns,
            lower=ends[0],
            upper=ends[1],
            speed=drive.no_load * drive.reduction,
            gains=(round(drive.servo.p_gain), round(drive.servo.d_gain)),
            full=drive.reduction / (drive.gain * TICK_ANGLE),
        )
        for servo in servos.ids
    ]
