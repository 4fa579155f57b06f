import sys
import wave
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.action_units import UNITS
from kinesic.face.display import DisplayError
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT
from kinesic.face.show.files import encoder, film_strip, save, save_film
from kinesic.face.show.sheet import ACROSS, GAP, KINDS, LABEL, draw_units_sheet
from kinesic.files import film_file

PIXELS = np.zeros((8, 8, 3), dtype=np.uint8)


def test_a_picture_comes_back(tmp_path: Path):
    pixels = np.random.default_rng(0).integers(0, 256, (8, 12, 3), dtype=np.uint8)
    save(pixels, tmp_path / "x.png")
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "x.png")), pixels)


def test_a_film_has_its_frames(tmp_path: Path):
    frames = [np.full((8, 8, 3), 40 * k, dtype=np.uint8) for k in range(5)]
    save_film(frames, tmp_path / "x.webp", rate=20.0)
    with Image.open(tmp_path / "x.webp") as film:
        assert film.n_frames == 5


@pytest.mark.parametrize("name", ["x.gif", "x", "nowhere/x.png"])
def test_a_path_that_no_picture_goes_to_is_named(tmp_path: Path, name: str):
    with pytest.raises(DisplayError, match=name):
        save(PIXELS, tmp_path / name)


@pytest.mark.parametrize("name", ["x.gif", "x", "nowhere/x.webp"])
def test_a_path_that_no_film_goes_to_is_named(tmp_path: Path, name: str):
    with pytest.raises(DisplayError, match=name):
        save_film([PIXELS], tmp_path / name, rate=24.0)


def test_pictures_of_a_film_keep_the_clock(tmp_path: Path):
    """Periods that are no whole milliseconds do not add up to a drift."""
    frames = [np.full((8, 8, 3), 3 * k, dtype=np.uint8) for k in range(60)]
    save_film(frames, tmp_path / "x.webp", rate=24.0)
    total = 0
    with Image.open(tmp_path / "x.webp") as film:
        for k in range(film.n_frames):
            film.seek(k)
            film.load()
            total += film.info["duration"]
    assert total == 2500


def test_a_strip_has_its_pictures_in_rows():
    frames = [np.full((700, 700, 3), 10 * k, dtype=np.uint8) for k in range(3)]
    pixels = film_strip(frames)
    assert pixels.shape == (1400, 1400, 3)
    assert [pixels[100, 100, 0], pixels[100, 800, 0], pixels[800, 100, 0], pixels[800, 800, 0]] == [0, 10, 20, 0]


def test_an_encoder_makes_mp4(tmp_path: Path):
    try:
        encoder()
    except DisplayError as error:
        pytest.skip(str(error))
    with wave.open(str(tmp_path / "x.wav"), "wb") as sound:
        sound.setparams((1, 2, 22050, 0, "NONE", ""))
        sound.writeframes(bytes(22050))
    frames = [np.full((33, 31, 3), 20 * k, dtype=np.uint8) for k in range(12)]
    save_film(frames, tmp_path / "x.mp4", rate=24.0, sound=tmp_path / "x.wav")
    data = (tmp_path / "x.mp4").read_bytes()
    assert data[4:8] == b"ftyp"
    assert b"avc1" in data
    assert b"mp4a" in data


def test_without_an_encoder_the_packages_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(film_file.shutil, "which", lambda name: None)
    with pytest.raises(DisplayError, match="pip install imageio-ffmpeg") as caught:
        save_film([PIXELS], tmp_path / "x.mp4", rate=24.0)
    assert "\n" not in str(caught.value)


def test_a_sheet_has_four_pictures_of_each_unit(drawable: None):
    with Portrait(size=(40, 40), preset=DRAFT) as portrait:
        pixels = draw_units_sheet(portrait, units=[1, 4, 12, 26])
    assert pixels.shape == (2 * (40 + LABEL) + LABEL, ACROSS * (len(KINDS) * 40 + GAP) - GAP, 3)
    assert len(UNITS) <= 13 * ACROSS
