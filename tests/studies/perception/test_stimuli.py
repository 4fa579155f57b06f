import numpy as np
import pytest
from PIL import Image

from kinesic.face.display import DisplayError, offscreen
from kinesic.studies.perception.design import stimuli
from kinesic.studies.perception.page import PICTURE_RATE, SECONDS, draw_stimuli, file_of

FROWNS = [each for each in stimuli() if each.action.name == "4" and (each.agent, each.strength) == ("female", "high")]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory):
    try:
        with offscreen():
            pass
    except DisplayError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("study")
    list(draw_stimuli(FROWNS, folder, size=96))
    return {(each.wrinkles, each.presentation): folder / file_of(each) for each in FROWNS}


def test_wrinkles_are_what_differs(drawn: dict):
    with_them, without = (np.asarray(Image.open(drawn[kind, "image"])).astype(int) for kind in (True, False))
    changed = np.abs(with_them - without).max(axis=-1) > 8
    assert 0.001 < changed.mean() < 0.1


def test_a_film_plays_once_and_comes_back_to_rest(drawn: dict):
    film = Image.open(drawn[True, "animation"])
    assert film.info["loop"] == 1
    frames = []
    for k in range(film.n_frames):
        film.seek(k)
        frames.append(np.asarray(film.convert("RGB")).astype(float))
    assert sum(film_duration(drawn[True, "animation"])) == pytest.approx(1000 * SECONDS, rel=0.05)
    moved = [np.abs(frame - frames[0]).mean() for frame in frames]
    assert max(moved) > 5 * moved[-1]
    assert moved.index(max(moved)) / PICTURE_RATE == pytest.approx(1.0, abs=0.6)


def film_duration(path) -> list[int]:
    """[ms] of each frame."""
    film, found = Image.open(path), []
    for k in range(film.n_frames):
        film.seek(k)
        film.load()
        found.append(film.info["duration"])
    return found
