"""The film of a performance by a robot with skin: the whole figure, its face in step with its hands."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.planning.face_track import faces
from kinesic.planning.plan import Plan
from kinesic.report.films import Kind

if TYPE_CHECKING:
    from kinesic.face.render.portrait import Pixels

SIZE = (1280, 720)  # [pixels]
RATE = 24.0  # [Hz]
MOST_PICTURES = 480  # of one film, as its writer may hold them all; a longer one has fewer a second


@dataclass(frozen=True, eq=False)
class FigureFilm:
    """What a figure did."""

    kind: ClassVar[Kind] = "twin"  # it is drawn where a robot's would be
    robot: Robot
    angles: Floats  # (k, n) [rad] of its pictures
    units: tuple[Mapping[str, float], ...]  # k action units -> 0..1
    rate: float  # [Hz] of pictures
    size: tuple[int, int] = SIZE

    @classmethod
    def of(cls, plan: Plan, times: Floats, angles: Floats) -> "FigureFilm":
        """The film of a motion that was measured at (m,) [s], (m, n) [rad], with the face that was planned."""
        rate = min(RATE, MOST_PICTURES / max(float(times[-1]), 1e-9))
        moments = np.arange(0.0, times[-1] + 1e-9, 1.0 / rate)
        postures = np.column_stack([np.interp(moments, times, column) for column in angles.T])
        units = tuple(dict(row) for row in faces(plan, moments))
        return cls(plan.setup.robot, postures, units, rate)

    @staticmethod
    def prepare() -> None:
        """Nothing is known before the job."""

    def draw(self, path: Path, progress: Callable[[float], None], /) -> str:
        """Draws it to a file, telling the share that is done; returns why not, or nothing."""
        from kinesic.face.display import DisplayError  # noqa: PLC0415 - another film's process does without
        from kinesic.face.render.figure import FILMED, FigurePortrait  # noqa: PLC0415 - as above
        from kinesic.face.show.files import save_film  # noqa: PLC0415 - as above
        from kinesic.face.show.pictures import LazyPictures  # noqa: PLC0415 - as above

        try:
            with FigurePortrait(self.robot.skeleton, preset=FILMED, size=self.size) as portrait:
                pictures = LazyPictures(len(self.angles), partial(self._draw_one, portrait.draw, progress))
                save_film(pictures, path, rate=self.rate)
        except DisplayError as error:
            return str(error)
        return ""

    def _draw_one(
        self, draw: "Callable[[Floats, Mapping[str, float]], Pixels]", progress: Callable[[float], None], index: int
    ) -> "Pixels":
        picture = draw(self.angles[index], self.units[index])
        progress((index + 1) / len(self.angles))
        return picture
