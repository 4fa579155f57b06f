"""Who works through tasks: options of verbs, and the engine that they ask for."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import click

from kinesic.cli.options import together

if TYPE_CHECKING:
    from kinesic.tasks.engine import Engine

CLUSTER_HELP = "Workers of dask.distributed do it: the address of their scheduler, or local:N for N of them here."


@dataclass(frozen=True)
class Workers:
    """Who works through tasks."""

    jobs: Annotated[
        int | None,
        click.option("--jobs", type=click.IntRange(min=1), help="Processes (default: one for each core)."),
    ]
    cluster: Annotated[str | None, click.option("--cluster", metavar="ADDRESS", help=CLUSTER_HELP)]

    @contextmanager
    def engine(self) -> Iterator["Engine"]:
        """Opens the engine that is asked for, has it do all tasks meanwhile, and says where it works.

        Raises:
            ConfigError: there is no such cluster.
        """
        from kinesic.tasks.engine import Processes, using_engine  # noqa: PLC0415 - help needs it not

        if self.cluster is None:
            with using_engine(Processes(self.jobs or os.cpu_count() or 1)) as engine:
                yield engine
            return
        if self.jobs is not None:
            raise click.UsageError("--jobs is of processes here, --cluster of others: say one of them")
        from kinesic.tasks.cluster import cluster  # noqa: PLC0415 - an extra

        with cluster(self.cluster) as found, using_engine(found) as engine:
            click.echo(f"cluster: {engine.place}", err=True)
            yield engine


workers = together("workers", Workers)
