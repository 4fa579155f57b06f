"""Admissible clusters and their certificates, without starting a cluster."""

import logging
import stat
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

import pytest

from kinesic.body.config import ConfigError
from kinesic.tasks import dask_access
from kinesic.tasks.dask_access import NO_ROUTES, Certificates, open_client

pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="the extra cluster is not installed")


class Opened:
    """Stub of a dask client or cluster that records its arguments."""

    made: list["Opened"]

    def __init__(self, *given: object, **named: object) -> None:
        self.given, self.named, self.closed = given, named, False
        self.made.append(self)

    def __enter__(self) -> "Opened":
        return self

    def __exit__(self, *_: object) -> None:
        self.closed = True


@pytest.fixture
def clients(monkeypatch) -> list[Opened]:
    import distributed  # noqa: PLC0415 - an extra

    kind = type("Client", (Opened,), {"made": []})
    monkeypatch.setattr(distributed, "Client", kind)
    return kind.made


@pytest.fixture
def clusters(monkeypatch) -> list[Opened]:
    """Record local clusters, each with dask's configuration at its start."""
    import dask  # noqa: PLC0415 - an extra
    import distributed  # noqa: PLC0415 - an extra

    class Cluster(Opened):
        made: ClassVar[list[Opened]] = []

        def __init__(self, **named: object) -> None:
            super().__init__(**named)
            self.folder = Path(dask.config.get("temporary-directory"))
            self.mode = stat.S_IMODE(self.folder.stat().st_mode)
            self.routes = {name: dask.config.get(name) for name in NO_ROUTES}

    monkeypatch.setattr(distributed, "LocalCluster", Cluster)
    return Cluster.made


@pytest.fixture
def files(tmp_path: Path) -> Certificates:
    made = Certificates(tmp_path / "ca.pem", tmp_path / "member.pem", tmp_path / "member.key")
    for pem in (made.ca, made.cert, made.key):
        pem.touch(0o600)
    return made


def refused(address: str, **named: object) -> str:
    with pytest.raises(ConfigError) as caught, open_client(address, timeout=1.0, **named):
        pass
    return str(caught.value)


@pytest.mark.parametrize("address", ["tls://10.0.0.2:8786", "wss://10.0.0.2:8786"])
def test_client_of_a_remote_scheduler_uses_the_certificates_and_is_closed_after_use(clients, files, address):
    with open_client(address, timeout=3.0, certificates=files) as client:
        assert [client] == clients
        assert not client.closed
    assert client.closed
    assert client.given == (address,)
    assert client.named["timeout"] == 3.0
    security = client.named["security"]
    assert security.require_encryption is True
    assert (security.tls_ca_file, security.tls_client_cert, security.tls_client_key) == (
        str(files.ca),
        str(files.cert),
        str(files.key),
    )


def test_certificates_missing_on_the_command_line_come_from_the_dask_configuration(clients):
    with open_client("tls://10.0.0.2:8786", timeout=3.0):
        pass
    assert clients[0].named["security"] is None


@pytest.mark.parametrize("address", ["tcp://10.0.0.2:8786", "10.0.0.2:8786", "xtls://10.0.0.2", "TLS://10.0.0.2"])
def test_connection_without_tls_needs_the_insecure_option(clients, files, address):
    assert "without TLS, anyone who reaches its ports runs code there" in refused(address)
    assert f"--cluster {address}: without TLS" in refused(address, certificates=files)
    assert clients == []
    with open_client(address, timeout=1.0, insecure=True):
        pass
    assert [client.given for client in clients] == [(address,)]


@pytest.mark.parametrize("missing", ["ca", "cert", "key"])
def test_missing_certificate_is_reported_before_connecting(clients, files, missing):
    path: Path = getattr(files, missing)
    path.unlink()
    option = {"ca": "--tls-ca", "cert": "--tls-cert", "key": "--tls-key"}[missing]
    assert f"{option} {path}: no such file" in refused("tls://10.0.0.2:8786", certificates=files)
    path.mkdir()
    assert "no such file" in refused("tls://10.0.0.2:8786", certificates=files)
    assert clients == []


def test_private_key_readable_by_others_is_refused(clients, files):
    files.key.chmod(0o604)
    assert "--tls-key" in refused("tls://10.0.0.2:8786", certificates=files)
    files.key.chmod(0o600)
    files.cert.chmod(0o644)  # public
    with open_client("tls://10.0.0.2:8786", timeout=1.0, certificates=files):
        pass


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (OSError("timed out"), r"no scheduler answers \(timed out\); give ADDRESS"),
        (ValueError("no port"), r"no scheduler answers \(no port\); give ADDRESS"),
        (TypeError("no ca"), r"no certificate \(no ca\); give tls://"),
    ],
)
def test_error_for_a_failed_cluster_connection_names_the_remedy(monkeypatch, error, said):
    import distributed  # noqa: PLC0415 - an extra

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(distributed, "Client", fail)
    with pytest.raises(ConfigError, match=said), open_client("tls://10.0.0.2:8786", timeout=1.0):
        pass


def test_local_cluster_has_a_private_temporary_folder_encryption_and_no_web_pages(clients, clusters):
    with open_client("local:3", timeout=1.0) as client:
        (cluster,) = clusters
        assert client.given == (cluster,)
        assert cluster.folder.is_dir()
        assert not cluster.closed
    assert cluster.closed
    assert not cluster.folder.exists()
    assert cluster.folder.name.startswith("kinesic-dask-")
    assert cluster.mode == 0o700
    assert cluster.routes == NO_ROUTES
    assert all(routes == [] for routes in cluster.routes.values())
    security = cluster.named["security"]
    assert security.require_encryption is True
    assert "BEGIN" in security.tls_ca_file  # in memory, no file
    assert {name: cluster.named[name] for name in ("n_workers", "threads_per_worker", "silence_logs")} == {
        "n_workers": 3,
        "threads_per_worker": 1,
        "silence_logs": logging.CRITICAL,
    }
    assert cluster.named["dashboard_address"] == "127.0.0.1:0"
    assert cluster.named["scheduler_kwargs"] == {"dashboard": False}


def test_two_cluster_runs_have_different_certificates(clients, clusters):
    for _ in range(2):
        with open_client("local:1", timeout=1.0):
            pass
    first, second = (cluster.named["security"].tls_ca_file for cluster in clusters)
    assert first != second


def test_local_cluster_workers_refuse_certificates_and_the_insecure_option(clients, clusters, files):
    assert "their own certificates" in refused("local:1", certificates=files)
    assert "their own certificates" in refused("local:1", insecure=True)
    assert clusters == clients == []


@pytest.mark.parametrize("count", ["", "0", "-1", "two", "1.5", "1e3", "+1"])
def test_worker_count_in_a_cluster_address_must_be_a_positive_integer(clients, clusters, count):
    assert f"{count or 'nothing'} is not a number of workers" in refused(f"local:{count}")
    assert clusters == clients == []


def test_worker_count_is_read_from_the_cluster_address():
    assert [dask_access._count(f"local:{count}") for count in ("1", "2", "64")] == [1, 2, 64]


def test_missing_cryptography_package_is_reported(clients, clusters, monkeypatch):
    import distributed  # noqa: PLC0415 - an extra

    def fail() -> None:
        raise ImportError("no cryptography")

    monkeypatch.setattr(distributed.Security, "temporary", fail)
    assert "needs cryptography" in refused("local:1")
    assert clusters == []
