import numpy as np
import pytest
from PIL import Image

from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.studies.perception.design import list_stimuli
from kinesic.studies.perception.page import FILM_DURATION, PICTURE_RATE, draw_stimuli, file_of

FROWNS = [
    stimulus
    for stimulus in list_stimuli()
    if stimulus.action.name == "4" and (stimulus.agent, stimulus.strength) == ("female", "high")
]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory):
    try:
        with open_offscreen_context():
            pass
    except DisplayError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("study")
    list(draw_stimuli(FROWNS, folder, size=96))
    return {(frown.wrinkles, frown.presentation): folder / file_of(frown) for frown in FROWNS}


@pytest.mark.soak
def test_wrinkled_and_smooth_stimuli_differ(drawn: dict):
    with_them, without = (np.asarray(Image.open(drawn[kind, "image"])).astype(int) for kind in (True, False))
    changed = np.abs(with_them - without).max(axis=-1) > 8
    assert 0.001 < changed.mean() < 0.1


@pytest.mark.soak
def test_stimulus_film_plays_once_and_ends_at_rest(drawn: dict):
    film = Image.open(drawn[True, "animation"])
    assert film.info["loop"] == 1
    frames = []
    for k in range(film.n_frames):
        film.seek(k)
        frames.append(np.asarray(film.convert("RGB")).astype(float))
    assert sum(film_duration(drawn[True, "animation"])) == pytest.approx(1000 * FILM_DURATION, rel=0.05)
    moved = [np.abs(frame - frames[0]).mean() for frame in frames]
    assert max(moved) > 5 * moved[-1]
    assert moved.index(max(moved)) / PICTURE_RATE == pytest.approx(1.0, abs=0.6)


def film_duration(path) -> list[int]:
    """Durations of the frames [ms]."""
    film, results = Image.open(path), []
    for k in range(film.n_frames):
        film.seek(k)
        film.load()
        results.append(film.info["duration"])
    return results
