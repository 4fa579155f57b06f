"""Runs the fault matrix: the same motion under each fault, for any driver, on the same virtual wire in virtual time.

The host's own computing takes no virtual time: what a cycle lasts is what the wire and the driver's waiting last.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from kinesic.bench.bus.drivers import Driver, DriverReading
from kinesic.body.arrays import Floats
from kinesic.hardware.bus.bus import Servo
from kinesic.hardware.protocol.models import MODELS
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.virtual.bus import VirtualBus
from kinesic.hardware.virtual.faults import BUILD_KINDS, CALM, FaultPlan, Kind, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

MODEL = "xm430_w350"
PERIOD = 0.01  # [s]
AMPLITUDE, TURN = 200, 2.0  # [ticks], [s] of the motion
TOLERANCE = 3  # [ticks] within which a position is true
MEMORY = 0.01  # [s] more than a period, around a position's time, in which it must have been true
ROOM = 1.25  # times what the wire needs that a period is at least
STRIKE = 0.5  # [s] of motion before the faults that have a time
RATES = (0.01, 0.05)
MIXED: tuple[Kind, ...] = ("corrupt", "drop", "truncate", "duplicate", "noise", "lost")

Opens = Callable[[Wire, Sequence[Servo], float], Driver]


@dataclass(frozen=True)
class FaultCase:
    """What goes wrong in a trial."""

    name: str
    faults: tuple[PlannedFault, ...] = ()
    cycles: int = 300  # of a trial


@dataclass(frozen=True, eq=False)
class TrialResult:
    """What a driver did under one fault."""

    case: str
    servos: int
    baud: int
    seed: int
    period: float  # [s]
    refused: str = ""  # why it would not drive these servos
    exceptions: int = 0
    wrong: int = 0  # positions given as true that never were
    fresh: float = 0.0  # share of the positions that servos could give which came, be it late but with their time
    prompt: float = 0.0  # share that came in the cycle that asked for them
    oldest: float = 0.0  # [s] of a position at the end of its cycle
    durations: Floats = field(default_factory=lambda: np.zeros(1))  # (m,) [s] of the cycles
    reported: float | None = (
        None  # [s] from the begin of the first cycle with a hardware error until its report; None: never
    )

    def duration(self, percent: float) -> float:
        """Returns a percentile of the cycles' durations [s]."""
        return float(np.percentile(self.durations, percent))


def cases() -> tuple[FaultCase, ...]:
    """Lists the faults of the matrix that a bus alone can meet."""
    rates = [FaultCase(f"{kind} {rate:.0%}", (PlannedFault(kind, rate=rate),)) for rate in RATES for kind in MIXED]
    # the first late answer of a wire is taken for a lost one: what matters is how many follow
    late = [FaultCase(f"late {rate:.0%}", (PlannedFault("late", rate=rate),), cycles=1500) for rate in RATES]
    alerts = [
        FaultCase(f"alert {error.name.lower()}", (PlannedFault("alert", (2,), start=STRIKE, value=error.value),))
        for error in HardwareError
    ]
    return (
        FaultCase("calm"),
        *rates,
        *late,
        FaultCase("mixed 6 x 2%", tuple(PlannedFault(kind, rate=0.02) for kind in MIXED)),
        FaultCase("requests lost 1%", (PlannedFault("lost", rate=0.01, way="request"),)),
        FaultCase("silent", (PlannedFault("silent", (2,), start=STRIKE),)),
        FaultCase("reboot", (PlannedFault("reboot", (2,), start=STRIKE),)),
        *alerts,
        FaultCase("overheat", (PlannedFault("overheat", (2,), start=0.1, seconds=1.5, value=60.0),)),  # to 115 C
        FaultCase("undervoltage", (PlannedFault("undervoltage", start=STRIKE, seconds=0.5, value=8.0),)),
        FaultCase("watchdog", (PlannedFault("watchdog", (2,), start=STRIKE),)),
        FaultCase("unplug", tuple(PlannedFault("unplug", start=STRIKE + k, seconds=0.2) for k in range(2))),
        FaultCase("duplicate id", (PlannedFault("duplicate_id", (2,)),)),
        FaultCase("wrong model", (PlannedFault("wrong_model", (2,)),)),
        FaultCase("old firmware", (PlannedFault("old_firmware"),)),
    )


def trial(
    case: FaultCase, opens: Opens, *, servos: int, baud: int, seed: int, cycles: int | None = None
) -> TrialResult:
    """Drives virtual servos through a fault.

    Args:
        case: the fault.
        opens: makes the driver from an open wire, the servos and the period [s].
        servos: how many.
        baud: [bit/s].
        seed: of the faults.
        cycles: how many, one each period or as fast as the driver can; by default the case's.
    """
    plan = FaultPlan(case.faults, seed)
    fittings = tuple(ServoFitting(servo, model=MODEL) for servo in range(1, servos + 1))
    built = FaultPlan(plan.of(BUILD_KINDS), seed)
    plant, buses = build_bus([Cable("trial", fittings, baud=baud, faults=built)])
    bus = buses["trial"]
    wire = MemoryWire(bus)
    period = max(PERIOD, ROOM * _ideal(servos, baud, fast=not plan.of(frozenset({"old_firmware"}))))
    try:
        driver = opens(wire, [Servo(fitting.servo, MODELS[MODEL]) for fitting in fittings], period)
    except BusError as error:
        return TrialResult(case.name, servos, baud, seed, period, refused=str(error).splitlines()[0])
    bus.advance(wire.now())
    for servo in plant.servos:
        servo.write(Register.TORQUE_ENABLE.field.address, b"\1")
    bus.expose(FaultPlan(tuple(m for m in plan.faults if m.kind not in BUILD_KINDS), seed) if case.faults else CALM)
    return _Watch(case, plant, bus, wire, period).drive(driver, cycles or case.cycles, baud, seed)


def _ideal(servos: int, baud: int, *, fast: bool) -> float:
    """[s] of a cycle with the full record of every servo: 14 + 5 n, 14 + n, and 8 + 22 n or 29 n bytes."""
    octets = 36 + 28 * servos if fast else 28 + 35 * servos
    return octets * 10 / baud + 0.001


class _Watch:
    """Looks over a driver's shoulder: it knows where the servos really are."""

    def __init__(
        self, case: FaultCase, plant: ShaftSimulation, bus: VirtualBus, wire: MemoryWire, period: float
    ) -> None:
        self._case, self._plant, self._bus, self._wire, self._period = case, plant, bus, wire, period
        self._truth: deque[tuple[float, Ticks]] = deque()
        self._began = wire.now()

    def drive(self, driver: Driver, cycles: int, baud: int, seed: int) -> TrialResult:
        """Drives a motion of so many cycles."""
        wire, starts = self._wire, self._places()
        exceptions = wrong = prompt = later = able = 0
        owed = np.zeros(len(starts), dtype=np.int64)  # cycles that have not brought a position
        oldest, reported, failed, durations = 0.0, None, None, []
        for k in range(cycles):
            wire.sleep(self._began + k * self._period)
            begun = wire.now()
            able += self._count_able(begun)
            goals = self._goals(starts, begun - self._began)
            self._remember(begun)
            if failed is None and self._has_error():
                failed = begun
            try:
                reading = driver.cycle(goals)
            except (OSError, LookupError, ValueError, TypeError):
                exceptions += 1
                reading = None
            ended = wire.now()
            durations.append(ended - begun)
            self._remember(ended)
            if reading is None:
                continue
            wrong += self._count_wrong(reading)
            prompt += int(reading.fresh.sum())
            belated = reading.late & (owed > 0)
            later += int(belated.sum())
            owed += ~reading.fresh
            owed -= belated
            known = reading.times > begun - 10.0
            oldest = max([oldest, *(ended - reading.times[known]).tolist()])
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
        phases = 2 * np.pi * (time / TURN + np.arange(len(starts)) / len(starts))
        moved = AMPLITUDE * (np.sin(phases) - np.sin(phases - 2 * np.pi * time / TURN))
        goals: Ticks = np.rint(starts + moved).astype(np.int64)
        return goals

    def _count_able(self, time: float) -> int:
        if not self._bus.plugged(time):
            return 0
        return sum(servo.electronics.up and not servo.mute for servo in self._plant.servos)

    def _has_error(self) -> bool:
        return any(servo.electronics.alert for servo in self._plant.servos)

    def _places(self) -> Ticks:
        """(n,) where the servos are, in their registers' ticks."""
        return np.array([servo.electronics.here() for servo in self._plant.servos], dtype=np.int64)

    def _remember(self, time: float) -> None:
        """Keeps where they are, as long as somebody may rightly say so."""
        self._plant.advance(time)
        self._truth.append((time, self._places()))
        while self._truth[0][0] < time - 20 * self._period - 2 * MEMORY:
            self._truth.popleft()

    def _count_wrong(self, reading: DriverReading) -> int:
        """Positions that were not true around the time that is given for them; very old ones are not judged."""
        first = self._truth[0][0]
        lies = 0
        for place in np.flatnonzero(reading.times >= first).tolist():
            time = reading.times[place]
            near = [there[place] for when, there in self._truth if abs(when - time) <= MEMORY + self._period]
            said = reading.positions[place]
            lies += not min(near) - TOLERANCE <= said <= max(near) + TOLERANCE
        return lies


def matrix(opens: Opens, *, sizes: Sequence[int], bauds: Sequence[int], seeds: Sequence[int]) -> Iterator[TrialResult]:
    """Runs all cases, sizes, rates and seeds for one driver."""
    for case in cases():
        for servos in sizes:
            for baud in bauds:
                for seed in seeds:
                    yield trial(case, opens, servos=servos, baud=baud, seed=seed)
