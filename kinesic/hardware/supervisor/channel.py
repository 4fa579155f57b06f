"""Shares memory between planner and supervisor: commands and requests one way, status and events the other.

Each word has one writer, but for requests. A row is complete when its CRC says so, whatever order a processor writes
in; rows are counted by their number, so that nobody waits for anybody. The memory has no name: when both are gone, so
is it.
"""

import mmap
import os
import sys
import tempfile
import zlib
from dataclasses import dataclass, field
from math import nan
from operator import attrgetter
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.hardware.bus.telemetry import Telemetry
from kinesic.hardware.supervisor.settings import Policy
from kinesic.hardware.supervisor.state_machine import Awaited, Stage

CAPACITY = 16_384  # commands: more than two minutes of them
EVENTS = 512
HISTORY = 4096  # cycles: more than half a minute of them
TELLINGS, TOLD = 8, 256  # of how servos are; of so many servos
MEMORY_NAME = "kinesic"  # as the host shows it
PACES = 1000  # steps of the pace that a watch asks for
LOOKS = 50  # at a row that is being written
STAGES = tuple(Stage)
POLICIES: tuple[Policy, ...] = ("hold", "limp")
AWAITED: tuple[Awaited, ...] = get_args(Awaited)
_WORDS = ("written", "read", "ended", "release", "estop", "resume", "confirm", "pace", "noted", "cycles", "tellings")
_PLACES = {name: place for place, name in enumerate(_WORDS)}
_TEXT = 400  # [bytes] of an event


def _nothing() -> Floats:
    return sealed([])


@dataclass(frozen=True, eq=False)
class Status:
    """How the supervisor and its servos are in one cycle."""

    stage: Stage = Stage.CLOSED
    clock: float = 0.0  # [s] of the machine's monotonic clock, when it was this performance time
    time: float = nan  # [s] performance time; NaN before the first command
    scale: float = 0.0  # how fast it runs
    energised: int = 0  # servos with torque
    hottest: float = 0.0  # [C]
    volts: float = 0.0  # [V] the lowest
    silent: int = 0  # servos that have not answered lately
    late: int = 0  # cycles that began more than a period late
    faulty: bool = False
    waits: Awaited = "nothing"  # for what it waits
    angles: Floats = field(default_factory=_nothing)  # (n,) [rad] measured; NaN for a servo that did not answer
    goals: Floats = field(default_factory=_nothing)  # (n,) [rad]
    taken: Floats = field(default_factory=_nothing)  # (n,) [s] of that clock, of each angle; NaN likewise

    def time_at(self, clock: float) -> float:
        """Returns the performance time [s] at another time [s] of the machine's monotonic clock, a moment later."""
        return self.time + self.scale * (clock - self.clock)


@dataclass(frozen=True)
class Note:
    """Something that has happened."""

    clock: float  # [s] of the machine's monotonic clock
    servo: int  # id; -1: none
    kind: str
    text: str


Rows = NDArray[np.void]


class Channel:
    """The shared memory, seen from either side."""

    def __init__(self, memory: mmap.mmap, joints: int, capacity: int = CAPACITY) -> None:
        """Shares memory of `memory_size(joints, capacity)` bytes, all zero at first."""
        self.capacity, self._memory = capacity, memory
        self._commands = _command(joints)
        start = 8 * len(_WORDS)
        self._words = memoryview(memory)[:start].cast("Q")
        self._status: Rows = np.frombuffer(memory, _status(joints), HISTORY, start)
        start += self._status.nbytes
        self._events: Rows = np.frombuffer(memory, _EVENT, EVENTS, start)
        start += self._events.nbytes
        self._ring: Rows = np.frombuffer(memory, self._commands, capacity, start)
        self._telemetry: Rows = np.frombuffer(memory, _TELEMETRY, TELLINGS, start + self._ring.nbytes)
        self._taken = self._noted = self._seen = 0  # rows that this side has read

    def word(self, name: str) -> int:
        """Reads a counter or a request."""
        return self._words[_PLACES[name]]

    def set(self, name: str, value: int) -> None:
        """Sets a counter or a request of this side."""
        self._words[_PLACES[name]] = value

    def stop(self, policy: Policy) -> None:
        """Asks the supervisor for an emergency stop."""
        self.set("estop", POLICIES.index(policy) + 1)

    def slow_to(self, pace: float) -> None:
        """Asks the supervisor for a pace of time, 0..1, until another is asked for."""
        self.set("pace", 1 + round(PACES * pace))

    @property
    def room(self) -> int:
        """Commands that still fit."""
        return self.capacity - (self.word("written") - self.word("read"))

    def write(self, time: float, goals: Floats, leads: Floats | float = 0.0) -> bool:
        """Adds a command of the planner; returns False, and does nothing, while there is no room.

        Args:
            time: [s] of the performance.
            goals: (n,) [rad].
            leads: (n,) [rad] part of them that carries the planned speed; it shrinks while time is slowed down.
        """
        if self.room <= 0:
            return False
        number = self.word("written")
        _store(self._ring, number % self.capacity, number + 1, time, goals, leads)
        self.set("written", number + 1)
        return True

    def commands(self, most: int) -> list[tuple[float, Floats, Floats]]:
        """Takes new commands for the supervisor, so many at most: times [s], goals and their leads (n,) [rad]."""
        found: list[tuple[float, Floats, Floats]] = []
        while self._taken < self.word("written") and len(found) < most:
            row = _load(self._ring, self._taken % self.capacity, self._taken + 1)
            if row is None:
                break
            found.append((float(row["time"]), sealed(row["goals"]), sealed(row["leads"])))
            self._taken += 1
        if found:
            self.set("read", self._taken)
        return found

    def write_status(self, status: Status) -> None:
        """Adds a status of the supervisor."""
        number = self.word("cycles")
        words = STAGES.index(status.stage), AWAITED.index(status.waits)
        _store(self._status, number % HISTORY, number + 1, *words, *_row(status))
        self.set("cycles", number + 1)

    def status(self) -> Status:
        """Returns the last status."""
        for _ in range(LOOKS):
            number = self.word("cycles")
            row = _load(self._status, (number - 1) % HISTORY, number)
            if row is not None:
                return _told(row)
        return _SILENT

    def write_telemetry(self, telemetry: Telemetry) -> None:
        """Says how every servo is; of a robot with more than `TOLD` of them, those that come first."""
        number, count = self.word("tellings"), min(len(telemetry.celsius), TOLD)
        figures = np.zeros((_FIGURES_OF_ONE, TOLD), dtype=np.float32)
        figures[:, :count] = telemetry.figures[:, :count]
        _store(self._telemetry, number % TELLINGS, number + 1, telemetry.clock, count, figures)
        self.set("tellings", number + 1)

    def telemetry(self) -> Telemetry:
        """Returns how every servo was when that was said last."""
        for _ in range(LOOKS):
            number = self.word("tellings")
            row = _load(self._telemetry, (number - 1) % TELLINGS, number)
            if row is not None:
                figures = row["figures"][:, : int(row["count"])].astype(np.float64)
                return Telemetry(float(row["clock"]), *(sealed(figure) for figure in figures))
        return Telemetry()

    def history(self) -> tuple[Status, ...]:
        """Returns the status of every cycle since the last call; of too many, the last."""
        cycles, found = self.word("cycles"), []
        self._seen = max(self._seen, cycles - HISTORY)
        while self._seen < cycles:
            row = _load(self._status, self._seen % HISTORY, self._seen + 1)
            if row is not None:
                found.append(_told(row))
            self._seen += 1
        return tuple(found)

    def note(self, note: Note) -> None:
        """Adds an event of the supervisor."""
        number = self.word("noted")
        kind, text = note.kind.encode(), note.text.encode()[:_TEXT]
        _store(self._events, number % EVENTS, number + 1, note.clock, note.servo, kind, text)
        self.set("noted", number + 1)

    def notes(self) -> tuple[Note, ...]:
        """Takes all new events for the planner; of too many, the last."""
        noted, found = self.word("noted"), []
        self._noted = max(self._noted, noted - EVENTS)
        while self._noted < noted:
            row = _load(self._events, self._noted % EVENTS, self._noted + 1)
            if row is not None:
                kind, text = (bytes(row[name]).decode(errors="replace") for name in ("kind", "text"))
                found.append(Note(float(row["clock"]), int(row["servo"]), kind, text))
            self._noted += 1
        return tuple(found)


def _told(row: np.void) -> Status:
    return Status(
        stage=STAGES[int(row["stage"])],
        waits=AWAITED[int(row["waits"])],
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
        goals=sealed(row["goals"]),
        taken=sealed(row["taken"]),
    )


_SILENT = Status()
_VECTORS = ("angles", "goals", "taken")
_FIGURES = ("clock", "time", "scale", "energised", "hottest", "volts", "silent", "late", "faulty")
_row = attrgetter(*_FIGURES, *_VECTORS)


def _command(joints: int) -> np.dtype[np.void]:
    vectors = [(name, "<f8", (joints,)) for name in ("goals", "leads")]
    return np.dtype([("number", "<u8"), ("time", "<f8"), *vectors, ("crc", "<u8")])


def _status(joints: int) -> np.dtype[np.void]:
    kinds = [(name, "<i8" if isinstance(getattr(_SILENT, name), int) else "<f8") for name in _FIGURES]
    vectors = [(name, "<f8", (joints,)) for name in _VECTORS]
    return np.dtype([("number", "<u8"), ("stage", "<i8"), ("waits", "<i8"), *kinds, *vectors, ("crc", "<u8")])


_EVENT = np.dtype(
    [("number", "<u8"), ("clock", "<f8"), ("servo", "<i8"), ("kind", "S24"), ("text", f"S{_TEXT}"), ("crc", "<u8")]
)
_FIGURES_OF_ONE = len(Telemetry().figures)
_TELEMETRY = np.dtype(
    [("number", "<u8"), ("clock", "<f8"), ("count", "<i8"), ("figures", "<f4", (_FIGURES_OF_ONE, TOLD)), ("crc", "<u8")]
)


def memory_size(joints: int, capacity: int = CAPACITY) -> int:
    """Returns the size [bytes] of the memory for so many joints."""
    rows = HISTORY * _status(joints).itemsize + EVENTS * _EVENT.itemsize + capacity * _command(joints).itemsize
    return 8 * len(_WORDS) + rows + TELLINGS * _TELEMETRY.itemsize


def memory_file(octets: int) -> int:
    """Makes new, nameless memory of so many bytes, and returns its descriptor."""
    if sys.platform == "linux":
        descriptor = os.memfd_create(MEMORY_NAME)
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    os.ftruncate(descriptor, octets)
    return descriptor


def map_memory(descriptor: int, octets: int) -> mmap.mmap:
    """Maps the memory behind a descriptor."""
    return mmap.mmap(descriptor, octets)


def _store(rows: Rows, place: int, number: int, *values: object) -> None:
    row = np.zeros(1, dtype=rows.dtype)
    row[0] = (number, *values, 0)
    row["crc"] = zlib.crc32(row.tobytes()[:-8])
    rows[place] = row[0]


def _load(rows: Rows, place: int, number: int) -> np.void | None:
    """Loads the row of this number; None while it is not complete."""
    row = rows[place].copy()
    complete = number > 0 and int(row["number"]) == number and int(row["crc"]) == zlib.crc32(row.tobytes()[:-8])
    return row if complete else None
