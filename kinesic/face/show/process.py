"""Draws a preview in a process of its own: the newest command, as often as the machine can."""

import multiprocessing
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.face.display import DisplayError, offscreen
from kinesic.face.gl.context import GlContext
from kinesic.face.render.camera import CLOSE, LIGHTS
from kinesic.face.render.effects import Effects
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import PRESETS
from kinesic.face.render.pupils import Pupils, light_on_eyes
from kinesic.face.show.controls import Controls
from kinesic.face.show.files import SideFilm
from kinesic.face.show.preview_settings import UNCHANGED, PreviewSettings
from kinesic.face.show.shared_command import SharedCommand, ShownFace
from kinesic.face.show.window import open_window

PAUSE = 0.004  # [s] between two looks at the shared command
FASTEST = 1 / 60  # [s] between two pictures


class Screen(Protocol):
    """Where pictures go and keys come from."""

    @property
    def closed(self) -> bool:
        """Whether somebody closed it."""

    def show(self, pixels: Picture, title: str, /) -> None:
        """Shows a picture."""

    def pressed(self) -> list[str]:
        """Names of the keys that were pressed since the last call."""


class Nowhere:
    """A screen that nobody sees: the pictures are drawn all the same."""

    closed = False

    def show(self, pixels: Picture, title: str, /) -> None:
        """Nothing."""

    def pressed(self) -> list[str]:
        """None."""
        return []


class ChildAnswer(Protocol):
    """A pipe to the process that plays, which is told that the preview is ready, or why it is not."""

    def send(self, word: str, /) -> None:
        """Sends a word."""


def show_face(shared: SharedCommand, answer: ChildAnswer, look: PreviewSettings) -> None:
    """Opens a window or none, and draws until no command is to come or the window is closed."""
    try:
        with ExitStack() as opened:
            size = (look.side, look.side)
            body = None if look.beside is None else SideFilm(look.beside, look.side)
            wide = look.side if body is None else look.side + body.at(0.0).shape[1]
            begun = Controls(look.preset, look.variant, gain=look.gain, yaw_deg=look.yaw_deg)
            screen: Screen = Nowhere()
            if look.windowed:
                screen = framed = opened.enter_context(open_window((wide, look.side), begun.title))
                context = framed.context
            else:
                context = opened.enter_context(offscreen())
            draw = painter(context, size, body, look.effects, light=look.light)
            draw(shared.read(), begun)  # whatever cannot be drawn is told before the performance begins
            answer.send("")
            follow(shared, screen, draw, begun)
    except DisplayError as error:
        answer.send(str(error))


def painter(
    context: GlContext,
    size: tuple[int, int],
    body: SideFilm | None = None,
    effects: Effects = UNCHANGED,
    *,
    light: float = 1.0,
) -> Callable[[ShownFace, Controls], Picture]:
    """Makes a function that draws; it keeps a portrait for each preset and variant."""
    portraits: dict[tuple[str, Variant], Portrait] = {}
    lights, pupils, last = LIGHTS.scaled(light), Pupils(), 0.0

    def draw(shown: ShownFace, controls: Controls) -> Picture:
        nonlocal last
        kind = (controls.preset, controls.variant)
        if kind not in portraits:
            preset = effects.applied(PRESETS[controls.preset])
            portraits[kind] = Portrait(controls.variant, preset=preset, size=size, lights=lights, context=context)
        camera, units = replace(CLOSE, yaw_deg=controls.yaw_deg, turn=shown.turn), controls.over(shown.units)
        wide = pupils.follow(light_on_eyes(lights, units, camera), shown.time - last)
        last = shown.time
        face = portraits[kind].draw(units, camera, gain=controls.gain, pupil=wide)
        return face if body is None else np.concatenate([face, body.at(shown.time)], axis=1)

    return draw


def follow(
    shared: SharedCommand, screen: Screen, draw: Callable[[ShownFace, Controls], Picture], controls: Controls
) -> int:
    """Draws the newest command whenever it or a key changed something; frames are dropped, not commands.

    Returns:
        The number of pictures.
    """
    drawn, last, pictures, player = None, -FASTEST, 0, multiprocessing.parent_process()
    while not (screen.closed or controls.shut) and (player is None or player.is_alive()):
        over = shared.over  # before the command is read: the last command is drawn
        for key in screen.pressed():
            controls = controls.pressed(key)
        newest = (shared.read(), controls)
        if newest != drawn and time.perf_counter() - last >= FASTEST:
            last = time.perf_counter()
            screen.show(draw(*newest), controls.title)
            drawn, pictures = newest, pictures + 1
        elif over:
            break
        else:
            time.sleep(PAUSE)
    return pictures
