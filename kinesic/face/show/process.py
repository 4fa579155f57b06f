"""Preview process that draws the newest command's face as often as possible."""

import multiprocessing
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.face.display import DisplayError, open_offscreen_context
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import CLOSE_CAMERA, STUDIO_LIGHTS
from kinesic.face.render.effects import Effects
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import QUALITY_PRESETS
from kinesic.face.render.pupils import Pupils, compute_light_on_eyes
from kinesic.face.show.controls import Controls
from kinesic.face.show.files import SideFilm
from kinesic.face.show.preview_settings import NO_EFFECTS, PreviewSettings
from kinesic.face.show.shared_command import SharedCommand, ShownFace
from kinesic.face.show.window import open_window

POLL_INTERVAL = 0.004  # [s] interval between two reads of the shared command
MIN_FRAME_INTERVAL = 1 / 60  # [s] smallest time between two pictures


class Screen(Protocol):
    """Interface of an output for pictures that also returns pressed keys."""

    @property
    def closed(self) -> bool:
        """Whether the screen was closed."""

    def show(self, pixels: Picture, title: str, /) -> None:
        """Show a picture of the face."""

    def pressed(self) -> list[str]:
        """Return the names of the keys pressed since the last call."""


class HiddenScreen:
    """Screen without output, for previews without a window."""

    closed = False

    def show(self, pixels: Picture, title: str, /) -> None:
        """Discard the picture of the face."""

    def pressed(self) -> list[str]:
        """Return no keys, since a hidden screen has none."""
        return []


class ChildAnswer(Protocol):
    """Pipe that reports to the main process whether the preview is ready."""

    def send(self, word: str, /) -> None:
        """Report success as an empty text, or an error."""


def show_face(shared: SharedCommand, answer: ChildAnswer, look: PreviewSettings) -> None:
    """Draw the preview until the performance ends or the window closes."""
    try:
        with ExitStack() as opened:
            size = (look.side, look.side)
            body = None if look.beside is None else SideFilm(look.beside, look.side)
            wide = look.side if body is None else look.side + body.at(0.0).shape[1]
            begun = Controls(look.preset, look.variant, gain=look.gain, yaw_deg=look.yaw_deg)
            screen: Screen = HiddenScreen()
            if look.windowed:
                screen = framed = opened.enter_context(open_window((wide, look.side), begun.title))
                context = framed.context
            else:
                context = opened.enter_context(open_offscreen_context())
            draw = make_painter(context, size, body, look.effects, light=look.light)
            draw(shared.read(), begun)  # reports drawing errors before the performance starts
            answer.send("")
            run_preview(shared, screen, draw, begun)
    except DisplayError as error:
        answer.send(str(error))


def make_painter(
    context: GlContext,
    size: tuple[int, int],
    body: SideFilm | None = None,
    effects: Effects = NO_EFFECTS,
    *,
    light: float = 1.0,
) -> Callable[[ShownFace, Controls], Picture]:
    """Return a drawing function that caches portraits by preset and variant."""
    portraits: dict[tuple[str, Variant], Portrait] = {}
    lights, pupils, last = STUDIO_LIGHTS.scaled(light), Pupils(), 0.0

    def draw(shown: ShownFace, controls: Controls) -> Picture:
        nonlocal last
        kind = (controls.preset, controls.variant)
        if kind not in portraits:
            preset = effects.apply_to(QUALITY_PRESETS[controls.preset])
            portraits[kind] = Portrait(controls.variant, preset=preset, size=size, lights=lights, context=context)
        camera, units = (
            replace(CLOSE_CAMERA, yaw_deg=controls.yaw_deg, turn=shown.turn),
            controls.merge_units(shown.units),
        )
        wide = pupils.follow(compute_light_on_eyes(lights, units, camera), shown.time - last)
        last = shown.time
        face = portraits[kind].draw(units, camera, gain=controls.gain, pupil=wide)
        return face if body is None else np.concatenate([face, body.at(shown.time)], axis=1)

    return draw


def run_preview(
    shared: SharedCommand, screen: Screen, draw: Callable[[ShownFace, Controls], Picture], controls: Controls
) -> int:
    """Redraw the face whenever the command or the settings change.

    Frames may be dropped, but never the last command.

    Returns:
        The number of pictures.
    """
    drawn, last, pictures, player = None, -MIN_FRAME_INTERVAL, 0, multiprocessing.parent_process()
    while not (screen.closed or controls.is_closing) and (player is None or player.is_alive()):
        over = shared.is_over  # read before the command, so that the last command is drawn
        for key in screen.pressed():
            controls = controls.press(key)
        newest = (shared.read(), controls)
        if newest != drawn and time.perf_counter() - last >= MIN_FRAME_INTERVAL:
            last = time.perf_counter()
            screen.show(draw(*newest), controls.title)
            drawn, pictures = newest, pictures + 1
        elif over:
            break
        else:
            time.sleep(POLL_INTERVAL)
    return pictures
