"""Writes words under a film: a line or two in a dark band, cut where they are too many."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from kinesic.body.arrays import Picture
from kinesic.files.film_file import PixelBox

TALL = 0.04  # of letters, in heights of the picture
WIDE = 0.86  # of a line at most, in widths of the picture
LOW = 0.025  # of the band above the lower edge, in heights of the picture
PADDING = 0.45  # round the words, in heights of letters
BAND, INK = (16, 20, 28, 190), (255, 255, 255, 255)
MOST_LINES = 2

Spoken = tuple[float, float, str]  # [s] begin, [s] end, and what is said then


def words_at(spoken: Sequence[Spoken], time: float) -> str:
    """What is said at a time."""
    return " ".join(text for begin, end, text in spoken if begin <= time < end)


def caption_box(text: str, size: tuple[int, int]) -> PixelBox | None:
    """The part of a picture of a size in which words are written; None without words."""
    return _band(text, size)[0] if text else None


def write_caption(picture: Picture, text: str) -> None:
    """Writes words into a picture; nothing without words."""
    if text:
        height, width, _ = picture.shape
        (left, top, right, low), ink, share = _band(text, (width, height))
        below = picture[top:low, left:right]
        below[...] = (below * (1.0 - share) + ink * share).astype(np.uint8)


@lru_cache(maxsize=4)
def _band(text: str, size: tuple[int, int]) -> tuple[PixelBox, NDArray[np.float32], NDArray[np.float32]]:
    """Where a caption is, its colours (h, w, 3), and how much of them is seen (h, w, 1)."""
    width, height = size
    font = ImageFont.load_default(max(round(TALL * height), 8))
    lines = _lines(text, font, WIDE * width)
    words, padding = "\n".join(lines), round(PADDING * TALL * height)
    pen = ImageDraw.Draw(Image.new("RGBA", (1, 1)))
    left, top, right, low = (round(value) for value in pen.multiline_textbbox((0, 0), words, font=font, align="center"))
    across, tall = min(right - left + 2 * padding, width), min(low - top + 2 * padding, height)
    band = Image.new("RGBA", (across + across % 2, tall + tall % 2), (0, 0, 0, 0))
    pen = ImageDraw.Draw(band)
    pen.rounded_rectangle((0, 0, band.width - 1, band.height - 1), radius=padding, fill=BAND)
    pen.multiline_text((padding - left, padding - top), words, font=font, fill=INK, align="center")
    x, y = (width - band.width) // 4 * 2, (height - band.height - round(LOW * height)) // 2 * 2
    colours = np.asarray(band, dtype=np.float32)
    return (x, y, x + band.width, y + band.height), colours[..., :3], colours[..., 3:] / np.float32(255)


def _lines(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, most: float) -> list[str]:
    """Breaks words into lines of a width; what does not fit into the last is left out, with an ellipsis."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if not lines[-1] or font.getlength(longer) <= most:
            lines[-1] = longer
        elif len(lines) < MOST_LINES:
            lines.append(word)
        else:
            lines[-1] += " ..."
            break
    return lines
