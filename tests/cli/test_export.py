"""Verb `kinesic export`."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli import kinesic

BML = '<bml id="b"><head id="n" lexeme="NOD" start="0"/></bml>'


@pytest.fixture(autouse=True)
def document(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A document in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "nod.bml"
    path.write_text(BML)
    return path


def export(*arguments: str) -> int:
    return kinesic(["export", *arguments], standalone_mode=False)


def test_exported_recording_is_named_after_the_document(capsys):
    pytest.importorskip("foxglove", reason="the extra mcap is not installed")
    assert export("nod.bml", "--to", "mcap") == 0
    assert capsys.readouterr().out == "recording: nod.mcap\n"
    assert Path("nod.mcap").read_bytes().startswith(b"\x89MCAP0")
    with pytest.raises(ConfigError, match=r"nod\.mcap"):
        export("nod.bml", "--to", "mcap")
    assert export("nod.bml", "--to", "mcap", "--performed", "--force") == 0
    assert b"/measured/joint_states" in Path("nod.mcap").read_bytes()


@pytest.mark.parametrize(("kind", "right"), [("mcap", "x.mcap"), ("rerun", "x.rrd")])
def test_export_refuses_a_wrong_file_suffix_and_suggests_the_right_one(kind: str, right: str):
    with pytest.raises(ConfigError, match=f"name it {right}"):
        export("nod.bml", "--to", kind, "--out", "x.glb")
