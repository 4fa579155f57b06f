"""Fault matrix: the same motion under each fault, for any driver.

All trials use the same kind of virtual wire in virtual time. The host's computing takes no virtual time; a cycle lasts
as long as the wire and the driver's waiting.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from kinesic.bench.bus.drivers import Driver, DriverReading
from kinesic.body.arrays import Floats
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.virtual.bus import VirtualBus
from kinesic.hardware.virtual.faults import BUILD_KINDS, NO_FAULTS, FaultKind, FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

SERVO_MODEL = "xm430_w350"  # model of all virtual servos
BUS_PERIOD = 0.01  # [s] smallest cycle period of a trial
MOTION_AMPLITUDE = 200  # [ticks] amplitude of the servos' sinusoidal motion
MOTION_PERIOD = 2.0  # [s] period of the servos' sinusoidal motion
POSITION_TOLERANCE = 3  # [ticks] error above which a read position counts as wrong
TIME_TOLERANCE = 0.01  # [s] timestamp error, beyond one period, above which a position counts as wrong
PERIOD_MARGIN = 1.25  # smallest trial period / shortest bus cycle
FAULT_START = 0.5  # [s] motion time at which timed faults start
FAULT_RATES = (0.01, 0.05)  # probabilities of random faults, one per fault case
RANDOM_KINDS: tuple[FaultKind, ...] = ("corrupt", "drop", "truncate", "duplicate", "noise", "lost")

DriverFactory = Callable[[Wire, Sequence[Servo], float], Driver]


@dataclass(frozen=True)
class FaultCase:
    """Bus faults of one trial and its number of cycles."""

    name: str
    faults: tuple[PlannedFault, ...] = ()
    cycles: int = 300  # number of cycles of a trial
    model: str = SERVO_MODEL  # model of all servos


@dataclass(frozen=True, eq=False)
class TrialResult:
    """Measured behaviour of a driver under one bus fault."""

    case: str
    servos: int
    baud: int
    seed: int
    period: float  # [s] cycle period
    refused: str = ""  # reason why the driver refused these servos
    exceptions: int = 0  # number of exceptions
    wrong: int = 0  # number of positions that were never true near their timestamps
    fresh: float = 0.0  # fraction of the readable positions that arrived, even if late but with the correct time
    prompt: float = 0.0  # fraction of the readable positions that arrived in the cycle of their request
    oldest: float = 0.0  # [s] largest age of a position at the end of its cycle
    durations: Floats = field(default_factory=lambda: np.zeros(1))  # (m,) [s] durations of the cycles
    reported: float | None = (
        None  # [s] from the start of the first cycle with a hardware error to its report; None: never
    )

    def duration(self, percent: float) -> float:
        """Return a percentile of the bus cycle durations [s]."""
        return float(np.percentile(self.durations, percent))


def list_cases() -> tuple[FaultCase, ...]:
    """List all fault cases of the matrix, including one without faults."""
    rates = [
        FaultCase(f"{kind} {rate:.0%}", (PlannedFault(kind, rate=rate),))
        for rate in FAULT_RATES
        for kind in RANDOM_KINDS
    ]
    # A wire's first late answer counts as lost. The number of late answers after it matters, which needs more cycles.
    late = [FaultCase(f"late {rate:.0%}", (PlannedFault("late", rate=rate),), cycles=1500) for rate in FAULT_RATES]
    alerts = [
        FaultCase(f"alert {error.name.lower()}", (PlannedFault("alert", (2,), start=FAULT_START, value=error.value),))
        for error in HardwareError
    ]
    return (
        FaultCase("calm"),
        *rates,
        *late,
        FaultCase("mixed 6 x 2%", tuple(PlannedFault(kind, rate=0.02) for kind in RANDOM_KINDS)),
        FaultCase("requests lost 1%", (PlannedFault("lost", rate=0.01, way="request"),)),
        FaultCase("silent", (PlannedFault("silent", (2,), start=FAULT_START),)),
        FaultCase("reboot", (PlannedFault("reboot", (2,), start=FAULT_START),)),
        *alerts,
        FaultCase(
            "overheat", (PlannedFault("overheat", (2,), start=0.1, seconds=1.5, value=60.0),)
        ),  # heats up to 115 C
        FaultCase("undervoltage", (PlannedFault("undervoltage", start=FAULT_START, seconds=0.5, value=8.0),)),
        FaultCase("watchdog", (PlannedFault("watchdog", (2,), start=FAULT_START),)),
        FaultCase("unplug", tuple(PlannedFault("unplug", start=FAULT_START + k, seconds=0.2) for k in range(2))),
        FaultCase("duplicate id", (PlannedFault("duplicate_id", (2,)),)),
        FaultCase("wrong model", (PlannedFault("wrong_model", (2,)),)),
        FaultCase("old firmware", (PlannedFault("old_firmware"),)),
    )


def run_trial(
    case: FaultCase, make_driver: DriverFactory, *, servos: int, baud: int, seed: int, cycles: int | None = None
) -> TrialResult:
    """Drive virtual servos through one fault case with one driver.

    Args:
        case: fault and length of the trial.
        make_driver: returns the driver for an open wire, the servos and the period [s].
        servos: number of servos.
        baud: baud rate [bit/s].
        seed: seed of random faults.
        cycles: number of cycles, one per period or as fast as the driver can; default: the number of the case.
    """
    plan = FaultPlan(case.faults, seed)
    fittings = tuple(ServoFitting(servo, model=case.model) for servo in range(1, servos + 1))
    built = FaultPlan(plan.of(BUILD_KINDS), seed)
    plant, buses = build_bus([Cable("trial", fittings, baud=baud, faults=built)])
    bus = buses["trial"]
    wire = MemoryWire(bus)
    period = max(
        BUS_PERIOD, PERIOD_MARGIN * _compute_min_cycle_time(servos, baud, fast=not plan.of(frozenset({"old_firmware"})))
    )
    try:
        driver = make_driver(wire, [Servo(fitting.servo, SERVO_MODELS[case.model]) for fitting in fittings], period)
    except BusError as error:
        return TrialResult(case.name, servos, baud, seed, period, refused=str(error).splitlines()[0])
    bus.advance(wire.now())
    for servo in plant.servos:
        servo.write(Register.TORQUE_ENABLE.field.address, b"\1")
    bus.expose(
        FaultPlan(tuple(m for m in plan.faults if m.kind not in BUILD_KINDS), seed) if case.faults else NO_FAULTS
    )
    return _TrialObserver(case, plant, bus, wire, period).drive(driver, cycles or case.cycles, baud, seed)


def _compute_min_cycle_time(servos: int, baud: int, *, fast: bool) -> float:
    """Return the shortest possible bus cycle [s] with full servo records.

    A cycle writes 14 + 5 n bytes, requests 14 + n and reads 8 + 22 n bytes (fast) or 29 n bytes.
    """
    octets = 36 + 28 * servos if fast else 28 + 35 * servos
    return octets * 10 / baud + 0.001


class _TrialObserver:
    """Observer that knows the servos' true positions in a fault trial."""

    def __init__(
        self, case: FaultCase, plant: ShaftSimulation, bus: VirtualBus, wire: MemoryWire, period: float
    ) -> None:
        self._case, self._plant, self._bus, self._wire, self._period = case, plant, bus, wire, period
        self._truth: deque[tuple[float, Ticks]] = deque()
        self._began = wire.now()

    def drive(self, driver: Driver, cycles: int, baud: int, seed: int) -> TrialResult:
        """Run the bus cycles of the motion and return the trial's result."""
        wire, starts = self._wire, self._read_true_positions()
        exceptions = wrong = prompt = later = able = 0
        missed = np.zeros(len(starts), dtype=np.int64)  # cycles without a position, per servo
        oldest, reported, failed, durations = 0.0, None, None, []
        for k in range(cycles):
            wire.sleep(self._began + k * self._period)
            begun = wire.now()
            able += self._count_able(begun)
            goals = self._goals(starts, begun - self._began)
            self._record_truth(begun)
            if failed is None and self._has_error():
                failed = begun
            try:
                reading = driver.cycle(goals)
            except (OSError, LookupError, ValueError, TypeError):
                exceptions += 1
                reading = None
            ended = wire.now()
            durations.append(ended - begun)
            self._record_truth(ended)
            if reading is None:
                continue
            wrong += self._count_wrong(reading)
            prompt += int(reading.fresh.sum())
            belated = reading.late & (missed > 0)
            later += int(belated.sum())
            missed += ~reading.fresh
            missed -= belated
            is_recent = reading.times > begun - 10.0
            oldest = max([oldest, *(ended - reading.times[is_recent]).tolist()])
            if reported is None and reading.alerts.any():
                reported = ended - (begun if failed is None else failed)
        return TrialResult(
            case=self._case.name,
            servos=len(starts),
            baud=baud,
            seed=seed,
            period=self._period,
            exceptions=exceptions,
            wrong=wrong,
            fresh=(prompt + later) / max(able, 1),
            prompt=prompt / max(able, 1),
            oldest=oldest,
            durations=np.array(durations),
            reported=reported,
        )

    def _goals(self, starts: Ticks, time: float) -> Ticks:
        phases = 2 * np.pi * (time / MOTION_PERIOD + np.arange(len(starts)) / len(starts))
        moved = MOTION_AMPLITUDE * (np.sin(phases) - np.sin(phases - 2 * np.pi * time / MOTION_PERIOD))
        goals: Ticks = np.rint(starts + moved).astype(np.int64)
        return goals

    def _count_able(self, time: float) -> int:
        if not self._bus.plugged(time):
            return 0
        return sum(servo.electronics.up and not servo.mute for servo in self._plant.servos)

    def _has_error(self) -> bool:
        return any(servo.electronics.alert for servo in self._plant.servos)

    def _read_true_positions(self) -> Ticks:
        """Return the true servo positions in register ticks, shape (n,)."""
        return np.array([servo.electronics.present_position() for servo in self._plant.servos], dtype=np.int64)

    def _record_truth(self, time: float) -> None:
        """Record the true positions and drop positions too old to be compared."""
        self._plant.advance(time)
        self._truth.append((time, self._read_true_positions()))
        while self._truth[0][0] < time - 20 * self._period - 2 * TIME_TOLERANCE:
            self._truth.popleft()

    def _count_wrong(self, reading: DriverReading) -> int:
        """Count read positions that were never true near their timestamps.

        Positions older than the recorded history are not judged.
        """
        first = self._truth[0][0]
        wrong = 0
        for servo in np.flatnonzero(reading.times >= first).tolist():
            time = reading.times[servo]
            truth = [
                positions[servo] for when, positions in self._truth if abs(when - time) <= TIME_TOLERANCE + self._period
            ]
            reading_position = reading.positions[servo]
            wrong += not min(truth) - POSITION_TOLERANCE <= reading_position <= max(truth) + POSITION_TOLERANCE
        return wrong


def run_matrix(
    make_driver: DriverFactory, *, sizes: Sequence[int], bauds: Sequence[int], seeds: Sequence[int]
) -> Iterator[TrialResult]:
    """Yield the result per fault case, servo count, baud rate and seed."""
    for case in list_cases():
        for servos in sizes:
            for baud in bauds:
                for seed in seeds:
                    yield run_trial(case, make_driver, servos=servos, baud=baud, seed=seed)
