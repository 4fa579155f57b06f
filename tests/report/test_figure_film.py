from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.robot import Robot
from kinesic.face.display import find_display_problem
from kinesic.face.render.figure import UPPER_BODY_CAMERA
from kinesic.files.film_settings import DEFAULT_FILM
from kinesic.report.figure_film import MIN_FIELD_OF_VIEW, FigureFilm, frame_motion
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.filming.framing import find_capsule_balls, list_watched_segments

SMILE = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/>'
    '<faceLexeme id="f" lexeme="smile" start="0" end="1.5"/></bml>'
)


@pytest.fixture(scope="module")
def film() -> FigureFilm:
    planned = plan(SMILE, set_up("human"))
    times = np.arange(round(planned.duration * 100) + 1) / 100
    return FigureFilm.of(planned, times, planned.trajectory.sample(times)[0])


def test_figure_film_has_posture_and_face_per_picture(film: FigureFilm):
    assert film.rate == DEFAULT_FILM.rate == 30.0
    assert len(film.angles) == len(film.units)
    tilt = film.robot.skeleton.joint("skullbase_tilt")
    assert np.ptp(film.angles[:, tilt]) > np.radians(5)
    assert max(row.get("12", row.get("L12", 0.0)) for row in film.units) > 0.3


def test_long_figure_film_has_a_lower_frame_rate():
    planned = plan(SMILE, set_up("human"))
    times = np.array([0.0, 1000.0])
    long = FigureFilm.of(planned, times, np.stack([planned.setup.robot.skeleton.rest] * 2))
    assert len(long.angles) <= 3601
    assert long.rate == pytest.approx(3.6)


def test_figure_film_is_drawn_picture_by_picture(film: FigureFilm, tmp_path: Path):
    if why := find_display_problem():
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


@pytest.mark.soak
def test_camera_always_frames_hands_and_head():
    robot = Robot.load("human")
    wide = robot.skeleton.rest.copy()
    for side in "lr":
        wide[robot.skeleton.joint(f"{side}_shoulder_abduct")] = np.radians(100)
    found = {}
    for name, postures in (("rest", [robot.skeleton.rest]), ("wide", [robot.skeleton.rest, wide])):
        middle, field = frame_motion(robot, np.array(postures), UPPER_BODY_CAMERA, aspect=1.0)
        camera = replace(UPPER_BODY_CAMERA, pivot=middle, field_deg=field)
        places, _ = find_capsule_balls(robot, np.array(postures), list_watched_segments(robot))
        seen = (camera.projection(1.0) @ camera.view()) @ np.append(
            places.reshape(-1, 3), np.ones((places[..., 0].size, 1)), 1
        ).T
        found[name] = (float(np.abs(seen[:2] / seen[3]).max()), field)
        assert found[name][0] < 1 / 1.2, "a margin is left on all sides"
    assert MIN_FIELD_OF_VIEW < found["rest"][1] < found["wide"][1]
    assert found["wide"][0] > 0.7, "no smaller than needed"


def test_undrawable_figure_film_gives_a_reason(film: FigureFilm, tmp_path: Path):
    assert "use 1 to 4096 per side" in replace(film, size=(9000, 10)).draw(tmp_path / "x.webp", lambda share: None)
    assert Robot.load("human").skin == "female"
    assert Robot.load().skin is None
