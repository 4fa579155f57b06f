"""Adapter that runs tests of kinesic's virtual servos on the independent ones.

The names are those of kinesic's own virtual bus, so that one test runs on both.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.wiring import Cable, ServoFitting

from ...manual_servo import faults as wire
from ...manual_servo import servo_faults as servos
from ...manual_servo import strangers
from ...manual_servo.device import BAUD_RATES, Device
from ...manual_servo.faults import Fault
from ...manual_servo.line import Line, World
from ...manual_servo.physics import MID_TICKS, TICKS_PER_RADIAN, Shaft
from ...manual_servo.table import MODELS

REBOOT_TIME = 0.25  # [s] default time from a reboot until a servo receives instructions


class Registers:
    """Control table of an independent servo, indexed by kinesic's registers."""

    def __init__(self, device: Device) -> None:
        self._device = device

    def __getitem__(self, register: Register) -> int:
        self._device.firmware.refresh()
        field = register.field
        return int.from_bytes(self._device.memory.bytes[field.address : field.end], "little", signed=field.signed)

    def __setitem__(self, register: Register, value: int) -> None:
        field = register.field
        self._device.memory.bytes[field.address : field.end] = field.pack(value)
        self._device.firmware.reload()


class Electronics:
    """Sensors and autonomous behaviour of an independent servo."""

    def __init__(self, device: Device) -> None:
        self._device = device

    def present_position(self) -> int:
        """Return the actual position [ticks]."""
        return round(self._device.firmware.position)

    def fail(self, bits: int) -> None:
        self._device.firmware.alert(bits)

    @property
    def up(self) -> bool:
        """Return whether the servo receives, which it does not during a reboot."""
        return self._device.wakes <= self._device.firmware.time

    @property
    def latched(self) -> bool:
        """Return whether the servo has shut down after a hardware error."""
        return self._device.firmware.shut

    @property
    def celsius(self) -> float:
        return self._device.firmware.celsius

    @celsius.setter
    def celsius(self, value: float) -> None:
        self._device.firmware.celsius = value


class Servo:
    """Independent servo with the attributes that kinesic's tests read."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.memory, self.electronics = Registers(device), Electronics(device)

    @property
    def mute(self) -> bool:
        return self.device.mute

    @mute.setter
    def mute(self, value: bool) -> None:
        self.device.mute = value

    def write(self, address: int, data: bytes) -> None:
        self.device.write(address, data)

    def reboot(self, *, seconds: float = REBOOT_TIME) -> None:
        self.device.boot(self.device.firmware.time)
        self.device.wakes = self.device.firmware.time + seconds


class Jams:
    """Flags of the blocked servos."""

    def __init__(self, shafts: Sequence[Shaft]) -> None:
        self._shafts = shafts

    def __setitem__(self, place: int, value: bool) -> None:
        self._shafts[place].jammed = value


@dataclass(frozen=True)
class Turned:
    """Shaft angle on kinesic's scale, where tick 0 is angle 0."""

    angle: float  # [rad]


class Physics:
    """Shafts of all independent servos."""

    def __init__(self, devices: Sequence[Device]) -> None:
        self._shafts = [device.shaft for device in devices]
        self.jammed = Jams(self._shafts)

    def shafts(self) -> list[Turned]:
        return [Turned(shaft.ticks / TICKS_PER_RADIAN) for shaft in self._shafts]

    def turn(self, place: int, angle: float) -> None:
        self._shafts[place].angle = angle - MID_TICKS / TICKS_PER_RADIAN


class Plant:
    """Independent servos and their simulated world."""

    def __init__(self, devices: Sequence[Device]) -> None:
        self.world, self.servos, self.physics = World(devices), [Servo(d) for d in devices], Physics(devices)

    @property
    def time(self) -> float:
        return self.world.time

    def advance(self, time: float) -> None:
        self.world.advance(time)


class Bus:
    """Independent wire that accepts kinesic's planned faults."""

    def __init__(self, line: Line) -> None:
        self.line = line

    def expose(self, plan: FaultPlan) -> None:
        self.line.faults = [fault for fault in self.line.faults if not isinstance(fault, wire.Spoiled)]
        for planned in plan.faults:
            for fault in _translate(planned, self.line, plan.seed):
                self.line.expose(fault, at=self.line.world.time + planned.start, seconds=planned.seconds)


class ManualWire:
    """Wire in virtual time that never waits for real time."""

    def __init__(self, bus: Bus, *, name: str = "memory", time: float = 0.0) -> None:
        self.name, self._line, self._time, self._gone = name, bus.line, time, False

    @property
    def baud(self) -> int:
        return self._line.baud

    @baud.setter
    def baud(self, value: int) -> None:
        self._line.baud = value

    def now(self) -> float:
        return self._time

    def write(self, data: bytes | bytearray, /) -> None:
        self._check()
        self._line.send(bytes(data), self._time)

    def read(self, deadline: float, /) -> bytes:
        self._check()
        arrival = self._line.arrives()
        self._time = max(self._time, min(arrival, deadline))
        self._line.world.advance(self._time)
        self._check()
        return self._line.receive(self._time)

    def sleep(self, until: float, /) -> None:
        self._time = max(self._time, until)

    def reopen(self) -> bool:
        self._line.world.advance(self._time)
        self._gone = not self._line.plugged
        return not self._gone

    def close(self) -> None:
        self._line.drop()

    def _check(self) -> None:
        """Raise an error if the port was unplugged, even if it is plugged in again."""
        self._line.world.advance(self._time)
        self._gone = self._gone or not self._line.plugged
        if self._gone:
            raise BusError(f"{self.name}: the port is gone")


def build_manual(cables: Sequence[Cable]) -> tuple[Plant, Mapping[str, Bus]]:
    """Build independent servos for tests that call `build_bus`."""
    groups = [[_build(fitting, cable) for fitting in cable.fittings] for cable in cables]
    plant = Plant([device for group in groups for device in group])
    buses = {}
    for cable, group in zip(cables, groups, strict=True):
        line = Line(plant.world, group, baud=cable.baud, latency=cable.latency)
        buses[cable.name] = Bus(line)
        buses[cable.name].expose(cable.faults)
    return plant, buses


def _build(fitting: ServoFitting, cable: Cable) -> Device:
    angle = (fitting.ticks - MID_TICKS) / TICKS_PER_RADIAN
    device = Device(fitting.servo, fitting.model, baud=cable.baud, firmware=fitting.firmware, angle=angle)
    device.memory["return_delay"] = fitting.return_delay
    return device


WIRE_FAULTS = {  # kinesic's kind of a wire fault -> fault class of the independent servos
    "corrupt": wire.Garble,
    "drop": wire.DropByte,
    "truncate": wire.Truncate,
    "duplicate": wire.Duplicate,
    "noise": wire.Insert,
    "lost": wire.Lose,
    "late": wire.Late,
}


def _translate(planned: PlannedFault, line: Line, seed: int) -> list[Fault]:
    """Convert a fault chance per combined reply of several servos to a chance per servo."""
    concerned = [device.id for device in line.devices if not planned.servos or device.id in planned.servos]
    if planned.way == "request" and planned.kind in WIRE_FAULTS:
        return [wire.LostRequest(planned.rate, seed=seed)]
    if planned.kind in WIRE_FAULTS:
        share = 1 - (1 - planned.rate) ** (1 / max(1, len(concerned)))
        return [WIRE_FAULTS[planned.kind](share, tuple(concerned), seed=seed)]
    if planned.kind == "unplug":
        return [wire.Unplugged()]
    of_servo = {
        "silent": servos.Silent,
        "reboot": servos.Reboot,
        "alert": partial(servos.Alert, bits=int(planned.effective_value)),
        "overheat": partial(servos.TemperatureRamp, rate=planned.effective_value),
        "undervoltage": partial(servos.Undervoltage, volts=planned.effective_value),
        "watchdog": servos.Tripped,
        "wrong_model": partial(strangers.foreign_model, number=int(planned.effective_value)),
        "old_firmware": partial(strangers.foreign_firmware, firmware=int(planned.effective_value)),
        "duplicate_id": partial(_double, line),
    }
    return [of_servo[planned.kind](servo) for servo in concerned]


def _double(line: Line, servo: int) -> Fault:
    """Add a second servo with the same id to the wire."""
    model = next(name for name, known in MODELS.items() if known is line.device(servo).memory.model)
    other = Device(servo, model, baud=BAUD_RATES[line.device(servo).memory["baud"]], angle=-1.0)
    line.world.devices += (other,)
    line.devices.append(other)
    return Fault()
