"""Whatever names, links and races a client comes with: no file outside the folders that it was given is touched."""

import os
import tempfile
from pathlib import Path

import pytest

from kinesic import Performer
from kinesic.files.draft import DRAFT_NAME

from .intruder import SECRET, WEIGHTS, Grounds, Intruder

SAMPLE_SIZE, SOAK_SIZE = 120, 5000  # requests


def attack(root: Path, monkeypatch: pytest.MonkeyPatch, setup, *, count: int, seed: int) -> Intruder:
    """Makes requests, and looks at everything outside before and afterwards."""
    grounds = Grounds(root)
    grounds.lay_out()
    monkeypatch.setenv("HOME", str(grounds.outside / "home"))
    monkeypatch.setattr(tempfile, "tempdir", str(grounds.temporary))
    monkeypatch.chdir(grounds.outside / "work")
    before, roots = grounds.snapshot(), sorted(os.listdir("/"))
    planted = sorted(os.listdir(grounds.temporary))
    intruder = Intruder(grounds, setup, Performer(variation=0.0, idle=0.0), seed)
    with grounds.racing():
        intruder.act(count)
    assert grounds.snapshot() == before
    assert sorted(os.listdir("/")) == roots
    assert sorted({*os.listdir(grounds.temporary)} - {"stranger.toml"}) == planted
    assert sorted(os.listdir(root)) == ["given", "outside", "temporary"]
    assert not list(filter(DRAFT_NAME.fullmatch, os.listdir(grounds.given))), "no draft stays"
    for path in grounds.given.rglob("*"):
        assert path.is_symlink() or not path.is_file() or SECRET not in path.read_text(errors="replace"), path
    assert set(intruder.granted) == set(WEIGHTS), (intruder.granted, "some requests of every kind are granted")
    return intruder


def test_no_file_outside_is_touched_by_a_sample_of_hostile_requests(tmp_path, monkeypatch, upper22_setup):
    attack(tmp_path, monkeypatch, upper22_setup, count=SAMPLE_SIZE, seed=1)


@pytest.mark.soak
def test_no_file_outside_is_touched_by_five_thousand_hostile_requests(tmp_path, monkeypatch, upper22_setup):
    intruder = attack(tmp_path, monkeypatch, upper22_setup, count=SOAK_SIZE, seed=2)
    assert sum(intruder.done.values()) == SOAK_SIZE
    print("requests", dict(intruder.done), "granted", dict(intruder.granted))  # noqa: T201 - for whoever runs with -s
