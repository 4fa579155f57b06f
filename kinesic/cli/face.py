"""`kinesic face`: the face in pictures, films and a window."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import get_args

import click
import numpy as np

from kinesic.bml.block import Face
from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.cli.options import PlanningOptions, planning, read_input
from kinesic.cli.playback import play_whole
from kinesic.controller.perform import plan
from kinesic.controller.play import command_times, play
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.expressivity.face.expressions import entries, expression
from kinesic.face.assets.action_units import intensities
from kinesic.face.assets.mesh import Variant
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import CLOSE, FRONT, Camera
from kinesic.face.render.portrait import Pixels, Portrait
from kinesic.face.render.presets import PRESETS
from kinesic.face.show.controls import HELP as KEYS
from kinesic.face.show.files import check_ending, check_film, save, save_film
from kinesic.face.show.preview import Preview
from kinesic.face.show.process import PreviewSettings
from kinesic.face.show.recording import FaceRecording, PortraitSettings
from kinesic.face.show.sheet import draw_units_sheet as contact_sheet
from kinesic.face.show.window import has_display
from kinesic.planning.face_track import commands_with_face
from kinesic.planning.plan import Plan

FILM_RATE = 25.0  # [Hz] of films
SECONDS = 2.0  # that a film of one expression lasts
RISE = 0.5  # [s] from rest to the expression, and back
CELL, STRIP = 176, 192  # pixels of each picture of a sheet, and of a strip
SIDE = 512  # pixels of any other

AU_HELP = "Action units of FACS and their intensities: 1=0.8,2=0.8; L or R before one moves that side."
EMOTION_HELP = "An emotion or a lexeme of BML: joy, surprise, RAISE_BROWS."
OUT_HELP = "X.png, or X.webp or X.mp4 to move; a window without it."


@dataclass(frozen=True)
class Sight:
    """How the face is looked at."""

    variant: Variant
    preset: str
    camera: Camera
    gain: float
    side: int | None

    def portrait(self, side: int) -> Portrait:
        """Ready to be drawn, as large as asked or else of a side [pixels]."""
        side = self.side if self.side is not None else side
        return Portrait(self.variant, preset=PRESETS[self.preset], size=(side, side))

    @property
    def look(self) -> PreviewSettings:
        """The same for a window."""
        side = self.side if self.side is not None else SIDE
        return PreviewSettings(self.variant, self.preset, side, gain=self.gain, yaw_deg=self.camera.yaw_deg)


@click.command()
@click.option("--au", "units", default="", metavar="N=X,...", help=AU_HELP)
@click.option("--emotion", metavar="NAME", help=EMOTION_HELP)
@click.option("--amount", type=click.FloatRange(0.0, 1.0), default=1.0, show_default=True, help="Of the emotion.")
@click.option("--bml", metavar="FILE", help="A document whose face is performed; - for standard input.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help=OUT_HELP)
@click.option("--variant", type=click.Choice(get_args(Variant)), default="female", show_default=True)
@click.option(
    "--preset", type=click.Choice(list(PRESETS)), default="normal", show_default=True, help="How much is drawn."
)
@click.option("--yaw", default=0.0, metavar="DEG", help="Seen from the side: 90 shows the left side, 180 the back.")
@click.option("--size", type=int, help=f"Pixels along a side ({SIDE}; {CELL} each on a sheet, {STRIP} in a strip).")
@click.option("--gain", default=1.0, show_default=True, help="Of the wrinkles, 0 to 4.")
@click.option("--sheet", is_flag=True, help="Every action unit low and high, with and without wrinkles.")
@planning
def face(
    settings: PlanningOptions,
    units: str,
    emotion: str | None,
    amount: float,
    bml: str | None,
    out: Path | None,
    variant: Variant,
    preset: str,
    yaw: float,
    size: int | None,
    gain: float,
    sheet: bool,
) -> int:
    """Draws the face: a still, a film, a contact sheet, or a window where there is a display and no --out."""
    if sum((bool(units or emotion), bml is not None, sheet)) > 1:
        raise click.UsageError("choose one: --au and --emotion, --bml, or --sheet")
    try:
        told = read_units(units) | read_emotion(emotion, amount)
        sight = Sight(variant, preset, replace(CLOSE if sheet or bml else FRONT, yaw_deg=yaw), gain, size)
        if out is None and (sheet or not has_display()):
            raise DisplayError("no display for a window; --out X.png, X.webp or X.mp4 writes a file")
        if bml is not None:
            _perform(plan(read_input(bml), settings.setup(), source=bml), sight, out)
        elif out is None:
            _show(told, sight)
        else:
            _draw(told, sight, out, sheet=sheet)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    if out is not None:
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


def read_emotion(name: str | None, amount: float) -> dict[str, float]:
    """Action units of an emotion or a lexeme at an amount 0..1; none for None.

    Raises:
        DisplayError: no expression has such a name.
    """
    if name is None:
        return {}
    found = expression(Face((name,), amount=amount))
    if found.unknown:
        known = ", ".join(entry.words[0] for entry in entries() if len(entry.words) > 1)
        raise DisplayError(f"--emotion {name}: no expression is called so; there are {known}")
    return dict(found.units)


def _draw(told: Mapping[str, float], sight: Sight, out: Path, *, sheet: bool) -> None:
    """A still, a short film, or a sheet."""
    moving = out.suffix.lower() not in ("", ".png") and not sheet
    (check_film if moving else check_ending)(out)
    with sight.portrait(CELL if sheet else SIDE) as portrait:
        if sheet:
            save(contact_sheet(portrait, sight.camera), out)
        elif moving:
            save_film(list(_film(portrait, told, sight)), out, rate=FILM_RATE)
        else:
            save(portrait.draw(told, sight.camera, gain=sight.gain), out)


def _film(portrait: Portrait, told: Mapping[str, float], sight: Sight) -> Iterator[Pixels]:
    """The expression rising from rest, held, and gone again."""
    for frame in range(round(SECONDS * FILM_RATE)):
        time = frame / FILM_RATE
        t = min(1.0, time / RISE, (SECONDS - time) / RISE)
        share = t * t * (3 - 2 * t)
        yield portrait.draw({name: share * value for name, value in told.items()}, sight.camera, gain=sight.gain)


def _show(told: Mapping[str, float], sight: Sight) -> None:
    """One expression in a window, until somebody closes it."""
    none = np.zeros(0)
    click.echo(KEYS, err=True)
    with Preview(look=sight.look, windowed=True) as preview:
        preview.write(Command(0.0, none, none, none, none, told))
        preview.wait()


def _perform(planned: Plan, sight: Sight, out: Path | None) -> None:
    """The face of a document, in a window or a file."""
    robot, times = planned.setup.robot, command_times(planned.duration)
    if out is None:
        click.echo(KEYS, err=True)
        play_whole(planned, Preview(robot, look=sight.look, windowed=True))
        return
    with TemporaryDirectory() as folder:
        heard, wav = sound(planned), None
        if heard is not None:
            wav = Path(folder) / "speech.wav"
            write_wav(heard, wav)
        side = sight.side if sight.side is not None else STRIP if out.suffix.lower() == ".png" else SIDE
        rate = FILM_RATE / 2 if out.suffix.lower() == ".png" else FILM_RATE
        look = PortraitSettings(sight.variant, PRESETS[sight.preset], side, sight.camera, sight.gain)
        recording = FaceRecording(out, robot, look=look, rate=rate, sound=wav)
        play(commands_with_face(planned, times), recording)
