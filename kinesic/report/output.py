"""Writes a performance into a folder of its own."""

import json
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from kinesic.controller.performance import Performance
from kinesic.controller.play import command_times, play
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.face.display import DisplayError
from kinesic.face.show.recording import FaceRecording, PortraitSettings
from kinesic.files.output_file import new_file, write_text
from kinesic.files.output_folder import new_folder
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


def default_folder(source: str) -> Path:
    """Names the folder of what is made of a source now: `out/NAME-TIME`."""
    return Path("out") / f"{Path(source).stem[:100] or 'stdin'}-{datetime.now():%Y%m%d-%H%M%S}"


@dataclass(frozen=True, kw_only=True)
class Written(Recordings):
    """Paths of what was written."""

    report: Path
    page: Path
    measured: Path  # what the twin did, as `kinesic twin fit` reads it

    def within(self, folder: Path) -> "Written":
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
) -> Written:
    """Writes report.json, report.html, measured.npz, speech.wav and, where OpenGL works, films of twin and face.

    Args:
        performance: in the twin.
        data: of its report.
        folder: that is made, as a whole: when something fails there is none, or still the earlier one.
        film: whether twin and face are filmed.
        force: whether an earlier folder that kinesic has made may be replaced.

    Raises:
        ConfigError: the folder must not be written.
    """
    with new_folder(folder, force=force) as fresh:
        written = _write_files(performance, data, fresh, film=film)
    return written.within(folder)


def rewrite(written: Written, performance: Performance, data: dict[str, Json]) -> None:
    """Writes the report and its page, over older ones."""
    write_text(written.report, json.dumps(data, indent=1), force=True)
    with new_file(written.page, force=True) as fresh:
        write_page(performance, data, written, path=fresh)


def _write_files(performance: Performance, data: dict[str, Json], folder: Path, *, film: bool) -> Written:
    plan = performance.plan
    twin, why_no_film = _filmed(performance, folder / "film.webp") if film else (None, NOT_ASKED)
    face, why_no_face = _face(plan, folder / "face.webp") if film else (None, NOT_ASKED)
    measured = folder / "measured.npz"
    write_log(performance.measured, plan.setup.robot, measured)
    voice, heard = folder / "speech.wav", sound(plan)
    if heard is not None:
        write_wav(heard, voice)
    written = Written(
        report=folder / "report.json",
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
