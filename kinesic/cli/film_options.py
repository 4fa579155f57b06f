"""Options that say whether a performance is filmed, and how."""

from functools import wraps
from typing import get_args

import click

from kinesic.cli.options import Verb
from kinesic.files.film_settings import USUAL, FilmFormat, FilmSettings

SMALLEST, LARGEST = 64, 2048  # [pixels] of a side
FASTEST = 60.0  # [Hz]


class FilmSize(click.ParamType[tuple[int, int]]):
    """Width and height, as 1280x720."""

    name = "size"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        """Reads a size."""
        sides = str(value).lower().split("x")
        if len(sides) != 2 or not all(side.isdecimal() for side in sides):
            self.fail(f"{value!r} is no size: two whole numbers, as in 1280x720", param, ctx)
        width, height = (int(side) for side in sides)
        if not all(SMALLEST <= side <= LARGEST and not side % 2 for side in (width, height)):
            self.fail(f"{value}: both sides must be even, {SMALLEST} to {LARGEST} pixels, as in 1280x720", param, ctx)
        return width, height


def film_options(verb: Verb) -> Verb:
    """Adds --film and how films are; the verb gets `film`, None where none is wanted."""

    @wraps(verb)
    def begin(
        *, film: bool, film_format: FilmFormat, film_size: tuple[int, int], film_rate: float, **given: object
    ) -> int:
        return verb(film=FilmSettings(film_size, film_rate, film_format) if film else None, **given)

    for option in (
        click.option(
            "--film-rate", type=click.FloatRange(1.0, FASTEST), default=USUAL.rate, show_default=True, metavar="HZ"
        ),
        click.option(
            "--film-size", type=FilmSize(), default="x".join(map(str, USUAL.size)), show_default=True, metavar="WxH"
        ),
        click.option(
            "--film-format",
            type=click.Choice(get_args(FilmFormat)),
            default=USUAL.format,
            show_default=True,
            help="mp4 carries the voice, and needs an encoder; `kinesic doctor` names it.",
        ),
        click.option("--film/--no-film", default=True, help="Films of the twin and of the face, where OpenGL works."),
    ):
        begin = option(begin)
    return begin
