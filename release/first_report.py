"""Measure time and size of a first installation and performance of kinesic.

An empty folder gets a virtual environment, kinesic from a folder of wheels and everything else from the package index,
with nothing cached; then `kinesic demo` performs the greeting there. The time of each step and the sizes are printed.
Run the script on an idle machine.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PIP_OPTIONS = ("--quiet", "--disable-pip-version-check", "--no-cache-dir")


@dataclass(frozen=True)
class Step:
    """Command of a new user, with its elapsed and processor time."""

    name: str
    elapsed: float  # [s] wall time
    processor: float  # [s] CPU time of all processes


def main() -> None:
    """Measure all steps, and exit with an error if one fails."""
    parser = argparse.ArgumentParser(description="Measure time and size of a first installation and performance.")
    parser.add_argument("--wheels", type=Path, default=ROOT / "dist", help="folder of the wheels (default: dist)")
    parser.add_argument("--python", default=sys.executable, help="interpreter of the environment (default: this one)")
    arguments = parser.parse_args()
    if not [*arguments.wheels.glob("kinesic-*.whl")]:
        sys.exit(f"{arguments.wheels} has no wheel of kinesic; `make wheels` builds it")
    with tempfile.TemporaryDirectory(prefix="kinesic-first-report-") as folder:
        print(measure(Path(folder), arguments.wheels.resolve(), arguments.python))


def measure(folder: Path, wheels: Path, python: str) -> str:
    """Install and run kinesic in an empty folder, and return the measurements.

    Raises:
        SystemExit: a step fails, or writes no report.
    """
    environment, packages = folder / "environment", folder / "packages"
    pip = [environment / "bin" / "python", "-m", "pip"]
    commands = {
        "environment": [python, "-m", "venv", environment],
        "download": [*pip, "download", *PIP_OPTIONS, "--dest", packages, "--find-links", wheels, "kinesic"],
        "installation": [*pip, "install", *PIP_OPTIONS, "--no-index", "--find-links", packages, "kinesic"],
        "kinesic demo": [environment / "bin" / "kinesic", "demo", "--no-open"],
    }
    steps = [run(name, command, folder) for name, command in commands.items()]
    reports = [path for path in folder.rglob("report.html") if environment not in path.parents]
    if not reports:
        sys.exit("kinesic demo wrote no report.html")
    return describe(steps, installed=size_of(environment), downloaded=size_of(packages))


def run(name: str, command: list[object], folder: Path) -> Step:
    """Run a command with default settings, and return its times."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("KINESIC_", "PYTHON", "VIRTUAL_"))}
    start, used = time.monotonic(), _used_by_children()
    done = subprocess.run(
        [*map(str, command)],
        cwd=folder,
        env=clean,
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    if done.returncode:
        sys.exit(f"{name} failed:\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return Step(name, time.monotonic() - start, _used_by_children() - used)


def size_of(folder: Path) -> int:
    """Return the total size [bytes] of a folder's files, without links."""
    return sum(path.lstat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


def describe(steps: list[Step], *, installed: int, downloaded: int) -> str:
    """Return a table of the steps, their sum and the sizes."""
    total = Step("all", sum(step.elapsed for step in steps), sum(step.processor for step in steps))
    rows = [f"{step.name:14}{step.elapsed:8.1f} s{step.processor:8.1f} s" for step in (*steps, total)]
    heading = f"{'step':14}{'elapsed':>10}{'processor':>10}"
    sizes = [f"installed {installed / 1e6:.0f} MB, downloaded {downloaded / 1e6:.0f} MB"]
    return "\n".join([heading, *rows, *sizes])


def _used_by_children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
