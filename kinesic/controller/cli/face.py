"""`kinesic face`: pictures of the face."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import get_args

import click

from kinesic.body.config import ConfigError
from kinesic.face.camera import FRONT, Camera
from kinesic.face.display import DisplayError
from kinesic.face.files import FILM, check_ending, save, save_film
from kinesic.face.mesh import Variant
from kinesic.face.portrait import Pixels, Portrait
from kinesic.face.presets import PRESETS
from kinesic.face.sheet import CLOSE
from kinesic.face.sheet import sheet as contact_sheet
from kinesic.face.units import intensities

RATE = 24.0  # [Hz] of films
SECONDS = 2.0  # that a film lasts
RISE = 0.5  # [s] from rest to the expression, and back
CELL = 176  # pixels of each picture of a sheet

AU_HELP = "Action units of FACS and their intensities: 1=0.8,2=0.8; L or R before one moves that side."


@click.command()
@click.option("--au", "units", default="", metavar="N=X,...", help=AU_HELP)
@click.option("--out", required=True, type=click.Path(dir_okay=False, path_type=Path), help="X.png, or X.webp to move.")
@click.option("--variant", type=click.Choice(get_args(Variant)), default="female", show_default=True)
@click.option(
    "--preset", type=click.Choice(list(PRESETS)), default="normal", show_default=True, help="How much is drawn."
)
@click.option("--yaw", default=0.0, metavar="DEG", help="Seen from the side: 90 shows the left side, 180 the back.")
@click.option("--size", type=int, help=f"Pixels along a side (512; {CELL} each on a sheet).")
@click.option("--gain", default=1.0, show_default=True, help="Of the wrinkles, 0 to 4.")
@click.option("--sheet", is_flag=True, help="Every action unit low and high, with and without wrinkles.")
def face(
    units: str, out: Path, variant: Variant, preset: str, yaw: float, size: int | None, gain: float, sheet: bool
) -> int:
    """Draws the face: a still, a short film or a contact sheet."""
    if sheet and units:
        raise click.UsageError("--sheet draws every action unit; leave out --au")
    side = size if size is not None else CELL if sheet else 512
    try:
        told, camera = read_units(units), replace(CLOSE if sheet else FRONT, yaw_deg=yaw)
        check_ending(out)
        with Portrait(variant, preset=PRESETS[preset], size=(side, side)) as portrait:
            if sheet:
                save(contact_sheet(portrait, camera), out)
            elif out.suffix.lower() == FILM:
                save_film(list(_film(portrait, told, camera, gain)), out, rate=RATE)
            else:
                save(portrait.draw(told, camera, gain=gain), out)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    click.echo(f"picture: {out}")
    return 0


def read_units(text: str) -> dict[str, float]:
    """Action units and intensities of `1=0.8,L12=0.5`.

    Raises:
        DisplayError: it is not written so, an unknown unit, or an intensity outside 0..1.
    """
    found: dict[str, float] = {}
    for part in filter(None, (each.strip() for each in text.split(","))):
        name, _, value = part.partition("=")
        try:
            found[name.strip().upper()] = float(value)
        except ValueError:
            raise DisplayError(f"--au {part}: write a unit and its intensity, such as 12=0.8") from None
    intensities(found)
    return found


def _film(portrait: Portrait, told: Mapping[str, float], camera: Camera, gain: float) -> Iterator[Pixels]:
    """The expression rising from rest, held, and gone again."""
    for frame in range(round(SECONDS * RATE)):
        time = frame / RATE
        t = min(1.0, time / RISE, (SECONDS - time) / RISE)
        share = t * t * (3 - 2 * t)
        yield portrait.draw({name: share * value for name, value in told.items()}, camera, gain=gain)
