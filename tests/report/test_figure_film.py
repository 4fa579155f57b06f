from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.robot import Robot
from kinesic.controller.perform import plan, set_up
from kinesic.face.display import available
from kinesic.files.film_settings import USUAL
from kinesic.report.figure_film import FigureFilm

SMILE = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/>'
    '<faceLexeme id="f" lexeme="smile" start="0" end="1.5"/></bml>'
)


@pytest.fixture(scope="module")
def film() -> FigureFilm:
    planned = plan(SMILE, set_up("human"))
    times = np.arange(round(planned.duration * 100) + 1) / 100
    return FigureFilm.of(planned, times, planned.trajectory.sample(times)[0])


def test_it_has_a_posture_and_a_face_for_each_picture(film: FigureFilm):
    assert film.rate == USUAL.rate == 30.0
    assert len(film.angles) == len(film.units)
    tilt = film.robot.skeleton.joint("skullbase_tilt")
    assert np.ptp(film.angles[:, tilt]) > np.radians(5)
    assert max(row.get("12", row.get("L12", 0.0)) for row in film.units) > 0.3


def test_a_long_one_has_fewer_pictures_a_second():
    planned = plan(SMILE, set_up("human"))
    times = np.array([0.0, 1000.0])
    long = FigureFilm.of(planned, times, np.stack([planned.setup.robot.skeleton.rest] * 2))
    assert len(long.angles) <= 3601
    assert long.rate == pytest.approx(3.6)


def test_it_is_drawn_picture_by_picture(film: FigureFilm, tmp_path: Path):
    if why := available():
        pytest.skip(why)
    short = replace(film, angles=film.angles[8:32:8], units=film.units[8:32:8], words=film.words[8:32:8], size=(96, 54))
    shares: list[float] = []
    assert short.draw(tmp_path / "film.webp", shares.append) == ""
    with Image.open(tmp_path / "film.webp") as seen:
        assert seen.size == (96, 54)
        assert seen.n_frames == 3
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_what_cannot_be_drawn_says_why(film: FigureFilm, tmp_path: Path):
    assert "each side may be 1 to 4096" in replace(film, size=(9000, 10)).draw(tmp_path / "x.webp", lambda share: None)
    assert Robot.load("human").skin == "female"
    assert Robot.load().skin is None
