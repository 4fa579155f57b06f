"""Tries mutants in copies of the tree, never in the tree itself."""

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

MEMORY = 8 << 30  # [bytes] of address space that a mutant may take
PATIENCE = (20.0, 8.0)  # [s] that tests of a mutant may take, and how many times as long as without it
SELECTION = "not soak and not realtime"

Outcome = Literal["killed", "timeout", "survived"]


@dataclass(frozen=True)
class Sandbox:
    """A copy of the tree, in which one mutant is tried after the other."""

    root: Path

    @classmethod
    def make(cls, tree: Path, root: Path) -> "Sandbox":
        """Copies what tests need of a tree."""
        for name in ("kinesic", "tests", "docs", "examples"):
            shutil.copytree(tree / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md", "CHANGELOG.md", "Makefile"):
            shutil.copy(tree / name, root / name)
        return cls(root)

    def compile(self) -> None:
        """Compiles all modules once, so that no trial has to, and checks that tests find this copy's."""
        subprocess.run((sys.executable, "-m", "compileall", "-q", "kinesic", "tests"), cwd=self.root, check=True)
        asked = (sys.executable, "-c", "import kinesic; print(kinesic.__file__)")
        found = subprocess.check_output(asked, cwd=self.root, env=self._environment(), text=True).strip()
        if Path(found).parent.parent != self.root:
            raise SystemExit(f"tests would run {found}, not the copy in {self.root}")

    def try_mutant(self, module: str, mutant: bytes, tests: Sequence[str], *, usual: float) -> Outcome:
        """Runs tests on a mutant.

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
            code = self._run(tests, PATIENCE[0] + PATIENCE[1] * usual)
        finally:
            path.write_bytes(original)
        return "timeout" if code is None else "killed" if code else "survived"

    def time_tests(self, tests: Sequence[str]) -> float:
        """Measures how long tests take, which must pass [s]."""
        began = time.monotonic()
        if self._run(tests, 600.0) != 0:
            raise SystemExit(f"without any mutant, these fail: {' '.join(tests)}")
        return time.monotonic() - began

    def _run(self, tests: Sequence[str], limit: float) -> int | None:
        """Exit code of pytest; None where it takes too long."""
        command = (sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", SELECTION, *tests)
        running = subprocess.Popen(
            command,
            cwd=self.root,
            env=self._environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        resource.prlimit(running.pid, resource.RLIMIT_AS, (MEMORY, MEMORY))
        try:
            return running.wait(limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            _end_group(running)

    def _environment(self) -> dict[str, str]:
        fixed = {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONHASHSEED": "0", "PYTHONPATH": str(self.root)}
        return os.environ | fixed | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def _end_group(running: subprocess.Popen[bytes]) -> None:
    """Ends what the tests of a mutant may have left behind, too."""
    with suppress(ProcessLookupError):
        os.killpg(running.pid, signal.SIGKILL)
    running.wait()
