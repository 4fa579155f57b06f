"""`kinesic face`, as it is typed."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.controller.cli import main


def typed(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """The exit code."""
    monkeypatch.setattr(sys, "argv", ["kinesic", "face", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_a_still(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "x.png"
    code = typed(
        monkeypatch, "--au", "1=0.8, 2=0.8", "--out", str(out), "--size", "64", "--variant", "male", "--yaw", "30"
    )
    assert code == 0
    assert capsys.readouterr().out.splitlines()[-1].endswith(str(out))
    assert np.asarray(Image.open(out)).shape == (64, 64, 3)


def test_a_film_rises_and_falls(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    out = tmp_path / "x.webp"
    assert typed(monkeypatch, "--au", "26=1", "--out", str(out), "--size", "32", "--preset", "draft") == 0
    with Image.open(out) as film:
        assert film.n_frames > 20  # equal neighbours are one frame of WebP


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--au", "99=1"], "no action unit 99"),
        (["--au", "1=1.5"], "action unit 1 is 1.5"),
        (["--au", "1=nan"], "action unit 1 is nan"),
        (["--au", "frown"], "such as 12=0.8"),
        (["--size", "0"], "0 x 0 pixels"),
        (["--yaw", "inf"], "yaw inf is no angle"),
    ],
)
def test_bad_input_is_one_line(
    words: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    assert typed(monkeypatch, *words, "--out", str(tmp_path / "x.png")) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert not (tmp_path / "x.png").exists()


def test_a_machine_without_opengl_is_told_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setitem(sys.modules, "moderngl", None)
    assert typed(monkeypatch, "--out", str(tmp_path / "x.png")) == 2
    assert "pip install 'kinesic[face]'" in capsys.readouterr().err
