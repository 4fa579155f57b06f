"""Verb `kinesic face`: render the face to a file or window."""

from collections import Counter
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
from kinesic.cli.options import (
    DEFAULT_PICTURE_SIDE,
    SHEET_PICTURE_SIDE,
    STRIP_PICTURE_SIDE,
    ExpressionOptions,
    PictureFile,
    Planning,
    read_input,
)
from kinesic.cli.playback import play_whole
from kinesic.cli.progress import show_stages, stage_progress
from kinesic.controller.play import play
from kinesic.controller.soundtrack import sound, write_wav
from kinesic.expressivity.face.expressions import entries, find_expression
from kinesic.face.assets.action_units import read_intensities
from kinesic.face.display import DisplayError
from kinesic.face.render.camera import CLOSE_CAMERA, FRONT_CAMERA, STUDIO_LIGHTS, Camera
from kinesic.face.render.effects import Effects
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import QUALITY_PRESETS, Preset
from kinesic.face.render.pupils import Pupils, compute_light_on_eyes
from kinesic.face.show.controls import KEY_HELP
from kinesic.face.show.files import check_ending, check_film, save_film, save_picture
from kinesic.face.show.preview import Preview
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.recording import FaceRecording, PortraitSettings
from kinesic.face.show.sheet import draw_units_sheet
from kinesic.face.show.window import has_display
from kinesic.files.output_file import check_file, new_file
from kinesic.planning.face_track import commands_with_face
from kinesic.planning.plan import Plan
from kinesic.session.plan import plan

FILM_RATE = 25.0  # [Hz] frame rate of films
FILM_SUPERSAMPLING = 2  # samples along each side of a pixel in films, except with preset draft
MAX_SUPERSAMPLED_SIDE = 2048  # [pixels] largest film side with several samples per pixel
EXPRESSION_FILM_DURATION = 2.0  # [s] duration of a film of one expression
MIN_BRIGHTNESS = 0.01  # darkest light, relative to the default
MAX_BRIGHTNESS = 4.0  # brightest light, relative to the default
LIGHT_REMEDY = (
    f"give a brightness relative to the default, {MIN_BRIGHTNESS:g} to {MAX_BRIGHTNESS:g}, or two such as 0.05:1"
)
EXPRESSION_RISE_TIME = 0.5  # [s] duration of the rise from the neutral face, and of the fall back to it


@dataclass(frozen=True)
class ViewSettings:
    """Camera, effects and light for rendering the face."""

    view: FaceView
    camera: Camera
    effects: Effects
    light: tuple[float, float] = (1.0, 1.0)  # brightness in the first and second half of a film

    def choose_side(self, default_side: int) -> int:
        """Return the picture's side length [pixels], as requested or by default."""
        return default_side if self.view.size is None else self.view.size

    def choose_preset(self, *, filmed: bool) -> Preset:
        """Return the quality preset, with supersampling for films.

        Films render several samples per pixel because moving edges would flicker.

        Raises:
            DisplayError: an effect cannot be combined with this preset.
        """
        preset = self.effects.apply_to(QUALITY_PRESETS[self.view.preset])
        supersampled = filmed and preset.smooth and self.choose_side(DEFAULT_PICTURE_SIDE) <= MAX_SUPERSAMPLED_SIDE
        return replace(preset, samples=FILM_SUPERSAMPLING) if supersampled else preset

    def open_portrait(self, default_side: int, *, filmed: bool) -> Portrait:
        """Open a renderer of the face with this view."""
        side = self.choose_side(default_side)
        lights = STUDIO_LIGHTS.scaled(self.light[0])
        return Portrait(self.view.variant, preset=self.choose_preset(filmed=filmed), size=(side, side), lights=lights)

    @property
    def preview_settings(self) -> PreviewSettings:
        """Settings of a preview window with this view."""
        view = self.view
        return PreviewSettings(
            view.variant,
            view.preset,
            self.choose_side(DEFAULT_PICTURE_SIDE),
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
    """Draw an expression, a document's face, or a sheet of action units.

    The result goes to a file, or without a file to a window.
    """
    if sum((bool(expression.units or expression.emotion), bml is not None, sheet)) > 1:
        raise click.UsageError("choose one: --au and --emotion, --bml, or --sheet")
    out = picture.out
    try:
        units = read_units(expression.units) | read_emotion(expression.emotion, expression.amount)
        settings = ViewSettings(
            view, replace(CLOSE_CAMERA if sheet or bml else FRONT_CAMERA, yaw_deg=view.yaw), effects.effects
        )
        settings = replace(settings, light=read_light(view.light, filmed=_is_expression_film(out, bml, sheet=sheet)))
        if out is None and (sheet or not has_display()):
            raise DisplayError("no display for a window; --out X.png, X.webp or X.mp4 writes a file")
        if out is not None:
            _check_suffix(out, still=sheet)
            check_file(out, force=picture.force)
        document_plan = None if bml is None else plan(read_input(bml), planning.set_up(), source=bml)
        if out is None:
            _show_window(units if document_plan is None else document_plan, settings)
        else:
            with new_file(out, force=picture.force) as temporary, show_stages() as stage:
                progress = stage_progress(stage, "drawing")
                _draw(units if document_plan is None else document_plan, settings, temporary, progress, sheet=sheet)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    if out is not None:
        click.echo(f"picture: {out}")
    return 0


def read_units(text: str) -> dict[str, float]:
    """Parse action units with intensities, such as `1=0.8,L12=0.5`.

    Raises:
        DisplayError: the syntax is wrong, a unit is unknown, or an intensity is outside 0..1.
    """
    intensities: dict[str, float] = {}
    for part in filter(None, (item.strip() for item in text.split(","))):
        name, _, value = part.partition("=")
        try:
            intensities[name.strip().upper()] = float(value)
        except ValueError:
            raise DisplayError(f"--au {part}: write a unit and its intensity, such as 12=0.8") from None
    read_intensities(intensities)
    return intensities


def read_emotion(name: str | None, amount: float) -> dict[str, float]:
    """Return the action units of an emotion at an intensity 0..1.

    The name may be an emotion or a BML lexeme. Without a name there are no units.

    Raises:
        DisplayError: no expression has this name.
    """
    if name is None:
        return {}
    expression = find_expression(Face((name,), amount=amount))
    if expression.unknown:
        count = Counter(entry.words[0] for entry in entries())  # two words name those that share their first one
        names = ", ".join(" ".join(entry.words[: min(count[entry.words[0]], 2)]) for entry in entries())
        raise DisplayError(f"--emotion {name}: no expression has this name; there are {names}")
    return dict(expression.units)


def read_light(text: str, *, filmed: bool) -> tuple[float, float]:
    """Parse one brightness, or two for the halves of a film.

    Brightness is relative to the default lighting: `0.5`, or `0.05:1`.

    Raises:
        DisplayError: the syntax is wrong, a value is out of range, or two values are given without a film.
    """
    try:
        first, *rest = (float(value) for value in text.split(":"))
    except ValueError:
        raise DisplayError(f"--light {text}: {LIGHT_REMEDY}") from None
    if len(rest) > 1 or not all(MIN_BRIGHTNESS <= value <= MAX_BRIGHTNESS for value in (first, *rest)):
        raise DisplayError(f"--light {text}: {LIGHT_REMEDY}")
    if rest and not filmed:
        raise DisplayError(f"--light {text}: two values need a film of an expression, such as --out X.mp4")
    return first, rest[0] if rest else first


def _is_expression_film(out: Path | None, bml: str | None, *, sheet: bool) -> bool:
    """Return whether the output is a film of one expression."""
    return out is not None and _is_film(out) and bml is None and not sheet


def _is_film(out: Path) -> bool:
    return out.suffix.lower() not in ("", ".png")


def _check_suffix(out: Path, *, still: bool) -> None:
    """Refuse an output path whose suffix is not a supported format.

    A film needs a film suffix, a still a picture suffix.
    """
    (check_film if _is_film(out) and not still else check_ending)(out)


def _draw(
    content: Mapping[str, float] | Plan,
    settings: ViewSettings,
    out: Path,
    progress: Callable[[float], None],
    *,
    sheet: bool,
) -> None:
    if isinstance(content, Plan):
        _film_document(content, settings, out, progress)
        return
    progress(0.0)
    with settings.open_portrait(
        SHEET_PICTURE_SIDE if sheet else DEFAULT_PICTURE_SIDE, filmed=_is_film(out) and not sheet
    ) as portrait:
        if sheet:
            save_picture(draw_units_sheet(portrait, settings.camera, progress=progress), out)
        elif _is_film(out):
            save_film(list(_draw_frames(portrait, content, settings, progress)), out, rate=FILM_RATE)
        else:
            save_picture(portrait.draw(content, settings.camera, gain=settings.view.gain), out)


def _draw_frames(
    portrait: Portrait, units: Mapping[str, float], settings: ViewSettings, progress: Callable[[float], None]
) -> Iterator[Picture]:
    """Yield film frames in which the expression rises, holds and fades.

    The pupils adapt to the light.
    """
    pupils = Pupils()
    for frame in range(round(EXPRESSION_FILM_DURATION * FILM_RATE)):
        progress(frame / (EXPRESSION_FILM_DURATION * FILM_RATE))
        time = frame / FILM_RATE
        t = min(1.0, time / EXPRESSION_RISE_TIME, (EXPRESSION_FILM_DURATION - time) / EXPRESSION_RISE_TIME)
        intensity = t * t * (3 - 2 * t)
        scaled_units = {name: intensity * value for name, value in units.items()}
        portrait.light(STUDIO_LIGHTS.scaled(settings.light[time >= EXPRESSION_FILM_DURATION / 2]))
        pupil_size = pupils.follow(
            compute_light_on_eyes(portrait.lights, scaled_units, settings.camera), 1.0 / FILM_RATE
        )
        yield portrait.draw(scaled_units, settings.camera, gain=settings.view.gain, pupil=pupil_size)


def _show_window(content: Mapping[str, float] | Plan, settings: ViewSettings) -> None:
    """Show an expression until the window closes, or play a document once."""
    empty = np.zeros(0)
    click.echo(KEY_HELP, err=True)
    if isinstance(content, Plan):
        play_whole(content, Preview(content.setup.robot, look=settings.preview_settings, windowed=True))
        return
    with Preview(look=settings.preview_settings, windowed=True) as preview:
        preview.write(Command(0.0, empty, empty, empty, empty, content))
        preview.wait()


def _film_document(planned: Plan, settings: ViewSettings, out: Path, progress: Callable[[float], None]) -> None:
    """Film the face during the performance of a document."""
    robot, times = planned.setup.robot, planned.command_times
    with TemporaryDirectory() as folder:
        speech, speech_file = sound(planned), None
        if speech is not None:
            speech_file = Path(folder) / "speech.wav"
            write_wav(speech, speech_file)
        is_strip, view = out.suffix.lower() == ".png", settings.view
        side, rate = (STRIP_PICTURE_SIDE, FILM_RATE / 2) if is_strip else (DEFAULT_PICTURE_SIDE, FILM_RATE)
        pixels = settings.choose_side(side)
        preset = settings.choose_preset(filmed=not is_strip)
        look = PortraitSettings(view.variant, preset, (pixels, pixels), settings.camera, view.gain, settings.light[0])
        recording = FaceRecording(out, robot, look=look, rate=rate, sound=speech_file, progress=progress)
        play(commands_with_face(planned, times), recording)
