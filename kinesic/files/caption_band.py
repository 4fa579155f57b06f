"""Captions in a dark band at the bottom of a film."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Picture
from kinesic.files.film_file import PixelBox
from kinesic.files.late_pillow import Image, ImageDraw, ImageFont

LETTER_HEIGHT = 0.04  # font size / picture height
MAX_LINE_WIDTH = 0.86  # Largest line width / picture width
BAND_MARGIN = 0.025  # Distance of the caption band from the lower edge / picture height
BAND_PADDING = 0.45  # space between words and edges of the band / font size
BAND_COLOUR = (16, 20, 28, 190)  # RGBA of the band behind the words
TEXT_COLOUR = (255, 255, 255, 255)  # RGBA of the words
MAX_LINES = 2  # Largest number of lines of a caption
Spoken = tuple[float, float, str]  # [s] begin, [s] end, and the spoken words


def words_at(spoken: Sequence[Spoken], time: float) -> str:
    """Return the texts spoken at a time [s], joined by spaces."""
    return " ".join(text for begin, end, text in spoken if begin <= time < end)


def caption_box(text: str, size: tuple[int, int]) -> PixelBox | None:
    """Return the pixel box of a caption in a picture, or None.

    None without words; `size` is width and height of the picture.
    """
    return _render_band(text, size)[0] if text else None


def write_caption(picture: Picture, text: str) -> None:
    """Draw a caption into a picture, unless the text is empty."""
    if text:
        height, width, _ = picture.shape
        (left, top, right, low), ink, opacity = _render_band(text, (width, height))
        below = picture[top:low, left:right]
        below[...] = (below * (1.0 - opacity) + ink * opacity).astype(np.uint8)


@lru_cache(maxsize=4)
def _render_band(text: str, size: tuple[int, int]) -> tuple[PixelBox, NDArray[np.float32], NDArray[np.float32]]:
    """Render a caption as pixel box, colours and opacity.

    The colours have shape (h, w, 3), the opacity (h, w, 1).
    """
    width, height = size
    font = ImageFont.load_default(max(round(LETTER_HEIGHT * height), 8))
    lines = _break_lines(text, font, MAX_LINE_WIDTH * width)
    words, padding = "\n".join(lines), round(BAND_PADDING * LETTER_HEIGHT * height)
    pen = ImageDraw.Draw(Image.new("RGBA", (1, 1)))
    left, top, right, low = (round(value) for value in pen.multiline_textbbox((0, 0), words, font=font, align="center"))
    across, tall = min(right - left + 2 * padding, width), min(low - top + 2 * padding, height)
    band = Image.new("RGBA", (across + across % 2, tall + tall % 2), (0, 0, 0, 0))
    pen = ImageDraw.Draw(band)
    pen.rounded_rectangle((0, 0, band.width - 1, band.height - 1), radius=padding, fill=BAND_COLOUR)
    pen.multiline_text((padding - left, padding - top), words, font=font, fill=TEXT_COLOUR, align="center")
    x, y = (width - band.width) // 4 * 2, (height - band.height - round(BAND_MARGIN * height)) // 2 * 2
    colours = np.asarray(band, dtype=np.float32)
    return (x, y, x + band.width, y + band.height), colours[..., :3], colours[..., 3:] / np.float32(255)


def _break_lines(text: str, font: "ImageFont.FreeTypeFont | ImageFont.ImageFont", max_width: float) -> list[str]:
    """Break a caption into lines of at most `max_width` [pixels].

    A wider word has its own line. Words beyond the last line are replaced by an ellipsis.
    """
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if not lines[-1] or font.getlength(longer) <= max_width:
            lines[-1] = longer
        elif len(lines) < MAX_LINES:
            lines.append(word)
        else:
            lines[-1] += " ..."
            break
    return lines
