"""Films of a report: each is drawn by a process of its own, which ends with whoever waits for it."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.face.display import available
from kinesic.report.films import FACE_RATE, FACE_SIDE, FaceFilm, FilmProcesses, TwinFilm, draw_films, film_processes
from kinesic.sim.film import FILM_SIZE
from kinesic.sim.gl import opengl_fault

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
NONE = np.zeros_like(REST)


def face(units: dict[str, float], seconds: float = 0.25) -> FaceFilm:
    times = np.arange(round(seconds * FACE_RATE) + 1) / FACE_RATE
    return FaceFilm.of(ROBOT, (Command(time, REST, NONE, NONE, REST, units) for time in times.tolist()))


def twin(seconds: float = 0.5) -> TwinFilm:
    return TwinFilm(ROBOT, np.array([0.0, seconds]), np.array([REST, 0.5 * REST]))


@pytest.fixture
def processes() -> Iterator[FilmProcesses]:
    with film_processes() as begun:
        yield begun


@pytest.fixture(scope="module")
def drawing() -> None:
    if why := opengl_fault() or available():
        pytest.skip(why)


@pytest.mark.usefixtures("drawing")
def test_both_are_drawn_and_the_share_that_is_done_grows_to_all(tmp_path: Path, processes: FilmProcesses):
    shares: list[float] = []
    film, portrait = tmp_path / "film.webp", tmp_path / "face.webp"
    whys = draw_films({film: twin(), portrait: face({"12": 0.5})}, processes, shares.append)
    assert whys == {film: "", portrait: ""}
    with Image.open(film) as seen:
        assert (seen.size, seen.n_frames) == (FILM_SIZE, 6)
    with Image.open(portrait) as seen:
        assert (seen.size, seen.n_frames) == ((FACE_SIDE, FACE_SIDE), 1), "equal pictures are one"
    assert shares[-1] == 1.0
    assert shares == sorted(shares)
    assert len(shares) > 6


@pytest.mark.usefixtures("drawing")
def test_what_cannot_be_drawn_says_why_and_takes_nothing_along(tmp_path: Path, processes: FilmProcesses):
    film, portrait = tmp_path / "film.webp", tmp_path / "face.webp"
    whys = draw_films({film: twin(0.1), portrait: face({"99": 0.5})}, processes)
    assert whys[film] == ""
    assert "99" in whys[portrait]
    assert not portrait.exists()


def test_a_process_that_dies_is_a_reason(tmp_path: Path, processes: FilmProcesses):
    processes["twin"].kill()
    (why,) = draw_films({tmp_path / "film.webp": twin()}, processes).values()
    assert "SIGKILL" in why
    assert "kinesic doctor" in why


def test_an_interruption_ends_the_processes(tmp_path: Path, processes: FilmProcesses):
    def interrupt(share: float) -> None:
        raise KeyboardInterrupt

    job = twin(60.0) if opengl_fault() is None else pytest.skip("nothing is drawn here")
    with pytest.raises(KeyboardInterrupt):
        draw_films({tmp_path / "film.webp": job}, processes, interrupt)
    assert all(process.wait(10.0) for process in processes.values())


def test_processes_without_a_job_end_when_they_are_left():
    with film_processes() as begun:
        assert all(process.poll() is None for process in begun.values())
    assert all(process.poll() for process in begun.values())
