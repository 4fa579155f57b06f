"""The face as a sink that makes a film: it keeps commands, and draws them when the performance is over."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType

import numpy as np

from kinesic.body.arrays import Floats, Picture
from kinesic.body.choices import Variant
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.face.render.camera import CLOSE, LIGHTS, Camera
from kinesic.face.render.head_pose import turns
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL, Preset
from kinesic.face.render.pupils import Pupils, light_on_eyes
from kinesic.face.show.files import check_film, save_film

MOST_PICTURES = 3600  # of one film
SEEN = 5  # digits of a pupil [m]: a hundredth of a millimetre is not seen
HALF = 1e-6  # [s] that a command may be early


@dataclass(frozen=True)
class PortraitSettings:
    """How each picture of a film is drawn."""

    variant: Variant = "female"  # of the head
    preset: Preset = NORMAL  # how much is drawn
    size: tuple[int, int] = (384, 384)  # width and height [pixels]
    camera: Camera = CLOSE
    gain: float = 1.0  # of the wrinkles
    light: float = 1.0  # of the scene, by the usual one


PLAIN = PortraitSettings()


class FaceRecording:
    """Pictures of a performance at a steady rate; nothing is drawn before it is closed, so that it holds up nobody."""

    def __init__(
        self,
        path: Path,
        robot: Robot | None = None,
        *,
        look: PortraitSettings = PLAIN,
        rate: float = 25.0,
        sound: Path | None = None,
        progress: Callable[[float], None] = lambda share: None,
    ) -> None:
        """Begins a film.

        Args:
            path: of the file: .webp, .mp4 where an encoder is installed, or .png for a strip of the pictures.
            robot: whose head turns the face; None: it looks ahead.
            look: of the pictures.
            rate: [Hz] of pictures; less when there would be more than `MOST_PICTURES`.
            sound: a WAV on the clock of the performance, for formats that have a sound.
            progress: gets the share of the pictures that are drawn, after each of them.

        Raises:
            DisplayError: the path names no format that can be written here.
        """
        check_film(path)
        self._path, self._robot, self._look, self._rate, self._sound = path, robot, look, rate, sound
        self._progress = progress
        self._rows: list[tuple[float, Mapping[str, float], Floats]] = []

    def write(self, command: Command) -> None:
        """Keeps a command where a picture is due."""
        if not self._rows or command.time - self._rows[0][0] > len(self._rows) / self._rate - HALF:
            self._rows.append((command.time, command.face, command.angles))

    def close(self) -> None:
        """Draws the pictures and writes the film.

        Raises:
            DisplayError: nothing can be drawn here, an unknown action unit, or an intensity outside 0..1.
        """
        if self._rows:
            step = -(-len(self._rows) // MOST_PICTURES)
            rows, self._rows = self._rows[::step], []
            save_film(self._drawn(rows), self._path, rate=self._rate / step, sound=self._sound)

    def _drawn(self, rows: list[tuple[float, Mapping[str, float], Floats]]) -> Iterator[Picture]:
        angles = np.array([angles for _, _, angles in rows])
        stands = np.zeros((len(rows), 3)) if self._robot is None else turns(self._robot, angles)
        look, before, last, pupils = self._look, None, rows[0][0], Pupils()
        lights = LIGHTS.scaled(look.light)
        with Portrait(look.variant, preset=look.preset, size=look.size, lights=lights) as portrait:
            for k, ((time, units, _), turn) in enumerate(zip(rows, stands.tolist(), strict=True)):
                camera = replace(look.camera, turn=tuple(turn))
                wide = round(pupils.follow(light_on_eyes(lights, units, camera), time - last), SEEN)
                if before is None or before != (units, turn, wide):  # a face that holds still is not drawn again
                    pixels = portrait.draw(units, camera, gain=look.gain, pupil=wide)
                before, last = (units, turn, wide), time
                yield pixels
                self._progress((k + 1) / len(rows))

    def __enter__(self) -> "FaceRecording":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
