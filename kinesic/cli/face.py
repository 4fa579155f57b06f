"""`kinesic face`: the face in pictures, films and a window."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import click
import numpy as np

from kinesic.bml.block import Face
from kinesic.body.arrays import Picture
from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.cli.effects import EffectOptions, FaceView
from kinesic.cli.options import CELL, SIDE, STRIP, ExpressionOptions, PictureFile, Planning, read_input
from kinesic.cli.playback import play_whole
from kinesic.cli.progress import share_of, show_stages
from kinesic.controller.perform import plan
from kinesic.controller.play import command_times, play
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.expressivity.face.expressions import entries, find_expression
from kinesic.face.assets.action_units import intensities
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import CLOSE, FRONT, LIGHTS, Camera
from kinesic.face.render.effects import Effects
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import PRESETS, Preset
from kinesic.face.render.pupils import Pupils, light_on_eyes
from kinesic.face.show.controls import HELP as KEYS
from kinesic.face.show.files import check_ending, check_film, save, save_film
from kinesic.face.show.preview import Preview
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.recording import FaceRecording, PortraitSettings
from kinesic.face.show.sheet import draw_units_sheet as contact_sheet
from kinesic.face.show.window import has_display
from kinesic.files.output_file import check_file, new_file
from kinesic.planning.face_track import commands_with_face
from kinesic.planning.plan import Plan

FILM_RATE = 25.0  # [Hz] of films
FILM_SAMPLES = 2  # pixels drawn along each side of one of a film, but of a draft
FILM_SIDE = 2048  # pixels along a side of a film, beyond which there is no room for that
SECONDS = 2.0  # that a film of one expression lasts
DIMMEST, BRIGHTEST = 0.01, 4.0  # light of the scene, by the usual one
LIGHT_HOW = f"write how bright it is by the usual light, {DIMMEST:g} to {BRIGHTEST:g}, or two such as 0.05:1"
RISE = 0.5  # [s] from rest to the expression, and back


@dataclass(frozen=True)
class ViewSettings:
    """How the face is looked at."""

    view: FaceView
    camera: Camera
    effects: Effects
    light: tuple[float, float] = (1.0, 1.0)  # of the scene at first, and from the middle of a film

    def side(self, usual: int) -> int:
        """Says how many pixels are drawn along a side: those requested, or else the usual ones."""
        return usual if self.view.size is None else self.view.size

    def preset(self, *, filmed: bool) -> Preset:
        """Says how much is drawn: of a film each pixel several times, since edges that move flicker else.

        Raises:
            DisplayError: an effect cannot be drawn so.
        """
        found = self.effects.applied(PRESETS[self.view.preset])
        finer = filmed and found.smooth and self.side(SIDE) <= FILM_SIDE
        return replace(found, samples=FILM_SAMPLES) if finer else found

    def portrait(self, usual: int, *, filmed: bool) -> Portrait:
        """Opens a portrait of the requested size, or else of the usual one [pixels]."""
        side = self.side(usual)
        lights = LIGHTS.scaled(self.light[0])
        return Portrait(self.view.variant, preset=self.preset(filmed=filmed), size=(side, side), lights=lights)

    @property
    def look(self) -> PreviewSettings:
        """The settings of a preview window in this view."""
        view = self.view
        return PreviewSettings(
            view.variant,
            view.preset,
            self.side(SIDE),
            gain=view.gain,
            light=self.light[0],
            yaw_deg=view.yaw,
            effects=self.effects,
        )


def draw_face(
    planning: Planning,
    expression: ExpressionOptions,
    bml: str | None,
    picture: PictureFile,
    view: FaceView,
    effects: EffectOptions,
    sheet: bool,
) -> int:
    """Draws an expression, the face of a document, or a sheet of all action units, to a file or a window."""
    if sum((bool(expression.units or expression.emotion), bml is not None, sheet)) > 1:
        raise click.UsageError("choose one: --au and --emotion, --bml, or --sheet")
    out = picture.out
    try:
        units = read_units(expression.units) | read_emotion(expression.emotion, expression.amount)
        settings = ViewSettings(view, replace(CLOSE if sheet or bml else FRONT, yaw_deg=view.yaw), effects.effects)
        settings = replace(settings, light=read_light(view.light, filmed=_changes(out, bml, sheet=sheet)))
        if out is None and (sheet or not has_display()):
            raise DisplayError("no display for a window; --out X.png, X.webp or X.mp4 writes a file")
        if out is not None:
            _check_picture(out, still=sheet)
            check_file(out, force=picture.force)
        planned = None if bml is None else plan(read_input(bml), planning.set_up(), source=bml)
        if out is None:
            _show(units if planned is None else planned, settings)
        else:
            with new_file(out, force=picture.force) as fresh, show_stages() as stage:
                drawing = share_of(stage, "drawing")
                _draw(units if planned is None else planned, settings, fresh, drawing, sheet=sheet)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    if out is not None:
        click.echo(f"picture: {out}")
    return 0


def read_units(text: str) -> dict[str, float]:
    """Reads action units and intensities such as `1=0.8,L12=0.5`.

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
    """Finds the action units of an emotion or a lexeme at an amount 0..1; none for None.

    Raises:
        DisplayError: no expression has such a name.
    """
    if name is None:
        return {}
    found = find_expression(Face((name,), amount=amount))
    if found.unknown:
        known = ", ".join(entry.words[0] for entry in entries() if len(entry.words) > 1)
        raise DisplayError(f"--emotion {name}: no expression is called so; there are {known}")
    return dict(found.units)


def read_light(text: str, *, filmed: bool) -> tuple[float, float]:
    """Reads how bright the scene is at first and from the middle of the film, by the usual light: `0.5`, `0.05:1`.

    Raises:
        DisplayError: it is not written so, too dark or too bright, or there is no film in which it could change.
    """
    try:
        first, *later = (float(each) for each in text.split(":"))
    except ValueError:
        raise DisplayError(f"--light {text}: {LIGHT_HOW}") from None
    if len(later) > 1 or not all(DIMMEST <= each <= BRIGHTEST for each in (first, *later)):
        raise DisplayError(f"--light {text}: {LIGHT_HOW}")
    if later and not filmed:
        raise DisplayError(f"--light {text}: light changes in the film of an expression alone, such as --out X.mp4")
    return first, later[0] if later else first


def _changes(out: Path | None, bml: str | None, *, sheet: bool) -> bool:
    """Whether what is drawn is a film of an expression."""
    return out is not None and _is_film(out) and bml is None and not sheet


def _is_film(out: Path) -> bool:
    return out.suffix.lower() not in ("", ".png")


def _check_picture(out: Path, *, still: bool) -> None:
    """Refuses a path whose ending names no format of films, or of pictures where it is a still."""
    (check_film if _is_film(out) and not still else check_ending)(out)


def _draw(
    shown: Mapping[str, float] | Plan,
    settings: ViewSettings,
    out: Path,
    progress: Callable[[float], None],
    *,
    sheet: bool,
) -> None:
    if isinstance(shown, Plan):
        _film_whole(shown, settings, out, progress)
        return
    progress(0.0)
    with settings.portrait(CELL if sheet else SIDE, filmed=_is_film(out) and not sheet) as portrait:
        if sheet:
            save(contact_sheet(portrait, settings.camera, progress=progress), out)
        elif _is_film(out):
            save_film(list(_film(portrait, shown, settings, progress)), out, rate=FILM_RATE)
        else:
            save(portrait.draw(shown, settings.camera, gain=settings.view.gain), out)


def _film(
    portrait: Portrait, units: Mapping[str, float], settings: ViewSettings, progress: Callable[[float], None]
) -> Iterator[Picture]:
    """Yields the expression as it rises from rest, stays and goes again; pupils follow the light."""
    pupils = Pupils()
    for frame in range(round(SECONDS * FILM_RATE)):
        progress(frame / (SECONDS * FILM_RATE))
        time = frame / FILM_RATE
        t = min(1.0, time / RISE, (SECONDS - time) / RISE)
        share = t * t * (3 - 2 * t)
        shown = {name: share * value for name, value in units.items()}
        portrait.light(LIGHTS.scaled(settings.light[time >= SECONDS / 2]))
        wide = pupils.follow(light_on_eyes(portrait.lights, shown, settings.camera), 1.0 / FILM_RATE)
        yield portrait.draw(shown, settings.camera, gain=settings.view.gain, pupil=wide)


def _show(shown: Mapping[str, float] | Plan, settings: ViewSettings) -> None:
    """Shows one expression in a window until somebody closes it, or the face of a document once."""
    none = np.zeros(0)
    click.echo(KEYS, err=True)
    if isinstance(shown, Plan):
        play_whole(shown, Preview(shown.setup.robot, look=settings.look, windowed=True))
        return
    with Preview(look=settings.look, windowed=True) as preview:
        preview.write(Command(0.0, none, none, none, none, shown))
        preview.wait()


def _film_whole(planned: Plan, settings: ViewSettings, out: Path, progress: Callable[[float], None]) -> None:
    """Films the face of a document."""
    robot, times = planned.setup.robot, command_times(planned.duration)
    with TemporaryDirectory() as folder:
        speech, wav = sound(planned), None
        if speech is not None:
            wav = Path(folder) / "speech.wav"
            write_wav(speech, wav)
        is_strip, view = out.suffix.lower() == ".png", settings.view
        side, rate = (STRIP, FILM_RATE / 2) if is_strip else (SIDE, FILM_RATE)
        pixels = settings.side(side)
        preset = settings.preset(filmed=not is_strip)
        look = PortraitSettings(view.variant, preset, (pixels, pixels), settings.camera, view.gain, settings.light[0])
        recording = FaceRecording(out, robot, look=look, rate=rate, sound=wav, progress=progress)
        play(commands_with_face(planned, times), recording)
