"""Verbs `kinesic capture` and `kinesic gestures install`."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli import kinesic as command

from ..capture.clips import bvh, reach


def run(*arguments: str) -> int:
    return command(list(arguments), standalone_mode=False)


@pytest.fixture(autouse=True)
def clips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of one clip in the current folder."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "clips"
    folder.mkdir()
    (folder / "OfferRt.bvh").write_bytes(bvh(reach(100)))
    return folder


def test_clips_are_imported_listed_installed_and_removed(capsys):
    assert run("capture", "import", "clips", "--out", "mine", "--licence", "CC0") == 0
    out = capsys.readouterr().out
    assert out.startswith("1 gestures: 1 metaphoric\nlicence: CC0\n")
    assert out.endswith("gestures: mine\n")
    assert run("gestures", "show", "offer_rt", "--lexicon", "mine") == 0
    assert "captured: offer rt" in capsys.readouterr().out
    assert run("gestures", "install", "mine") == 0
    assert capsys.readouterr().out.startswith("clips: 1 gestures, licence CC0, from clips\n")
    assert run("gestures", "remove", "clips") == 0
    assert not Path("gestures/clips").exists()


def test_clips_that_an_import_skips_are_listed_and_set_the_exit_code(clips, capsys):
    (clips / "bad.bvh").write_bytes(b"nothing")
    assert run("capture", "import", "clips", "--out", "mine") == 1
    assert "left out: clips/bad.bvh" in capsys.readouterr().err
    with pytest.raises(ConfigError, match="exists already"):
        run("capture", "import", "clips", "--out", "mine")


def test_motion_graph_of_a_library_is_summarised(clips, capsys):
    for number in range(2):
        (clips / f"OfferRt{number}.bvh").write_bytes(bvh(reach(100, height=60 + number)))
    run("capture", "import", "clips", "--out", "mine")
    capsys.readouterr()
    assert run("capture", "graph", "mine") == 0
    out = capsys.readouterr().out
    assert out.startswith("3 gestures, 3 preparation, 3 stroke,")
    assert "transitions between 3 connected gestures" in out
    assert "separate" not in out
    with pytest.raises(ConfigError, match="no collection"):
        run("capture", "graph", "clips")
