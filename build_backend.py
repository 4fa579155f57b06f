"""Builds kinesic with setuptools: reproducible source archives, and a C++ compiler where the machine has none.

setuptools writes times, users and permissions of the machine into the archive. They are replaced here, so that anyone
can build the archive again and compare it with the published one. On Linux without a C++ compiler, the extension is
compiled by the one in the PyPI package ziglang; Python's headers come from the distribution if they are missing.

Three environment variables serve published wheels. KINESIC_WHEEL_TARGET is the processor for which zig compiles;
KINESIC_ABI3=1 makes one wheel for CPython 3.12 and all later versions. KINESIC_HOME is the web address of the
repository, to which links and pictures of the README lead on PyPI.
"""

import gzip
import io
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
from pathlib import Path

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403 - the hooks of PEP 517 and PEP 660 other than those below

Settings = dict[str, str | list[str] | None] | None

SOURCE_TIME = 1_767_225_600  # [s] 2026-01-01 UTC, unless SOURCE_DATE_EPOCH is set
ZIG_TARGETS = {"x86_64": "x86_64-linux-gnu.2.17", "aarch64": "aarch64-linux-gnu.2.28"}  # processor -> oldest glibc
STABLE_ABI_VERSION = (3, 12)  # oldest CPython whose stable ABI suffices for nanobind


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    """Build the source archive, the same bytes at any time, place and umask."""
    name = build_meta.build_sdist(sdist_directory, config_settings)
    path = Path(sdist_directory, name)
    path.write_bytes(_normalised(path.read_bytes(), int(os.environ.get("SOURCE_DATE_EPOCH", SOURCE_TIME))))
    return name


def get_requires_for_build_wheel(config_settings: Settings = None) -> list[str]:
    """Return the packages that a wheel needs: those of setuptools, and a compiler if the machine has none."""
    return [*build_meta.get_requires_for_build_wheel(config_settings), *missing_compiler()]


def get_requires_for_build_editable(config_settings: Settings = None) -> list[str]:
    """Return the packages that an editable installation needs, as for a wheel."""
    return [*build_meta.get_requires_for_build_editable(config_settings), *missing_compiler()]


def published_readme() -> str:
    """Return the README, with absolute links to this version if KINESIC_HOME is set."""
    text = Path("README.md").read_text(encoding="utf-8")
    home = os.environ.get("KINESIC_HOME", "").rstrip("/")
    if not home:
        return text
    version = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]

    def make_absolute(link: re.Match[str]) -> str:
        view = "raw" if link["picture"] else "blob"
        return f"{link['picture']}[{link['text']}]({home}/{view}/v{version}/{link['path']})"

    return re.sub(r"(?P<picture>!?)\[(?P<text>[^]]*)\]\((?!\w+:|#)(?P<path>[^)]+)\)", make_absolute, text)


def missing_compiler() -> list[str]:
    """Return the PyPI packages of a compiler (clang, libc++ and old glibc versions), if the machine needs them."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    return project["optional-dependencies"]["compiler"] if needs_zig() else []


def needs_zig() -> bool:
    """Return whether this is a Linux machine of a known processor without a C++ compiler.

    The compiler of the machine is not used either for a wheel that is to be published.
    """
    if sys.platform != "linux" or target_processor() not in ZIG_TARGETS:
        return False  # setuptools finds the compilers of macOS and Windows itself
    if "KINESIC_WHEEL_TARGET" in os.environ:
        return True
    named = os.environ.get("CXX") or sysconfig.get_config_var("CXX") or "c++"
    return not any(shutil.which(name) for name in (named.split()[0], "c++", "g++", "clang++"))


def target_processor() -> str:
    """Return the processor for which the extension is compiled."""
    return os.environ.get("KINESIC_WHEEL_TARGET") or platform.machine()


def uses_stable_abi() -> bool:
    """Return whether the extension is to run on later versions of CPython, too."""
    return os.environ.get("KINESIC_ABI3") == "1" and sys.version_info[:2] >= STABLE_ABI_VERSION


def write_zig(folder: Path) -> str:
    """Write a program that calls zig's C++ compiler for the target, without its sanitizers; return its path."""
    program = folder.absolute() / "zig-c++"
    command = [sys.executable, "-m", "ziglang", "c++", "-target", ZIG_TARGETS[target_processor()], "-fno-sanitize=all"]
    folder.mkdir(parents=True, exist_ok=True)
    program.write_text(f'#!/bin/sh\nexec {shlex.join(command)} "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    return str(program)


def python_headers(folder: Path) -> list[str]:
    """Return include folders of Python's headers in addition to those of the interpreter.

    Python of Debian and Ubuntu has its headers in a package of its own, which apt-get can fetch without root.

    Args:
        folder: into which the package is unpacked.

    Raises:
        FileNotFoundError: the headers are missing, and this is not Debian or Ubuntu.
    """
    if Path(sysconfig.get_path("include"), "Python.h").exists():
        return []
    name = f"python{sys.version_info.major}.{sys.version_info.minor}"
    headers = folder / "usr" / "include"
    if not (headers / name / "Python.h").exists():
        _unpack_debian(f"lib{name}-dev", folder)
    return [str(headers / name), str(headers)]


def _unpack_debian(package: str, folder: Path) -> None:
    """Fetch a package of the distribution, and unpack it into a folder; nothing is installed."""
    if not shutil.which("apt-get") or not shutil.which("dpkg-deb"):
        raise FileNotFoundError(
            f"Python.h is not in {sysconfig.get_path('include')}: install python3-dev or python3-devel, "
            "or take a Python that has its headers (pyenv, uv, conda)"
        )
    state = (folder / "apt").absolute()
    for part in ("lists/partial", "archives/partial"):
        (state / part).mkdir(parents=True, exist_ok=True)
    apt = ["apt-get", "-qq", "-o", f"Dir::State={state}", "-o", f"Dir::Cache={state}"]
    apt += ["-o", "Dir::State::status=/var/lib/dpkg/status", "-o", "Acquire::Languages=none"]
    subprocess.run([*apt, "update"], cwd=state, check=True)
    subprocess.run([*apt, "download", package], cwd=state, check=True)
    (archive,) = state.glob(f"{package}_*.deb")
    subprocess.run(["dpkg-deb", "-x", str(archive), str(folder)], check=True)
    shutil.rmtree(state)


def _normalised(archive: bytes, time: int) -> bytes:
    """Return the archive in the order of names, without times, owners and permissions of this machine."""
    plain = io.BytesIO()
    with tarfile.open(fileobj=io.BytesIO(archive)) as old, tarfile.open(fileobj=plain, mode="w") as new:
        for entry in sorted(old.getmembers(), key=lambda member: member.name):
            entry.mtime, entry.uid, entry.gid, entry.uname, entry.gname, entry.pax_headers = time, 0, 0, "", "", {}
            entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
            new.addfile(entry, old.extractfile(entry) if entry.isreg() else None)
    return gzip.compress(plain.getvalue(), mtime=0)
