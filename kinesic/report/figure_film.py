"""The film of a performance by a robot with skin: the whole figure, its face in step with its hands."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.files.caption_band import words_at, write_caption
from kinesic.files.film_file import EncodingError, durations, open_film
from kinesic.files.film_settings import USUAL, FilmSettings
from kinesic.planning.face_track import faces
from kinesic.planning.plan import Plan
from kinesic.report.films import Kind, captions_of

MOST_PICTURES = 3600  # of one film; a longer one has fewer a second


@dataclass(frozen=True, eq=False)
class FigureFilm:
    """What a figure did."""

    kind: ClassVar[Kind] = "twin"  # it is drawn where a robot's would be
    after: ClassVar[None] = None
    robot: Robot
    angles: Floats  # (k, n) [rad] of its pictures
    units: tuple[Mapping[str, float], ...]  # k action units -> 0..1
    words: tuple[str, ...]  # k captions
    rate: float  # [Hz] of pictures
    size: tuple[int, int] = USUAL.size
    sound: Path | None = None  # a WAV on the same clock

    @classmethod
    def of(cls, plan: Plan, times: Floats, angles: Floats, settings: FilmSettings = USUAL) -> "FigureFilm":
        """The film of a motion that was measured at (m,) [s], (m, n) [rad], with the face that was planned."""
        rate = min(settings.rate, MOST_PICTURES / max(float(times[-1]), 1e-9))
        moments = np.arange(0.0, times[-1] + 1e-9, 1.0 / rate)
        postures = np.column_stack([np.interp(moments, times, column) for column in angles.T])
        units = tuple(dict(row) for row in faces(plan, moments))
        spoken = captions_of(plan)
        words = tuple(words_at(spoken, time + 0.5 / rate) for time in moments.tolist())
        return cls(plan.setup.robot, postures, units, words, rate, settings.size)

    @staticmethod
    def prepare() -> None:
        """Nothing is known before the job."""

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file, telling the share that is done; returns why not, or nothing."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - another film's process does without
        from kinesic.face.render.figure import FILMED, FigurePortrait  # noqa: PLC0415 - as above

        shown = durations(len(self.angles), self.rate)
        try:
            with (
                FigurePortrait(self.robot.skeleton, preset=FILMED, size=self.size) as portrait,
                open_film(path, self.size, rate=self.rate, sound=self.sound) as film,
            ):
                for k, (posture, units, words) in enumerate(zip(self.angles, self.units, self.words, strict=True)):
                    picture = portrait.draw(posture, units).copy()
                    write_caption(picture, words)
                    film.write(picture, None, shown[k])
                    progress((k + 1) / len(self.angles))
        except (DisplayError, EncodingError) as error:
            return str(error)
        return ""
