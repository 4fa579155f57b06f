"""Shared memory between planner and supervisor.

Commands and requests go one way, status and events the other. Each word has one writer, except requests. A row is
complete when its CRC matches, in any memory order of the processor. Rows are numbered, so that neither side waits. The
memory has no name and disappears with both processes.
"""

import mmap
import os
import sys
import tempfile
from dataclasses import dataclass, field
from math import nan
from operator import attrgetter
from typing import get_args

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.notes import TEXT_SIZE, Note, join_notes, split_note
from kinesic.hardware.supervisor.ring_rows import Rows, load_row, store_row
from kinesic.hardware.supervisor.settings import Policy
from kinesic.hardware.supervisor.state_machine import Awaited, Stage

COMMAND_CAPACITY = 16_384  # Largest number of commands in the ring buffer, more than two minutes at 100 Hz
EVENT_CAPACITY = 512  # Largest number of events in the ring buffer
STATUS_CAPACITY = 4096  # largest number of statuses in the ring buffer, more than half a minute at 100 Hz
TELEMETRY_CAPACITY = 8  # Largest number of telemetry rows in the ring buffer
CAP_CAPACITY = 4  # largest number of caps in the ring buffer
MAX_TELEMETRY_SERVOS = 256  # Largest number of servos in a telemetry row
MEMORY_NAME = "kinesic"  # name of the shared memory in /proc/PID/fd
PACE_STEPS = 1000  # Resolution of the requested time scale, in steps from 0 to 1
READ_ATTEMPTS = 50  # Attempts to read a ring row that is being written
STAGE_VALUES = tuple(Stage)  # stages by their number in the shared memory
STOP_POLICIES: tuple[Policy, ...] = ("hold", "limp")  # policies by their number in the shared memory, from 1 on
AWAITED_VALUES: tuple[Awaited, ...] = get_args(Awaited)  # awaited inputs by their number in the shared memory
_WORD_NAMES = (
    "written",
    "read",
    "ended",
    "release",
    "estop",
    "resume",
    "confirm",
    "pace",
    "noted",
    "cycles",
    "tellings",
    "capped",
)
_WORD_OFFSETS = {name: place for place, name in enumerate(_WORD_NAMES)}  # word name -> index in the shared memory


def _no_values() -> Floats:
    return sealed([])


@dataclass(frozen=True, eq=False)
class Status:
    """State of the supervisor and its servos in one cycle."""

    stage: Stage = Stage.CLOSED
    clock: float = 0.0  # [s] monotonic clock of the machine at this status
    time: float = nan  # [s] performance time; NaN before the first command
    scale: float = 0.0  # rate of performance time relative to real time
    energised: int = 0  # number of servos with torque
    hottest: float = 0.0  # [C] temperature of the hottest servo
    volts: float = 0.0  # [V] lowest supply voltage of all servos
    silent: int = 0  # number of servos that have not answered recently
    late: int = 0  # number of cycles that began more than a period late
    faulty: bool = False
    waits: Awaited = "nothing"  # input that the supervisor waits for
    angles: Floats = field(default_factory=_no_values)  # (n,) [rad] measured; NaN for a silent servo
    setpoints: Floats = field(default_factory=_no_values)  # (n,) [rad] joint angles sent to the servos as goals
    taken: Floats = field(default_factory=_no_values)  # (n,) [s] clock time of each angle; NaN for a silent servo

    def time_at(self, clock: float) -> float:
        """Extrapolate the performance time [s] to a slightly later clock time [s]."""
        return self.time + self.scale * (clock - self.clock)


class Channel:
    """Reader and writer of the memory shared by planner and supervisor."""

    def __init__(self, memory: mmap.mmap, joints: int, capacity: int = COMMAND_CAPACITY) -> None:
        """Use memory of `memory_size(joints, capacity)` bytes, initially zero."""
        self.capacity, self._memory = capacity, memory
        self._commands = _command(joints)
        start = 8 * len(_WORD_NAMES)
        self._words = memoryview(memory)[:start].cast("Q")
        self._status: Rows = np.frombuffer(memory, _status(joints), STATUS_CAPACITY, start)
        start += self._status.nbytes
        self._events: Rows = np.frombuffer(memory, _EVENT_DTYPE, EVENT_CAPACITY, start)
        start += self._events.nbytes
        self._ring: Rows = np.frombuffer(memory, self._commands, capacity, start)
        self._telemetry: Rows = np.frombuffer(memory, _TELEMETRY_DTYPE, TELEMETRY_CAPACITY, start + self._ring.nbytes)
        start += self._ring.nbytes + self._telemetry.nbytes
        self._caps: Rows = np.frombuffer(memory, _caps(joints), CAP_CAPACITY, start)
        self._taken = self._noted = self._seen = self._capped = 0  # counts of rows that this side has read

    def word(self, name: str) -> int:
        """Read a counter or request word of the shared memory."""
        return self._words[_WORD_OFFSETS[name]]

    def set(self, name: str, value: int) -> None:
        """Set a counter or request word of the shared memory."""
        self._words[_WORD_OFFSETS[name]] = value

    def stop(self, policy: Policy) -> None:
        """Request an emergency stop."""
        self.set("estop", STOP_POLICIES.index(policy) + 1)

    def slow_to(self, pace: float) -> None:
        """Request an upper limit of the time scale, 0..1."""
        self.set("pace", 1 + round(PACE_STEPS * pace))

    @property
    def room(self) -> int:
        """Free space in the command buffer [commands]."""
        return self.capacity - (self.word("written") - self.word("read"))

    def write(self, time: float, goals: Floats, leads: Floats | float = 0.0) -> bool:
        """Add a planner command, and return whether the channel had space.

        Args:
            time: [s] performance time.
            goals: (n,) [rad] setpoints.
            leads: (n,) [rad] feed-forward of the planned velocity in them, which shrinks while time is slowed down.
        """
        if self.room <= 0:
            return False
        number = self.word("written")
        store_row(self._ring, number % self.capacity, number + 1, time, goals, leads)
        self.set("written", number + 1)
        return True

    def commands(self, most: int) -> list[tuple[float, Floats, Floats]]:
        """Remove and return at most `most` new commands, for the supervisor.

        Returns:
            Times [s], setpoints and their feed-forward offsets (n,) [rad].
        """
        new_commands: list[tuple[float, Floats, Floats]] = []
        while self._taken < self.word("written") and len(new_commands) < most:
            row = load_row(self._ring, self._taken % self.capacity, self._taken + 1)
            if row is None:
                break
            new_commands.append((float(row["time"]), sealed(row["goals"]), sealed(row["leads"])))
            self._taken += 1
        if new_commands:
            self.set("read", self._taken)
        return new_commands

    def write_caps(self, caps: ServoCaps) -> None:
        """Add caps of velocity and power, which replace earlier ones."""
        number = self.word("capped")
        store_row(self._caps, number % CAP_CAPACITY, number + 1, caps.velocities, caps.duties, caps.holding)
        self.set("capped", number + 1)

    def caps(self) -> ServoCaps | None:
        """Return the latest caps if they are new, for the supervisor."""
        number = self.word("capped")
        row = load_row(self._caps, (number - 1) % CAP_CAPACITY, number) if number > self._capped else None
        if row is None:
            return None
        self._capped = number
        return ServoCaps(*(sealed(row[name]) for name in _CAP_VECTORS))

    def write_status(self, status: Status) -> None:
        """Add a supervisor status to the ring buffer."""
        number = self.word("cycles")
        words = STAGE_VALUES.index(status.stage), AWAITED_VALUES.index(status.waits)
        store_row(self._status, number % STATUS_CAPACITY, number + 1, *words, *_row(status))
        self.set("cycles", number + 1)

    def status(self) -> Status:
        """Return the latest status."""
        for _ in range(READ_ATTEMPTS):
            number = self.word("cycles")
            row = load_row(self._status, (number - 1) % STATUS_CAPACITY, number)
            if row is not None:
                return _status_of(row)
        return _CLOSED_STATUS

    def write_telemetry(self, telemetry: Telemetry) -> None:
        """Add telemetry of the first `MAX_TELEMETRY_SERVOS` servos."""
        number, count = self.word("tellings"), min(len(telemetry.celsius), MAX_TELEMETRY_SERVOS)
        quantities = np.zeros((_TELEMETRY_QUANTITIES, MAX_TELEMETRY_SERVOS), dtype=np.float32)
        quantities[:, :count] = telemetry.figures[:, :count]
        store_row(self._telemetry, number % TELEMETRY_CAPACITY, number + 1, telemetry.clock, count, quantities)
        self.set("tellings", number + 1)

    def telemetry(self) -> Telemetry:
        """Return the latest telemetry of all servos."""
        for _ in range(READ_ATTEMPTS):
            number = self.word("tellings")
            row = load_row(self._telemetry, (number - 1) % TELEMETRY_CAPACITY, number)
            if row is not None:
                quantities = row["quantities"][:, : int(row["count"])].astype(np.float64)
                return Telemetry(float(row["clock"]), *(sealed(figure) for figure in quantities))
        return Telemetry()

    def history(self) -> tuple[Status, ...]:
        """Return the statuses since the last call, at most STATUS_CAPACITY."""
        cycles, statuses = self.word("cycles"), []
        self._seen = max(self._seen, cycles - STATUS_CAPACITY)
        while self._seen < cycles:
            row = load_row(self._status, self._seen % STATUS_CAPACITY, self._seen + 1)
            if row is not None:
                statuses.append(_status_of(row))
            self._seen += 1
        return tuple(statuses)

    def note(self, note: Note) -> None:
        """Add a supervisor event to the ring buffer."""
        number, rows = self.word("noted"), split_note(note)
        for k, (kind, text) in enumerate(rows, number):
            store_row(self._events, k % EVENT_CAPACITY, k + 1, note.clock, note.servo, kind, text)
        self.set("noted", number + len(rows))

    def notes(self) -> tuple[Note, ...]:
        """Return the events since the last call, of at most EVENT_CAPACITY rows."""
        noted = self.word("noted")
        first, self._noted = max(self._noted, noted - EVENT_CAPACITY), noted
        rows = (load_row(self._events, k % EVENT_CAPACITY, k + 1) for k in range(first, noted))
        return join_notes(row for row in rows if row is not None)


def _status_of(row: np.void) -> Status:
    return Status(
        stage=STAGE_VALUES[int(row["stage"])],
        waits=AWAITED_VALUES[int(row["waits"])],
        clock=float(row["clock"]),
        time=float(row["time"]),
        scale=float(row["scale"]),
        energised=int(row["energised"]),
        hottest=float(row["hottest"]),
        volts=float(row["volts"]),
        silent=int(row["silent"]),
        late=int(row["late"]),
        faulty=bool(row["faulty"]),
        angles=sealed(row["angles"]),
        setpoints=sealed(row["setpoints"]),
        taken=sealed(row["taken"]),
    )


_CLOSED_STATUS = Status()  # status before the first cycle
_STATUS_VECTORS = ("angles", "setpoints", "taken")  # fields of a status with a value per joint
_STATUS_NUMBERS = ("clock", "time", "scale", "energised", "hottest", "volts", "silent", "late", "faulty")
_CAP_VECTORS = ("velocities", "duties", "holding")  # fields of caps, in their order
_row = attrgetter(*_STATUS_NUMBERS, *_STATUS_VECTORS)


def _command(joints: int) -> np.dtype[np.void]:
    vectors = [(name, "<f8", (joints,)) for name in ("goals", "leads")]
    return np.dtype([("number", "<u8"), ("time", "<f8"), *vectors, ("crc", "<u8")])


def _caps(joints: int) -> np.dtype[np.void]:
    return np.dtype([("number", "<u8"), *((name, "<f8", (joints,)) for name in _CAP_VECTORS), ("crc", "<u8")])


def _status(joints: int) -> np.dtype[np.void]:
    kinds = [(name, "<i8" if isinstance(getattr(_CLOSED_STATUS, name), int) else "<f8") for name in _STATUS_NUMBERS]
    vectors = [(name, "<f8", (joints,)) for name in _STATUS_VECTORS]
    return np.dtype([("number", "<u8"), ("stage", "<i8"), ("waits", "<i8"), *kinds, *vectors, ("crc", "<u8")])


_EVENT_DTYPE = np.dtype(
    [("number", "<u8"), ("clock", "<f8"), ("servo", "<i8"), ("kind", "S24"), ("text", f"S{TEXT_SIZE}"), ("crc", "<u8")]
)
_TELEMETRY_QUANTITIES = len(Telemetry().figures)  # number of rows of `figures`
_TELEMETRY_DTYPE = np.dtype(
    [
        ("number", "<u8"),
        ("clock", "<f8"),
        ("count", "<i8"),
        ("quantities", "<f4", (_TELEMETRY_QUANTITIES, MAX_TELEMETRY_SERVOS)),
        ("crc", "<u8"),
    ]
)


def memory_size(joints: int, capacity: int = COMMAND_CAPACITY) -> int:
    """Return the size [bytes] of a channel's memory for `joints` joints."""
    rows = (
        STATUS_CAPACITY * _status(joints).itemsize
        + EVENT_CAPACITY * _EVENT_DTYPE.itemsize
        + capacity * _command(joints).itemsize
        + CAP_CAPACITY * _caps(joints).itemsize
    )
    return 8 * len(_WORD_NAMES) + rows + TELEMETRY_CAPACITY * _TELEMETRY_DTYPE.itemsize


def memory_file(octets: int) -> int:
    """Create anonymous shared memory and return its file descriptor."""
    if sys.platform == "linux":
        descriptor = os.memfd_create(MEMORY_NAME)
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    os.ftruncate(descriptor, octets)
    return descriptor


def map_memory(descriptor: int, octets: int) -> mmap.mmap:
    """Map a file descriptor's `octets` bytes as shared memory."""
    return mmap.mmap(descriptor, octets)
