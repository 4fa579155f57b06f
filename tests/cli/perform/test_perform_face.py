"""The face in `kinesic perform`."""

import json
import os
import re

import pytest
from PIL import Image

from kinesic.face.display import available
from kinesic.face.show.window import has_display

SMILE = (
    b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><speech id="s"><text>My mum.</text></speech>'
    b'<faceLexeme id="f" lexeme="smile"/><face id="g" type="FACS" au="99" start="0" end="1"/></bml>'
)

SMALL = ("--film-size", "160x90", "--film-rate", "5")  # of the twin's film


@pytest.fixture
def smile(tmp_path):
    path = tmp_path / "smile.bml"
    path.write_bytes(SMILE)
    return path


def test_the_face_is_filmed_and_shown_beside_the_twin(kinesic, smile, tmp_path):
    if available() is not None:
        pytest.skip(str(available()))
    ended = kinesic("perform", smile, "--out", "there", "--voice", "durations", *SMALL)
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


def test_without_opengl_the_page_says_why_there_is_no_face(kinesic, smile, tmp_path, monkeypatch):
    (tmp_path / "empty").mkdir()  # of the process that draws
    (tmp_path / "empty" / "sitecustomize.py").write_text(WITHOUT_EGL)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path / "empty"), os.environ.get("PYTHONPATH", "")]))
    ended = kinesic("perform", smile, "--out", "there", "--voice", "durations", *SMALL)
    assert ended.code == 0, ended.err
    missing = r"no OpenGL: libEGL\.so\.1( and libGL\.so\.1)? cannot be loaded; apt-get install libegl1 libgl1"
    told = re.search(rf"face: none \(({missing})\)", ended.out)
    assert told is not None, ended.out
    why = told[1]
    page = (tmp_path / "there" / "report.html").read_text()
    assert f"No film of the face: {why}".replace("'", "&#39;") in page


def test_on_a_face_without_a_display_it_is_performed_all_the_same(kinesic, smile, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if has_display():
        pytest.skip("this system has a display in any case")
    ended = kinesic("perform", smile, "--out", "there", "--no-film", "--on", "face,twin", "--voice", "durations")
    assert ended.code == 0, ended.err
    assert "face: no display for a window" in ended.err
    assert "face: none (not asked for)" in ended.out


def test_a_face_that_is_nowhere_is_named(kinesic, smile):
    ended = kinesic("perform", smile, "--on", "nose", "--out", "there", "--no-film")
    assert ended.code == 2
    assert "'nose' is not one of twin, servos, face" in ended.err
