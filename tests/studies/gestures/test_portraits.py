"""Shaded portraits and turntables of robots and of the human."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.image import imread

from kinesic.body.robot import Robot
from kinesic.sim.film import FilmError, opengl_fault
from kinesic.studies.gestures import portraits
from kinesic.studies.gestures.isolated import key_postures, plan_gesture
from kinesic.studies.gestures.portraits import draw_stills, draw_turntable
from kinesic.studies.gestures.sheet import draw_portraits

from ...face.conftest import drawable  # noqa: F401  # fixture

UNSKINNED_HUMAN = replace(Robot.load("human"), skin=None)
HUMAN = Robot.load("human")


@pytest.fixture(scope="module")
def modelled() -> None:
    """Skip without OpenGL for MuJoCo."""
    if why := opengl_fault():
        pytest.skip(why)


@contextmanager
def few_pictures(count: int) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(portraits, "TURNTABLE_FRAMES", count)
        patch.setattr(portraits, "TURNTABLE_SIZE", 96)
        yield


def is_skin(picture: np.ndarray) -> np.ndarray:
    red, green, blue = (picture[..., k].astype(int) for k in range(3))
    return (red > 150) & (red > green + 20) & (green > blue)  # hair is darker


def test_portrait_of_the_human_shows_head_and_hands(drawable: None):  # noqa: F811 - the fixture
    raised = HUMAN.skeleton.rest.copy()
    for side in "lr":
        raised[HUMAN.skeleton.names.index(f"{side}_shoulder_flexion")] = np.radians(170)
    view, (down, up) = draw_stills(HUMAN, [HUMAN.skeleton.rest, raised], [{}, {}], (200, 230))
    for picture, angles in ((down, HUMAN.skeleton.rest), (up, raised)):
        skin, frames = is_skin(picture), HUMAN.skeleton.frames(angles)
        assert not any(edge.any() for edge in (skin[0], skin[-1], skin[:, 0], skin[:, -1]))
        for name in ("l_wrist", "r_wrist"):
            right, above = view.project(frames.origins[HUMAN.skeleton.segment(name)])
            row, column = int(230 * (0.5 - above)), int(100 + 230 * right)
            assert skin[max(row - 30, 0) : row + 30, max(column - 30, 0) : column + 30].any()


@pytest.mark.parametrize("name", ["upper22", "upper36"])
def test_turntable_film_rotates_about_evenly_and_loops_without_a_jump(name: str, modelled: None):
    robot, shares = Robot.load(name), []
    with few_pictures(8):
        pictures = draw_turntable(robot, robot.skeleton.rest, progress=shares.append)
    assert shares == [(k + 1) / 8 for k in range(8)]
    assert {picture.shape for picture in pictures} == {(96, 96, 3)}
    steps = [
        float(np.abs(a.astype(int) - b).mean()) for a, b in zip(pictures, [*pictures[1:], pictures[0]], strict=True)
    ]
    assert min(steps) > 0.2 * max(steps) > 0.0  # also from the last to the first picture


def test_turntable_of_the_human_shows_skin(drawable: None):  # noqa: F811 - the fixture
    with few_pictures(4):
        pictures = draw_turntable(HUMAN, HUMAN.skeleton.rest)
    front, left, back, right = (is_skin(picture)[:32].sum() for picture in pictures)
    assert front > 1.5 * back  # face in front, hair behind
    assert left > 0
    assert right > 0


def test_portrait_of_the_human_shows_its_facial_expression(drawable: None):  # noqa: F811 - the fixture
    rest = HUMAN.skeleton.rest
    _, (plain, smiling, again) = draw_stills(HUMAN, [rest] * 3, [{}, {"12": 1.0}, {}], (200, 230))
    changed = np.abs(plain.astype(int) - smiling).max(axis=-1) > 20
    assert 0 < changed.sum() < 200
    assert np.array_equal(plain, again)


def test_portrait_of_a_robot_shows_the_expression_on_its_face_screen(modelled: None):
    robot = Robot.load("upper36")
    rest = robot.skeleton.rest
    _, (plain, smiling, again) = draw_stills(robot, [rest] * 3, [{}, {"12": 1.0, "26": 1.0}, {}], (200, 230))
    changed = np.abs(plain.astype(int) - smiling).max(axis=-1) > 60
    assert 20 < changed.sum() < 1000
    assert np.array_equal(plain, again)


@pytest.mark.soak
def test_palm_paths_are_drawn_over_portraits(known, tmp_path, modelled: None):
    form = known.lexicon.find("greet_wave").form
    show = key_postures(form, plan_gesture(form, known), 2)
    with_ways, without = (
        imread(draw_portraits(one, known.robot, tmp_path / f"{k}.png", scale=1.5, dots=72, says="The hand waves."))
        for k, one in enumerate((show, replace(show, paths={})))
    )
    assert with_ways.shape == without.shape
    changed = np.abs(with_ways - without).max(axis=-1) > 0.2
    assert 0.001 < changed.mean() < 0.1


def test_missing_opengl_of_portraits_is_reported(monkeypatch):
    monkeypatch.setattr(portraits, "opengl_fault", lambda: "OpenGL is missing: install it")
    with pytest.raises(FilmError, match="install it"):
        draw_turntable(UNSKINNED_HUMAN, UNSKINNED_HUMAN.skeleton.rest)
