"""Output of a performance that films the face after its end."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType

import numpy as np

from kinesic.body.arrays import Floats, Picture
from kinesic.body.choices import Variant
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.face.render.camera import CLOSE_CAMERA, STUDIO_LIGHTS, Camera
from kinesic.face.render.head_pose import compute_head_turns
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, Preset
from kinesic.face.render.pupils import Pupils, compute_light_on_eyes
from kinesic.face.show.files import check_film, save_film

MAX_PICTURES = 3600  # largest number of pictures per film
PUPIL_DIGITS = 5  # decimal places of a pupil diameter [m]; finer changes are invisible
TIME_TOLERANCE = 1e-6  # [s] largest time by which a command may precede its picture


@dataclass(frozen=True)
class PortraitSettings:
    """Renderer settings for the pictures of a face film."""

    variant: Variant = "female"  # variant of the head
    preset: Preset = NORMAL_PRESET  # quality preset
    size: tuple[int, int] = (384, 384)  # width and height [pixels]
    camera: Camera = CLOSE_CAMERA
    gain: float = 1.0  # gain of the wrinkles
    light: float = 1.0  # brightness factor of the scene


DEFAULT_SETTINGS = PortraitSettings()


class FaceRecording:
    """Output of a performance that makes a film of its face.

    Pictures are drawn when the recording is closed, so that drawing does not delay the performance.
    """

    def __init__(
        self,
        path: Path,
        robot: Robot | None = None,
        *,
        look: PortraitSettings = DEFAULT_SETTINGS,
        rate: float = 25.0,
        sound: Path | None = None,
        progress: Callable[[float], None] = lambda fraction: None,
    ) -> None:
        """Start an empty recording of a face film.

        Args:
            path: file ending in .webp, .mp4 (if an encoder is installed), or .png for a strip of the pictures.
            robot: robot whose head turns the face; None: the face looks ahead.
            look: settings of the pictures.
            rate: frame rate [Hz]; lower if there would be more than `MAX_PICTURES`.
            sound: WAV file on the clock of the performance, for formats with sound.
            progress: called after each picture with the fraction drawn.

        Raises:
            DisplayError: the suffix is not that of a supported film format.
        """
        check_film(path)
        self._path, self._robot, self._look, self._rate, self._sound = path, robot, look, rate, sound
        self._progress = progress
        self._rows: list[tuple[float, Mapping[str, float], Floats]] = []

    def write(self, command: Command) -> None:
        """Record a command if a picture is due."""
        if not self._rows or command.time - self._rows[0][0] > len(self._rows) / self._rate - TIME_TOLERANCE:
            self._rows.append((command.time, command.face, command.angles))

    def close(self) -> None:
        """Draw the recorded pictures and write the film.

        Raises:
            DisplayError: nothing can be drawn here, an unknown action unit, or an intensity outside 0..1.
        """
        if self._rows:
            step = -(-len(self._rows) // MAX_PICTURES)
            rows, self._rows = self._rows[::step], []
            save_film(self._drawn(rows), self._path, rate=self._rate / step, sound=self._sound)

    def _drawn(self, rows: list[tuple[float, Mapping[str, float], Floats]]) -> Iterator[Picture]:
        angles = np.array([angles for _, _, angles in rows])
        stands = np.zeros((len(rows), 3)) if self._robot is None else compute_head_turns(self._robot, angles)
        look, previous, last, pupils = self._look, None, rows[0][0], Pupils()
        lights = STUDIO_LIGHTS.scaled(look.light)
        with Portrait(look.variant, preset=look.preset, size=look.size, lights=lights) as portrait:
            for k, ((time, units, _), turn) in enumerate(zip(rows, stands.tolist(), strict=True)):
                camera = replace(look.camera, turn=tuple(turn))
                wide = round(pupils.follow(compute_light_on_eyes(lights, units, camera), time - last), PUPIL_DIGITS)
                if previous is None or previous != (units, turn, wide):  # an unchanged face is not drawn again
                    pixels = portrait.draw(units, camera, gain=look.gain, pupil=wide)
                previous, last = (units, turn, wide), time
                yield pixels
                self._progress((k + 1) / len(rows))

    def __enter__(self) -> "FaceRecording":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
