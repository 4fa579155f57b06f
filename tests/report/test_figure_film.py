from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.robot import Robot
from kinesic.face.display import find_display_problem
from kinesic.face.render.figure import UPPER_BODY_CAMERA
from kinesic.files.film_settings import DEFAULT_FILM
from kinesic.report.figure_film import FIGURE_MARGIN, MAX_FIELD_OF_VIEW, MIN_FIELD_OF_VIEW, FigureFilm, frame_motion
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


def test_film_of_the_drawn_figure_has_posture_and_face_for_each_frame(film: FigureFilm):
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
def test_film_camera_shows_bent_forearms_with_a_margin():
    robot = Robot.load("human")
    asking = robot.skeleton.rest.copy()
    for side in "lr":
        asking[robot.skeleton.joint(f"{side}_elbow_flexion")] = np.radians(95)
    framings = {}
    for name, postures in (("rest", [robot.skeleton.rest]), ("asking", [asking])):
        middle, field = frame_motion(robot, np.array(postures), UPPER_BODY_CAMERA, aspect=16 / 9)
        framings[name] = seen_extent(robot, postures, middle, field, 16 / 9), field
    (left, right, bottom, top), field = framings["asking"]
    assert -1 / FIGURE_MARGIN < min(left, bottom) < max(right, top) < 1 / FIGURE_MARGIN, "a margin is left on all sides"
    assert max(right, top) > 0.85, "no smaller than needed"
    assert MIN_FIELD_OF_VIEW <= field < framings["rest"][1]
    assert framings["rest"][0][3] < 1.0


def test_film_of_a_wide_motion_is_cropped_so_that_the_head_has_at_least_105_pixels():
    robot = Robot.load("human")
    raised, wide = robot.skeleton.rest.copy(), robot.skeleton.rest.copy()
    for side in "lr":
        raised[robot.skeleton.joint(f"{side}_shoulder_flexion")] = np.radians(165)
        wide[robot.skeleton.joint(f"{side}_shoulder_abduct")] = np.radians(90)
    middle, field = frame_motion(robot, np.array([robot.skeleton.rest, raised, wide]), UPPER_BODY_CAMERA, aspect=1.0)
    assert field == MAX_FIELD_OF_VIEW
    assert 0.6 < seen_extent(robot, [raised], middle, field, 1.0)[3] < 1.0, "raised hands are seen"
    head = 0.22 / (2 * UPPER_BODY_CAMERA.distance * np.tan(np.radians(field) / 2))
    assert 720 * head > 105


def seen_extent(robot, postures, middle, field, aspect) -> tuple[float, float, float, float]:
    """Return the bounds of hands and head in the picture, -1..1."""
    camera = replace(UPPER_BODY_CAMERA, pivot=middle, field_deg=field)
    places, radii = find_capsule_balls(robot, np.array(postures), list_watched_segments(robot))
    points = np.concatenate([(places + radii[:, None] * way).reshape(-1, 3) for way in np.eye(3)[1:]])
    points = np.concatenate([points, *((places - radii[:, None] * way).reshape(-1, 3) for way in np.eye(3)[1:])])
    x, y, _, w = (camera.projection(aspect) @ camera.view()) @ np.append(points, np.ones((len(points), 1)), 1).T
    return float((x / w).min()), float((x / w).max()), float((y / w).min()), float((y / w).max())


def test_film_of_a_human_figure_that_cannot_be_drawn_gives_a_reason(film: FigureFilm, tmp_path: Path):
    assert "use 1 to 4096 per side" in replace(film, size=(9000, 10)).draw(tmp_path / "x.webp", lambda share: None)
    assert Robot.load("human").skin == "female"
    assert Robot.load().skin is None
