"""Measures the bus: how near it comes to what the wire allows, and what it costs the host."""

# The wire keeps virtual time. The driver first talks to virtual servos, then once more to a recording of what they
# answered, so that host time is that of the driver alone. What the driver costs in real time is measured on a
# pseudo-terminal whose servos live in another process.

import multiprocessing
import tempfile
import time
from multiprocessing.synchronize import Event
from pathlib import Path
from statistics import median

import numpy as np

from kinesic.bench.bus.supervisor import measure_supervisor
from kinesic.bench.figure import Figure
from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus, Servo
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.models import MODELS
from kinesic.hardware.protocol.servo_map import MID_TICKS
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.virtual.bus import VirtualBus
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

COUNTS = (7, 14, 20, 26)
BAUDS = (57_600, 1_000_000, 2_000_000, 4_000_000)
MODEL = "xm430_w350"
CYCLES, PASSES = 200, 5
UNIT = "% of a core"
RATE_GOAL, HEALTH_GOAL, CPU_GOAL = 95.0, 100.0, 10.0  # [%], [Hz], [%]
FLAT_OUT = 1e-4  # [s] period of a bus that has no time to spare
SWING = 50  # [ticks] that goals move to and fro
REAL_COUNT, REAL_BAUD, REAL_PERIOD, REAL_SECONDS = 14, 1_000_000, 0.01, 3.0
PATIENCE = 20.0  # [s] for the other process to begin


class Recorder(MemoryWire):
    """A wire that remembers its times, and what it brought."""

    def __init__(self, bus: VirtualBus) -> None:
        super().__init__(bus)
        self.times: list[float] = []
        self.chunks: list[bytes] = []

    def now(self) -> float:
        """As a wire in memory."""
        self.times.append(super().now())
        return self.times[-1]

    def read(self, deadline: float, /) -> bytes:
        """As a wire in memory."""
        self.chunks.append(super().read(deadline))
        return self.chunks[-1]


class RecordingWire:
    """A wire that repeats a recording, whatever is asked."""

    def __init__(self, recorder: Recorder) -> None:
        self.name, self.baud = recorder.name, recorder.baud
        self._times, self._chunks = iter(recorder.times), iter(recorder.chunks)

    def now(self) -> float:
        """As it was."""
        return next(self._times)

    def write(self, data: bytes | bytearray, /) -> None:
        """Discards the bytes: the answers are recorded."""

    def read(self, _deadline: float, /) -> bytes:
        """As it was."""
        return next(self._chunks)

    def sleep(self, until: float, /) -> None:
        """Returns at once: recorded times need no waiting."""

    def reopen(self) -> bool:
        """Reports that the port is there."""
        return True

    def close(self) -> None:
        """Nothing to give back."""


def bench() -> list[Figure]:
    """Measures the rate for every number of servos and baud rate, and the load of a loop at 100 Hz."""
    figures = []
    for count in COUNTS:
        for baud in BAUDS:
            wire_s, host_s = cycle_times(count, baud)
            share = 100 * wire_s / (wire_s + host_s)
            figures.append(Figure(f"bus.rate_{count}_servos_{baud}_baud", share, "%", RATE_GOAL, "higher"))
            if (count, baud) == (26, 1_000_000):
                hertz = 1 / (wire_s + host_s)
                figures.append(Figure("bus.rate_full_health", hertz, "Hz", HEALTH_GOAL, "higher"))
    with tempfile.TemporaryDirectory() as folder:
        figures += cpu_load(Path(folder) / "port")
    return figures


def cycle_times(count: int, baud: int) -> tuple[float, float]:
    """Measures what a cycle with goals and full records takes on the wire, and of the host.

    Args:
        count: of servos.
        baud: [bit/s].

    Returns:
        Wire time with 1 ms USB latency, and CPU time of the driver [s], medians.
    """
    _, buses = build_bus([_cable(count, baud)])
    recorder = Recorder(buses["bench"])
    servos = open_bus(recorder, _servos(count)).servos
    recorder.times.clear()
    recorder.chunks.clear()
    driver = Bus(recorder, servos, period=FLAT_OUT)
    wire = [driver.cycle(goals).duration for goals in _goals(count)]
    host: list[float] = []
    for _ in range(PASSES):
        driver = Bus(RecordingWire(recorder), servos, period=FLAT_OUT)
        for goals in _goals(count):
            began = time.process_time()
            driver.cycle(goals)
            host.append(time.process_time() - began)
    return median(wire), median(host)


def _goals(count: int) -> list[Ticks]:
    swing = np.rint(SWING * np.sin(np.arange(CYCLES) / 20)).astype(np.int64)
    return list(MID_TICKS + swing[:, None] + np.arange(count))


def _cable(count: int, baud: int) -> Cable:
    return Cable("bench", tuple(ServoFitting(k + 1, model=MODEL) for k in range(count)), baud=baud)


def _servos(count: int) -> list[Servo]:
    return [Servo(k + 1, MODELS[MODEL]) for k in range(count)]


def cpu_load(link: Path) -> list[Figure]:
    """Measures CPU shares of a loop at 100 Hz and of the whole supervisor, system calls included."""
    names = [f"bus.cpu_{REAL_COUNT}_servos", f"bus.cpu_supervisor_{REAL_COUNT}_servos"]
    shares: list[float | None] = [None, None]
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    servos = context.Process(target=_serve, args=(str(link), stop), daemon=True)
    servos.start()
    try:
        if _appears(link):
            wire = SerialWire(link, REAL_BAUD)
            loop = _share_of_core(open_bus(wire, _servos(REAL_COUNT), period=REAL_PERIOD))
            wire.close()
            whole = measure_supervisor(
                link, model=MODEL, count=REAL_COUNT, baud=REAL_BAUD, period=REAL_PERIOD, seconds=REAL_SECONDS
            )
            shares = [loop, whole]
    finally:
        stop.set()
        servos.join()
    return [
        Figure(name, None, UNIT, CPU_GOAL, "lower", why="the virtual servos did not start")
        if share is None
        else Figure(name, 100 * share, UNIT, CPU_GOAL, "lower")
        for name, share in zip(names, shares, strict=True)
    ]


def _share_of_core(driver: Bus) -> float:
    goals = np.full(REAL_COUNT, MID_TICKS)
    began, cpu = time.monotonic(), time.process_time()
    for k in range(round(REAL_SECONDS / REAL_PERIOD)):
        driver.cycle(goals)
        driver.wire.sleep(began + (k + 1) * REAL_PERIOD)
    return (time.process_time() - cpu) / (time.monotonic() - began)


def _serve(link: str, stop: Event) -> None:
    """The other process: virtual servos on a pseudo-terminal, until told to stop."""
    _, buses = build_bus([_cable(REAL_COUNT, REAL_BAUD)])
    serve_wires([PtyPort(buses["bench"], Path(link))], lambda: not stop.is_set())


def _appears(link: Path) -> bool:
    limit = time.monotonic() + PATIENCE
    while not link.exists() and time.monotonic() < limit:
        time.sleep(0.01)
    return link.exists()
