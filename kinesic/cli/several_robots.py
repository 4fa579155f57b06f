"""`kinesic perform --robot A,B`: one document by several robots, a report of each, and a film of them side by side."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from kinesic.body.arrays import Picture
from kinesic.body.config import ConfigError, locate
from kinesic.cli.options import Output, Performers, Planning, TwinOptions
from kinesic.cli.perform import perform_file
from kinesic.cli.plan import document_name
from kinesic.cli.servos.memory import check_alone
from kinesic.face.show.files import SideFilm, save_film
from kinesic.face.show.pictures import LazyPictures
from kinesic.files.film_settings import FilmSettings
from kinesic.files.output_file import check_file, new_file
from kinesic.files.output_folder import check_folder
from kinesic.report.gltf.scene import is_scene
from kinesic.report.output import default_folder

FILM = "film.webp"
HEIGHT, ASPECT = 720, 4 / 3  # [pixels] of the film, and width to height of each robot's part of it
RATE = 30.0  # [Hz]
MOST_PICTURES = 3600  # of one film; a longer one has fewer a second


def perform_document(
    file: str, planning: Planning, performers: Performers, way: TwinOptions, output: Output, film: FilmSettings | None
) -> int:
    """Performs a document with one robot, or with several whose names have commas between them."""
    perform = perform_with_several if "," in planning.robot else perform_file
    return perform(file, planning, performers, way, output, film)


def perform_with_several(
    file: str, planning: Planning, performers: Performers, way: TwinOptions, output: Output, film: FilmSettings | None
) -> int:
    """Performs a document with each robot of a list, into a folder of its own, and films them side by side.

    Raises:
        ConfigError: a robot is unknown, named twice, or more is asked than several robots can do.
    """
    robots = planning.robot.split(",")
    _check(robots, performers, output)
    check_alone(way)
    if film is not None and film.format != "webp":
        raise ConfigError("--film-format mp4: several robots are filmed side by side as webp alone; name one robot")
    if file == "-":
        raise ConfigError("standard input is read once: several robots need a file")
    if is_scene(output.out):
        raise ConfigError(f"{output.out}: a scene has one robot: name one, or give --out FOLDER")
    folder = output.out or default_folder(document_name(file))
    places = [folder / _folder_name(robot) for robot in robots]
    for place in places:
        check_folder(place, force=output.force)
    beside = folder / FILM
    if folder.is_dir():
        check_file(beside, force=output.force)
    code = 0
    for robot, place in zip(robots, places, strict=True):
        alone = replace(planning, robot=robot)
        code = max(code, perform_file(file, alone, performers, way, replace(output, out=place), film))
    if film is not None and all((place / FILM).exists() for place in places):
        film_beside = _Beside(places)
        with new_file(beside, force=output.force) as fresh:
            save_film(film_beside.pictures, fresh, rate=film_beside.rate)
        click.echo(f"side by side: {beside}")
    return code


def _check(robots: Sequence[str], performers: Performers, output: Output) -> None:
    for robot in robots:
        locate("robot", robot)
    if len({_folder_name(robot) for robot in robots}) < len(robots):
        raise ConfigError(f"--robot {','.join(robots)}: each robot may be named once")
    if performers.sinks != {"twin"}:
        raise ConfigError("several robots perform in the twin alone: name one robot for --on servos or face")
    if output.as_json:
        raise ConfigError("--json tells of one robot: name one, or read report.json of each")


def _folder_name(robot: str) -> str:
    """Return the folder name for a robot, never `.` or `..`."""
    stem = Path(robot).stem
    return stem if stem.strip(".") else "robot"


class _Beside:
    """Several films next to one another; block zero is at the same time in all."""

    def __init__(self, places: Sequence[Path]) -> None:
        self._films = [SideFilm(place / FILM, HEIGHT) for place in places]
        timings = [json.loads((place / "report.json").read_text(encoding="utf-8"))["timing"] for place in places]
        first = max(timing["zero_s"] for timing in timings)
        self._waits = [first - timing["zero_s"] for timing in timings]
        ends = [wait + timing["duration_s"] for wait, timing in zip(self._waits, timings, strict=True)]
        self.rate = min(RATE, MOST_PICTURES / max(ends))  # [Hz]
        self.pictures = LazyPictures(int(max(ends) * self.rate) + 1, self._draw)

    def _draw(self, index: int) -> Picture:
        time = index / self.rate
        return np.concatenate(
            [_middle(film.at(max(time - wait, 0.0))) for film, wait in zip(self._films, self._waits, strict=True)],
            axis=1,
        )


def _middle(picture: Picture) -> Picture:
    """The part of a picture that is as wide as each robot's is."""
    width = min(round(HEIGHT * ASPECT), picture.shape[1])
    left = (picture.shape[1] - width) // 2
    return picture[:, left : left + width]
