"""Where a performance is written: a folder of its own, never on top of another."""

import json
import shutil
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.controller.page import write_page
from kinesic.controller.performance import Performance
from kinesic.controller.report import Json
from kinesic.sim.film import FilmError
from kinesic.sim.film import film as write_film
from kinesic.sim.log import write_log

FILM_RATE = 12.5  # [Hz]


@dataclass(frozen=True)
class Written:
    """Paths of what was written."""

    report: Path
    page: Path
    measured: Path  # what the twin did, as `kinesic twin fit` reads it
    film: Path | None
    why_no_film: str = ""


def free_folder(asked: Path | None, source: str, *, force: bool = False) -> Path:
    """The folder `asked`, or `out/NAME-TIME`; it is made when something is written.

    Raises:
        ConfigError: it exists already and `force` is not given.
    """
    folder = asked or Path("out") / f"{Path(source).stem or 'stdin'}-{datetime.now():%Y%m%d-%H%M%S}"
    if folder.exists() and not force:
        raise ConfigError(f"{folder} exists already; --force replaces it, --out names another")
    return folder


def emptied(folder: Path) -> Path:
    """Makes a folder, and removes what was there before."""
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    return folder


def write(performance: Performance, data: dict[str, Json], folder: Path, *, film: bool = True) -> Written:
    """Writes report.json, report.html, measured.npz and, where OpenGL works, the film of the twin."""
    report = emptied(folder) / "report.json"
    report.write_text(json.dumps(data, indent=1), encoding="utf-8")
    picture, why = _filmed(performance, folder / "film.webp") if film else (None, "not asked for")
    measured = folder / "measured.npz"
    write_log(performance.measured, performance.plan.facts.robot, measured)
    page = folder / "report.html"
    write_page(performance, data, film=picture, path=page, no_film=why)
    return Written(report, page, measured, picture, why)


def _filmed(performance: Performance, path: Path) -> tuple[Path | None, str]:
    """The film's path, or why there is none."""
    measured = performance.measured
    try:
        write_film(performance.plan.facts.robot, measured.times, measured.angles, path, rate=FILM_RATE)
    except FilmError as error:
        return None, str(error)
    return path, ""
