"""Only the owner of dask workers can run code on them."""

import os
import shutil
import socket
import stat
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.tasks import cluster as module
from kinesic.tasks.cluster import cluster
from kinesic.tasks.dask_access import Certificates, open_client

from .certificates import make_certificates
from .dask_programs import dask_scheduler, dask_workers

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra cluster is not installed"),
    pytest.mark.realtime,
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]
INTRUDER = Path(__file__).with_name("intruder.py")
needs_openssl = pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="the intruder forks")


def listening_ports() -> list[int]:
    """Return the TCP ports at which this process and its descendants listen."""
    import psutil  # noqa: PLC0415 - comes with distributed

    us = psutil.Process()
    results = [
        net_connection for one in (us, *us.children(recursive=True)) for net_connection in one.net_connections("inet")
    ]
    return sorted({item.laddr.port for item in results if item.status == psutil.CONN_LISTEN})


def intrude(kinds: str, ports: list[int]) -> list[str]:
    """Return the users whose processes ran an intruder's code."""
    command = [sys.executable, str(INTRUDER), kinds, *map(str, ports)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout.split()


def http_status(port: int, path: str) -> str:
    """Return the HTTP status of a port, or None without an HTTP answer."""
    with socket.create_connection(("127.0.0.1", port), 5) as plain:
        plain.sendall(f"GET {path} HTTP/1.0\r\nHost: localhost\r\n\r\n".encode())
        try:
            line = plain.makefile("rb").readline()
        except OSError:
            return ""
    return line.decode().split(" ")[1] if line.startswith(b"HTTP/") else ""


@pytest.fixture(scope="module")
def local():
    """Start a local cluster, and yield it with the ports it opened."""
    before = listening_ports()
    with cluster("local:1") as engine:
        yield engine, [port for port in listening_ports() if port not in before]


@needs_fork
def test_local_cluster_ports_let_no_other_user_run_code(local):
    _, ports = local
    assert len(ports) >= 3
    assert intrude("plain,forged", ports) == []


@needs_fork
@pytest.mark.soak
def test_cluster_without_certificates_lets_other_users_run_code():
    from distributed import LocalCluster  # noqa: PLC0415 - an extra

    before = listening_ports()
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0"):
        ports = [port for port in listening_ports() if port not in before]
        assert intrude("plain", ports) == [str(os.getuid())] * 3, "scheduler, nanny and worker"


def test_http_ports_of_a_local_cluster_serve_no_pages(local):
    _, ports = local
    for port in ports:
        for path in (
            "/health",
            "/info/main/workers.html",
            "/json/identity.json",
            "/metrics",
            "/status",
            "/proxy/1/x/y",
        ):
            assert http_status(port, path) in ("", "404")


def test_dask_folders_of_local_workers_are_inside_a_private_folder(local):
    engine, _ = local
    folders = (
        "[d for d in __import__('sys').path if 'dask' in d] + [__import__('distributed').get_worker().local_directory]"
    )
    (outcome,) = (result for _, result in engine.run([folders], _evaluate))
    assert len(outcome) >= 2
    for folder in map(Path, outcome):
        private = next(parent for parent in (folder, *folder.parents) if parent.name.startswith("kinesic-dask-"))
        assert stat.S_IMODE(private.stat().st_mode) == 0o700


def _evaluate():
    return eval


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "127.0.0.1:9", "ws://127.0.0.1:9", "ucx://127.0.0.1:9"])
def test_cluster_address_without_tls_is_refused_unless_insecure(address, monkeypatch):
    monkeypatch.setattr(module, "SCHEDULER_TIMEOUT", 1)
    with pytest.raises(ConfigError, match=r"without TLS.* give tls:// with --tls-ca.*--insecure"), cluster(address):
        pass


def test_error_for_a_tls_address_without_certificates_names_the_options():
    with (
        pytest.raises(ConfigError, match="--tls-ca, --tls-cert and --tls-key"),
        open_client("tls://127.0.0.1:9", timeout=1),
    ):
        pass


def test_certificate_files_are_refused_for_local_cluster_workers(tmp_path):
    files = Certificates(tmp_path / "a", tmp_path / "b", tmp_path / "c")
    for pem in (files.ca, files.cert, files.key):
        pem.touch(0o600)
    with pytest.raises(ConfigError, match="their own certificates"), cluster("local:1", certificates=files):
        pass


def test_missing_certificates_and_keys_readable_by_others_are_refused(tmp_path):
    files = Certificates(tmp_path / "ca.pem", tmp_path / "member.pem", tmp_path / "member.key")
    with pytest.raises(ConfigError, match=r"--tls-ca .*ca\.pem: no such file"):
        files.security()
    for pem in (files.ca, files.cert, files.key):
        pem.touch()
    files.key.chmod(0o640)
    with pytest.raises(ConfigError, match=r"--tls-key .*member\.key: other users can read it \(mode 640\); chmod 600"):
        files.security()


@needs_openssl
@needs_fork
@pytest.mark.soak
def test_scheduler_with_documented_certificates_admits_only_clients_with_these_certificates(tmp_path):
    files = make_certificates(tmp_path)
    with dask_scheduler(tmp_path, files) as address, dask_workers(address, tmp_path, certificates=files):
        assert address.startswith("tls://")
        with cluster(address, certificates=files) as engine:
            assert dict(engine.run(["2 + 2"], _evaluate)) == {"2 + 2": 4}
        port = int(address.rpartition(":")[2])
        assert intrude("plain", [port]) == []
        assert intrude("forged", [port]) == []
