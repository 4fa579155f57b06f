"""Writes a performance into a folder of its own: the page first, then its films."""

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from kinesic.controller.performance import Performance
from kinesic.controller.play import command_times
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.files.film_settings import USUAL, FilmSettings
from kinesic.files.output_file import new_file, write_text
from kinesic.files.output_folder import new_folder
from kinesic.files.plain_name import cut_name
from kinesic.planning.face_track import asks_face, commands_with_face
from kinesic.planning.plan import Plan
from kinesic.report.figure_film import FigureFilm
from kinesic.report.films import (
    FACE_RATE,
    FaceFilm,
    FilmJob,
    FilmProcesses,
    TwinFilm,
    draw_films,
)
from kinesic.report.page import Recordings, write_page
from kinesic.report.report import Json
from kinesic.sim.filming.face_screen import screen_of
from kinesic.sim.log import write_log

NOT_ASKED = "not asked for"
NOT_YET = "not drawn yet, or stopped; this page is written anew when it is"


def default_folder(source: str) -> Path:
    """Names the folder of what is made of a source now: `out/NAME-TIME`."""
    return Path("out") / f"{cut_name(Path(source).stem, limit=100) or 'stdin'}-{datetime.now():%Y%m%d-%H%M%S}"


@dataclass(frozen=True, kw_only=True)
class WrittenPaths(Recordings):
    """Paths of what was written."""

    report: Path
    page: Path
    measured: Path  # what the twin did, as `kinesic twin fit` reads it

    def within(self, folder: Path) -> "WrittenPaths":
        """The same files in another folder."""
        return replace(
            self,
            report=folder / self.report.name,
            page=folder / self.page.name,
            measured=folder / self.measured.name,
            film=self.film and folder / self.film.name,
            face=self.face and folder / self.face.name,
            voice=self.voice and folder / self.voice.name,
        )


def write_report(
    performance: Performance, data: dict[str, Json], folder: Path, *, film: bool = True, force: bool = False
) -> WrittenPaths:
    """Writes report.json, report.html, measured.npz and speech.wav; films are drawn afterwards, by `add_films`.

    Args:
        performance: in the twin.
        data: of its report.
        folder: that is made, as a whole: when something fails there is none, or still the earlier one.
        film: whether films are to follow; the page then says that they are not there yet.
        force: whether an earlier folder that kinesic has made may be replaced.

    Raises:
        ConfigError: the folder must not be written.
    """
    with new_folder(folder, force=force) as fresh:
        written = _write_files(performance, data, fresh, why_no_film=NOT_YET if film else NOT_ASKED)
    return written.within(folder)


def add_films(
    written: WrittenPaths,
    performance: Performance,
    data: dict[str, Json],
    processes: FilmProcesses,
    *,
    settings: FilmSettings = USUAL,
    progress: Callable[[float], None] = lambda share: None,
) -> WrittenPaths:
    """Draws the films of twin and face, where OpenGL works, and puts them into a report that is there.

    Args:
        written: the report.
        performance: in the twin.
        data: of the report.
        processes: that draw.
        settings: of the film of the robot.
        progress: gets the share of the films that is drawn.

    Raises:
        ConfigError: a film could not be written.
    """
    plan, measured = performance.plan, performance.measured
    robot = plan.setup.robot
    with TemporaryDirectory() as place:
        film, face = (Path(place) / name for name in (settings.name, "face.webp"))
        jobs: dict[Path, FilmJob] = {}
        portrait = face_film(plan, min(settings.rate, FACE_RATE))
        if portrait is not None:
            jobs[face] = portrait
        if robot.skin is None:
            twin = TwinFilm.of(plan, measured.times, measured.angles, settings)
            jobs[film] = replace(twin, after=face, sound=written.voice)
        else:
            figure = FigureFilm.of(plan, measured.times, measured.angles, settings)
            jobs[film] = replace(figure, sound=written.voice)
        whys = {face: "nothing is asked of it"} | draw_films(jobs, processes, progress)
        for drawn in (path for path, why in whys.items() if not why):
            with new_file(written.report.with_name(drawn.name), force=True) as fresh:
                shutil.copyfile(drawn, fresh)
    kept = {path: None if why else written.report.with_name(path.name) for path, why in whys.items()}
    whole = replace(written, film=kept[film], why_no_film=whys[film], face=kept[face], why_no_face=whys[face])
    _write_page(whole, performance, data)
    return whole


def face_film(plan: Plan, rate: float = FACE_RATE) -> FaceFilm | None:
    """The film of the face of a plan at a rate [Hz]; it looks ahead where it is for a screen. None: nobody needs it."""
    screen = screen_of(plan.setup.robot) is not None
    if not screen and not asks_face(plan):
        return None
    times = command_times(plan.duration, rate=rate)
    return FaceFilm.of(None if screen else plan.setup.robot, commands_with_face(plan, times), rate)


def rewrite(written: WrittenPaths, performance: Performance, data: dict[str, Json]) -> None:
    """Writes the report and its page, over older ones."""
    write_text(written.report, json.dumps(data, indent=1), force=True)
    _write_page(written, performance, data)


def _write_page(written: WrittenPaths, performance: Performance, data: dict[str, Json]) -> None:
    with new_file(written.page, force=True) as fresh:
        write_page(performance, data, written, path=fresh)


def _write_files(performance: Performance, data: dict[str, Json], folder: Path, *, why_no_film: str) -> WrittenPaths:
    plan = performance.plan
    measured = folder / "measured.npz"
    write_log(performance.measured, plan.setup.robot, measured)
    voice, heard = folder / "speech.wav", sound(plan)
    if heard is not None:
        write_wav(heard, voice)
    written = WrittenPaths(
        report=folder / "report.json",
        page=folder / "report.html",
        measured=measured,
        why_no_film=why_no_film,
        why_no_face=why_no_film,
        voice=None if heard is None else voice,
    )
    rewrite(written, performance, data)
    return written
