"""Autonomous behaviour of a servo: boot, shutdown, bus watchdog and sensors.

Assumed without a source: a reboot takes `BOOT_TIME`; any instruction on the wire feeds the bus watchdog; a stall of
`OVERLOAD_TIME` is an overload; an error stays until the reboot.
"""

import struct
from math import inf

from kinesic.hardware.protocol.packet import ALERT_BIT
from kinesic.hardware.protocol.registers import (
    CLOCK_WRAP,
    TICK_ANGLE,
    WATCHDOG_TRIPPED,
    WATCHDOG_UNIT,
    HardwareError,
    Mode,
    Register,
)
from kinesic.hardware.virtual.control_table import Memory
from kinesic.hardware.virtual.physics import NO_TORQUE, Demand, Shaft
from kinesic.hardware.virtual.set_point import SetPoint

BOOT_TIME = 0.13  # [s] time from a reboot until the servo receives instructions
OVERLOAD_TIME = 1.0  # [s] duration of full duty without motion after which the servo reports an overload
STALL_DUTY = 0.99  # duty from which on a servo without motion counts as overloaded
MIN_BOOT_TIME = 1e-6  # [s] shortest boot time, in place of a requested shorter one
NOMINAL_VOLTS = 12.0  # [V] supply voltage of most models
ROOM_TEMPERATURE = 25.0  # [C] initial temperature of a virtual servo
SMALL_MODEL_VOLTS = 5.0  # [V] supply voltage of models that do not withstand 12 V
_SUPPLY_FORMAT = struct.Struct("<HB")  # Consecutive registers PRESENT_INPUT_VOLTAGE and PRESENT_TEMPERATURE
_SUPPLY_ADDRESS = Register.PRESENT_INPUT_VOLTAGE.field.address  # address of _SUPPLY_FORMAT
_TORQUE_AT_BOOT_BIT = 1  # STARTUP_CONFIGURATION bit that switches torque on at boot
_RAM_AT_BOOT_BIT = 2  # STARTUP_CONFIGURATION bit that restores RAM at boot


class Firmware:
    """Registers, protection and control loop of a servo, without its shaft."""

    def __init__(self, memory: Memory) -> None:
        """Create the electronics of a servo that is switched off.

        `place` powers it.
        """
        self.memory = memory
        self.motion = SetPoint(memory, Shaft(0.0))
        is_small = memory[Register.MAX_VOLTAGE_LIMIT] < NOMINAL_VOLTS * 10
        self.volts = SMALL_MODEL_VOLTS if is_small else NOMINAL_VOLTS
        self.celsius, self.heating = ROOM_TEMPERATURE, 0.0  # [C] temperature, [K/s] heating rate
        self.latched = False  # whether the servo has shut down until a reboot
        self.backup: bytes | None = None  # backup of RAM
        self.shaft, self.time = Shaft(0.0), 0.0
        self._instructed = self._started = 0.0  # [s] last instruction, and boot
        self._wakes = 0.0  # [s] end of the boot
        self._stalled_since = inf
        self._shown = -1.0  # [s] time of the sensor registers
        self._steady: Demand | None = None  # demand until a register changes
        self._watchdog_time: float | None = None  # [s] watchdog time until a register changes
        self._checked: tuple[float, float] | None = None  # voltage and temperature of the last check without error

    @property
    def up(self) -> bool:
        """Whether the servo has booted and receives instructions."""
        return self._wakes <= self.time

    @property
    def alert(self) -> int:
        """Alert bit of the error byte."""
        return ALERT_BIT if self.memory[Register.HARDWARE_ERROR_STATUS] else 0

    def place(self, shaft: Shaft, time: float) -> None:
        """Mount the servo on a shaft and power it.

        Its goal is the present position within the first turn.
        """
        self.shaft, self.time = shaft, time
        self._boot(time)

    def due(self) -> float:
        """Return the time [s] of the servo's next autonomous action, or infinity."""
        if self._wakes > self.time:
            return self._wakes
        if self._watchdog_time is None:
            watchdog = self.memory[Register.BUS_WATCHDOG]
            watching = watchdog > 0 and self.memory[Register.TORQUE_ENABLE]
            self._watchdog_time = watchdog * WATCHDOG_UNIT if watching else inf
        return self._instructed + self._watchdog_time

    def demand(self, time: float) -> Demand:
        """Return the control loop's motor command from a time [s] on."""
        if self._wakes > self.time:
            return NO_TORQUE
        if self._steady is not None:
            return self._steady
        demand = self.motion.demand(time)
        if self.motion.settled(time):
            self._steady = demand
        return demand

    def update_shaft(self, shaft: Shaft, time: float) -> None:
        """Update shaft and time [s], then check watchdog, load, heat and supply."""
        asleep = self._wakes > self.time
        self.celsius += self.heating * (time - self.time)
        self.shaft, self.time = shaft, time
        if asleep:
            if self.up:
                self._boot(self._wakes)
            return
        if self.due() <= time:
            self.trip()
        if abs(shaft.duty) >= STALL_DUTY or self._checked != (self.volts, self.celsius):
            self._guard()

    def hear(self, time: float) -> None:
        """Record the time of an instruction to any servo on the wire."""
        self._instructed = time

    def trip(self) -> None:
        """Stop at the present position, as the bus watchdog does.

        Torque stays on.
        """
        memory = self.memory
        memory[Register.BUS_WATCHDOG] = WATCHDOG_TRIPPED
        memory[Register.PROFILE_ACCELERATION] = memory[Register.PROFILE_VELOCITY] = 0
        self.motion.stop(self.shaft, self.time)
        self.changed()

    def fail(self, bits: int) -> None:
        """Set bits of the hardware error status, and the alert bit.

        Errors of the shutdown mask switch torque off.
        """
        memory = self.memory
        memory[Register.HARDWARE_ERROR_STATUS] |= bits
        if bits & memory[Register.SHUTDOWN]:
            self.latched = True
            memory[Register.TORQUE_ENABLE] = 0
        self.changed()

    def reboot(self, *, seconds: float = BOOT_TIME) -> None:
        """Interrupt the power, which resets RAM, torque and turn count."""
        self.memory.restore_ram()
        self._wakes = self.time + max(seconds, MIN_BOOT_TIME)

    def present_position(self) -> int:
        """Return PRESENT_POSITION [ticks]."""
        return round(self.motion.ticks(self.shaft.angle))

    def _boot(self, time: float) -> None:
        memory = self.memory
        memory.restore_ram()
        self._started = self._instructed = self._wakes = time
        self.latched, self._stalled_since = False, inf
        self.motion = SetPoint(memory, self.shaft)
        self.motion.fold(self.shaft)
        self.motion.rest(self.shaft, time)
        startup = memory[Register.STARTUP_CONFIGURATION]
        if startup & _RAM_AT_BOOT_BIT and self.backup is not None:
            memory.put_ram(self.backup)
        memory[Register.BACKUP_READY] = self.backup is not None
        memory[Register.GOAL_PWM] = memory[Register.PWM_LIMIT]
        if Register.GOAL_CURRENT in memory:
            memory[Register.GOAL_CURRENT] = memory[Register.CURRENT_LIMIT]
        memory[Register.GOAL_POSITION] = self.present_position()
        memory[Register.TORQUE_ENABLE] = startup & _TORQUE_AT_BOOT_BIT
        self.changed()

    def fold(self) -> None:
        """Reset the set point to the shaft's position.

        In position mode the position is wrapped to one turn before.
        """
        if self.memory[Register.OPERATING_MODE] == Mode.POSITION.value:
            self.motion.fold(self.shaft)
        self.motion.rest(self.shaft, self.time)

    def _guard(self) -> None:
        memory, bits = self.memory, 0
        volts = round(self.volts * 10)
        if not memory[Register.MIN_VOLTAGE_LIMIT] <= volts <= memory[Register.MAX_VOLTAGE_LIMIT]:
            bits |= HardwareError.VOLTAGE.value
        if self.celsius >= memory[Register.TEMPERATURE_LIMIT]:
            bits |= HardwareError.OVERHEATING.value
        if (
            abs(self.shaft.duty) < STALL_DUTY
            or abs(self.shaft.speed) > TICK_ANGLE
            or not memory[Register.TORQUE_ENABLE]
        ):
            self._stalled_since = inf
        else:
            self._stalled_since = min(self._stalled_since, self.time)
            bits |= HardwareError.OVERLOAD.value if self.time - self._stalled_since >= OVERLOAD_TIME else 0
        if bits & ~memory[Register.HARDWARE_ERROR_STATUS]:
            self.fail(bits)
        self._checked = (self.volts, self.celsius)

    def show(self) -> None:
        """Write the present sensor values to the registers."""
        if self._shown == self.time:
            return
        memory, self._shown = self.memory, self.time
        self.motion.show(self.shaft, self.time)
        memory[Register.REALTIME_TICK] = int((self.time - self._started) * 1000 + 1e-6) % CLOCK_WRAP
        volts, celsius = round(self.volts * 10), max(0, min(255, round(self.celsius)))
        memory.put(_SUPPLY_ADDRESS, _SUPPLY_FORMAT.pack(volts, celsius))

    def changed(self) -> None:
        """Invalidate all cached values derived from registers."""
        self._shown = -1.0
        self._steady = self._watchdog_time = self._checked = None
