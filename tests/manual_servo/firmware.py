"""Millisecond loop of a servo: control, bus watchdog, protection, sensors."""

from collections.abc import Callable

from .memory import WATCHDOG_TRIPPED, Memory
from .motion import VELOCITY_UNIT, Pid, Profile
from .physics import TICKS_PER_RADIAN, Shaft
from .table import GOAL_REGISTERS

VOLTAGE, OVERHEAT, ENCODER, SHOCK, OVERLOAD = 1, 4, 8, 16, 32  # bits of the hardware error status
FULL_PWM = 885  # [counts] PWM at full power
HEATING_RATE = 0.3  # [C/s] heating at full power
COOLING_RATE = 0.01  # [1/s] rate of approach to the room temperature
ROOM_TEMPERATURE = 25.0  # [C] temperature of a servo that has not moved
OVERLOAD_TIME = 2.0  # [s] duration of full power without motion after which the servo reports an overload
STALL_CURRENT_RATIO = 0.8  # current of a stalled motor / current limit
POSITION, CURRENT_POSITION, PWM, VELOCITY = 3, 5, 16, 1  # operating modes
TICKS_PER_TURN = 4096
MAX_HOMING_OFFSET = 1024  # [ticks] largest homing offset that position mode applies


class Firmware:
    """Firmware of one servo."""

    def __init__(self, memory: Memory, shaft: Shaft) -> None:
        self.memory, self.shaft = memory, shaft
        self.profile, self.pid = Profile(), Pid()
        self.time = self.booted = self.heard = self.strained = 0.0  # [s]
        self.volts, self.celsius = memory.model.rated, ROOM_TEMPERATURE
        self.drift = 1.0  # clock rate / true rate
        self.tampers: list[Callable[[Memory], None]] = []  # functions that falsify present values
        self.base = 0  # [ticks] whole turns that are subtracted from the position
        self._summed = 0.0
        self.boot(0.0)

    def boot(self, time: float) -> None:
        """Reset RAM, and bring the position into one turn."""
        self.memory.reset()
        self.shut = False  # whether the servo has shut down, until a reboot
        self.booted = self.heard = time
        self._orient()
        self.fold()
        self.memory["goal_position"] = round(self.position)
        self.profile.stand(self.position)
        self.reload()
        if self.memory["startup"] & 1:
            self.memory["torque"] = 1
            self.switched({"torque": 0})

    @property
    def position(self) -> float:
        """Return the position [ticks] as the firmware counts it."""
        return self._sign * self.shaft.ticks + self._homing - self.base

    def _orient(self) -> None:
        """Read rotation direction and homing offset from the registers."""
        memory = self.memory
        offset = memory["homing_offset"]
        ignored = memory["operating_mode"] == POSITION and abs(offset) > MAX_HOMING_OFFSET
        self._homing = 0 if ignored else offset
        self._sign = -1 if memory["drive_mode"] & 1 else 1

    def fold(self) -> None:
        """Reduce the position to one turn."""
        self.base += TICKS_PER_TURN * (round(self.position) // TICKS_PER_TURN)

    def switched(self, before: dict[str, int]) -> None:
        """Apply changed registers, given their values before the write."""
        memory = self.memory
        self._orient()
        if before.get("operating_mode", memory["operating_mode"]) != memory["operating_mode"]:
            self._change_mode()
        if before.get("torque") == 0 and memory["torque"]:
            if memory["operating_mode"] == POSITION:
                self.fold()
            self.profile.stand(self.position)
            self.pid.rest()
            self._summed = self.strained = 0.0
            self.head()
        elif memory["torque"] and any(name in before for name in GOAL_REGISTERS):
            self.head()
        if "watchdog" in before:
            self.heard = self.time
        self.reload()

    def _change_mode(self) -> None:
        memory, item = self.memory, self.memory.item
        for name in ("position_p", "position_i", "position_d", "velocity_p", "velocity_i"):
            memory[name] = item(name).initial
        for name in ("feed_forward_1", "feed_forward_2", "profile_velocity", "profile_acceleration"):
            memory[name] = 0
        memory["goal_pwm"] = memory["pwm_limit"]
        if memory["operating_mode"] == POSITION:
            self.fold()
            memory["goal_position"] = round(self.position)

    def head(self) -> None:
        """Start a profile to the goal in the registers."""
        memory = self.memory
        timed = bool(memory["drive_mode"] & 4)
        speed, acceleration = memory["profile_velocity"], memory["profile_acceleration"]
        self.profile.head(float(memory["goal_position"]), speed, acceleration, timed)

    def reload(self) -> None:
        """Cache the register values for the control loop."""
        memory = self.memory
        self._orient()
        self.torque, self.mode = bool(memory["torque"]), memory["operating_mode"]
        self._gains = (memory["position_p"], memory["position_i"], memory["position_d"])
        self._limit = min(abs(memory["goal_pwm"]), memory["pwm_limit"])
        if self.mode == CURRENT_POSITION:
            self._limit = min(self._limit, FULL_PWM * abs(memory["goal_current"]) / max(1, memory["current_limit"]))
        counts = memory["watchdog"]
        self._patience = 0.02 * counts if counts > 0 and self.torque else None
        self._hottest, self._least, self._most = (
            memory["temperature_limit"],
            memory["min_voltage"],
            memory["max_voltage"],
        )

    def run(self, seconds: float) -> None:
        """Run the firmware for one time step."""
        self.time += seconds
        if self._patience is not None and self.time - self.heard > self._patience:
            self.trip()
        duty = self._control(seconds) / FULL_PWM if self.torque else None
        self.shaft.step(seconds, duty, self.volts)
        work = duty or 0.0
        self.celsius += (HEATING_RATE * work * work - COOLING_RATE * (self.celsius - ROOM_TEMPERATURE)) * seconds
        full = self.torque and abs(work) * FULL_PWM >= 0.95 * self._limit > 0.0 and abs(self.shaft.speed) < 0.05
        self.strained = self.strained + seconds if full else 0.0
        wrong = (self.celsius >= self._hottest and OVERHEAT) | (self.strained > OVERLOAD_TIME and OVERLOAD)
        if not self._least <= round(10 * self.volts) <= self._most:
            wrong |= VOLTAGE
        if wrong:
            self.alert(wrong)

    def _control(self, seconds: float) -> float:
        memory = self.memory
        if self.mode == PWM:
            return self._sign * memory["goal_pwm"]
        if self.mode == VELOCITY:
            error = memory["goal_velocity"] - self._sign * self.shaft.speed * TICKS_PER_RADIAN / VELOCITY_UNIT
            self._summed += error
            wish = memory["velocity_p"] / 128 * error + memory["velocity_i"] / 65536 * self._summed
            return self._sign * max(-self._limit, min(self._limit, wish))
        if self.mode == 0:
            return self._sign * max(
                -FULL_PWM, min(FULL_PWM, FULL_PWM * memory["goal_current"] / max(1, memory["current_limit"]))
            )
        return self._sign * self.pid.step(self.profile.step(seconds) - self.position, self._gains, self._limit)

    def trip(self) -> None:
        """Stop because the bus was silent for too long."""
        memory = self.memory
        memory["watchdog"] = WATCHDOG_TRIPPED
        memory["profile_velocity"] = memory["profile_acceleration"] = memory["goal_velocity"] = 0
        self.profile.stand(self.position)
        self.reload()

    def alert(self, bits: int) -> None:
        """Report a hardware error, and shut down if the shutdown mask has its bit."""
        memory = self.memory
        memory["error"] |= bits
        if bits & memory["shutdown"] and not self.shut:
            self.shut = True
            memory["torque"] = 0
            self.reload()

    def refresh(self) -> None:
        """Update the present values."""
        memory, shaft, model = self.memory, self.shaft, self.memory.model
        counts = 1000 if model.amperes is None else STALL_CURRENT_RATIO * model.current_limit
        speed = self._sign * shaft.speed * TICKS_PER_RADIAN / VELOCITY_UNIT
        memory["present_position"] = round(self.position)
        memory["present_velocity"] = round(speed)
        memory["present_current"] = round(self._sign * shaft.share * counts) if self.torque else 0
        memory["tick"] = int((self.time - self.booted) * 1000 * self.drift) % 32768
        memory["volts"], memory["celsius"] = round(10 * self.volts), round(self.celsius)
        memory["moving"] = int(abs(speed) > memory["moving_threshold"])
        memory["position_trajectory"] = round(self.profile.place)
        memory["velocity_trajectory"] = round(self.profile.speed / VELOCITY_UNIT)
        memory["moving_status"] = int(self.profile.place == self.profile.goal) | (2 if self.profile.speed else 0)
