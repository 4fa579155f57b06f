"""Command-line options for filming a performance."""

from functools import wraps
from typing import get_args

import click

from kinesic.cli.options import Verb
from kinesic.files.film_settings import DEFAULT_FILM, FaceLook, FilmFormat, FilmSettings

MIN_FILM_SIDE = 64  # [pixels] smallest width or height of a film
MAX_FILM_SIDE = 2048  # [pixels] largest width or height of a film
MAX_FILM_RATE = 60.0  # [Hz] highest frame rate of a film


class FilmSize(click.ParamType[tuple[int, int]]):
    """Parameter type for a film size WIDTHxHEIGHT, such as 1280x720."""

    name = "size"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        """Parse and check width and height [pixels]."""
        sides = str(value).lower().split("x")
        if len(sides) != 2 or not all(side.isdecimal() for side in sides):
            self.fail(f"{value!r} is not a size; give two whole numbers, as in 1280x720", param, ctx)
        width, height = (int(side) for side in sides)
        if not all(MIN_FILM_SIDE <= side <= MAX_FILM_SIDE and not side % 2 for side in (width, height)):
            self.fail(
                f"{value}: both sides must be even, {MIN_FILM_SIDE} to {MAX_FILM_SIDE} pixels, as in 1280x720",
                param,
                ctx,
            )
        return width, height


def film_options(verb: Verb) -> Verb:
    """Add the film options to a verb, which receives them as `film`.

    With --no-film the value is None.
    """

    @wraps(verb)
    def run(
        *,
        film: bool,
        film_format: FilmFormat,
        film_size: tuple[int, int],
        film_rate: float,
        film_face: FaceLook,
        **arguments: object,
    ) -> int:
        settings = FilmSettings(film_size, film_rate, film_format, film_face)
        return verb(film=settings if film else None, **arguments)

    for option in (
        click.option(
            "--film-face",
            type=click.Choice(get_args(FaceLook)),
            default=DEFAULT_FILM.face,
            show_default=True,
            help="Face on the screen of a robot: drawn, or the rendered head with its wrinkles.",
        ),
        click.option(
            "--film-rate",
            type=click.FloatRange(1.0, MAX_FILM_RATE),
            default=DEFAULT_FILM.rate,
            show_default=True,
            metavar="HZ",
            help="Frame rate of the films.",
        ),
        click.option(
            "--film-size",
            type=FilmSize(),
            default="x".join(map(str, DEFAULT_FILM.size)),
            show_default=True,
            metavar="WxH",
            help="Width and height of the films in pixels; several robots side by side fit into this size.",
        ),
        click.option(
            "--film-format",
            type=click.Choice(get_args(FilmFormat)),
            default=DEFAULT_FILM.format,
            show_default=True,
            help="Format of the films; mp4 has sound and needs an encoder, which `kinesic doctor` names.",
        ),
        click.option("--film/--no-film", default=True, help="Film the twin and the face, if OpenGL works."),
    ):
        run = option(run)
    return run
