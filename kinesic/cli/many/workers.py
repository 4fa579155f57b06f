"""Who works through tasks: options of verbs, and the engine that they ask for."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import click

from kinesic.cli.options import together

if TYPE_CHECKING:
    from kinesic.tasks.engine import Engine

CLUSTER_HELP = "Workers of dask.distributed do it: tls://HOST:PORT of their scheduler, or local:N for N of them here."
TLS_CA_HELP = "Certificate (PEM) of the authority that signed those of the cluster; default: dask's configuration."
TLS_CERT_HELP = "Certificate (PEM) that the scheduler asks for."
TLS_KEY_HELP = "Key (PEM) of --tls-cert, which no other user may read."
INSECURE_HELP = "Accepts a scheduler without TLS: whoever reaches its ports runs code on its workers, and here."
INSECURE_WARNING = "warn: --insecure: whoever reaches a port of this cluster can run code on its workers and here"

PEM_FILE = click.Path(path_type=Path, dir_okay=False)


@dataclass(frozen=True)
class Workers:
    """Who works through tasks."""

    jobs: Annotated[
        int | None,
        click.option("--jobs", type=click.IntRange(min=1), help="Processes (default: one for each core)."),
    ]
    cluster: Annotated[str | None, click.option("--cluster", metavar="ADDRESS", help=CLUSTER_HELP)]
    tls_ca: Annotated[Path | None, click.option("--tls-ca", type=PEM_FILE, help=TLS_CA_HELP)] = None
    tls_cert: Annotated[Path | None, click.option("--tls-cert", type=PEM_FILE, help=TLS_CERT_HELP)] = None
    tls_key: Annotated[Path | None, click.option("--tls-key", type=PEM_FILE, help=TLS_KEY_HELP)] = None
    insecure: Annotated[bool, click.option("--insecure", is_flag=True, help=INSECURE_HELP)] = False

    @contextmanager
    def engine(self) -> Iterator["Engine"]:
        """Open the requested engine and print where it works.

        Raises:
            ConfigError: there is no such cluster, or it cannot be reached safely.
        """
        from kinesic.tasks.engine import Processes, using_engine  # noqa: PLC0415 - help needs it not

        files = [each for each in (self.tls_ca, self.tls_cert, self.tls_key) if each is not None]
        if self.cluster is None:
            if files or self.insecure:
                raise click.UsageError("--tls-ca, --tls-cert, --tls-key and --insecure belong to --cluster: add it")
            with using_engine(Processes(self.jobs or os.cpu_count() or 1)) as engine:
                yield engine
            return
        if self.jobs is not None:
            raise click.UsageError("--jobs is of processes here, --cluster of others: say one of them")
        if files and (len(files) < 3 or self.insecure):
            raise click.UsageError("give --tls-ca, --tls-cert and --tls-key together, and without --insecure")
        from kinesic.tasks.cluster import cluster  # noqa: PLC0415 - an extra
        from kinesic.tasks.dask_access import Certificates  # noqa: PLC0415 - as above

        if self.insecure:
            click.echo(INSECURE_WARNING, err=True)
        certificates = Certificates(*files) if files else None
        with (
            cluster(self.cluster, certificates=certificates, insecure=self.insecure) as found,
            using_engine(found) as engine,
        ):
            click.echo(f"cluster: {engine.place}", err=True)
            yield engine


workers = together("workers", Workers)
