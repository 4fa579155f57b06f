"""Writes a performance into a folder of its own, never on top of another."""

import json
import shutil
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.controller.performance import Performance
from kinesic.controller.play import command_times, play
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.face.display import DisplayError
from kinesic.face.show.recording import FaceRecording, PortraitSettings
from kinesic.planning.face_track import asks_face, commands_with_face
from kinesic.planning.plan import Plan
from kinesic.report.page import Recordings, write_page
from kinesic.report.report import Json
from kinesic.sim.film import FilmError
from kinesic.sim.film import film as write_film
from kinesic.sim.log import write_log

FILM_RATE = 12.5  # [Hz]
FACE_RATE = 16  # [Hz] lips move faster than arms: no closure of theirs is left out
NOT_ASKED = "not asked for"
FACE = PortraitSettings(side=256)


def free_folder(asked: Path | None, source: str, *, force: bool = False) -> Path:
    """Chooses the folder `asked`, or `out/NAME-TIME`; it is made when something is written.

    Raises:
        ConfigError: it exists already and `force` is not given.
    """
    folder = asked or Path("out") / f"{Path(source).stem or 'stdin'}-{datetime.now():%Y%m%d-%H%M%S}"
    if folder.exists() and not force:
        raise ConfigError(f"{folder} exists already; --force replaces it, --out names another")
    return folder


def empty_folder(folder: Path) -> Path:
    """Makes a folder, and removes what was there before."""
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    return folder


@dataclass(frozen=True, kw_only=True)
class Written(Recordings):
    """Paths of what was written."""

    report: Path
    page: Path
    measured: Path  # what the twin did, as `kinesic twin fit` reads it


def write_report(performance: Performance, data: dict[str, Json], folder: Path, *, film: bool = True) -> Written:
    """Writes report.json, report.html, measured.npz, speech.wav and, where OpenGL works, films of twin and face."""
    plan = performance.plan
    report = empty_folder(folder) / "report.json"
    twin, why_no_film = _filmed(performance, folder / "film.webp") if film else (None, NOT_ASKED)
    face, why_no_face = _face(plan, folder / "face.webp") if film else (None, NOT_ASKED)
    measured = folder / "measured.npz"
    write_log(performance.measured, plan.setup.robot, measured)
    voice, heard = folder / "speech.wav", sound(plan)
    if heard is not None:
        write_wav(heard, voice)
    written = Written(
        report=report,
        page=folder / "report.html",
        measured=measured,
        film=twin,
        why_no_film=why_no_film,
        face=face,
        why_no_face=why_no_face,
        voice=None if heard is None else voice,
    )
    rewrite(written, performance, data)
    return written


def rewrite(written: Written, performance: Performance, data: dict[str, Json]) -> None:
    """Writes the report and its page, over older ones."""
    written.report.write_text(json.dumps(data, indent=1), encoding="utf-8")
    write_page(performance, data, written, path=written.page)


def _face(plan: Plan, path: Path) -> tuple[Path | None, str]:
    """The path of the face's film, or why there is none."""
    if not asks_face(plan):
        return None, "nothing is asked of it"
    times = command_times(plan.duration, rate=FACE_RATE)
    try:
        play(commands_with_face(plan, times), FaceRecording(path, plan.setup.robot, look=FACE, rate=FACE_RATE))
    except DisplayError as error:
        return None, str(error)
    return path, ""


def _filmed(performance: Performance, path: Path) -> tuple[Path | None, str]:
    """The film's path, or why there is none."""
    measured = performance.measured
    try:
        write_film(performance.plan.setup.robot, measured.times, measured.angles, path, rate=FILM_RATE)
    except FilmError as error:
        return None, str(error)
    return path, ""
