"""Films of a report, each drawn in a process of its own."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.face.display import find_display_problem
from kinesic.files.film_file import WebpFilm
from kinesic.files.film_settings import FilmSettings
from kinesic.planning.captions import make_captions
from kinesic.planning.face_track import compute_faces
from kinesic.report import films
from kinesic.report.films import FACE_RATE, FACE_SIZE, FaceFilm, FilmProcesses, TwinFilm, draw_films, film_processes
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.film import moments
from kinesic.sim.filming.drawn_face import SCREEN_SIZE, paint_face
from kinesic.sim.gl import opengl_fault

ROBOT = Robot.load()
REST_POSTURE = ROBOT.skeleton.rest
ZERO_RATES = np.zeros_like(REST_POSTURE)
SPOKEN_BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><speech id="s"><text>Hello <sync id="a"/>you</text>'
    '</speech><faceLexeme id="f" lexeme="smile" start="0" end="1.5"/></bml>'
)
SMALL_FILM = FilmSettings(size=(320, 180), rate=10.0)


class Drawn(NamedTuple):
    film: Path
    portrait: Path
    whys: dict[Path, str]
    shares: list[float]


def face(units: dict[str, float], seconds: float = 0.1) -> FaceFilm:
    times = np.arange(round(seconds * FACE_RATE) + 1) / FACE_RATE
    return FaceFilm.of(
        ROBOT, (Command(time, REST_POSTURE, ZERO_RATES, ZERO_RATES, REST_POSTURE, units) for time in times.tolist())
    )


def twin(seconds: float = 0.5) -> TwinFilm:
    return TwinFilm(ROBOT, np.array([0.0, seconds]), np.array([REST_POSTURE, 0.5 * REST_POSTURE]), SMALL_FILM)


@contextmanager
def quick_processes() -> Iterator[FilmProcesses]:
    """Start film processes that are all prepared for the twin, without the skin of a face."""
    begin = films._process
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(films, "_process", lambda kind: begin("twin"))
        with film_processes() as begun:
            yield begun


@pytest.fixture
def processes() -> Iterator[FilmProcesses]:
    with quick_processes() as begun:
        yield begun


@pytest.fixture(scope="module")
def drawing() -> None:
    if why := opengl_fault() or find_display_problem():
        pytest.skip(why)


@pytest.fixture(scope="module")
def drawn(drawing: None, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Drawn]:
    """Draw the twin's film after a successful and a failed face film."""
    results = {}
    for name, units, start in (
        ("with", {"12": 0.5, "26": 0.9}, film_processes),
        ("without", {"99": 0.5}, quick_processes),
    ):
        folder, shares = tmp_path_factory.mktemp(name), list[float]()
        film, portrait = folder / "film.webp", folder / "face.webp"
        job = replace(twin(), units=({},) * 6, after=portrait)
        with start() as begun:
            whys = draw_films({film: job, portrait: face(units)}, begun, shares.append)
        results[name] = Drawn(film, portrait, whys, shares)
    return results


def test_robot_and_face_films_are_drawn_and_progress_grows_to_one(drawn: dict[str, Drawn]):
    film, portrait, whys, shares = drawn["with"]
    assert whys == {film: "", portrait: ""}
    with Image.open(film) as seen:
        assert (seen.size, seen.n_frames) == (SMALL_FILM.size, 6)
    with Image.open(portrait) as seen:
        assert (seen.size, seen.n_frames) == (FACE_SIZE, 1), "equal pictures are one"
    assert shares[-1] == 1.0
    assert shares == sorted(shares)
    assert len(shares) > 6


def test_film_that_cannot_be_drawn_gives_a_reason_while_other_films_are_drawn(drawn: dict[str, Drawn]):
    film, portrait, whys, _ = drawn["without"]
    assert whys[film] == ""
    assert "99" in whys[portrait]
    assert not portrait.exists()


def test_reason_of_a_missing_film_names_the_signal_that_killed_its_process(tmp_path: Path, processes: FilmProcesses):
    processes["twin"].kill()
    (why,) = draw_films({tmp_path / "film.webp": twin()}, processes).values()
    assert "SIGKILL" in why
    assert "kinesic doctor" in why


@pytest.mark.soak
def test_keyboard_interrupt_ends_the_film_processes(tmp_path: Path, processes: FilmProcesses):
    def interrupt(share: float) -> None:
        raise KeyboardInterrupt

    job = twin(60.0) if opengl_fault() is None else pytest.skip("nothing is drawn here")
    with pytest.raises(KeyboardInterrupt):
        draw_films({tmp_path / "film.webp": job}, processes, interrupt)
    assert all(process.wait(10.0) for process in processes.values())


def test_idle_film_processes_end_when_their_context_manager_exits():
    with film_processes() as begun:
        assert all(process.poll() is None for process in begun.values())
    assert all(process.poll() for process in begun.values())


def test_robot_film_shows_a_painted_face_where_the_rendered_face_film_is_missing(drawn: dict[str, Drawn]):
    """The films differ around the head alone."""
    heads = {}
    for name, film in drawn.items():
        with Image.open(film.film) as seen:
            heads[name] = np.asarray(seen.convert("RGB")).astype(int)
    differs = np.argwhere(np.abs(heads["with"] - heads["without"]).max(axis=2) > 40)
    assert len(differs) > 40
    assert np.ptp(differs, axis=0).max() < 0.15 * SMALL_FILM.size[0]


def test_film_has_a_face_per_picture_and_the_captions_of_its_plan() -> None:
    planned = plan(SPOKEN_BLOCK, set_up("upper22", voice="durations"))
    times = np.arange(round(planned.duration * 100) + 1) / 100
    film = TwinFilm.of(planned, times, planned.trajectory.sample(times)[0])
    shot = moments(float(times[0]), float(times[-1]))
    assert len(film.units) == len(shot)
    assert [dict(row) for row in compute_faces(planned, shot)] == list(film.units)
    assert max(row.get("12", row.get("L12", 0.0)) for row in film.units) > 0.3
    assert [(said.begin, said.end, said.text) for said in make_captions(planned)] == list(film.spoken)
    assert [text for _, _, text in film.spoken] == ["Hello", "you"]


def test_incomplete_face_film_is_ignored(tmp_path: Path) -> None:
    whole, spoilt, missing = (tmp_path / f"{name}.webp" for name in ("whole", "spoilt", "missing"))
    with WebpFilm(whole, SCREEN_SIZE) as film:
        for k in range(3):
            film.write(np.full((*SCREEN_SIZE[::-1], 3), 60 * k, dtype=np.uint8), None, 1000 // FACE_RATE)
    with suppress(ZeroDivisionError), WebpFilm(spoilt, SCREEN_SIZE) as film:
        raise ZeroDivisionError
    for path, rendered in ((whole, True), (spoilt, False), (missing, False)):
        faces_of = replace(twin(), units=({"26": 0.8},) * 2, after=path)._faces()
        assert faces_of is not None
        assert (faces_of(0, 0.0) == paint_face({"26": 0.8}, size=SCREEN_SIZE)).all() != rendered
    in_step = replace(twin(), after=whole)._faces()
    assert in_step is not None
    shades = [round(float(in_step(k, k / FACE_RATE).mean()) / 60) for k in range(3)]
    assert shades == [0, 1, 2], "each picture has the face of its own time"


def test_preparation_of_a_twin_film_imports_the_film_module_in_advance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "kinesic.sim.film")
    TwinFilm.prepare()
    assert "kinesic.sim.film" in sys.modules


def test_face_film_keeps_the_face_of_a_command_that_is_changed_later() -> None:
    units = {"12": 0.5}
    film = FaceFilm.of(None, [Command(0.0, REST_POSTURE, ZERO_RATES, ZERO_RATES, REST_POSTURE, units)], 12.0)
    units["12"] = 0.9
    assert film.commands[0].face == {"12": 0.5}
    assert (film.rate, film.robot) == (12.0, None)


def test_twin_film_without_action_units_has_no_face_pictures() -> None:
    assert twin()._faces() is None
    painted = replace(twin(), units=({}, {"26": 0.8}))._faces()
    assert painted is not None
    for k, units in enumerate(({}, {"26": 0.8})):
        assert (painted(k, 0.0) == paint_face(units, size=SCREEN_SIZE)).all()
