"""The film of a performance by a robot with skin: the whole figure, its face in step with its hands."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.files.caption_band import words_at, write_caption
from kinesic.files.film_file import EncodingError, durations, open_film
from kinesic.files.film_settings import USUAL, FilmSettings
from kinesic.planning.face_track import faces
from kinesic.planning.plan import Plan
from kinesic.report.films import FilmKind, captions_of
from kinesic.sim.filming.framing import FRAME, moving_balls, watched_segments

if TYPE_CHECKING:
    from kinesic.face.render.camera import Camera

MOST_PICTURES = 3600  # of one film; a longer one has fewer a second
NARROWEST = 15.0  # [deg] upright: head and hands with some of the body about them


@dataclass(frozen=True, eq=False)
class FigureFilm:
    """A film of a human figure through a performance."""

    kind: ClassVar[FilmKind] = "twin"  # it is drawn where a robot's would be
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
        from kinesic.face.render.figure import FILMED, UPPER, FigurePortrait  # noqa: PLC0415 - as above

        shown = durations(len(self.angles), self.rate)
        middle, field = frame_motion(self.robot, self.angles, UPPER, aspect=self.size[0] / self.size[1])
        camera = replace(UPPER, pivot=middle, field_deg=field)
        try:
            with (
                FigurePortrait(self.robot.skeleton, preset=FILMED, size=self.size) as portrait,
                open_film(path, self.size, rate=self.rate, sound=self.sound) as film,
            ):
                for k, (posture, units, words) in enumerate(zip(self.angles, self.units, self.words, strict=True)):
                    picture = portrait.draw(posture, units, camera).copy()
                    write_caption(picture, words)
                    film.write(picture, None, shown[k])
                    progress((k + 1) / len(self.angles))
        except (DisplayError, EncodingError) as error:
            return str(error)
        return ""


def frame_motion(
    robot: Robot, postures: Floats, camera: "Camera", *, aspect: float
) -> tuple[tuple[float, float, float], float]:
    """Finds where a camera in front has to look for the hands and the head of a motion, with a margin.

    Args:
        robot: who moves.
        postures: (m, n) [rad].
        camera: how far it stands, and before what.
        aspect: width to height of the picture.

    Returns:
        What it looks at [m], and its field of view upright [deg].
    """
    places, radii = moving_balls(robot, postures, watched_segments(robot))
    away = camera.distance + camera.pivot[0] - places[..., 0]
    middle, slopes = list(camera.pivot), []
    for axis, wide in ((1, aspect), (2, 1.0)):
        high, low = (float((sign * places[..., axis] + radii).max()) for sign in (1.0, -1.0))
        middle[axis] = (high - low) / 2
        seen = (np.abs(places[..., axis] - middle[axis]) + radii) / away
        slopes.append(FRAME * float(seen.max()) / wide)
    field = 2 * float(np.degrees(np.arctan(max(slopes))))
    return (middle[0], middle[1], middle[2]), max(field, NARROWEST)
