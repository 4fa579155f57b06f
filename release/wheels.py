"""Build the source archive and the Linux wheels of kinesic, and check them.

The wheels are for x86-64 and aarch64. CPython 3.11 has a wheel of its own; a second one, with the stable ABI, serves
3.12 and all later versions. All are compiled by zig (PyPI package ziglang) for old versions of glibc, so that any Linux
machine of either processor can build both.

Needed are CPython 3.11 and one later version with their headers (pyenv, uv or python.org; those of Debian lack the
headers of other processors), and the tools of the extra `release` beside the interpreter that runs this script.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NEWEST_GLIBC = {"x86_64": 17, "aarch64": 28}  # minor version of glibc 2 that a wheel may need, by processor
BUILD_FOLDER = ROOT / "build" / "wheels"  # folder that every run empties
OWN_VERSION = (3, 11)  # CPython version with its own wheel, as nanobind needs a later stable ABI
VERSION_QUERY = "import sys; print(*sys.version_info[:2])"
HEADER_QUERY = "import os, sysconfig; print(os.path.exists(os.path.join(sysconfig.get_path('include'), 'Python.h')))"


@dataclass(frozen=True, eq=False)
class Interpreter:
    """CPython interpreter with headers for compiling extensions."""

    path: str
    version: tuple[int, int]


def main() -> None:
    """Build all archives, and exit with an error if a check fails."""
    parser = argparse.ArgumentParser(description="Build and check the source archive and the Linux wheels.")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the archives (default: dist)")
    parser.add_argument("--python", action="append", help="interpreter: 3.11 and a later one; default: those found")
    parser.add_argument("--processor", action="append", choices=NEWEST_GLIBC, help="default: both")
    arguments = parser.parse_args()
    interpreters = choose_interpreters(arguments.python or [*find_interpreters()])
    arguments.out.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(BUILD_FOLDER, ignore_errors=True)
    BUILD_FOLDER.mkdir(parents=True)
    built = build_all(interpreters, arguments.processor or [*NEWEST_GLIBC], BUILD_FOLDER)
    check(built)
    for path in built:
        shutil.copy(path, arguments.out / path.name)
        print(f"{arguments.out / path.name}: {path.stat().st_size / 1e6:.1f} MB")


def find_interpreters() -> Iterator[str]:
    """Yield the paths of the Python interpreters on PATH and in pyenv."""
    names = [f"python3.{minor}" for minor in range(OWN_VERSION[1], 20)]
    yield from (path for name in names if (path := shutil.which(name)))
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"), "versions")
    yield from (str(path) for path in sorted(pyenv.glob("3.*/bin/python")))


def choose_interpreters(paths: list[str]) -> list[Interpreter]:
    """Return CPython 3.11 and the oldest later version, both with headers.

    Raises:
        SystemExit: one of them is missing.
    """
    usable = [Interpreter(path, version) for path in paths if (version := read_version(path)) is not None]
    own = [each for each in usable if each.version == OWN_VERSION]
    later = sorted((each for each in usable if each.version > OWN_VERSION), key=lambda each: each.version)
    if not own or not later:
        found = ", ".join(f"{each.path} ({each.version[0]}.{each.version[1]})" for each in usable) or "none"
        sys.exit(f"CPython 3.11 and a later version with headers (Python.h) are needed; found: {found}; see --python")
    return [own[0], later[0]]


def read_version(path: str) -> tuple[int, int] | None:
    """Return the version of an interpreter, or None without headers."""
    asked = [path, "-c", f"{VERSION_QUERY}; {HEADER_QUERY}"]
    answer = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.split()
    return (int(answer[0]), int(answer[1])) if answer[2:] == ["True"] else None


def build_all(interpreters: list[Interpreter], processors: list[str], folder: Path) -> list[Path]:
    """Build the source archive and its wheels, and return their paths."""
    run(sys.executable, "-m", "build", "--sdist", "--outdir", folder, ROOT)
    (archive,) = folder.glob("*.tar.gz")
    built = [archive]
    for interpreter in interpreters:
        python = make_environment(interpreter, folder / f"python{interpreter.version[1]}")
        for processor in processors:
            source = folder / f"source-{interpreter.version[1]}-{processor}"
            with tarfile.open(archive) as packed:
                packed.extractall(source, filter="data")
            (tree,) = source.iterdir()
            built.append(build_wheel(interpreter, python, processor, tree, folder / "wheels"))
            shutil.rmtree(source)
    return built


def make_environment(interpreter: Interpreter, folder: Path) -> Path:
    """Create an environment with kinesic's build tools, and return its Python."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    run(interpreter.path, "-m", "venv", folder)
    python = folder / "bin" / "python"
    tools = ["build", *project["build-system"]["requires"], *project["project"]["optional-dependencies"]["compiler"]]
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *tools)
    return python


def build_wheel(interpreter: Interpreter, python: Path, processor: str, tree: Path, folder: Path) -> Path:
    """Compile a wheel, tagged with the oldest platform that it supports."""
    is_stable = interpreter.version > OWN_VERSION
    environment = os.environ | {
        "KINESIC_WHEEL_TARGET": processor,
        "KINESIC_ABI3": "1" if is_stable else "0",
        "_PYTHON_HOST_PLATFORM": f"linux-{processor}",
    }
    if not is_stable:
        environment["SETUPTOOLS_EXT_SUFFIX"] = f".cpython-{''.join(map(str, OWN_VERSION))}-{processor}-linux-gnu.so"
    raw = tree.parent / "raw"
    run(python, "-m", "build", "--wheel", "--no-isolation", "--outdir", raw, tree, environment=environment)
    (wheel,) = raw.glob("*.whl")
    target = folder / f"{interpreter.version[1]}-{processor}"
    run(*auditwheel("repair", "--plat", "auto", "--only-plat", "--wheel-dir", target, wheel))
    (repaired,) = target.glob("*.whl")
    return repaired


def check(built: list[Path]) -> None:
    """Check the metadata of all archives and the libraries of all wheels.

    Raises:
        SystemExit: a wheel needs a newer platform than its name states.
    """
    run(sys.executable, "-m", "twine", "check", "--strict", *built)
    for wheel in (path for path in built if path.suffix == ".whl"):
        shown = run(*auditwheel("show", wheel))
        glibc, processor = read_platform(shown)
        print(f"{wheel.name}: glibc 2.{glibc}, {processor}")
        if glibc > NEWEST_GLIBC[processor] or f"manylinux_2_{glibc}_{processor}" not in wheel.name:
            sys.exit(
                f"{wheel.name} needs a newer glibc than 2.{NEWEST_GLIBC[processor]}, or has another name:\n{shown}"
            )


def read_platform(shown: str) -> tuple[int, str]:
    """Return minor glibc 2 version and processor from auditwheel's output.

    Raises:
        SystemExit: the wheel is consistent with no platform, or needs libraries of other packages.
    """
    found = re.search(r'following\s+platform\s+tag:\s+"manylinux_2_(\d+)_(\w+)"', shown)
    if found is None:  # libraries of other packages make it a mere linux_...
        sys.exit(f"auditwheel does not allow this wheel everywhere:\n{shown}")
    return int(found[1]), found[2]


def auditwheel(*arguments: object) -> list[object]:
    """Return the command that runs auditwheel with this Python."""
    return [sys.executable, "-m", "auditwheel", *arguments]


def run(*command: object, environment: dict[str, str] | None = None) -> str:
    """Run a command and return its output, or exit if it fails."""
    environment = dict(environment or os.environ)
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    done = subprocess.run([*map(str, command)], env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


if __name__ == "__main__":
    main()
