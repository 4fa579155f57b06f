"""Connection to a dask scheduler that refuses all other users.

A port of dask without TLS lets anyone who reaches it run code as the owner of that process, loopback included. Workers
of this machine get certificates that exist for one run, in memory. A remote scheduler must present a certificate.
"""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from kinesic.body.config import ConfigError
from kinesic.extras import install_extra
from kinesic.files.private_file import check_private

if TYPE_CHECKING:
    from distributed import Client, Security

LOCAL_PREFIX = "local:"  # prefix of an address that starts workers on this machine
ENCRYPTED_SCHEMES = ("tls://", "wss://")  # URL schemes of dask whose connections authenticate both ends
ADDRESS_FORMS = "ADDRESS of a dask scheduler, such as tls://10.0.0.2:8786, or local:N for N workers on this machine"
ENCRYPTION_REMEDY = (
    "give tls:// with --tls-ca, --tls-cert and --tls-key (docs/how-to/run-many-documents.md), "
    "or --insecure in a network without other users"
)
NO_ROUTES: dict[str, object] = {  # dask settings that remove its HTTP pages, which TLS does not cover
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}


@dataclass(frozen=True)
class Certificates:
    """Certificate files that authenticate the members of a cluster, in PEM format."""

    ca: Path  # certificate of the authority that signed all others
    cert: Path  # certificate of this caller
    key: Path  # private key of this caller, unreadable for other users

    def security(self) -> "Security":
        """Return the certificate files as dask's security settings.

        Raises:
            ConfigError: a file is missing, or other users can read the key.
        """
        from distributed import Security  # noqa: PLC0415 - an extra

        for option, file in (("--tls-ca", self.ca), ("--tls-cert", self.cert), ("--tls-key", self.key)):
            if not file.is_file():
                raise ConfigError(f"{option} {file}: no such file")
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
    """Connect to the scheduler at an address, or to new local workers.

    Args:
        address: address of a scheduler, or local:N.
        timeout: [s] for the scheduler to answer.
        certificates: certificates for a remote scheduler; None: those of dask's configuration.
        insecure: whether a scheduler without TLS is accepted.

    Raises:
        ConfigError: the scheduler does not answer, or the connection would not be authenticated.
    """
    import distributed  # noqa: PLC0415 - an extra

    with ExitStack() as stack:
        security = certificates.security() if certificates else None
        target: object = address
        if address.startswith(LOCAL_PREFIX):
            if certificates or insecure:
                raise ConfigError(
                    f"--cluster {address}: local workers have their own certificates; omit --tls-... and --insecure"
                )
            target = stack.enter_context(_local_workers(_count(address)))
        elif not address.startswith(ENCRYPTED_SCHEMES) and not insecure:
            raise ConfigError(
                f"--cluster {address}: without TLS, anyone who reaches its ports runs code there; {ENCRYPTION_REMEDY}"
            )
        try:
            client = distributed.Client(target, timeout=timeout, security=security)
        except (OSError, ValueError) as error:
            raise ConfigError(f"--cluster {address}: no scheduler answers ({error}); give {ADDRESS_FORMS}") from None
        except TypeError as error:  # raised by dask without a certificate
            raise ConfigError(f"--cluster {address}: no certificate ({error}); {ENCRYPTION_REMEDY}") from None
        yield stack.enter_context(client)


@contextmanager
def _local_workers(count: int) -> Iterator[object]:
    """Start local dask workers that only this process can reach."""
    import dask  # noqa: PLC0415 - an extra
    import distributed  # noqa: PLC0415 - an extra

    from kinesic.tasks.quick_start import quick_start  # noqa: PLC0415 - needs the extra

    with ExitStack() as stack:
        # Workers import modules and unpickle results from dask's folder; the default one in /tmp belongs to its first
        # user.
        folder = stack.enter_context(TemporaryDirectory(prefix="kinesic-dask-", ignore_cleanup_errors=True))
        stack.enter_context(dask.config.set({"temporary-directory": folder, **NO_ROUTES, **quick_start()}))
        try:
            security = distributed.Security.temporary()
        except ImportError:
            raise ConfigError(f"--cluster local:N needs cryptography: {install_extra('cluster')}") from None
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
        raise ConfigError(f"--cluster {address}: {text or 'nothing'} is not a number of workers; give {ADDRESS_FORMS}")
    return int(text)
