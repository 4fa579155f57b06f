from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.action_units import UNITS
from kinesic.face.display import DisplayError
from kinesic.face.files import save, save_film
from kinesic.face.portrait import Portrait
from kinesic.face.presets import DRAFT
from kinesic.face.sheet import ACROSS, GAP, KINDS, LABEL, sheet

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


def test_a_film_is_no_still(tmp_path: Path):
    with pytest.raises(DisplayError, match=r"ends in \.webp"):
        save_film([PIXELS], tmp_path / "x.png", rate=24.0)


def test_a_sheet_has_four_pictures_of_each_unit(drawable: None):
    with Portrait(size=(40, 40), preset=DRAFT) as portrait:
        pixels = sheet(portrait, units=[1, 4, 12, 26])
    assert pixels.shape == (2 * (40 + LABEL) + LABEL, ACROSS * (len(KINDS) * 40 + GAP) - GAP, 3)
    assert len(UNITS) <= 12 * ACROSS
