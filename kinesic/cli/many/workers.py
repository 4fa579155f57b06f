"""Command-line options for the processes or the cluster that run tasks."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import click

from kinesic.cli.options import group_options

if TYPE_CHECKING:
    from kinesic.tasks.engine import Engine

CLUSTER_HELP = "Run the tasks on dask.distributed: tls://HOST:PORT of a scheduler, or local:N for N workers here."
TLS_CA_HELP = "Certificate (PEM) of the authority of the cluster's certificates (default: dask's configuration)."
TLS_CERT_HELP = "Certificate (PEM) that the scheduler requires."
TLS_KEY_HELP = "Key (PEM) of --tls-cert; other users must not be able to read it."
INSECURE_HELP = "Accept a scheduler without TLS: anyone who can reach its ports can run code on its workers and here."
INSECURE_WARNING = "warn: --insecure: anyone who can reach a port of this cluster can run code on its workers and here"

PEM_FILE = click.Path(path_type=Path, dir_okay=False)


@dataclass(frozen=True)
class Workers:
    """Number of local processes, or address and certificates of a cluster."""

    jobs: Annotated[
        int | None,
        click.option("--jobs", type=click.IntRange(min=1), help="Number of processes (default: one per core)."),
    ]
    cluster: Annotated[str | None, click.option("--cluster", metavar="ADDRESS", help=CLUSTER_HELP)]
    tls_ca: Annotated[Path | None, click.option("--tls-ca", type=PEM_FILE, help=TLS_CA_HELP)] = None
    tls_cert: Annotated[Path | None, click.option("--tls-cert", type=PEM_FILE, help=TLS_CERT_HELP)] = None
    tls_key: Annotated[Path | None, click.option("--tls-key", type=PEM_FILE, help=TLS_KEY_HELP)] = None
    insecure: Annotated[bool, click.option("--insecure", is_flag=True, help=INSECURE_HELP)] = False

    @contextmanager
    def engine(self) -> Iterator["Engine"]:
        """Open the requested task engine and print where tasks run.

        Raises:
            ConfigError: there is no such cluster, or it cannot be reached safely.
        """
        from kinesic.tasks.engine import Processes, using_engine  # noqa: PLC0415 - unused by help

        files = [path for path in (self.tls_ca, self.tls_cert, self.tls_key) if path is not None]
        if self.cluster is None:
            if files or self.insecure:
                raise click.UsageError("--tls-ca, --tls-cert, --tls-key and --insecure require --cluster")
            with using_engine(Processes(self.jobs or os.cpu_count() or 1)) as engine:
                yield engine
            return
        if self.jobs is not None:
            raise click.UsageError("--jobs starts local processes, --cluster uses others; give one of them")
        if files and (len(files) < 3 or self.insecure):
            raise click.UsageError("give --tls-ca, --tls-cert and --tls-key together, and without --insecure")
        from kinesic.tasks.cluster import cluster  # noqa: PLC0415 - optional dependency
        from kinesic.tasks.dask_access import Certificates  # noqa: PLC0415 - as above

        if self.insecure:
            click.echo(INSECURE_WARNING, err=True)
        certificates = Certificates(*files) if files else None
        with (
            cluster(self.cluster, certificates=certificates, insecure=self.insecure) as cluster_engine,
            using_engine(cluster_engine) as engine,
        ):
            click.echo(f"cluster: {engine.place}", err=True)
            yield engine


worker_options = group_options("workers", Workers)
