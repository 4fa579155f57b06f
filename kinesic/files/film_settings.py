"""Settings of a film of a performance."""

from dataclasses import dataclass
from typing import Literal

FilmFormat = Literal["webp", "mp4"]


@dataclass(frozen=True)
class FilmSettings:
    """Size, rate and format of a film."""

    size: tuple[int, int] = (1280, 720)  # width and height [pixels], both even
    rate: float = 30.0  # [Hz] picture rate
    format: FilmFormat = "webp"

    @property
    def name(self) -> str:
        """File name of the film."""
        return f"film.{self.format}"


DEFAULT_FILM = FilmSettings()
