"""Progress display: the current stage with a bar, on terminals only."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import Protocol

BAR_WIDTH = 30  # [characters] width of a bar
BLOCK_WIDTH = 6  # [characters] width of the block that moves in a bar without a known end
BLOCK_SPEED = 10.0  # [characters/s] speed of the block in a bar without a known end


class Stage(Protocol):
    """Callback that displays the current stage of a command."""

    def __call__(self, name: str, fraction: float | None = None, /) -> None:
        """Display a stage and its completed fraction 0..1, None if unknown."""


class Step(Protocol):
    """Callback that counts a completed step."""

    def __call__(self, note: str = "", /) -> None:
        """Count a step, and display a note behind the bar."""


@dataclass
class Progress:
    """State of a command that is displayed as one line."""

    label: str = ""
    fraction: float | None = None  # completed fraction 0..1, None if unknown
    count: str = ""  # number of completed steps and of all steps
    note: str = ""
    start: float = field(default_factory=monotonic)  # [s] start of the command on the monotonic clock

    def line(self, now: float) -> str:
        """Return the progress line at a time of the monotonic clock."""
        elapsed = now - self.start
        seconds = int(elapsed)
        time = f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"
        parts = (self.label, f"[{self._bar(elapsed)}]", self.count, time, self.note)
        return " ".join(part for part in parts if part)

    def _bar(self, elapsed: float) -> str:
        if self.fraction is not None:
            return ("#" * round(BAR_WIDTH * min(max(self.fraction, 0.0), 1.0))).ljust(BAR_WIDTH, ".")
        begin = int(BLOCK_SPEED * elapsed) % (BAR_WIDTH - BLOCK_WIDTH + 1)
        return ("." * begin + "#" * BLOCK_WIDTH).ljust(BAR_WIDTH, ".")


def ignore_stage(name: str, fraction: float | None = None, /) -> None:
    """Accept a stage without displaying it."""


@contextmanager
def show_stages(*, rate: float = 10.0) -> Iterator[Stage]:
    """Open a progress bar on standard error, which disappears at the end.

    If standard error is not a terminal, the yielded callback does nothing.

    Args:
        rate: refresh rate [Hz]; a low rate disturbs concurrent measurements less.
    """
    progress = Progress()

    def display(name: str, fraction: float | None = None, /) -> None:
        progress.label, progress.fraction = name, fraction

    with _shown(progress, rate):
        yield display


@contextmanager
def show_steps(label: str, total: int) -> Iterator[Step]:
    """Open a progress bar on standard error that counts steps.

    The bar disappears at the end. Without a terminal, nothing is displayed.
    """
    completed = 0

    def step(note: str = "", /) -> None:
        nonlocal completed
        completed += 1
        progress.fraction, progress.count, progress.note = completed / total, f"{completed}/{total}", note

    progress = Progress(label, fraction=0.0, count=f"0/{total}")
    with _shown(progress, rate=10.0):
        yield step


@contextmanager
def _shown(progress: Progress, rate: float) -> Iterator[None]:
    if not sys.stderr.isatty():
        yield
        return
    from kinesic.cli.screen.live import LiveLines  # noqa: PLC0415 - needed on terminals only
    from kinesic.cli.terminal import error_console  # noqa: PLC0415 - as above

    with LiveLines(error_console(), lambda: (progress.line(monotonic()),), rate=rate).shown():
        yield


def stage_progress(stage: Stage, name: str) -> Callable[[float], None]:
    """Make a callback that displays the completed fraction of one stage."""
    return lambda fraction: stage(name, fraction)
