"""Connect to a dask scheduler that accepts only its own user.

Whoever reaches a port of dask without TLS runs code as the owner of that process, loopback included. Workers of this
machine get certificates that exist for one run, in memory. A scheduler elsewhere must show a certificate.
"""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from kinesic.body.config import ConfigError
from kinesic.files.private_file import check_private

if TYPE_CHECKING:
    from distributed import Client, Security

LOCAL_PREFIX = "local:"
ENCRYPTED_SCHEMES = ("tls://", "wss://")  # schemes of dask that authenticate both ends
ADDRESS_FORMS = "ADDRESS of a dask scheduler, such as tls://10.0.0.2:8786, or local:N for N workers on this machine"
ENCRYPTION_REMEDY = (
    "give tls:// with --tls-ca, --tls-cert and --tls-key (docs/many.md), or --insecure in a network that you alone use"
)
NO_ROUTES: dict[str, object] = {  # dask opens HTTP ports in any case, and TLS does not cover them
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}


@dataclass(frozen=True)
class Certificates:
    """Files by which the members of a cluster know each other, in PEM format."""

    ca: Path  # certificate of the authority that signed all others
    cert: Path  # of this caller
    key: Path  # of this caller's certificate, unreadable for others

    def security(self) -> "Security":
        """Return these files as dask takes them.

        Raises:
            ConfigError: a file is missing, or others can read the key.
        """
        from distributed import Security  # noqa: PLC0415 - an extra

        for option, file in (("--tls-ca", self.ca), ("--tls-cert", self.cert), ("--tls-key", self.key)):
            if not file.is_file():
                raise ConfigError(f"{option} {file}: there is no such file")
        check_private(self.key, "--tls-key")
        return Security(
            require_encryption=True,
            tls_ca_file=str(self.ca),
            tls_client_cert=str(self.cert),
            tls_client_key=str(self.key),
        )


@contextmanager
def open_client(
    address: str, *, timeout: float, certificates: Certificates | None = None, insecure: bool = False
) -> Iterator["Client"]:
    """Connect to the scheduler at an address, or to new workers of this machine.

    Args:
        address: of a scheduler, or local:N.
        timeout: [s] for the scheduler to answer.
        certificates: for a scheduler elsewhere; None: those that dask's configuration names.
        insecure: whether a scheduler without TLS is accepted.

    Raises:
        ConfigError: the scheduler does not answer, or the connection would not be authenticated.
    """
    import distributed  # noqa: PLC0415 - an extra

    with ExitStack() as stack:
        security = certificates.security() if certificates else None
        where: object = address
        if address.startswith(LOCAL_PREFIX):
            if certificates or insecure:
                raise ConfigError(f"--cluster {address}: these workers get certificates of their own; leave out others")
            where = stack.enter_context(_local_workers(_count(address)))
        elif not address.startswith(ENCRYPTED_SCHEMES) and not insecure:
            raise ConfigError(
                f"--cluster {address}: without TLS whoever reaches its ports runs code there; {ENCRYPTION_REMEDY}"
            )
        try:
            client = distributed.Client(where, timeout=timeout, security=security)
        except (OSError, ValueError) as error:
            raise ConfigError(
                f"--cluster {address}: no scheduler answers ({error}); it takes {ADDRESS_FORMS}"
            ) from None
        except TypeError as error:  # dask's complaint where it finds no certificate
            raise ConfigError(f"--cluster {address}: no certificate ({error}); {ENCRYPTION_REMEDY}") from None
        yield stack.enter_context(client)


@contextmanager
def _local_workers(count: int) -> Iterator[object]:
    """Begin workers that only this process can reach."""
    import dask  # noqa: PLC0415 - an extra
    import distributed  # noqa: PLC0415 - an extra

    from kinesic.tasks.quick_start import quick_start  # noqa: PLC0415 - needs the extra

    with ExitStack() as stack:
        # Workers import modules and unpickle results from dask's folder; the usual one in /tmp is its first user's.
        folder = stack.enter_context(TemporaryDirectory(prefix="kinesic-dask-", ignore_cleanup_errors=True))
        stack.enter_context(dask.config.set({"temporary-directory": folder, **NO_ROUTES, **quick_start()}))
        try:
            security = distributed.Security.temporary()
        except ImportError:
            raise ConfigError("--cluster local:N needs cryptography: pip install 'kinesic[cluster]'") from None
        yield stack.enter_context(
            distributed.LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                security=security,
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL,
            )
        )


def _count(address: str) -> int:
    text = address.removeprefix(LOCAL_PREFIX)
    if not text.isdecimal() or int(text) < 1:
        raise ConfigError(f"--cluster {address}: {text or 'nothing'} is no number of workers; it takes {ADDRESS_FORMS}")
    return int(text)
