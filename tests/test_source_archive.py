"""The source archive: two people who build it get the same bytes."""

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
BUILD = "import sys, build_backend; print(build_backend.build_sdist(sys.argv[1]))"

pytest.importorskip("setuptools", minversion="77", reason="a setuptools that can build is not installed")


def small_project(folder: Path, *, umask: int) -> Path:
    """Copy what the archive is made of, with a few sources, as somebody with this umask would have it."""
    before = os.umask(umask)
    try:
        (folder / "kinesic").mkdir(parents=True)
        for name in ("__init__.py", "version.py"):
            shutil.copyfile(ROOT / "kinesic" / name, folder / "kinesic" / name)
        for name in ("pyproject.toml", "build_backend.py", "README.md", "LICENSE", "NOTICE", "MANIFEST.in", "Makefile"):
            shutil.copyfile(ROOT / name, folder / name)
    finally:
        os.umask(before)
    return folder


def build(folder: Path, *, umask: int) -> str:
    """Return the hash of the archive that is built in a folder."""
    command = [sys.executable, "-c", BUILD, "out"]
    (folder / "out").mkdir()
    subprocess.run(command, cwd=folder, check=True, capture_output=True, umask=umask)
    (archive,) = (folder / "out").glob("*.tar.gz")
    return hashlib.sha256(archive.read_bytes()).hexdigest()


def test_two_folders_times_and_umasks_give_the_same_bytes(tmp_path: Path):
    first, second = small_project(tmp_path / "a", umask=0o022), small_project(tmp_path / "longer name", umask=0o077)
    for path in second.rglob("*"):
        os.utime(path, (1e9, 1e9))
    assert build(first, umask=0o022) == build(second, umask=0o077)
