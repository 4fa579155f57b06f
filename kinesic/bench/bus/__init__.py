"""Benchmark of the servo bus: cycle rates and CPU load.

It measures cycle rate compared with the wire's limit, and CPU load of the host.
"""

# The wire keeps virtual time. The driver first talks to virtual servos and then to a recording of their answers, so
# that the measured host time is that of the driver alone. The CPU load in real time is measured on a pseudo-terminal
# with virtual servos in another process.

import multiprocessing
import tempfile
import time
from multiprocessing.synchronize import Event
from pathlib import Path
from statistics import median

import numpy as np

from kinesic.bench.bus.supervisor import measure_supervisor
from kinesic.bench.metric import Metric
from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.servo_map import MID_TICKS
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.virtual.bus import VirtualBus
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

SERVO_COUNTS = (7, 14, 20, 26)  # numbers of servos on the measured bus
BAUD_RATES = (57_600, 1_000_000, 2_000_000, 4_000_000)  # [bit/s] measured baud rates of the bus
SERVO_MODEL = "xm430_w350"  # model of all virtual servos
CYCLE_COUNT = 200  # bus cycles per measurement
REPLAY_COUNT = 5  # replays of one recording
LOAD_UNIT = "% of a core"  # unit of CPU load metrics
MIN_RATE = 95.0  # [%] goal for the cycle rate / highest rate that the wire allows
MIN_HEALTH_RATE = 100.0  # [Hz] goal for the cycle rate with full records of 26 servos at 1 Mbaud
MAX_CPU_LOAD = 10.0  # [% of a core] goal of the driver's CPU load
SHORTEST_PERIOD = 1e-4  # [s] cycle period so short that the bus never pauses
GOAL_AMPLITUDE = 50  # [ticks] amplitude of the sinusoidal servo goals
REAL_COUNT = 14  # number of servos in the real-time measurement
REAL_BAUD = 1_000_000  # [bit/s] baud rate of the real-time measurement
REAL_PERIOD = 0.01  # [s] bus cycle period of the real-time measurement
REAL_SECONDS = 3.0  # [s] duration of the real-time measurement
START_TIMEOUT = 20.0  # [s] time limit for the server process of virtual servos to start


class RecordingWire(MemoryWire):
    """A wire that records its clock readings and received bytes."""

    def __init__(self, bus: VirtualBus) -> None:
        super().__init__(bus)
        self.times: list[float] = []
        self.chunks: list[bytes] = []

    def now(self) -> float:
        """Return the wire's time [s] and record it."""
        self.times.append(super().now())
        return self.times[-1]

    def read(self, deadline: float, /) -> bytes:
        """Read from the wire and record the bytes."""
        self.chunks.append(super().read(deadline))
        return self.chunks[-1]


class ReplayWire:
    """A wire that replays a recording regardless of the bytes written."""

    def __init__(self, recorder: RecordingWire) -> None:
        self.name, self.baud = recorder.name, recorder.baud
        self._times, self._chunks = iter(recorder.times), iter(recorder.chunks)

    def now(self) -> float:
        """Return the next recorded time [s]."""
        return next(self._times)

    def write(self, data: bytes | bytearray, /) -> None:
        """Discard bytes written to the replayed wire.

        The answers are recorded.
        """

    def read(self, _deadline: float, /) -> bytes:
        """Return the next recorded bytes."""
        return next(self._chunks)

    def sleep(self, until: float, /) -> None:
        """Return at once without sleeping.

        Recorded times need no waiting.
        """

    def reopen(self) -> bool:
        """Return True: a replayed wire never disconnects.

        The port is always there.
        """
        return True

    def close(self) -> None:
        """Do nothing: a replayed wire holds no resource."""


def bench() -> list[Metric]:
    """Measure cycle rates and CPU load of the bus."""
    metrics = []
    for count in SERVO_COUNTS:
        for baud in BAUD_RATES:
            wire_s, host_s = cycle_times(count, baud)
            rate = 100 * wire_s / (wire_s + host_s)
            metrics.append(Metric(f"bus.rate_{count}_servos_{baud}_baud", rate, "%", MIN_RATE, "higher"))
            if (count, baud) == (26, 1_000_000):
                hertz = 1 / (wire_s + host_s)
                metrics.append(Metric("bus.rate_full_health", hertz, "Hz", MIN_HEALTH_RATE, "higher"))
    with tempfile.TemporaryDirectory() as folder:
        metrics += cpu_load(Path(folder) / "port")
    return metrics


def cycle_times(count: int, baud: int) -> tuple[float, float]:
    """Measure transmission time and CPU time of a bus cycle.

    Args:
        count: number of servos.
        baud: baud rate [bit/s].

    Returns:
        Median time on the virtual wire with 1 ms USB latency, and median CPU time of the driver [s].
    """
    _, buses = build_bus([_cable(count, baud)])
    recorder = RecordingWire(buses["bench"])
    servos = open_bus(recorder, _servos(count)).servos
    recorder.times.clear()
    recorder.chunks.clear()
    driver = Bus(recorder, servos, period=SHORTEST_PERIOD)
    wire = [driver.cycle(goals).duration for goals in _goals(count)]
    host: list[float] = []
    for _ in range(REPLAY_COUNT):
        driver = Bus(ReplayWire(recorder), servos, period=SHORTEST_PERIOD)
        for goals in _goals(count):
            began = time.process_time()
            driver.cycle(goals)
            host.append(time.process_time() - began)
    return median(wire), median(host)


def _goals(count: int) -> list[Ticks]:
    swing = np.rint(GOAL_AMPLITUDE * np.sin(np.arange(CYCLE_COUNT) / 20)).astype(np.int64)
    return list(MID_TICKS + swing[:, None] + np.arange(count))


def _cable(count: int, baud: int) -> Cable:
    return Cable("bench", tuple(ServoFitting(k + 1, model=SERVO_MODEL) for k in range(count)), baud=baud)


def _servos(count: int) -> list[Servo]:
    return [Servo(k + 1, SERVO_MODELS[SERVO_MODEL]) for k in range(count)]


def cpu_load(link: Path) -> list[Metric]:
    """Measure the CPU load of the 100 Hz loop and the supervisor.

    System calls are included.
    """
    names = [f"bus.cpu_{REAL_COUNT}_servos", f"bus.cpu_supervisor_{REAL_COUNT}_servos"]
    fractions: list[float | None] = [None, None]
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    servos = context.Process(target=_serve, args=(str(link), stop), daemon=True)
    servos.start()
    try:
        if _wait_for_link(link):
            wire = SerialWire(link, REAL_BAUD)
            loop = _measure_loop_load(open_bus(wire, _servos(REAL_COUNT), period=REAL_PERIOD))
            wire.close()
            whole = measure_supervisor(
                link, model=SERVO_MODEL, count=REAL_COUNT, baud=REAL_BAUD, period=REAL_PERIOD, seconds=REAL_SECONDS
            )
            fractions = [loop, whole]
    finally:
        stop.set()
        servos.join()
    return [
        Metric(name, None, LOAD_UNIT, MAX_CPU_LOAD, "lower", why="the virtual servos did not start")
        if fraction is None
        else Metric(name, 100 * fraction, LOAD_UNIT, MAX_CPU_LOAD, "lower")
        for name, fraction in zip(names, fractions, strict=True)
    ]


def _measure_loop_load(driver: Bus) -> float:
    goals = np.full(REAL_COUNT, MID_TICKS)
    began, cpu = time.monotonic(), time.process_time()
    for k in range(round(REAL_SECONDS / REAL_PERIOD)):
        driver.cycle(goals)
        driver.wire.sleep(began + (k + 1) * REAL_PERIOD)
    return (time.process_time() - cpu) / (time.monotonic() - began)


def _serve(link: str, stop: Event) -> None:
    """Serve virtual servos on a pseudo-terminal until `stop` is set.

    Runs in the other process.
    """
    _, buses = build_bus([_cable(REAL_COUNT, REAL_BAUD)])
    serve_wires([PtyPort(buses["bench"], Path(link))], lambda: not stop.is_set())


def _wait_for_link(link: Path) -> bool:
    limit = time.monotonic() + START_TIMEOUT
    while not link.exists() and time.monotonic() < limit:
        time.sleep(0.01)
    return link.exists()
