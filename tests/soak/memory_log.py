"""Memory of a server's processes over time, with limited growth.

The median memory of the last fifth of the time after `WARM_UP_TIME` exceeds that of its first fifth by at most 2 %. The
sum counts anonymous and shared pages, each page once, however many forks share it. Pages of program files are excluded,
because other programs on the machine share them. Each role is also judged alone, by the pages that only its processes
hold, so that a role that shrinks hides no other that grows.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from kinesic.bench.bml.server import _list_process_tree

WARM_UP_TIME = 300.0  # [s] time in which all processes start, and each kind of request and flood occurs
WINDOW_FRACTION = 0.2  # length of the first and the last compared window / time after the warm-up
KNOWN_PROGRAMS = ("forkserver", "resource_tracker", "espeak_process")  # program names that are found in command lines


@dataclass(frozen=True)
class ProcessSize:
    """Memory of one process."""

    pid: int
    role: str
    private: int  # [bytes] memory that no other process shares
    share: int  # [bytes] anonymous and shared memory, each page divided by the number of its processes


@dataclass
class MemoryLog:
    """Samples of a server and all its descendants."""

    samples: list[tuple[float, tuple[ProcessSize, ...]]] = field(default_factory=list)  # process sizes by time [s]

    def record(self, time: float, server: int) -> None:
        """Record all processes of a server at a time [s]."""
        self.samples.append((time, tuple(_sizes(server))))

    @property
    def roles(self) -> tuple[str, ...]:
        """Program names of all recorded processes, in order of first appearance."""
        return tuple(dict.fromkeys(size.role for _, sizes in self.samples for size in sizes))

    def total(self, settled: float, duration: float) -> tuple[float, float]:
        """Return the memory [bytes] of all processes in the two compared windows."""
        return self._windows(settled, duration, lambda each: each.share)

    def private(self, settled: float, duration: float, role: str | None = None) -> tuple[float, float]:
        """Return the private memory [bytes] of a program in the two compared windows."""
        return self._windows(settled, duration, lambda each: each.private if role in (None, each.role) else 0)

    def _windows(self, settled: float, duration: float, size: Callable[[ProcessSize], int]) -> tuple[float, float]:
        width = WINDOW_FRACTION * (duration - settled)
        sums = [(time, sum(map(size, sizes))) for time, sizes in self.samples]
        first = median(held for time, held in sums if settled <= time <= settled + width)
        last = median(held for time, held in sums if duration - width <= time <= duration)
        return first, last

    def lines(self, settled: float, duration: float) -> Iterator[str]:
        """Yield a report of all processes."""
        for role in self.roles:
            yield f"{role}: private {_change(self.private(settled, duration, role))}"
        yield f"all: private {_change(self.private(settled, duration))}"
        yield f"all: anonymous and shared {_change(self.total(settled, duration))}"
        for pid in dict.fromkeys(size.pid for _, sizes in self.samples for size in sizes):
            yield self._course(pid)

    def _course(self, pid: int) -> str:
        """Describe the memory of one process over time."""
        own = [(time, size) for time, sizes in self.samples for size in sizes if size.pid == pid]
        sizes = [round(each.private / 1e6, 1) for _, each in own]
        return (
            f"{own[-1][1].role} {pid}: {own[0][0]:.0f} to {own[-1][0]:.0f} s, "
            f"private MB {sizes[:: max(1, len(sizes) // 24)]}"
        )


def growth(sizes: tuple[float, float]) -> float:
    """Return the growth [%] from the first window to the last."""
    before, after = sizes
    return 100.0 * (after / before - 1.0) if before else 0.0


def _change(sizes: tuple[float, float]) -> str:
    return f"{sizes[0] / 1e6:.2f} -> {sizes[1] / 1e6:.2f} MB ({growth(sizes):+.2f} %)"


def _sizes(server: int) -> Iterator[ProcessSize]:
    """Yield the memory of a server and all its descendants."""
    for pid in _list_process_tree(server):
        with suppress(OSError):  # it ends just now
            rollup = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()[1:]
            held = {line.split()[0].rstrip(":"): 1024 * int(line.split()[1]) for line in rollup}
            role = "server" if pid == server else _role(pid)
            if held:
                private = held["Private_Clean"] + held["Private_Dirty"]
                yield ProcessSize(pid, role, private, held["Pss_Anon"] + held["Pss_Shmem"])


def _role(pid: int) -> str:
    """Return the name of a child process, or of its program."""
    name = Path(f"/proc/{pid}/comm").read_text().strip()
    command = Path(f"/proc/{pid}/cmdline").read_text()
    if not name.startswith("python"):
        return name
    return next((known for known in reversed(KNOWN_PROGRAMS) if known in command), name)
