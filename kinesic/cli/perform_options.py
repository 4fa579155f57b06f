"""Options of one performance."""

from dataclasses import dataclass

from kinesic.cli.options import Output, Performers, Planning, TwinOptions
from kinesic.files.film_settings import FilmSettings


@dataclass(frozen=True)
class PerformOptions:
    """Options of one performance: planning, outputs, twin, report folder and film."""

    planning: Planning
    performers: Performers
    twin: TwinOptions
    output: Output
    film: FilmSettings | None
