"""Hostile names, links and races never touch a file outside the given folders."""

import os
import tempfile
from pathlib import Path

import pytest

from kinesic import Performer
from kinesic.files.draft import DRAFT_NAME

from .intruder import REQUEST_WEIGHTS, SECRET_TEXT, Grounds, Intruder

SAMPLE_SIZE = 120  # number of hostile requests in every run
SOAK_SIZE = 5000  # number of hostile requests in `make soak`


def attack(root: Path, monkeypatch: pytest.MonkeyPatch, setup, *, count: int, seed: int) -> Intruder:
    """Make requests and compare all outside files before and after."""
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
        assert path.is_symlink() or not path.is_file() or SECRET_TEXT not in path.read_text(errors="replace"), path
    assert set(intruder.granted) == set(REQUEST_WEIGHTS), (intruder.granted, "some requests of every kind are granted")
    return intruder


def test_sampled_hostile_requests_touch_no_outside_file(tmp_path, monkeypatch, upper22_setup):
    attack(tmp_path, monkeypatch, upper22_setup, count=SAMPLE_SIZE, seed=1)


@pytest.mark.soak
@pytest.mark.parametrize("seed", [2, 3])
def test_five_thousand_hostile_requests_touch_no_outside_file(tmp_path, monkeypatch, upper22_setup, seed):
    intruder = attack(tmp_path, monkeypatch, upper22_setup, count=SOAK_SIZE, seed=seed)
    assert sum(intruder.done.values()) == SOAK_SIZE
    print("requests", dict(intruder.done), "granted", dict(intruder.granted))  # noqa: T201 - for whoever runs with -s
