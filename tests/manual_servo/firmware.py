"""Millisecond loop of a servo: control, bus watchdog, protection, sensors."""

from collections.abc import Callable

from .memory import TRIPPED, Memory
from .motion import SPEED, Pid, Profile
from .physics import TICKS, Shaft
from .table import GOALS

VOLTAGE, OVERHEAT, ENCODER, SHOCK, OVERLOAD = 1, 4, 8, 16, 32
FULL = 885  # PWM counts of full power
HEATING, COOLING, AROUND = 0.3, 0.01, 25.0  # [C/s] at full power, [1/s], [C]
OVERLOADED = 2.0  # [s] of full power without moving
STALL_SHARE = 0.8  # of the current limit that a stalled motor takes
POSITION, CURRENT_POSITION, PWM, VELOCITY = 3, 5, 16, 1
PER_TURN, HOMING_MOST = 4096, 1024  # [ticks]; of the offset in position mode


class Firmware:
    """Firmware of one servo."""

    def __init__(self, memory: Memory, shaft: Shaft) -> None:
        self.memory, self.shaft = memory, shaft
        self.profile, self.pid = Profile(), Pid()
        self.time = self.booted = self.heard = self.strained = 0.0  # [s]
        self.volts, self.celsius = memory.model.rated, AROUND
        self.drift = 1.0  # of its clock
        self.tampers: list[Callable[[Memory], None]] = []  # what lies about present values
        self.base = 0  # [ticks] that folding took away
        self._summed = 0.0
        self.boot(0.0)

    def boot(self, time: float) -> None:
        """Reset RAM, and bring the position into one turn."""
        self.memory.reset()
        self.shut = False  # only a reboot brings torque back after a shutdown
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
        """Take over drive mode and homing offset from the registers."""
        memory = self.memory
        offset = memory["homing_offset"]
        ignored = memory["operating_mode"] == POSITION and abs(offset) > HOMING_MOST
        self._homing = 0 if ignored else offset
        self._sign = -1 if memory["drive_mode"] & 1 else 1

    def fold(self) -> None:
        """Bring the position into one turn."""
        self.base += PER_TURN * (round(self.position) // PER_TURN)

    def switched(self, before: dict[str, int]) -> None:
        """React to a write, given the earlier values."""
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
        elif memory["torque"] and any(name in before for name in GOALS):
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
        """Start a profile to the goal."""
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
            self._limit = min(self._limit, FULL * abs(memory["goal_current"]) / max(1, memory["current_limit"]))
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
        duty = self._control(seconds) / FULL if self.torque else None
        self.shaft.step(seconds, duty, self.volts)
        work = duty or 0.0
        self.celsius += (HEATING * work * work - COOLING * (self.celsius - AROUND)) * seconds
        full = self.torque and abs(work) * FULL >= 0.95 * self._limit > 0.0 and abs(self.shaft.speed) < 0.05
        self.strained = self.strained + seconds if full else 0.0
        wrong = (self.celsius >= self._hottest and OVERHEAT) | (self.strained > OVERLOADED and OVERLOAD)
        if not self._least <= round(10 * self.volts) <= self._most:
            wrong |= VOLTAGE
        if wrong:
            self.alert(wrong)

    def _control(self, seconds: float) -> float:
        memory = self.memory
        if self.mode == PWM:
            return self._sign * memory["goal_pwm"]
        if self.mode == VELOCITY:
            error = memory["goal_velocity"] - self._sign * self.shaft.speed * TICKS / SPEED
            self._summed += error
            wish = memory["velocity_p"] / 128 * error + memory["velocity_i"] / 65536 * self._summed
            return self._sign * max(-self._limit, min(self._limit, wish))
        if self.mode == 0:
            return self._sign * max(-FULL, min(FULL, FULL * memory["goal_current"] / max(1, memory["current_limit"])))
        return self._sign * self.pid.step(self.profile.step(seconds) - self.position, self._gains, self._limit)

    def trip(self) -> None:
        """Stop because the bus was silent for too long."""
        memory = self.memory
        memory["watchdog"] = TRIPPED
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
        counts = 1000 if model.amperes is None else STALL_SHARE * model.current_limit
        speed = self._sign * shaft.speed * TICKS / SPEED
        memory["present_position"] = round(self.position)
        memory["present_velocity"] = round(speed)
        memory["present_current"] = round(self._sign * shaft.share * counts) if self.torque else 0
        memory["tick"] = int((self.time - self.booted) * 1000 * self.drift) % 32768
        memory["volts"], memory["celsius"] = round(10 * self.volts), round(self.celsius)
        memory["moving"] = int(abs(speed) > memory["moving_threshold"])
        memory["position_trajectory"] = round(self.profile.place)
        memory["velocity_trajectory"] = round(self.profile.speed / SPEED)
        memory["moving_status"] = int(self.profile.place == self.profile.goal) | (2 if self.profile.speed else 0)
