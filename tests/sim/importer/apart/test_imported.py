"""Imports in a separate process: equal robots, and one-line errors."""

import os
import sys
import time
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.apart.imported import Bounds, import_apart
from kinesic.sim.importer.convert import Mapped

LINUX_ONLY = pytest.mark.skipif(sys.platform != "linux", reason="memory and processor time are bounded on Linux")


def refused(path: Path, bounds: Bounds | None = None) -> str:
    with pytest.raises(ConfigError) as caught:
        import_apart(path, bounds=bounds or Bounds())
    said = str(caught.value)
    assert "\n" not in said
    assert said.startswith(str(path))
    return said


@pytest.fixture(scope="module")
def large_mesh(puppets, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write a robot with a mesh of nearly the largest size."""
    folder = tmp_path_factory.mktemp("large")
    rows = [f"v {k % 97} {k % 89} {k % 83}\n" for k in range(600_000)]
    (folder / "large.obj").write_text("".join(rows) + "f 1 2 3\n" * 600_000)
    text = (
        puppets.puppet()
        .replace("<asset>", '<asset><mesh name="large" file="large.obj"/>')
        .replace('mesh="none"', 'mesh="large"')
    )
    path = folder / "large.xml"
    path.write_text(text)
    return path


def test_import_in_a_separate_process_gives_the_same_robot_and_ignores_modules_in_the_current_folder(
    hanging_path: Path, hanging_mapped: Mapped, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "mujoco.py").write_text("raise SystemExit(7)")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [folder for folder in sys.path if folder])  # a program has no empty entry
    result, here = import_apart(hanging_path), hanging_mapped
    assert [row[0] for row in result.mapping] == [hinge.name for hinge in here.hinges]
    assert result.left_out == here.figure.tree.left_out
    assert f"confidence {here.confidence:.2f} of 1" in result.text
    assert not result.shell


@pytest.mark.soak
def test_import_refusal_names_the_file_by_the_path_that_the_user_gave(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("broken.xml").write_text("<mujoco><worldbody>")
    assert refused(Path("broken.xml")).startswith("broken.xml: not a readable MJCF or URDF")
    assert refused(Path("nowhere.xml")) == "nowhere.xml: no such file"


def test_importing_a_named_pipe_is_rejected_without_waiting(tmp_path: Path):
    os.mkfifo(tmp_path / "pipe.xml")
    assert "not a regular file" in refused(tmp_path / "pipe.xml")


@LINUX_ONLY
def test_import_that_needs_more_memory_than_its_limit_is_rejected(large_mesh: Path):
    assert "memory" in refused(large_mesh, Bounds(memory=250_000_000))


@LINUX_ONLY
def test_import_that_needs_more_processor_time_than_its_limit_is_rejected(large_mesh: Path):
    assert "processor time" in refused(large_mesh, Bounds(cpu_time=1))


def test_import_that_takes_longer_than_its_time_limit_is_stopped(hanging_path: Path):
    began = time.monotonic()
    assert "takes longer than 0.05 s" in refused(hanging_path, Bounds(duration=0.05))
    assert time.monotonic() - began < 30.0


@pytest.mark.parametrize(
    ("does", "says"),
    [
        ("kill -SEGV $$", "signal 11"),
        ("echo Trace; echo KeyError: x >&2; exit 1", "KeyError: x"),
        ("echo a", "unreadable"),
    ],
)
def test_failure_of_the_import_process_is_reported_with_its_cause(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hanging_path: Path, does: str, says: str
):
    program = tmp_path / "python"
    program.write_text(f"#!/bin/sh\n{does}\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))
    assert says in refused(hanging_path)
