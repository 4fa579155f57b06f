"""Robot with raised arms under a random fault and an observer."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from random import Random

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.virtual.faults import PlannedFault
from kinesic.hardware.virtual.wiring import describe_cables

from ...manual_servo import faults, lies, servo_faults, strangers
from ...manual_servo.faults import Fault
from ...manual_servo.physics import Arm, Link
from ..manual.adapter import Plant
from ..supervisor.conftest import PERIOD, Desk
from .observer import Observer, SpyWire

RAISED_ANGLES = np.radians([10.0, 70.0, 80.0, 20.0, 70.0, 80.0, -20.0])  # [rad] hinge angles of one raised arm
SWAY_AMPLITUDE = np.radians(8.0)  # [rad] amplitude of the swaying arms
SWAY_PERIOD = 2.0  # [s] period of the swaying arms
RAISE_DURATION = 1.3  # [s] duration of the motion that raises the arms
PERFORMANCE_DURATION = 22.0  # [s] duration of the performance
OBSERVATION_DURATION = 6.0  # [s] duration of the observation after the end of a fault
WEIGHTS = {"flexion": 0.6, "bend": 0.35}  # [Nm] gravity torque on each hinge of a level arm part
SETTINGS = SupervisorSettings(pace=2.0, patience=1.2, hopeless=12.0)
ERROR_BITS = (1, 4, 8, 16, 32)  # bits of the hardware error status: voltage, overheating, encoder, shock, overload
WIRE_FAULT_KINDS = ("corrupt", "drop", "truncate", "duplicate", "noise", "lost", "late")


@dataclass(frozen=True)
class Strike:
    """Random fault with its wire, start time and duration."""

    name: str
    bus: str
    seconds: float
    begin: Callable[[Desk], None]
    wire: bool = False  # whether only the wire is faulty, so that no servo may be reported as stuck


class TrueShafts:
    """Actual states of the independent servos."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def torque(self) -> Flags:
        plant = self._desk.plant
        if isinstance(plant, Plant):
            return np.array([servo.device.firmware.torque for servo in plant.servos])
        return self._desk.true(Register.TORQUE_ENABLE) != 0

    def ticks(self) -> Floats:
        return self._desk.present_position.astype(float)


class Drill(Desk):
    """Robot whose arms have weight and whose wires are observed."""

    observer: Observer | None = None

    def start(self) -> None:
        if self.observer is None:
            self.observer = Observer(self.manifest, TrueShafts(self))
            self._make = self.wire
            if isinstance(self.plant, Plant):
                self.plant.world.arms = _arms(self.plant, self.manifest)
        self.wire = self._spied
        super().start()

    def _spied(self, bus: object, *, name: str, time: float) -> SpyWire:
        return SpyWire(self._make(bus, name=name, time=time), self.observer, name)

    def cycle(self) -> None:
        super().cycle()
        self.observer.look(self.plant.time, self.status.angles, self.status.taken)

    def raise_arms(self, up: Floats = RAISED_ANGLES) -> None:
        """Raise the arms, and let them sway in the raised posture."""
        self.open()
        rest = self.manifest.rest
        for k in range(round(PERFORMANCE_DURATION / PERIOD)):
            time = k * PERIOD
            share = min(1.0, time / RAISE_DURATION)
            smooth = share**3 * (10 - 15 * share + 6 * share**2)
            sway = (
                SWAY_AMPLITUDE * (1 - np.cos(2 * np.pi * (time - RAISE_DURATION) / SWAY_PERIOD)) / 2
                if time > RAISE_DURATION
                else 0.0
            )
            assert self.channel.write(time, rest + smooth * (up - rest) - np.sign(up) * sway)
        while not self.status.time > RAISE_DURATION + 0.3:
            self.cycle()
            assert not self.supervisor.done, self.kinds()[-12:]

    def suffer(self, strike: Strike, *, after: float = OBSERVATION_DURATION) -> None:
        """Apply a fault, and observe the robot until a time after its end."""
        self.observer.watching = True
        strike.begin(self)
        self.run(strike.seconds + after)

    @property
    def called_stuck(self) -> bool:
        """Return whether the supervisor reported a servo as blocked."""
        return any(line.startswith("failed") for line in self.kinds())


def _arms(plant: Plant, manifest: Manifest) -> tuple[Arm, ...]:
    arms = []
    for side in ("l", "r"):
        links = []
        for part, weight in WEIGHTS.items():
            k = next(k for k, member in enumerate(manifest.members) if member.hinge == f"{side}_{part}")
            links.append(Link(plant.servos[k].device.shaft, 0.0, manifest.members[k].turns, weight))
        arms.append(Arm(tuple(links)))
    return tuple(arms)


def drill(servos: str, folder: Path) -> Drill:
    """Create the observed robot on one of two kinds of virtual servos."""
    robot = Robot.load(Path(__file__).with_name("arms.toml"))
    return Drill(Manifest.of(robot), describe_cables(robot), folder / "events.jsonl", settings=SETTINGS, servos=servos)


def random_strike(servos: str, seed: int) -> Strike:
    """Draw a random fault for one of the two kinds of virtual servos."""
    dice = Random(f"{servos} {seed}")
    bus = dice.choice(["left", "right"])
    seconds = dice.choice([0.1, 0.3, 0.3, 0.6, 0.6, 1.0, 1.5, 1.5, 2.0, 2.0, 4.0, 10.0]) * dice.uniform(0.8, 1.0)
    servo = dice.choice([1, 2, 2, 3, 3, 4] if bus == "left" else [2, 2, 3, 3, 4])
    if servos == "kinesic":
        return _planned(dice, bus, servo, seconds)
    return _manual(dice, bus, servo, seconds)


def _planned(dice: Random, bus: str, servo: int, seconds: float) -> Strike:
    rate = dice.choice([0.05, 0.3, 1.0])
    choices = [PlannedFault(kind, rate=rate, seconds=seconds) for kind in WIRE_FAULT_KINDS]
    choices += [PlannedFault("silent", (servo,), seconds=seconds), PlannedFault("silent", seconds=seconds)] * 2
    choices += [PlannedFault("unplug", seconds=seconds)] * 3
    wire = len(choices)
    choices += [PlannedFault("alert", (servo,), value=bit) for bit in ERROR_BITS] * 2
    choices += [PlannedFault("reboot", (servo,)), PlannedFault("reboot"), PlannedFault("watchdog", (servo,))]
    choices += [PlannedFault("overheat", (servo,), seconds=seconds, value=8.0)]
    choices += [PlannedFault("undervoltage", seconds=seconds)]
    at = dice.randrange(len(choices))
    fault = choices[at]
    return Strike(fault.kind, bus, seconds, lambda desk: desk.expose(fault, bus=bus), wire=at < wire)


def _manual(dice: Random, bus: str, servo: int, seconds: float) -> Strike:
    seed, share = dice.randrange(1000), dice.choice([0.05, 0.3, 1.0])
    other = 3 if servo != 3 else 4
    spoiling = (
        *(faults.Garble, faults.Truncate, faults.DropByte, faults.Insert, faults.Duplicate, faults.Lose, faults.Late),
        *(faults.Mirror, faults.LostRequest, faults.Replay),
    )
    of_wire: list[Callable[[], Fault]] = [partial(kind, share, seed=seed) for kind in spoiling]
    of_wire += [faults.Echo, faults.Flood, faults.FrozenLink, faults.FrozenLink, faults.SilentAll, faults.SilentAll]
    of_wire += [
        faults.Unplugged,
        faults.Unplugged,
        partial(faults.WrongId, servo, other),
        partial(faults.BadCrc, servo),
    ]
    of_wire += [partial(faults.WrongLength, servo), partial(faults.Misquoted, servo)]
    of_wire += [partial(kind, servo) for kind in (servo_faults.Silent, servo_faults.Unhearing, servo_faults.Boasting)]
    of_wire += [partial(strangers.return_delay, servo), partial(strangers.return_level, servo)]
    of_wire += [
        partial(strangers.baud_changed, servo),
        partial(lies.DriftingClock, servo),
        partial(lies.StuckTick, servo),
    ]
    of_servo: list[Callable[[], Fault]] = [partial(servo_faults.Alert, servo, bit) for bit in ERROR_BITS] * 2
    of_servo += [partial(servo_faults.Reboot, servo), servo_faults.BrownOut, partial(servo_faults.TorqueOff, servo)]
    of_servo += [partial(servo_faults.Tripped, servo), partial(servo_faults.GoalIgnored, servo)]
    of_servo += [partial(servo_faults.Stalled, servo), partial(servo_faults.TemperatureRamp, servo, rate=8.0)]
    of_servo += [partial(servo_faults.VoltageSag, servo), partial(servo_faults.Undervoltage, servo)]
    of_servo += [
        partial(lies.FrozenServo, servo),
        partial(lies.Nonsense, servo),
        partial(lies.Scattered, servo, seed=seed),
    ]
    of_servo += [partial(lies.TurnOffset, servo, turns=dice.choice([-1, 1])), partial(strangers.alias_id, servo, other)]
    at = dice.randrange(len(of_wire) + len(of_servo))
    make = (of_wire + of_servo)[at]
    name = type(make()).__name__

    def begin(desk: Desk) -> None:
        desk.buses[bus].line.expose(make(), seconds=seconds)

    return Strike(name, bus, seconds, begin, wire=at < len(of_wire))
