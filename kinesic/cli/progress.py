"""How far a verb has come: the stage that it is in, with a bar, on a terminal; in a pipe or a file, nothing."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol


class Stage(Protocol):
    """Tells what is being done."""

    def __call__(self, name: str, share: float | None = None, /) -> None:
        """Names the stage, and the share of it that is done, 0..1; None: nobody knows."""


def untold(name: str, share: float | None = None, /) -> None:
    """Nobody looks."""


@contextmanager
def show_stages(*, rate: float = 10.0) -> Iterator[Stage]:
    """Opens a bar on the terminal that standard error is, which goes again at the end; without one, yields nothing.

    Args:
        rate: of its pictures [Hz]; the fewer, the less they disturb what is measured meanwhile.
    """
    if not sys.stderr.isatty():
        yield untold
        return
    from rich.console import Console  # noqa: PLC0415 - slow to import, and pipes need it not
    from rich.markup import escape  # noqa: PLC0415 - as above
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415 - as above

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, refresh_per_second=rate) as bar:
        task = bar.add_task("", total=None)

        def tell(name: str, share: float | None = None, /) -> None:
            bar.tasks[0].total = None if share is None else 1.0  # None: the bar only moves
            bar.update(task, description=escape(name), completed=share or 0.0)

        yield tell


def share_of(stage: Stage, name: str) -> Callable[[float], None]:
    """Makes a function that tells the share of one stage that is done."""
    return lambda share: stage(name, share)
