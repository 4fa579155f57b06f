"""Picture of the robot at the strokes of a planned document."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.report.silhouette import Colour, OutlineWindow, PenStroke, outline_lines, silhouette

FIGURE_HEIGHT = 300  # [pixels] height of a robot figure
LINE_HEIGHT = 20  # [pixels] height of a line of text below a robot figure
FIGURE_COLUMNS = 4  # largest number of robot figures in a row
SUPERSAMPLING_FACTOR = 3  # drawn pixels per picture pixel along each side
MIN_FIGURE_WIDTH = 170  # [pixels] smallest width of a robot figure, so that its text fits
PICTURE_COLOURS = 64  # number of colours of the PNG, low for a small file
TEXT_COLOUR = (34, 34, 34)  # RGB colour of the title below each robot figure
NOTE_COLOUR = (110, 110, 110)  # RGB colour of the note below each title


@dataclass(frozen=True, eq=False)
class StrokeFigure:
    """Posture at a stroke, with two lines of text."""

    angles: Floats  # (n,) [rad] joint angles of the posture
    title: str
    note: str = ""


def draw_strokes(robot: Robot, figures: Sequence[StrokeFigure]) -> bytes:
    """Draw postures from the front, in rows, and return a PNG.

    Args:
        robot: robot to draw.
        figures: at least one posture.
    """
    drawings = [outline_lines(silhouette(robot, figure.angles, {})) for figure in figures]
    window = OutlineWindow.around(line for lines in drawings for line in lines)
    scale = FIGURE_HEIGHT / window.tall  # [pixels/m]
    width = max(MIN_FIGURE_WIDTH, round(window.wide * scale))
    height = FIGURE_HEIGHT + 2 * LINE_HEIGHT
    columns = min(FIGURE_COLUMNS, len(figures))
    rows = -(-len(figures) // columns)
    picture = Image.new("RGB", (columns * width, rows * height), "white")
    for k, (figure, lines) in enumerate(zip(figures, drawings, strict=True)):
        row, column = divmod(k, columns)
        corner = (column * width, row * height)
        picture.paste(_draw_body(lines, window, scale, width), corner)
        _write(picture, figure, corner, width)
    file = BytesIO()
    picture.quantize(PICTURE_COLOURS).save(file, "PNG", optimize=True)
    return file.getvalue()


def _draw_body(lines: Sequence[PenStroke], window: OutlineWindow, scale: float, width: int) -> Image.Image:
    """Draw the lines of one robot figure as a picture."""
    size = (width * SUPERSAMPLING_FACTOR, FIGURE_HEIGHT * SUPERSAMPLING_FACTOR)
    fine = Image.new("RGB", size, "white")
    pen = ImageDraw.Draw(fine)
    zoom = scale * SUPERSAMPLING_FACTOR  # [pixels/m]
    for line in lines:
        points = np.stack(
            [size[0] / 2 + zoom * line.points[:, 0], size[1] - zoom * (line.points[:, 1] - window.low)], axis=1
        )
        radius, colour = max(1.0, zoom * line.width / 2), _to_rgb(line.colour)
        pen.line([(float(x), float(y)) for x, y in points], colour, width=round(2 * radius))
        for x, y in points:
            pen.ellipse((x - radius, y - radius, x + radius, y + radius), colour)
    return fine.resize((width, FIGURE_HEIGHT), Image.Resampling.LANCZOS)


def _write(picture: Image.Image, figure: StrokeFigure, corner: tuple[int, int], width: int) -> None:
    """Write title and note below one robot figure."""
    pen = ImageDraw.Draw(picture)
    for k, (text, colour, size) in enumerate(((figure.title, TEXT_COLOUR, 15), (figure.note, NOTE_COLOUR, 13))):
        font = ImageFont.load_default(size)
        place = (corner[0] + width / 2, corner[1] + FIGURE_HEIGHT + (k + 0.5) * LINE_HEIGHT)
        pen.text(place, _fitting(text, font, width), colour, font=font, anchor="mm")


def _fitting(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, width: int) -> str:
    """Shorten a text to the width of a figure [pixels]."""
    if font.getlength(text) <= width:
        return text
    while text and font.getlength(f"{text}...") > width:
        text = text[:-1]
    return f"{text.rstrip()}..."


def _to_rgb(colour: Colour) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in colour)
    return red, green, blue
