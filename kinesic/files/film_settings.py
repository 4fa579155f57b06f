"""What a film of a performance is like."""

from dataclasses import dataclass
from typing import Literal

FilmFormat = Literal["webp", "mp4"]


@dataclass(frozen=True)
class FilmSettings:
    """Its pictures and its file."""

    size: tuple[int, int] = (1280, 720)  # width and height [pixels], both even
    rate: float = 30.0  # [Hz] of pictures
    format: FilmFormat = "webp"

    @property
    def name(self) -> str:
        """Of its file."""
        return f"film.{self.format}"


USUAL = FilmSettings()
