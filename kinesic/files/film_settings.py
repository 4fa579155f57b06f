"""Settings of a film of a performance."""

from dataclasses import dataclass
from typing import Literal

FilmFormat = Literal["webp", "mp4"]
FaceLook = Literal["drawn", "rendered"]


@dataclass(frozen=True)
class FilmSettings:
    """Picture size, picture rate, format and face style of a film."""

    size: tuple[int, int] = (1280, 720)  # width and height [pixels], both even
    rate: float = 30.0  # [Hz] picture rate
    format: FilmFormat = "webp"  # file format of the film
    face: FaceLook = "drawn"  # look of the face on the screen of a robot's head, in film and page

    @property
    def name(self) -> str:
        """File name of the film."""
        return f"film.{self.format}"


DEFAULT_FILM = FilmSettings()  # settings of a film without options
