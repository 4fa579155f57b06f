"""Film and window of the face in `kinesic perform`."""

import json
import os
import re
import sys

import pytest
from PIL import Image

from kinesic.face.display import find_display_problem
from kinesic.face.show.window import has_display
from kinesic.files import late_pillow

SMILE = (
    b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><speech id="s"><text>My mum.</text></speech>'
    b'<faceLexeme id="f" lexeme="smile"/><face id="g" type="FACS" au="99" start="0" end="1"/></bml>'
)

SMALL_FILM = ("--film-size", "160x90", "--film-rate", "5")  # options of the twin's film


@pytest.fixture
def smile(tmp_path):
    path = tmp_path / "smile.bml"
    path.write_bytes(SMILE)
    return path


def test_report_page_contains_a_film_of_the_face(kinesic, smile, tmp_path):
    if find_display_problem() is not None:
        pytest.skip(str(find_display_problem()))
    ended = kinesic("perform", smile, "--out", "there", "--voice", "durations", *SMALL_FILM)
    assert ended.code == 0, ended.err
    assert "face: there/face.webp" in ended.out
    with Image.open(tmp_path / "there" / "face.webp") as film:
        assert film.n_frames > 5
    assert 'class="filmed" src="data:image/webp;base64,' in (tmp_path / "there" / "report.html").read_text()
    data = json.loads((tmp_path / "there" / "report.json").read_text())
    assert [row["outcome"] for row in data["behaviours"]][:2] == ["realised", "realised"]
    (spoken,) = data["speech"]
    assert not spoken["heard"]
    assert {row["id"] for row in data["sync"]} >= {"b:f:attackPeak", "b:f:end"}


WITHOUT_EGL = """
import ctypes

class Loaded(ctypes.CDLL):
    def __init__(self, name, *rest, **more):
        if "libEGL" in str(name):
            raise OSError(name)
        super().__init__(name, *rest, **more)

ctypes.CDLL = Loaded
"""


def run_at_start(code, folder, monkeypatch):
    """Run code at the start of the processes that draw films."""
    (folder / "empty").mkdir()
    (folder / "empty" / "sitecustomize.py").write_text(code)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder / "empty"), os.environ.get("PYTHONPATH", "")]))


def test_report_page_explains_a_missing_film_without_opengl(kinesic, smile, tmp_path, monkeypatch):
    run_at_start(WITHOUT_EGL, tmp_path, monkeypatch)
    ended = kinesic("perform", smile, "--out", "there", "--voice", "durations", *SMALL_FILM)
    assert ended.code == 0, ended.err
    pattern = r"no OpenGL: libEGL\.so\.1( and libGL\.so\.1)? cannot be loaded; apt-get install libegl1 libgl1"
    match = re.search(rf"face: none \(({pattern})\)", ended.out)
    assert match is not None, ended.out
    reason = match[1]
    page = (tmp_path / "there" / "report.html").read_text()
    assert f"No film of the face: {reason}".replace("'", "&#39;") in page


def test_report_without_pillow_gives_the_reason_for_the_missing_film(kinesic, tmp_path, monkeypatch):
    for module in ("PIL", *(f"PIL.{name}" for name in ("Image", "ImageDraw", "ImageFilter", "ImageFont"))):
        monkeypatch.setitem(sys.modules, module, None)  # cannot be imported
    for module in (late_pillow.Image, late_pillow.ImageDraw, late_pillow.ImageFilter, late_pillow.ImageFont):
        for name in [name for name in vars(module) if not name.startswith("_")]:
            monkeypatch.delattr(module, name)  # imported by another test
    run_at_start("import sys\nsys.modules['PIL'] = None\n", tmp_path, monkeypatch)
    (tmp_path / "beat.bml").write_text('<bml id="b"><gesture id="g" lexeme="beat" stroke="0.6"/></bml>')
    ended = kinesic("perform", "beat.bml", "--out", "beat")
    assert ended.code == 0, ended.err
    assert (tmp_path / "beat" / "report.html").is_file()
    for film, extra in (("film", "film"), ("face", "face")):
        assert re.search(rf'^{film}: none \(Pillow is not installed: .*kinesic\[{extra}\]"', ended.out, re.MULTILINE)


def test_perform_on_the_face_without_a_display_only_warns(kinesic, smile, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if has_display():
        pytest.skip("this system has a display in any case")
    ended = kinesic("perform", smile, "--out", "there", "--no-film", "--on", "face,twin", "--voice", "durations")
    assert ended.code == 0, ended.err
    assert "face: no display for a window" in ended.err
    assert "face: none (not requested)" in ended.out


def test_unknown_value_of_option_on_is_reported_with_the_valid_values(kinesic, smile):
    ended = kinesic("perform", smile, "--on", "nose", "--out", "there", "--no-film")
    assert ended.code == 2
    assert "'nose' is not one of twin, servos, face" in ended.err
