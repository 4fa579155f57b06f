"""Scheduler and workers of dask as separate processes."""

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep

from kinesic.tasks.dask_access import Certificates

QUICK_START_OPTIONS = (
    "--preload-nanny",
    "kinesic.tasks.quick_start",
)  # worker options that the guide gives for a quick start
READY_TEXT = "Registered to"  # text that a worker prints once it is ready
PATIENCE = 120.0  # [s] longest start of a program


def _tls(certificates: Certificates | None) -> tuple[str | Path, ...]:
    if certificates is None:
        return ()
    files = (certificates.ca, certificates.cert, certificates.key)
    return ("--protocol", "tls", "--tls-ca-file", files[0], "--tls-cert", files[1], "--tls-key", files[2])


@contextmanager
def dask_scheduler(folder: Path, certificates: Certificates | None = None) -> Iterator[str]:
    """Start a scheduler, and yield its address."""
    file = folder / "scheduler.json"
    options = ("--host", "127.0.0.1", "--port", "0", "--dashboard-address", "127.0.0.1:0", "--scheduler-file", file)
    options += _tls(certificates)
    with _program(sys.executable, "scheduler", *options, log=folder / "scheduler.log") as program:
        _wait_for("}", file, program, folder / "scheduler.log")
        yield json.loads(file.read_text())["address"]


@contextmanager
def dask_workers(
    address: str, folder: Path, pythons: Sequence[str] = (sys.executable,), *, certificates: Certificates | None = None
) -> Iterator[None]:
    """Start a worker for each Python interpreter, even of different environments.

    A nanny of dask begins a worker anew that dies.
    """
    logs = [folder / f"worker{number}.log" for number in range(len(pythons))]
    with ExitStack() as stack:
        programs = []
        for number, (python, log) in enumerate(zip(pythons, logs, strict=True)):
            options = (
                "--nthreads",
                "1",
                "--no-dashboard",
                "--local-directory",
                folder / str(number),
                *QUICK_START_OPTIONS,
            )
            options += _tls(certificates)
            programs.append(stack.enter_context(_program(python, "worker", address, *options, log=log)))
        for program, log in zip(programs, logs, strict=True):
            _wait_for(READY_TEXT, log, program, log)
        yield


def _wait_for(text: str, file: Path, program: subprocess.Popen[bytes], log: Path) -> None:
    until = monotonic() + PATIENCE
    while not file.exists() or text not in file.read_text():
        if program.poll() is not None or monotonic() > until:
            raise RuntimeError(log.read_text())
        sleep(0.02)


@contextmanager
def _program(python: str, name: str, *options: str | Path, log: Path) -> Iterator[subprocess.Popen[bytes]]:
    with log.open("wb") as file:
        command = [python, "-m", f"distributed.cli.dask_{name}", *map(str, options)]
        program = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT)
    try:
        yield program
    finally:
        program.terminate()
        try:
            program.wait(10.0)
        except subprocess.TimeoutExpired:
            program.kill()
            program.wait()
