from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.robot import Robot
from kinesic.controller.perform import plan, set_up
from kinesic.face.display import available
from kinesic.face.render.figure import UPPER
from kinesic.files.film_settings import USUAL
from kinesic.report.figure_film import NARROWEST, FigureFilm, frame_motion
from kinesic.sim.filming.framing import moving_balls, watched_segments

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
    short = replace(
        film, angles=film.angles[6:48:18], units=film.units[6:48:18], words=film.words[6:48:18], size=(96, 54)
    )
    shares: list[float] = []
    assert short.draw(tmp_path / "film.webp", shares.append) == ""
    with Image.open(tmp_path / "film.webp") as seen:
        assert seen.size == (96, 54)
        assert seen.n_frames == 3
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_the_camera_frames_hands_and_head_wherever_they_are():
    robot = Robot.load("human")
    wide = robot.skeleton.rest.copy()
    for side in "lr":
        wide[robot.skeleton.joint(f"{side}_shoulder_abduct")] = np.radians(100)
    found = {}
    for name, postures in (("rest", [robot.skeleton.rest]), ("wide", [robot.skeleton.rest, wide])):
        middle, field = frame_motion(robot, np.array(postures), UPPER, aspect=1.0)
        camera = replace(UPPER, pivot=middle, field_deg=field)
        places, _ = moving_balls(robot, np.array(postures), watched_segments(robot))
        seen = (camera.projection(1.0) @ camera.view()) @ np.append(
            places.reshape(-1, 3), np.ones((places[..., 0].size, 1)), 1
        ).T
        found[name] = (float(np.abs(seen[:2] / seen[3]).max()), field)
        assert found[name][0] < 1 / 1.2, "a margin is left on all sides"
    assert NARROWEST < found["rest"][1] < found["wide"][1]
    assert found["wide"][0] > 0.7, "no smaller than needed"


def test_what_cannot_be_drawn_says_why(film: FigureFilm, tmp_path: Path):
    assert "each side may be 1 to 4096" in replace(film, size=(9000, 10)).draw(tmp_path / "x.webp", lambda share: None)
    assert Robot.load("human").skin == "female"
    assert Robot.load().skin is None
