"""Output folder of a performance: report, page and films."""

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from kinesic.body.command import command_times
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.files.film_settings import DEFAULT_FILM, FilmSettings
from kinesic.files.output_file import new_file, write_text
from kinesic.files.output_folder import new_folder
from kinesic.files.plain_name import cut_name
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.face_track import commands_with_face, needs_face
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
from kinesic.report.scene import drawable
from kinesic.sim.filming.face_screen import build_face_screen
from kinesic.sim.log import write_log

PAGE_FILE = "report.html"  # file name of the page
NOT_REQUESTED = "not requested"  # reason in the report for a film that was not requested
NOT_YET = "not drawn yet, or stopped; this page is updated when it is"  # reason for a film that is not drawn yet


def default_folder(source: str) -> Path:
    """Return the default folder of an output: `out/NAME-TIME`."""
    return Path("out") / f"{cut_name(Path(source).stem, limit=100) or 'stdin'}-{datetime.now():%Y%m%d-%H%M%S}"


@dataclass(frozen=True, kw_only=True)
class WrittenPaths(Recordings):
    """Paths of the files that a report consists of."""

    report: Path
    page: Path
    measured: Path  # log of the twin's motion, readable by `kinesic twin fit`

    def within(self, folder: Path) -> "WrittenPaths":
        """Return the paths of the same files in another folder."""
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
    performance: DryRun, data: dict[str, Json], folder: Path, *, film: bool = True, force: bool = False
) -> WrittenPaths:
    """Write the report, its page, the measurements and the speech.

    `add_films` draws the films afterwards.

    Args:
        performance: performance in the twin.
        data: data of its report.
        folder: written as a whole: after an error it is missing, or still the earlier one.
        film: whether films follow; the page then reports them as pending.
        force: whether to replace an earlier folder made by kinesic.

    Raises:
        ConfigError: the folder must not be written.
    """
    with new_folder(folder, force=force) as fresh:
        written = _write_files(performance, data, fresh, why_no_film=NOT_YET if film else NOT_REQUESTED)
    return written.within(folder)


def add_films(
    written: WrittenPaths,
    performance: DryRun,
    data: dict[str, Json],
    processes: FilmProcesses,
    *,
    settings: FilmSettings = DEFAULT_FILM,
    progress: Callable[[float], None] = lambda share: None,
) -> WrittenPaths:
    """Draw the films into an existing report and update its page.

    Without OpenGL there are none.

    Args:
        written: paths of the report.
        performance: performance in the twin.
        data: data of the report.
        processes: processes that draw.
        settings: settings of the robot's film.
        progress: receives the drawn fraction of the films.

    Raises:
        ConfigError: a film could not be written.
    """
    plan, measured = performance.plan, performance.measured
    robot = drawable(plan.setup.robot)
    shown = measured.times <= performance.duration
    times, angles = measured.times[shown], measured.angles[shown]
    with TemporaryDirectory() as place:
        film, face = (Path(place) / name for name in (settings.name, "face.webp"))
        jobs: dict[Path, FilmJob] = {}
        portrait = face_film(plan, min(settings.rate, FACE_RATE))
        if portrait is not None:
            jobs[face] = portrait
        if robot.skin is None:
            twin = replace(TwinFilm.of(plan, times, angles, settings), robot=robot)
            jobs[film] = replace(twin, after=face if settings.face == "rendered" else None, sound=written.voice)
        else:
            figure = FigureFilm.of(plan, times, angles, settings)
            jobs[film] = replace(figure, sound=written.voice)
        whys = {face: "nothing is requested of it"} | draw_films(jobs, processes, progress)
        for drawn in (path for path, why in whys.items() if not why):
            with new_file(written.report.with_name(drawn.name), force=True) as fresh:
                shutil.copyfile(drawn, fresh)
    kept = {path: None if why else written.report.with_name(path.name) for path, why in whys.items()}
    whole = replace(
        written,
        film=kept[film],
        why_no_film=whys[film],
        face=kept[face],
        why_no_face=whys[face],
        face_on_head=settings.face == "rendered",
    )
    _write_page(whole, performance, data)
    return whole


def face_film(plan: Plan, rate: float = FACE_RATE) -> FaceFilm | None:
    """Return the job that draws a plan's face film, or None.

    It is needed for a screen on the head, where the face is drawn from the front, and for a plan that moves the face.
    """
    screen = build_face_screen(plan.setup.robot) is not None
    if not screen and not needs_face(plan):
        return None
    times = command_times(plan.duration, rate=rate, settle=0.0)
    return FaceFilm.of(None if screen else plan.setup.robot, commands_with_face(plan, times), rate)


def rewrite(written: WrittenPaths, performance: DryRun, data: dict[str, Json]) -> None:
    """Replace report.json and the page by new versions."""
    write_text(written.report, json.dumps(data, indent=1), force=True)
    _write_page(written, performance, data)


def _write_page(written: WrittenPaths, performance: DryRun, data: dict[str, Json]) -> None:
    with new_file(written.page, force=True) as fresh:
        write_page(performance, data, written, path=fresh)


def _write_files(performance: DryRun, data: dict[str, Json], folder: Path, *, why_no_film: str) -> WrittenPaths:
    plan = performance.plan
    measured = folder / "measured.npz"
    write_log(performance.measured, plan.setup.robot, measured)
    voice, speech_sound = folder / "speech.wav", sound(plan)
    if speech_sound is not None:
        write_wav(speech_sound, voice)
    written = WrittenPaths(
        report=folder / "report.json",
        page=folder / PAGE_FILE,
        measured=measured,
        why_no_film=why_no_film,
        why_no_face=why_no_film,
        voice=None if speech_sound is None else voice,
    )
    rewrite(written, performance, data)
    return written
