"""`kinesic face`, as it is typed."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.cli import main
from kinesic.cli.effects import FaceView
from kinesic.cli.face import ViewSettings
from kinesic.face.assets.mesh import load_head
from kinesic.face.gl import egl
from kinesic.face.render import portrait
from kinesic.face.render.camera import CLOSE
from kinesic.face.render.effects import Effects
from kinesic.face.show.window import has_display


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


def test_light_is_switched_in_the_middle_of_a_film(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    out, words = tmp_path / "x.webp", ("--size", "32", "--preset", "draft", "--light", "0.1:1")
    assert typed(monkeypatch, "--au", "26=1", "--out", str(out), *words) == 0
    bright = []
    with Image.open(out) as film:
        for k in range(film.n_frames):
            film.seek(k)
            bright.append(np.asarray(film.convert("L"))[8:24, 8:24].mean())
    assert max(bright[: len(bright) // 3]) < 0.8 * min(bright[2 * len(bright) // 3 :])


def test_a_film_has_several_samples_a_pixel_where_there_is_room_and_a_still_or_a_draft_one():
    def samples(preset: str, size: int | None, *, filmed: bool) -> int:
        return (
            ViewSettings(FaceView("female", preset, 0.0, size, 1.0, "1"), CLOSE, Effects())
            .preset(filmed=filmed)
            .samples
        )

    assert samples("normal", None, filmed=True) == samples("full", 512, filmed=True) == 2
    assert samples("normal", 512, filmed=False) == samples("draft", 512, filmed=True) == 1
    assert samples("normal", 4000, filmed=True) == 1


BML = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
<speech id="s"><text>My mum.</text></speech><faceLexeme id="f" lexeme="smile" start="0" attackPeak="0.3"/></bml>"""


@pytest.fixture
def document(tmp_path: Path) -> Path:
    path = tmp_path / "b.bml"
    path.write_text(BML)
    return path


@pytest.mark.parametrize(("name", "wide"), [("x.webp", 32), ("x.png", 2048)])
def test_a_document_becomes_a_film_or_a_strip(
    drawable: None, document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, wide: int
):
    out = tmp_path / name
    words = ["--bml", str(document), "--out", str(out), "--size", "32", "--preset", "draft", "--voice", "durations"]
    assert typed(monkeypatch, *words) == 0
    with Image.open(out) as film:
        assert film.width <= wide
        assert film.width * film.height * getattr(film, "n_frames", 1) >= 10 * 32 * 32


def test_an_emotion_is_what_its_units_show(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name, words in (("a.png", ["--emotion", "smile"]), ("b.png", ["--au", "6=0.5,12=0.9"])):
        assert typed(monkeypatch, *words, "--out", str(tmp_path / name), "--size", "48", "--preset", "draft") == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("words", [[], ["--bml", "b.bml"], ["--sheet"]])
def test_without_display_and_file_there_is_nothing_to_draw_on(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if has_display():
        pytest.skip("this system has a display in any case")
    assert typed(monkeypatch, *words) == 2
    assert capsys.readouterr().err == ("kinesic: no display for a window; --out X.png, X.webp or X.mp4 writes a file\n")


def test_one_thing_is_drawn_at_a_time(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    assert typed(monkeypatch, "--au", "1=1", "--sheet", "--out", "x.png") == 2
    assert "choose one" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--emotion", "Qwrtz"], "no expression is called so; there are raise"),
        (["--bml", "nowhere.bml"], "nowhere.bml: No such file"),
        (["--au", "99=1"], "no action unit 99"),
        (["--au", "1=1.5"], "action unit 1 is 1.5"),
        (["--au", "1=nan"], "action unit 1 is nan"),
        (["--au", "frown"], "such as 12=0.8"),
        (["--size", "0"], "0 x 0 pixels"),
        (["--yaw", "inf"], "yaw inf is no angle"),
        (["--focus", "nose"], "focus 'nose': write eyes, a distance such as 0.8"),
        (["--focus", "20"], "focus at 20 m; it may be 0.1 to 7 m"),
        (["--light", "dim"], "--light dim: write how bright it is by the usual light, 0.01 to 4"),
        (["--light", "9"], "--light 9: write how bright it is"),
        (["--light", "0.1:1"], "light changes in the film of an expression alone, such as --out X.mp4"),
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


def test_a_missing_head_is_one_line(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(load_head, "__kwdefaults__", {"path": tmp_path / "head.npz"})
    portrait._mesh.cache_clear()
    assert typed(monkeypatch, "--out", str(tmp_path / "x.png")) == 2
    error = capsys.readouterr().err
    assert "head.npz: no such file; it is part of kinesic: install kinesic again" in error
    assert error.count("\n") == 1


def test_a_machine_without_opengl_is_told_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(egl, "EGL", "libabsent.so.1")
    monkeypatch.setattr(egl, "started", egl.Egl)
    assert typed(monkeypatch, "--out", str(tmp_path / "x.png")) == 2
    assert "no OpenGL: libabsent.so.1 " in (error := capsys.readouterr().err)
    assert error.endswith("apt-get install libegl1 libgl1\n")


@pytest.mark.parametrize(
    "words",
    [
        ["--occlusion", "one-axis", "--occlusion-size", "41", "--falloff", "gaussian", "--estimator", "horizon"],
        ["--pattern", "noise", "--pattern-size", "7"],
        ["--scattering", "levels", "--focus", "0.7:0.8"],
        ["--shadow", "coloured", "--eyeshade"],
        ["--light", "0.5"],
    ],
)
def test_effects_are_switched_one_by_one(
    drawable: None, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    plain, other = tmp_path / "a.png", tmp_path / "b.png"
    assert typed(monkeypatch, "--size", "64", "--out", str(plain)) == 0
    assert typed(monkeypatch, "--size", "64", "--out", str(other), *words) == 0
    one, two = (np.asarray(Image.open(each)).astype(int) for each in (plain, other))
    assert np.abs(one - two).max() >= 2
