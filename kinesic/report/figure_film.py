"""Film of a human figure, its face synchronous with its hands."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.files.caption_band import words_at, write_caption
from kinesic.files.film_file import EncodingError, open_film, picture_durations
from kinesic.files.film_settings import DEFAULT_FILM, FilmSettings
from kinesic.planning.face_track import compute_faces
from kinesic.planning.plan import Plan
from kinesic.report.films import FilmKind, captions_of
from kinesic.sim.filming.framing import find_capsule_balls, list_watched_segments

if TYPE_CHECKING:
    from kinesic.face.render.camera import Camera

MAX_PICTURES = 3600  # largest number of pictures; longer films have a lower frame rate
MIN_FIELD_OF_VIEW = 15.0  # [deg] smallest vertical field of view, which includes part of the body
MAX_FIELD_OF_VIEW = 27.0  # [deg] largest vertical field of view, in which the face can be read
FIGURE_MARGIN = 1.1  # picture size / extent of hands and head: 5 % of that extent free on each side
LOWEST_VIEW = 0.70  # [m] height over the floor; hands below it may leave the picture


@dataclass(frozen=True, eq=False)
class FigureFilm:
    """Picklable job that draws the film of a human figure."""

    kind: ClassVar[FilmKind] = "twin"  # takes the place of the film of a robot without skin
    after: ClassVar[None] = None
    robot: Robot
    angles: Floats  # (k, n) [rad] hinge angles in each picture
    units: tuple[Mapping[str, float], ...]  # k action units -> 0..1
    words: tuple[str, ...]  # k captions
    rate: float  # [Hz] of pictures
    size: tuple[int, int] = DEFAULT_FILM.size
    sound: Path | None = None  # a WAV on the same clock

    @classmethod
    def of(cls, plan: Plan, times: Floats, angles: Floats, settings: FilmSettings = DEFAULT_FILM) -> "FigureFilm":
        """Make the job for a measured motion with the planned face.

        Times are (m,) [s], angles (m, n) [rad].
        """
        rate = min(settings.rate, MAX_PICTURES / max(float(times[-1]), 1e-9))
        moments = np.arange(0.0, times[-1] + 1e-9, 1.0 / rate)
        postures = np.column_stack([np.interp(moments, times, column) for column in angles.T])
        units = tuple(dict(row) for row in compute_faces(plan, moments))
        spoken = captions_of(plan)
        words = tuple(words_at(spoken, time + 0.5 / rate) for time in moments.tolist())
        return cls(plan.setup.robot, postures, units, words, rate, settings.size)

    @staticmethod
    def prepare() -> None:
        """Do nothing, as this film needs no preparation."""

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draw the film to a file and return any error text."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - another film's process does without
        from kinesic.face.render.figure import FILM_PRESET, UPPER_BODY_CAMERA, FigurePortrait  # noqa: PLC0415 - as above

        shown = picture_durations(len(self.angles), self.rate)
        middle, field = frame_motion(self.robot, self.angles, UPPER_BODY_CAMERA, aspect=self.size[0] / self.size[1])
        camera = replace(UPPER_BODY_CAMERA, pivot=middle, field_deg=field)
        try:
            with (
                FigurePortrait(self.robot.skeleton, preset=FILM_PRESET, size=self.size) as portrait,
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
    """Aim a front camera of limited view angle at hands and head.

    The field of view stays below `MAX_FIELD_OF_VIEW`, so that the face is readable. If hands then do not fit, the
    camera shows the head and the body below it.

    Args:
        robot: robot that moves.
        postures: (m, n) [rad].
        camera: distance and background.
        aspect: width / height of the picture.

    Returns:
        The target point [m] and the vertical field of view [deg].
    """
    hanging = np.zeros((1, len(robot.skeleton.hinges)))
    places, radii = find_capsule_balls(robot, np.concatenate([postures, hanging]), list_watched_segments(robot))
    away = camera.distance + camera.pivot[0] - places[..., 0]
    places = np.maximum(places, np.array([-np.inf, -np.inf, LOWEST_VIEW]) + radii[:, None])
    (left, right), (high, low) = (
        tuple(float((sign * places[..., axis] + radii).max()) for sign in (1.0, -1.0)) for axis in (1, 2)
    )
    middle = [camera.pivot[0], camera.pivot[1], (high - low) / 2]
    seen = [(np.abs(places[..., axis] - middle[axis]) + radii) / away for axis in (1, 2)]
    slope = FIGURE_MARGIN * float(seen[1].max())
    if float(seen[0].max()) * FIGURE_MARGIN > slope * aspect:
        middle[1] = (left - right) / 2
        seen[0] = (np.abs(places[..., 1] - middle[1]) + radii) / away
    field = 2 * float(np.degrees(np.arctan(max(slope, FIGURE_MARGIN * float(seen[0].max()) / aspect))))
    largest = float(np.tan(np.radians(MAX_FIELD_OF_VIEW) / 2)) * camera.distance
    if field > MAX_FIELD_OF_VIEW:
        top = float((places[..., 2] + radii).max())
        middle[2] = max(middle[2], top - (2 - FIGURE_MARGIN) * largest)
    return (middle[0], middle[1], middle[2]), min(max(field, MIN_FIELD_OF_VIEW), MAX_FIELD_OF_VIEW)
