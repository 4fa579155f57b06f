"""Simulates what a servo does by itself: it boots, guards, watches the bus, and shows what its sensors feel.

Assumed where no source says: a reboot takes `BOOT` seconds; any instruction on the wire feeds the bus watchdog; a stall
of `OVERLOAD` seconds is an overload; an error stays until the reboot.
"""

from math import inf

from kinesic.hardware.protocol.packet import ALERT
from kinesic.hardware.protocol.registers import (
    CLOCK_WRAP,
    TICK,
    WATCHDOG,
    WATCHDOG_TRIPPED,
    HardwareError,
    Mode,
    Register,
)
from kinesic.hardware.virtual.control_table import Memory
from kinesic.hardware.virtual.physics import LIMP, Demand, Shaft
from kinesic.hardware.virtual.set_point import SetPoint

BOOT = 0.13  # [s] from a reboot until it hears again
OVERLOAD = 1.0  # [s] of full duty without motion
STALLED = 0.99  # share of the largest duty that counts as full
SHORTEST_BOOT = 1e-6  # [s]
NOMINAL_VOLTS, ROOM = 12.0, 25.0  # [V], [C]
SMALL_VOLTS = 5.0  # [V] for models that do not stand 12 V
_TORQUE_AT_BOOT, _RAM_AT_BOOT = 1, 2


class Firmware:
    """Registers, guards and control loop of a servo; its shaft is somebody else's."""

    def __init__(self, memory: Memory) -> None:
        """Is not powered before `place`."""
        self.memory = memory
        self.motion = SetPoint(memory, Shaft(0.0))
        small = memory[Register.MAX_VOLTAGE_LIMIT] < NOMINAL_VOLTS * 10
        self.volts = SMALL_VOLTS if small else NOMINAL_VOLTS
        self.celsius, self.heating = ROOM, 0.0  # [C], [K/s]
        self.latched = False  # shut down until it is rebooted
        self.backup: bytes | None = None  # of RAM
        self.shaft, self.time = Shaft(0.0), 0.0
        self._instructed = self._started = 0.0  # [s]
        self._wakes = 0.0  # [s] when it is up again
        self._stalled_since = inf
        self._shown = -1.0  # [s] of the sensors' registers
        self._steady: Demand | None = None  # what it asks until a register changes
        self._patience: float | None = None  # [s] of the bus watchdog, likewise
        self._unharmed: tuple[float, float] | None = None  # volts and temperature that were looked at, likewise

    @property
    def up(self) -> bool:
        """Whether it hears."""
        return self._wakes <= self.time

    @property
    def alert(self) -> int:
        """The alert bit of its error byte."""
        return ALERT if self.memory[Register.HARDWARE_ERROR_STATUS] else 0

    def place(self, shaft: Shaft, time: float) -> None:
        """Puts it on a shaft and powers it: the goal is where it is, in the first turn."""
        self.shaft, self.time = shaft, time
        self._boot(time)

    def due(self) -> float:
        """Returns when [s] it does something by itself; infinite if it waits for instructions."""
        if not self.up:
            return self._wakes
        if self._patience is None:
            watchdog = self.memory[Register.BUS_WATCHDOG]
            watching = watchdog > 0 and self.memory[Register.TORQUE_ENABLE]
            self._patience = watchdog * WATCHDOG if watching else inf
        return self._instructed + self._patience

    def demand(self, time: float) -> Demand:
        """Returns what it demands of its motor from now on."""
        if not self.up:
            return LIMP
        if self._steady is not None:
            return self._steady
        demand = self.motion.demand(time)
        if self.motion.settled(time):
            self._steady = demand
        return demand

    def update_shaft(self, shaft: Shaft, time: float) -> None:
        """Takes what the shaft does at a time [s], and lets the guards act."""
        asleep = not self.up
        self.celsius += self.heating * (time - self.time)
        self.shaft, self.time = shaft, time
        if asleep:
            if self.up:
                self._boot(self._wakes)
            return
        if self.due() <= time:
            self.trip()
        self._guard()

    def hear(self, time: float) -> None:
        """Notes an instruction on the wire, for whichever servo."""
        self._instructed = time

    def trip(self) -> None:
        """Stops where it is, as the bus watchdog does; torque stays on."""
        memory = self.memory
        memory[Register.BUS_WATCHDOG] = WATCHDOG_TRIPPED
        memory[Register.PROFILE_ACCELERATION] = memory[Register.PROFILE_VELOCITY] = 0
        self.motion.stop(self.shaft, self.time)
        self.changed()

    def fail(self, bits: int) -> None:
        """Raises hardware errors: the alert bit is set, and those of the shutdown mask take the torque away."""
        memory = self.memory
        memory[Register.HARDWARE_ERROR_STATUS] |= bits
        if bits & memory[Register.SHUTDOWN]:
            self.latched = True
            memory[Register.TORQUE_ENABLE] = 0
        self.changed()

    def reboot(self, *, seconds: float = BOOT) -> None:
        """Takes the power away for a while, and with it RAM, torque and turns."""
        self.memory.restore_ram()
        self._wakes = self.time + max(seconds, SHORTEST_BOOT)

    def here(self) -> int:
        """Returns PRESENT_POSITION [ticks]."""
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
        if startup & _RAM_AT_BOOT and self.backup is not None:
            memory.put_ram(self.backup)
        memory[Register.BACKUP_READY] = self.backup is not None
        memory[Register.GOAL_PWM] = memory[Register.PWM_LIMIT]
        if Register.GOAL_CURRENT in memory:
            memory[Register.GOAL_CURRENT] = memory[Register.CURRENT_LIMIT]
        memory[Register.GOAL_POSITION] = self.here()
        memory[Register.TORQUE_ENABLE] = startup & _TORQUE_AT_BOOT
        self.changed()

    def fold(self) -> None:
        """Sets the set point to where the shaft is, within one turn in position mode."""
        if self.memory[Register.OPERATING_MODE] == Mode.POSITION.value:
            self.motion.fold(self.shaft)
        self.motion.rest(self.shaft, self.time)

    def _guard(self) -> None:
        strained = abs(self.shaft.duty) >= STALLED
        if not strained and self._unharmed == (self.volts, self.celsius):
            return
        memory, bits = self.memory, 0
        volts = round(self.volts * 10)
        if not memory[Register.MIN_VOLTAGE_LIMIT] <= volts <= memory[Register.MAX_VOLTAGE_LIMIT]:
            bits |= HardwareError.VOLTAGE.value
        if self.celsius >= memory[Register.TEMPERATURE_LIMIT]:
            bits |= HardwareError.OVERHEATING.value
        if not strained or abs(self.shaft.speed) > TICK or not memory[Register.TORQUE_ENABLE]:
            self._stalled_since = inf
        else:
            self._stalled_since = min(self._stalled_since, self.time)
            bits |= HardwareError.OVERLOAD.value if self.time - self._stalled_since >= OVERLOAD else 0
        if bits & ~memory[Register.HARDWARE_ERROR_STATUS]:
            self.fail(bits)
        self._unharmed = (self.volts, self.celsius)

    def show(self) -> None:
        """Brings the sensors' registers up to date."""
        if self._shown == self.time:
            return
        memory, self._shown = self.memory, self.time
        self.motion.show(self.shaft, self.time)
        memory[Register.REALTIME_TICK] = int((self.time - self._started) * 1000 + 1e-6) % CLOCK_WRAP
        memory[Register.PRESENT_INPUT_VOLTAGE] = round(self.volts * 10)
        memory[Register.PRESENT_TEMPERATURE] = max(0, min(255, round(self.celsius)))

    def changed(self) -> None:
        """Forgets what followed from registers that have changed."""
        self._shown = -1.0
        self._steady = self._patience = self._unharmed = None
