"""The set point of a virtual servo: how it travels to a goal, what it asks of the motor, and what registers show."""

import struct
from dataclasses import dataclass
from functools import cached_property
from math import copysign, inf, sqrt
from typing import Literal

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.registers import PROFILE_ACCELERATION, SPEED, TICK, Mode, Register
from kinesic.hardware.virtual.control_table import BY_TIME, REVERSE, Memory
from kinesic.hardware.virtual.physics import LIMP, Demand, Shaft

Form = Literal["step", "rectangle", "triangle", "trapezoid"]
WIDEST_OFFSET = 1024  # [ticks] of homing that position mode heeds
ARRIVED = 10  # [ticks] within which a servo calls itself in position; the manual gives no figure
LOST = 100  # [ticks] behind its set point beyond which it calls itself not following; the manual gives no figure
LOAD_FULL = 1000  # PRESENT_CURRENT of a servo without current sensor at stall

ANGLE_MODES = frozenset({Mode.POSITION.value, Mode.EXTENDED_POSITION.value, Mode.CURRENT_POSITION.value})
_FORMS = {"step": 0x00, "rectangle": 0x10, "triangle": 0x20, "trapezoid": 0x30}
_PRESENT = struct.Struct("<BBhhiiii")  # MOVING .. POSITION_TRAJECTORY stand side by side
_PRESENT_AT = Register.MOVING.field.address


@dataclass(frozen=True)
class Profile:
    """Three stretches of constant acceleration from where the set point was to the goal, where it rests."""

    start: float  # [rad]
    goal: float  # [rad]
    speed: float  # [rad/s] at the start
    cruise: float  # [rad/s] signed, of the middle stretch
    spans: tuple[float, float, float]  # [s] of speeding up, cruising, braking
    form: Form

    @property
    def duration(self) -> float:
        """[s]."""
        return sum(self.spans)

    def at(self, time: float) -> tuple[float, float]:
        """Returns set point [rad] and its speed [rad/s] at a time [s] from the start."""
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
        """While the speed changes evenly from one value to another."""
        speed = before + (after - before) * time / span
        return place + (before + speed) / 2 * time, speed


def still_profile(place: float) -> Profile:
    """Makes a profile without motion."""
    return Profile(place, place, 0.0, 0.0, (0.0, 0.0, 0.0), "step")


def by_speed(start: float, speed: float, goal: float, *, limit: float, acceleration: float) -> Profile:
    """Makes the velocity-based profile.

    Args:
        start: set point [rad].
        speed: of the set point [rad/s].
        goal: [rad].
        limit: largest speed [rad/s]; infinite: a step.
        acceleration: largest [rad/s^2]; infinite: a rectangle.
    """
    if limit == inf or (start == goal and speed == 0.0):
        return Profile(start, goal, 0.0, 0.0, (0.0, 0.0, 0.0), "step")
    if acceleration == inf:
        cruise = copysign(limit, goal - start)
        return Profile(start, goal, cruise, cruise, (0.0, abs(goal - start) / limit, 0.0), "rectangle")
    stops = start + speed * abs(speed) / (2 * acceleration)  # where braking at once would end
    way = copysign(1.0, goal - stops)
    along = speed * way
    peak = sqrt(max(acceleration * (goal - start) * way + along**2 / 2, 0.0))
    cruise = min(limit, peak)
    rise, fall = abs(cruise - along) / acceleration, cruise / acceleration
    left = (goal - start) * way - (along + cruise) / 2 * rise - cruise / 2 * fall
    flat = max(left, 0.0) / cruise if cruise > 0.0 else 0.0
    form: Form = "trapezoid" if peak >= limit else "triangle"
    return Profile(start, goal, speed, way * cruise, (rise, flat, fall), form)


def by_time(start: float, goal: float, *, duration: float, rise: float) -> Profile:
    """Makes the time-based profile: how long it takes, and how long it speeds up, at most half of that.

    Args:
        start: set point [rad].
        goal: [rad].
        duration: [s]; zero: a step.
        rise: [s]; zero: a rectangle.
    """
    if duration <= 0.0:
        return Profile(start, goal, 0.0, 0.0, (0.0, 0.0, 0.0), "step")
    rise = min(rise, duration / 2)
    cruise = (goal - start) / (duration - rise)
    if rise <= 0.0:
        return Profile(start, goal, cruise, cruise, (0.0, duration, 0.0), "rectangle")
    form: Form = "triangle" if rise >= duration / 2 else "trapezoid"
    return Profile(start, goal, 0.0, cruise, (rise, duration - 2 * rise, rise), form)


class SetPoint:
    """The set point of one servo, between its registers and its shaft."""

    def __init__(self, memory: Memory, shaft: Shaft) -> None:
        """Stands still where the shaft is, which is within the first turn."""
        self._memory = memory
        self._turns = 0  # whole turns that the register leaves out
        self._profile, self._since = still_profile(shaft.angle), 0.0  # [rad] of the shaft, [s]
        self._ramp = 0.0  # [rad/s] where the speed of velocity mode stood at `_since`
        self.stopped = False  # by the bus watchdog, until a goal comes

    def ticks(self, angle: float) -> float:
        """Converts a shaft's angle [rad] to PRESENT_POSITION, not rounded."""
        return self._sign * angle / TICK + self._offset - TICKS_PER_TURN * self._turns

    def angle(self, ticks: float) -> float:
        """Converts a position register to the shaft's angle [rad]."""
        return self._sign * (ticks - self._offset + TICKS_PER_TURN * self._turns) * TICK

    def fold(self, shaft: Shaft) -> None:
        """Forgets whole turns, so that the position lies in 0..4095."""
        self._turns += round(self.ticks(shaft.angle)) // TICKS_PER_TURN

    def rest(self, shaft: Shaft, time: float) -> None:
        """Sets the set point to where the shaft is."""
        self._profile, self._since, self._ramp = still_profile(shaft.angle), time, 0.0

    def stop(self, shaft: Shaft, time: float) -> None:
        """Stops where the shaft is, whatever the goals say."""
        self.rest(shaft, time)
        self.stopped = True

    def aim(self, time: float) -> None:
        """Plans the way to the goal registers anew."""
        memory, self.stopped = self._memory, False
        if memory[Register.OPERATING_MODE] == Mode.VELOCITY.value:
            self._ramp, self._since = self._velocity(time), time
            return
        place, speed = self._profile.at(time - self._since)
        goal = self.angle(memory[Register.GOAL_POSITION])
        pace, rise = memory[Register.PROFILE_VELOCITY], memory[Register.PROFILE_ACCELERATION]
        if memory[Register.DRIVE_MODE] & BY_TIME:
            self._profile = by_time(place, goal, duration=pace / 1000, rise=rise / 1000)
        else:
            limit, acceleration = pace * SPEED or inf, rise * PROFILE_ACCELERATION or inf
            self._profile = by_speed(place, speed, goal, limit=limit, acceleration=acceleration)
        self._since = time

    def demand(self, time: float) -> Demand:
        """Returns what is demanded of the motor, by mode."""
        memory = self._memory
        if not memory[Register.TORQUE_ENABLE]:
            return LIMP
        mode, pwm = memory[Register.OPERATING_MODE], memory[Register.GOAL_PWM]
        full = memory.model.range(Register.GOAL_PWM)[1]
        cap = min(abs(pwm), memory[Register.PWM_LIMIT]) / full
        if mode in ANGLE_MODES or self.stopped:
            if mode == Mode.CURRENT_POSITION.value:
                cap = min(cap, self._share(abs(memory[Register.GOAL_CURRENT])))
            return Demand("angle", self._profile.at(time - self._since)[0], cap)
        if mode == Mode.VELOCITY.value:
            return Demand("speed", self._sign * self._velocity(time), cap)
        if mode == Mode.CURRENT.value:
            return Demand("current", self._sign * self._share(memory[Register.GOAL_CURRENT]), cap)
        return Demand("duty", self._sign * pwm / full)

    def settled(self, time: float) -> bool:
        """Returns whether the demand stays until a register changes."""
        return (
            self._memory[Register.OPERATING_MODE] != Mode.VELOCITY.value
            and time - self._since >= self._profile.duration
        )

    def show(self, shaft: Shaft, time: float) -> None:
        """Writes what the sensors feel into the registers."""
        memory, sign, offset = self._memory, self._sign, self._offset
        turns = TICKS_PER_TURN * self._turns
        place, pace = self._profile.at(time - self._since)
        ongoing = time - self._since < self._profile.duration
        here, way = (round(sign * angle / TICK + offset - turns) for angle in (shaft.angle, place))
        speed = round(sign * shaft.speed / SPEED)
        status = _FORMS[self._profile.form] if ongoing else 0
        if memory[Register.OPERATING_MODE] in ANGLE_MODES:
            status |= (abs(memory[Register.GOAL_POSITION] - here) <= ARRIVED) | ongoing << 1
            status |= (abs(way - here) > LOST) << 3
        current = round(sign * shaft.load * self._full)
        present = _PRESENT.pack(
            ongoing or abs(speed) > memory[Register.MOVING_THRESHOLD],
            status,
            round(sign * shaft.duty * memory.model.range(Register.GOAL_PWM)[1]),
            current,
            speed,
            here,
            round(sign * pace / SPEED),
            way,
        )
        memory.put(_PRESENT_AT, present)

    @property
    def _sign(self) -> int:
        return -1 if self._memory[Register.DRIVE_MODE] & REVERSE else 1

    @property
    def _offset(self) -> int:
        """Homing [ticks]; position mode ignores one that is too wide."""
        homing = self._memory[Register.HOMING_OFFSET]
        ignored = self._memory[Register.OPERATING_MODE] == Mode.POSITION.value and abs(homing) > WIDEST_OFFSET
        return 0 if ignored else homing

    @cached_property
    def _full(self) -> int:
        """Count of the current register at stall."""
        model = self._memory.model
        return LOAD_FULL if model.amperes is None else model.starts(Register.GOAL_CURRENT)

    def _share(self, current: int) -> float:
        return current / self._full

    def _velocity(self, time: float) -> float:
        """The set point [rad/s] of velocity mode, in the register's sense."""
        goal = self._memory[Register.GOAL_VELOCITY] * SPEED
        rise = self._memory[Register.PROFILE_ACCELERATION] * PROFILE_ACCELERATION or inf
        gained = rise * (time - self._since) if time > self._since else 0.0
        if rise == inf or gained >= abs(goal - self._ramp):
            return goal
        return self._ramp + copysign(gained, goal - self._ramp)
