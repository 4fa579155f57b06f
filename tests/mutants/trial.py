"""Runs of tests on mutants, in copies of the tree only."""

import compileall
import multiprocessing
import os
import resource
import shutil
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import pytest

MAX_MEMORY = 8 << 30  # [bytes] largest address space of a mutant
TIME_LIMIT = (
    20.0,
    8.0,
)  # time limit for the tests of a mutant: constant part [s], and factor on the usual duration of the tests
# Tests of mutants skip the servos of `manual_servo`, because running both kinds takes twice as long.
PYTEST_SELECTION = ("-m", "not soak and not realtime", "-k", "not ([manual or -manual or manual-)")

FORK_CONTEXT = multiprocessing.get_context(
    "forkserver"
)  # process context in which each trial begins with the heavy libraries loaded
# MuJoCo is not preloaded, because kinesic selects its OpenGL backend before the import.
FORK_CONTEXT.set_forkserver_preload(["trial", "pytest", "numpy", "scipy.optimize", "scipy.sparse", "casadi", "msgspec"])
os.environ |= {"PYTHONHASHSEED": "0", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # of the trials

Outcome = Literal["killed", "timeout", "survived"]


@dataclass(frozen=True)
class Sandbox:
    """Copy of the tree, in which mutants are tried one after another."""

    root: Path

    @classmethod
    def make(cls, tree: Path, root: Path) -> "Sandbox":
        """Copy the files that tests need."""
        for name in ("kinesic", "tests", "docs", "examples"):
            shutil.copytree(tree / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md", "CHANGELOG.md", "Makefile", "mkdocs.yml"):
            shutil.copy(tree / name, root / name)
        for name in ("kinesic", "tests"):
            compileall.compile_dir(root / name, quiet=1)  # once, so that no trial has to
        return cls(root)

    def try_mutant(self, module: str, mutant: bytes, tests: Sequence[str], *, usual: float) -> Outcome:
        """Run tests on a mutant.

        Args:
            module: path of the module that is another one for this time.
            mutant: its source.
            tests: paths.
            usual: [s] that these tests take without the mutant.
        """
        path = self.root / module
        original = path.read_bytes()
        for compiled in path.parent.glob(f"__pycache__/{path.stem}.*.pyc"):
            compiled.unlink()  # it could pass for the mutant's
        path.write_bytes(mutant)
        try:
            code = self._run(tests, TIME_LIMIT[0] + TIME_LIMIT[1] * usual)
        finally:
            path.write_bytes(original)
        return "timeout" if code is None else "killed" if code else "survived"

    def time_tests(self, tests: Sequence[str]) -> float:
        """Measure the duration [s] of tests, which must pass.

        Their compiled modules are kept for the mutants.
        """
        began = time.monotonic()
        if self._run(tests, 600.0, keeps_compiled=True) != 0:
            raise SystemExit(f"without any mutant, these fail: {' '.join(tests)}")
        return time.monotonic() - began

    def _run(self, tests: Sequence[str], limit: float, *, keeps_compiled: bool = False) -> int | None:
        """Return the exit code of pytest, None after a timeout."""
        running = FORK_CONTEXT.Process(target=run_tests, args=(self.root, tests, keeps_compiled))
        running.start()
        running.join(limit)
        code = running.exitcode
        if running.pid is not None:
            with suppress(ProcessLookupError):
                os.killpg(running.pid, signal.SIGKILL)  # and what the tests may have left behind
        running.join()
        return code


def run_tests(root: Path, tests: Sequence[str], keeps_compiled: bool) -> None:
    """Run the tests of a source tree in a process, and exit with their code."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))
    os.chdir(root)
    sys.path.insert(0, str(root))
    spec = find_spec("kinesic")
    if spec is None or spec.origin != str(root / "kinesic" / "__init__.py"):
        sys.exit(f"tests would run {spec}, not the copy in {root}")
    sys.dont_write_bytecode = not keeps_compiled  # a mutant's would pass for another's
    os.environ["PYTHONPATH"] = str(root)  # for what tests start
    silence = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(silence, stream)
    sys.exit(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *PYTEST_SELECTION, *tests]))
