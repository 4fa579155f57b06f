"""Builds kinesic with setuptools, and a source archive whose bytes depend on the sources alone.

setuptools writes times, users and permissions of the machine into the archive. They are replaced here, so that anyone
can build the archive again and compare it with the published one.
"""

import gzip
import io
import os
import tarfile
from pathlib import Path

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403 - the hooks of PEP 517 and PEP 660 other than the one below

SOURCE_TIME = 1_767_225_600  # [s] 2026-01-01 UTC, unless SOURCE_DATE_EPOCH says otherwise


def build_sdist(sdist_directory: str, config_settings: dict[str, str | list[str] | None] | None = None) -> str:
    """Build the source archive, the same bytes at any time, place and umask."""
    name = build_meta.build_sdist(sdist_directory, config_settings)
    path = Path(sdist_directory, name)
    path.write_bytes(_normalised(path.read_bytes(), int(os.environ.get("SOURCE_DATE_EPOCH", SOURCE_TIME))))
    return name


def _normalised(archive: bytes, time: int) -> bytes:
    """Return the archive in the order of names, without times, owners and permissions of this machine."""
    plain = io.BytesIO()
    with tarfile.open(fileobj=io.BytesIO(archive)) as old, tarfile.open(fileobj=plain, mode="w") as new:
        for entry in sorted(old.getmembers(), key=lambda each: each.name):
            entry.mtime, entry.uid, entry.gid, entry.uname, entry.gname, entry.pax_headers = time, 0, 0, "", "", {}
            entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
            new.addfile(entry, old.extractfile(entry) if entry.isreg() else None)
    return gzip.compress(plain.getvalue(), mtime=0)
