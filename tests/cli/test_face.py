"""Verb `kinesic face`."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic import egl
from kinesic.cli import main
from kinesic.cli.effects import FaceView
from kinesic.cli.face import ViewSettings
from kinesic.face.assets.mesh import load_head
from kinesic.face.render import portrait
from kinesic.face.render.camera import CLOSE_CAMERA
from kinesic.face.render.effects import Effects
from kinesic.face.show.window import has_display


def run_face(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Run `kinesic face` with arguments, and return the exit code."""
    monkeypatch.setattr(sys, "argv", ["kinesic", "face", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_face_picture_has_the_requested_size(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    out = tmp_path / "x.png"
    code = run_face(
        monkeypatch, "--au", "1=0.8, 2=0.8", "--out", str(out), "--size", "64", "--variant", "male", "--yaw", "30"
    )
    assert code == 0
    assert capsys.readouterr().out.splitlines()[-1].endswith(str(out))
    assert np.asarray(Image.open(out)).shape == (64, 64, 3)


def test_film_of_an_expression_has_more_than_20_frames(drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    out = tmp_path / "x.webp"
    assert run_face(monkeypatch, "--au", "26=1", "--out", str(out), "--size", "32", "--preset", "draft") == 0
    with Image.open(out) as film:
        assert film.n_frames > 20  # WebP merges equal successive frames


def test_option_light_changes_the_brightness_within_a_face_film(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    out, words = tmp_path / "x.webp", ("--size", "32", "--preset", "draft", "--light", "0.1:1")
    assert run_face(monkeypatch, "--au", "26=1", "--out", str(out), *words) == 0
    brightness = []
    with Image.open(out) as film:
        for k in range(film.n_frames):
            film.seek(k)
            brightness.append(np.asarray(film.convert("L"))[8:24, 8:24].mean())
    assert max(brightness[: len(brightness) // 3]) < 0.8 * min(brightness[2 * len(brightness) // 3 :])


def test_face_films_are_supersampled_only_up_to_a_moderate_size():
    def samples(preset: str, size: int | None, *, filmed: bool) -> int:
        return (
            ViewSettings(FaceView("female", preset, 0.0, size, 1.0, "1"), CLOSE_CAMERA, Effects())
            .choose_preset(filmed=filmed)
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


@pytest.mark.parametrize(("name", "max_width"), [("x.webp", 32), ("x.png", 2048)])
def test_face_of_a_document_is_drawn_as_a_webp_film_or_a_png_strip(
    drawable: None, document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, max_width: int
):
    out = tmp_path / name
    words = ["--bml", str(document), "--out", str(out), "--size", "32", "--preset", "draft", "--voice", "durations"]
    assert run_face(monkeypatch, *words) == 0
    with Image.open(out) as film:
        assert film.width <= max_width
        assert film.width * film.height * getattr(film, "n_frames", 1) >= 10 * 32 * 32


def test_emotion_option_draws_the_same_picture_as_its_action_units(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for name, words in (("a.png", ["--emotion", "smile"]), ("b.png", ["--au", "6=0.5,12=0.9"])):
        assert run_face(monkeypatch, *words, "--out", str(tmp_path / name), "--size", "48", "--preset", "draft") == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("words", [[], ["--bml", "b.bml"], ["--sheet"]])
def test_face_without_a_display_asks_for_an_output_file(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if has_display():
        pytest.skip("this system has a display in any case")
    assert run_face(monkeypatch, *words) == 2
    assert capsys.readouterr().err == ("kinesic: no display for a window; --out X.png, X.webp or X.mp4 writes a file\n")


def test_face_options_au_and_sheet_together_are_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    assert run_face(monkeypatch, "--au", "1=1", "--sheet", "--out", "x.png") == 2
    assert "choose one" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--emotion", "Qwrtz"],
            "no expression has this name; there are raise brow, lower brow, oblique,",
        ),
        (["--bml", "nowhere.bml"], "nowhere.bml: No such file"),
        (["--au", "99=1"], "no action unit 99"),
        (["--au", "1=1.5"], "action unit 1 is 1.5"),
        (["--au", "1=nan"], "action unit 1 is nan"),
        (["--au", "frown"], "such as 12=0.8"),
        (["--size", "0"], "0 x 0 pixels"),
        (["--yaw", "inf"], "yaw inf is not finite"),
        (["--focus", "nose"], "focus 'nose': write eyes, a distance such as 0.8"),
        (["--focus", "20"], "focus at 20 m; use 0.1 to 7 m"),
        (["--light", "dim"], "--light dim: give a brightness relative to the default, 0.01 to 4"),
        (["--light", "9"], "--light 9: give a brightness"),
        (["--light", "0.1:1"], "two values need a film of an expression, such as --out X.mp4"),
    ],
)
def test_invalid_face_options_are_reported_in_one_line(
    words: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    assert run_face(monkeypatch, *words, "--out", str(tmp_path / "x.png")) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not (tmp_path / "x.png").exists()


def test_missing_head_mesh_is_reported_in_one_line(
    drawable: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(load_head, "__kwdefaults__", {"path": tmp_path / "head.npz"})
    portrait._load_mesh.cache_clear()
    assert run_face(monkeypatch, "--out", str(tmp_path / "x.png")) == 2
    error = capsys.readouterr().err
    assert "head.npz: no such file; it is part of kinesic: install kinesic again" in error
    assert error.count("\n") == 1


def test_missing_opengl_is_reported_with_the_packages_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(egl, "EGL_LIBRARY", "libabsent.so.1")
    monkeypatch.setattr(egl, "start_egl", egl.Egl)
    assert run_face(monkeypatch, "--out", str(tmp_path / "x.png")) == 2
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
def test_effect_options_change_the_face_picture(
    drawable: None, words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    plain, other = tmp_path / "a.png", tmp_path / "b.png"
    assert run_face(monkeypatch, "--size", "64", "--out", str(plain)) == 0
    assert run_face(monkeypatch, "--size", "64", "--out", str(other), *words) == 0
    one, two = (np.asarray(Image.open(path)).astype(int) for path in (plain, other))
    assert np.abs(one - two).max() >= 2
