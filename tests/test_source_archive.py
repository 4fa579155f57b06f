"""Reproducible source archive."""

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SETUP = "import setuptools; setuptools.setup(long_description='', long_description_content_type='text/markdown')"
BUILD = "import sys, build_backend; print(build_backend.build_sdist(sys.argv[1]))"

pytest.importorskip("setuptools", minversion="77", reason="a setuptools that can build is not installed")


def small_project(folder: Path, *, umask: int) -> Path:
    """Copy the archive's content with a few sources, using a given umask."""
    before = os.umask(umask)
    try:
        (folder / "kinesic").mkdir(parents=True)
        for name in ("__init__.py", "version.py"):
            shutil.copyfile(ROOT / "kinesic" / name, folder / "kinesic" / name)
        for name in ("pyproject.toml", "build_backend.py", "README.md", "LICENSE", "NOTICE", "MANIFEST.in", "Makefile"):
            shutil.copyfile(ROOT / name, folder / name)
        (folder / "setup.py").write_text(SETUP, encoding="utf-8")
    finally:
        os.umask(before)
    return folder


def build(folder: Path, *, umask: int) -> str:
    """Build the archive in a folder and return its hash."""
    command = [sys.executable, "-c", BUILD, "out"]
    (folder / "out").mkdir()
    subprocess.run(command, cwd=folder, check=True, capture_output=True, umask=umask)
    (archive,) = (folder / "out").glob("*.tar.gz")
    return hashlib.sha256(archive.read_bytes()).hexdigest()


def test_source_archive_is_independent_of_folder_time_and_umask(tmp_path: Path):
    first, second = small_project(tmp_path / "a", umask=0o022), small_project(tmp_path / "longer name", umask=0o077)
    for path in second.rglob("*"):
        os.utime(path, (1e9, 1e9))
    assert build(first, umask=0o022) == build(second, umask=0o077)
