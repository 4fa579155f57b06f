"""Verb `kinesic perform --robot A,B`: one document, several robots, one combined film."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from kinesic.body.arrays import Picture
from kinesic.body.config import ConfigError, locate_config
from kinesic.cli.options import Output, Performers, Planning, TwinOptions
from kinesic.cli.perform import perform_file
from kinesic.cli.perform_options import PerformOptions
from kinesic.cli.plan import document_name
from kinesic.cli.progress import show_stages
from kinesic.cli.servos.memory import check_single_robot
from kinesic.face.show.files import SideFilm, save_film
from kinesic.face.show.pictures import LazyPictures
from kinesic.files.film_settings import FilmSettings
from kinesic.files.output_file import check_file, new_file
from kinesic.files.output_folder import check_folder
from kinesic.report.gltf.scene import is_scene
from kinesic.report.output import default_folder

FILM_FILE = "film.webp"  # file name of the combined film
PART_ASPECT_RATIO = 4 / 3  # width / height of one robot's part of the film
MAX_FILM_FRAMES = 3600  # largest number of frames; longer films have a lower frame rate


def perform_document(
    file: str,
    planning: Planning,
    performers: Performers,
    twin_options: TwinOptions,
    output: Output,
    film: FilmSettings | None,
) -> int:
    """Perform a document with one robot, or with several in turn."""
    perform = perform_with_several if "," in planning.robot else perform_file
    return perform(file, PerformOptions(planning, performers, twin_options, output, film))


def perform_with_several(file: str, options: PerformOptions) -> int:
    """Perform a document with each robot, and film them side by side.

    Each robot has its own report folder.

    Raises:
        ConfigError: a robot is unknown or named twice, or an option does not allow several robots.
    """
    robots, output, film = options.planning.robot.split(","), options.output, options.film
    _check_options(robots, options.performers, output)
    check_single_robot(options.twin)
    if film is not None and film.format != "webp":
        raise ConfigError("--film-format mp4: several robots are filmed side by side only as webp; name one robot")
    if file == "-":
        raise ConfigError("standard input can be read only once; several robots need a file")
    if is_scene(output.out):
        raise ConfigError(f"{output.out}: a scene has one robot: name one, or give --out FOLDER")
    folder = output.out or default_folder(document_name(file))
    robot_folders = [folder / _make_folder_name(robot) for robot in robots]
    for robot_folder in robot_folders:
        check_folder(robot_folder, force=output.force)
    film_path = folder / FILM_FILE
    if folder.is_dir():
        check_file(film_path, force=output.force)
    exit_code = 0
    for robot, robot_folder in zip(robots, robot_folders, strict=True):
        robot_options = replace(
            options, planning=replace(options.planning, robot=robot), output=replace(output, out=robot_folder)
        )
        exit_code = max(exit_code, perform_file(file, robot_options))
    if film is not None and all((robot_folder / FILM_FILE).exists() for robot_folder in robot_folders):
        combined_film = _CombinedFilm(robot_folders, film)
        with new_file(film_path, force=output.force) as temporary, show_stages() as stage:
            stage("joining the films")
            save_film(combined_film.pictures, temporary, rate=combined_film.rate)
        click.echo(f"side by side: {film_path}")
    return exit_code


def _check_options(robots: Sequence[str], performers: Performers, output: Output) -> None:
    for robot in robots:
        locate_config("robot", robot)
    if len({_make_folder_name(robot) for robot in robots}) < len(robots):
        raise ConfigError(f"--robot {','.join(robots)}: each robot may be named once")
    if performers.sinks != {"twin"}:
        raise ConfigError("several robots perform only in the twin; name one robot for --on servos or face")
    if output.as_json:
        raise ConfigError("--json reports one robot; name one, or read report.json of each")


def _make_folder_name(robot: str) -> str:
    """Return the folder name for a robot, never `.` or `..`."""
    stem = Path(robot).stem
    return stem if stem.strip(".") else "robot"


class _CombinedFilm:
    """Several robots' films next to each other, aligned at block time zero."""

    def __init__(self, robot_folders: Sequence[Path], settings: FilmSettings) -> None:
        self._part_size = part_size(settings.size, len(robot_folders))
        self._films = [SideFilm(robot_folder / FILM_FILE, self._part_size[1]) for robot_folder in robot_folders]
        timings = [
            json.loads((robot_folder / "report.json").read_text(encoding="utf-8"))["timing"]
            for robot_folder in robot_folders
        ]
        latest_zero = max(timing["zero_s"] for timing in timings)
        self._waits = [latest_zero - timing["zero_s"] for timing in timings]
        ends = [delay + timing["duration_s"] for delay, timing in zip(self._waits, timings, strict=True)]
        self.rate = min(settings.rate, MAX_FILM_FRAMES / max(ends))  # [Hz]
        self.pictures = LazyPictures(int(max(ends) * self.rate) + 1, self._draw)

    def _draw(self, index: int) -> Picture:
        time = index / self.rate
        return np.concatenate(
            [
                _crop(film.at(max(time - delay, 0.0)), self._part_size[0])
                for film, delay in zip(self._films, self._waits, strict=True)
            ],
            axis=1,
        )


def part_size(film_size: tuple[int, int], count: int) -> tuple[int, int]:
    """Return each robot's picture size [pixels] in a side-by-side film.

    Args:
        film_size: largest width and height [pixels] of the whole film.
        count: number of robots.
    """
    height = min(film_size[1], int(film_size[0] / count / PART_ASPECT_RATIO))
    return min(film_size[0] // count, round(height * PART_ASPECT_RATIO)), height


def _crop(picture: Picture, width: int) -> Picture:
    """Return the middle columns of a picture, at most `width` [pixels] wide."""
    width = min(width, picture.shape[1])
    left = (picture.shape[1] - width) // 2
    return picture[:, left : left + width]
