"""Progress display: the current stage with a bar, on terminals only."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol


class Stage(Protocol):
    """Callback that displays the current stage of a command."""

    def __call__(self, name: str, fraction: float | None = None, /) -> None:
        """Display a stage and its completed fraction 0..1, None if unknown."""


def ignore_stage(name: str, fraction: float | None = None, /) -> None:
    """Accept a stage without displaying it."""


@contextmanager
def show_stages(*, rate: float = 10.0) -> Iterator[Stage]:
    """Open a progress bar on standard error, which disappears at the end.

    If standard error is not a terminal, the yielded callback does nothing.

    Args:
        rate: refresh rate [Hz]; a low rate disturbs concurrent measurements less.
    """
    if not sys.stderr.isatty():
        yield ignore_stage
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415 - slow to import

    from kinesic.cli.terminal import error_console  # noqa: PLC0415 - as above

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=error_console(), transient=True, refresh_per_second=rate) as bar:
        task = bar.add_task("", total=None)

        def display(name: str, fraction: float | None = None, /) -> None:
            bar.tasks[0].total = None if fraction is None else 1.0  # A bar without total only moves.
            bar.update(task, description=name, completed=fraction or 0.0)

        yield display


def stage_progress(stage: Stage, name: str) -> Callable[[float], None]:
    """Make a callback that displays the completed fraction of one stage."""
    return lambda fraction: stage(name, fraction)
