"""Film options of `kinesic perform`."""

import ast
import sys

import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.extras import install_command
from kinesic.report import films
from kinesic.sim.gl import opengl_fault

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.6"/></bml>'


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--film-size", "wide", "'wide' is not a size; give two whole numbers, as in 1280x720"),
        ("--film-size", "321x240", "both sides must be even, 64 to 2048 pixels"),
        ("--film-size", "32x32", "both sides must be even, 64 to 2048 pixels"),
        ("--film-rate", "0", "0 is not in the range 1.0<=x<=60.0"),
        ("--film-format", "gif", "'gif' is not one of 'webp', 'mp4'"),
    ],
)
def test_invalid_film_options_are_refused(kinesic, option, value, words):
    ended = kinesic("perform", "-", option, value, stdin=NOD)
    assert ended.code == 2
    assert words in ended.err.replace(",0", ".0")


def test_mp4_without_an_encoder_is_refused_before_planning(kinesic, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    ended = kinesic("perform", "-", "--film-format", "mp4", "--out", "out", stdin=NOD)
    assert ended.code == 2
    assert f"no encoder for .mp4: {install_command()} imageio-ffmpeg, or install ffmpeg" in ended.err
    assert not (tmp_path / "out").exists()
    assert "no encoder for .mp4" in kinesic("doctor").out.replace("\n", " ")


def test_film_of_several_robots_as_mp4_is_refused(kinesic, tmp_path):
    (tmp_path / "nod.bml").write_bytes(NOD)
    ended = kinesic(
        "perform", tmp_path / "nod.bml", "--robot", "upper22,human", "--film-format", "mp4", "--out", "both"
    )
    assert ended.code == 2
    assert "--film-format mp4: several robots are filmed side by side only as webp" in ended.err


def test_mp4_film_has_the_requested_size_frame_rate_and_sound(kinesic, tmp_path, monkeypatch):
    """Replace ffmpeg by a program that stores its arguments."""
    if why := opengl_fault():
        pytest.skip(why)
    begin = films._process
    monkeypatch.setattr(films, "_process", lambda kind: begin("twin"))  # The face is slow to open.
    monkeypatch.setattr("kinesic.report.output.face_film", lambda plan, rate: None)
    program = tmp_path / "ffmpeg"
    program.write_text(
        f"#!{sys.executable}\nimport sys\nfrom pathlib import Path\n"
        "size = len(sys.stdin.buffer.read())\nPath(sys.argv[-1]).write_text(repr((size, sys.argv)))\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr("kinesic.report.output.sound", lambda plan: Sound.of(22050, np.zeros(2205)))
    assert str(program) in kinesic("doctor").out.replace("\n", "")
    (tmp_path / "nod.bml").write_bytes(NOD)
    options = ("--film-size", "160x90", "--film-rate", "5", "--film-format", "mp4")
    ended = kinesic("perform", tmp_path / "nod.bml", "--out", "out", *options)
    assert ended.code == 0
    assert "film: out/film.mp4" in ended.out
    size, words = ast.literal_eval((tmp_path / "out" / "film.mp4").read_text())
    assert size % (160 * 90 * 3) == 0 < size
    assert (words[words.index("-s") + 1], words[words.index("-r") + 1]) == ("160x90", "5")
    assert words[words.index("-i", words.index("-i") + 1) + 1].endswith("speech.wav")
    assert '<video controls loop src="data:video/mp4;base64,' in (tmp_path / "out" / "report.html").read_text()
