"""Set point of a virtual servo: profile, motor command and sensor registers."""

import struct
from dataclasses import dataclass
from functools import cached_property
from math import copysign, inf, sqrt
from typing import Literal, NamedTuple

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.registers import PROFILE_ACCELERATION_UNIT, TICK_ANGLE, VELOCITY_UNIT, Mode, Register
from kinesic.hardware.virtual.control_table import REVERSE_BIT, TIME_PROFILE_BIT, Memory
from kinesic.hardware.virtual.physics import NO_TORQUE, Demand, Shaft

Form = Literal["step", "rectangle", "triangle", "trapezoid"]
MAX_HOMING_OFFSET = 1024  # [ticks] largest homing offset that position mode applies
IN_POSITION_TOLERANCE = 10  # [ticks] threshold of the in-position bit; the manual gives no value
FOLLOWING_ERROR_LIMIT = 100  # [ticks] threshold of the following-error bit; the manual gives no value
STALL_LOAD = 1000  # [0.1 %] value of PRESENT_CURRENT at stall, if the servo has no current sensor

# Operating modes with a goal position
POSITION_MODES = frozenset({Mode.POSITION.value, Mode.EXTENDED_POSITION.value, Mode.CURRENT_POSITION.value})
_FORM_BITS = {"step": 0x00, "rectangle": 0x10, "triangle": 0x20, "trapezoid": 0x30}  # MOVING_STATUS bits by form
_SENSOR_FORMAT = struct.Struct("<BBhhiiii")  # Consecutive registers MOVING to POSITION_TRAJECTORY
_SENSOR_ADDRESS = Register.MOVING.field.address  # address of _SENSOR_FORMAT


@dataclass(frozen=True)
class Profile:
    """Three-phase motion of the set point to the goal.

    Each phase has constant acceleration.
    """

    start: float  # [rad] set point at the start
    goal: float  # [rad] set point at the end
    speed: float  # [rad/s] velocity at the start
    cruise: float  # [rad/s] signed velocity of the middle phase
    spans: tuple[float, float, float]  # [s] durations of acceleration, cruise and deceleration
    form: Form

    @cached_property
    def duration(self) -> float:
        """Duration [s]."""
        return sum(self.spans)

    def at(self, time: float) -> tuple[float, float]:
        """Return set point [rad] and velocity [rad/s] at a time [s].

        Time counts from the start of the profile.
        """
        if time >= self.duration:
            return self.goal, 0.0
        rise, flat, fall = self.spans
        if time < rise:
            return self._eased(self.start, self.speed, self.cruise, rise, time)
        place = self.start + (self.speed + self.cruise) / 2 * rise
        if time < rise + flat:
            return place + self.cruise * (time - rise), self.cruise
        return self._eased(place + self.cruise * flat, self.cruise, 0.0, fall, time - rise - flat)

    @staticmethod
    def _eased(place: float, before: float, after: float, span: float, time: float) -> tuple[float, float]:
        """Return position [rad] and velocity [rad/s] during constant acceleration."""
        speed = before + (after - before) * time / span
        return place + (before + speed) / 2 * time, speed


def still_profile(place: float) -> Profile:
    """Make a profile without motion."""
    return Profile(place, place, 0.0, 0.0, (0.0, 0.0, 0.0), "step")


def velocity_profile(start: float, speed: float, goal: float, *, limit: float, acceleration: float) -> Profile:
    """Make a velocity-based profile from a set point to a goal.

    Args:
        start: [rad] set point.
        speed: [rad/s] velocity of the set point.
        goal: [rad].
        limit: [rad/s] velocity limit; infinite: a step.
        acceleration: [rad/s^2] limit; infinite: a rectangle.
    """
    if limit == inf or (start == goal and speed == 0.0):
        return Profile(start, goal, 0.0, 0.0, (0.0, 0.0, 0.0), "step")
    if acceleration == inf:
        cruise = copysign(limit, goal - start)
        return Profile(start, goal, cruise, cruise, (0.0, abs(goal - start) / limit, 0.0), "rectangle")
    stops = start + speed * abs(speed) / (2 * acceleration)  # end position of immediate braking
    direction = copysign(1.0, goal - stops)
    along = speed * direction
    peak = sqrt(max(acceleration * (goal - start) * direction + along**2 / 2, 0.0))
    cruise = min(limit, peak)
    rise, fall = abs(cruise - along) / acceleration, cruise / acceleration
    left = (goal - start) * direction - (along + cruise) / 2 * rise - cruise / 2 * fall
    flat = max(left, 0.0) / cruise if cruise > 0.0 else 0.0
    form: Form = "trapezoid" if peak >= limit else "triangle"
    return Profile(start, goal, speed, direction * cruise, (rise, flat, fall), form)


def time_profile(start: float, goal: float, *, duration: float, rise: float) -> Profile:
    """Make a time-based profile from a set point to a goal.

    Args:
        start: [rad] set point.
        goal: [rad].
        duration: [s]; zero: a step.
        rise: [s] acceleration time, at most half the duration; zero: a rectangle.
    """
    if duration <= 0.0:
        return Profile(start, goal, 0.0, 0.0, (0.0, 0.0, 0.0), "step")
    rise = min(rise, duration / 2)
    cruise = (goal - start) / (duration - rise)
    if rise <= 0.0:
        return Profile(start, goal, cruise, cruise, (0.0, duration, 0.0), "rectangle")
    form: Form = "triangle" if rise >= duration / 2 else "trapezoid"
    return Profile(start, goal, 0.0, cruise, (rise, duration - 2 * rise, rise), form)


class Tuning(NamedTuple):
    """Settings of the set point that a servo reads from its EEPROM."""

    mode: int  # value of the register OPERATING_MODE
    sign: int  # -1 with reversed rotation
    offset: int  # [ticks] effective homing offset
    pwm_limit: int  # [counts of PWM] largest duty
    moving_threshold: int  # [velocity counts] velocity from which the servo reports motion
    has_time_profile: bool


def read_tuning(memory: Memory) -> Tuning:
    """Read the set point's settings from the EEPROM."""
    mode, drive, homing = (
        memory[register] for register in (Register.OPERATING_MODE, Register.DRIVE_MODE, Register.HOMING_OFFSET)
    )
    return Tuning(
        mode=mode,
        sign=-1 if drive & REVERSE_BIT else 1,
        offset=homing if mode != Mode.POSITION.value or abs(homing) <= _largest_offset(memory) else 0,
        pwm_limit=memory[Register.PWM_LIMIT],
        moving_threshold=memory[Register.MOVING_THRESHOLD],
        has_time_profile=bool(drive & TIME_PROFILE_BIT),
    )


def _largest_offset(memory: Memory) -> int:
    """Return the largest homing offset [ticks] applied in position mode."""
    return MAX_HOMING_OFFSET if memory.model.table is None else TICKS_PER_TURN // 2


class SetPoint:
    """Generator of a servo's set point and motor commands from its registers."""

    def __init__(self, memory: Memory, shaft: Shaft) -> None:
        """Start at rest at the shaft's position, within the first turn."""
        self._memory = memory
        self._turns = 0  # whole turns not counted in the register
        self._profile, self._since = still_profile(shaft.angle), 0.0  # profile [rad] of the shaft, and its start [s]
        self._ramp = 0.0  # [rad/s] set point of velocity mode at `_since`
        self._tuning, self._tuning_version = read_tuning(memory), memory.eeprom_version
        self._full_pwm = memory.model.allowed_range(Register.GOAL_PWM)[1]
        self.stopped = False  # whether the bus watchdog has stopped the servo until the next goal

    def ticks(self, angle: float) -> float:
        """Convert a shaft angle [rad] to a PRESENT_POSITION value without rounding."""
        tuning = self.tuning
        return tuning.sign * angle / TICK_ANGLE + tuning.offset - TICKS_PER_TURN * self._turns

    def angle(self, ticks: float) -> float:
        """Convert a position register to a shaft angle [rad]."""
        tuning = self.tuning
        return tuning.sign * (ticks - tuning.offset + TICKS_PER_TURN * self._turns) * TICK_ANGLE

    def fold(self, shaft: Shaft) -> None:
        """Reset the turn count, so that the position is in 0..4095."""
        self._turns += round(self.ticks(shaft.angle)) // TICKS_PER_TURN

    def rest(self, shaft: Shaft, time: float) -> None:
        """Set the set point to the shaft's position, at rest."""
        self._profile, self._since, self._ramp = still_profile(shaft.angle), time, 0.0

    def stop(self, shaft: Shaft, time: float) -> None:
        """Stop at the shaft's position until the next goal."""
        self.rest(shaft, time)
        self.stopped = True

    def aim(self, time: float) -> None:
        """Plan the motion profile to the goal in the registers."""
        memory, self.stopped = self._memory, False
        if self.tuning.mode == Mode.VELOCITY.value:
            self._ramp, self._since = self._velocity(time), time
            return
        place, speed = self._profile.at(time - self._since)
        goal = self.angle(memory[Register.GOAL_POSITION])
        velocity, rise = memory[Register.PROFILE_VELOCITY], memory[Register.PROFILE_ACCELERATION]
        if self.tuning.has_time_profile:
            self._profile = time_profile(place, goal, duration=velocity / 1000, rise=rise / 1000)
        else:
            limit, acceleration = velocity * VELOCITY_UNIT or inf, rise * PROFILE_ACCELERATION_UNIT or inf
            self._profile = velocity_profile(place, speed, goal, limit=limit, acceleration=acceleration)
        self._since = time

    def demand(self, time: float) -> Demand:
        """Return the motor command in the current operating mode."""
        memory = self._memory
        if not memory[Register.TORQUE_ENABLE]:
            return NO_TORQUE
        tuning, pwm, full = self.tuning, memory[Register.GOAL_PWM], self._full_pwm
        mode, cap = tuning.mode, min(abs(pwm), tuning.pwm_limit) / full
        if mode in POSITION_MODES or self.stopped:
            if mode == Mode.CURRENT_POSITION.value:
                cap = min(cap, self._current_ratio(abs(memory[Register.GOAL_CURRENT])))
            return Demand("angle", self._profile.at(time - self._since)[0], cap)
        if mode == Mode.VELOCITY.value:
            return Demand("speed", tuning.sign * self._velocity(time), cap)
        if mode == Mode.CURRENT.value:
            return Demand("current", tuning.sign * self._current_ratio(memory[Register.GOAL_CURRENT]), cap)
        return Demand("duty", tuning.sign * pwm / full)

    def settled(self, time: float) -> bool:
        """Return whether the motor command is constant until a register changes."""
        return self.tuning.mode != Mode.VELOCITY.value and time - self._since >= self._profile.duration

    def show(self, shaft: Shaft, time: float) -> None:
        """Write shaft state and profile at a time [s] to sensor registers.

        These are the registers MOVING to POSITION_TRAJECTORY.
        """
        memory, tuning = self._memory, self.tuning
        sign, offset = tuning.sign, tuning.offset
        turns = TICKS_PER_TURN * self._turns
        place, velocity = self._profile.at(time - self._since)
        ongoing = time - self._since < self._profile.duration
        present, way = (round(sign * angle / TICK_ANGLE + offset - turns) for angle in (shaft.angle, place))
        speed = round(sign * shaft.speed / VELOCITY_UNIT)
        status = _FORM_BITS[self._profile.form] if ongoing else 0
        if tuning.mode in POSITION_MODES:
            status |= (abs(memory[Register.GOAL_POSITION] - present) <= IN_POSITION_TOLERANCE) | ongoing << 1
            status |= (abs(way - present) > FOLLOWING_ERROR_LIMIT) << 3
        current = round(sign * shaft.load * self._full)
        packed = _SENSOR_FORMAT.pack(
            ongoing or abs(speed) > tuning.moving_threshold,
            status,
            round(sign * shaft.duty * self._full_pwm),
            current,
            speed,
            present,
            round(sign * velocity / VELOCITY_UNIT),
            way,
        )
        memory.put(_SENSOR_ADDRESS, packed)

    @property
    def tuning(self) -> Tuning:
        """Operating mode, rotation direction and limits from the EEPROM."""
        version = self._memory.eeprom_version
        if version != self._tuning_version:
            self._tuning, self._tuning_version = read_tuning(self._memory), version
        return self._tuning

    @cached_property
    def _full(self) -> int:
        """Value of the current register at stall [counts]."""
        model = self._memory.model
        return STALL_LOAD if model.amperes is None else model.factory_value(Register.GOAL_CURRENT)

    def _current_ratio(self, current: int) -> float:
        return current / self._full

    def _velocity(self, time: float) -> float:
        """Return the set point [rad/s] of velocity mode, in register direction."""
        goal = self._memory[Register.GOAL_VELOCITY] * VELOCITY_UNIT
        rise = self._memory[Register.PROFILE_ACCELERATION] * PROFILE_ACCELERATION_UNIT or inf
        gained = rise * (time - self._since) if time > self._since else 0.0
        if rise == inf or gained >= abs(goal - self._ramp):
            return goal
        return self._ramp + copysign(gained, goal - self._ramp)
