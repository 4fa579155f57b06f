"""Contact sheet of all action units.

Each unit is shown weak and strong, with and without wrinkles (thesis Figures 4.4 to 4.6).
"""

from collections.abc import Callable, Sequence

import numpy as np

from kinesic.body.action_units import ACTION_UNITS
from kinesic.body.arrays import Picture
from kinesic.face.render.camera import CLOSE_CAMERA, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.files.late_pillow import Image, ImageDraw

LOW_INTENSITY = 0.4  # intensity in the pictures of weak action units
HIGH_INTENSITY = 1.0  # intensity in the pictures of strong action units
PICTURE_KINDS = (
    (LOW_INTENSITY, 0.0),
    (LOW_INTENSITY, 1.0),
    (HIGH_INTENSITY, 0.0),
    (HIGH_INTENSITY, 1.0),
)  # intensity and wrinkle gain of each picture
UNITS_PER_ROW = 3  # action units per row of the sheet
LABEL_HEIGHT = 16  # [pixels] height of the label above each picture
UNIT_GAP = 6  # [pixels] gap between the pictures of two action units
PAPER_COLOUR = (250, 250, 250)  # RGB colour of the background
TEXT_COLOUR = (40, 40, 40)  # RGB colour of the labels
SHEET_HEADING = (
    f"of each: {LOW_INTENSITY:g} plain, {LOW_INTENSITY:g} with wrinkles, "
    f"{HIGH_INTENSITY:g} plain, {HIGH_INTENSITY:g} with wrinkles"
)


def draw_units_sheet(
    portrait: Portrait,
    camera: Camera = CLOSE_CAMERA,
    *,
    units: Sequence[int] = tuple(ACTION_UNITS),
    progress: Callable[[float], None] = lambda fraction: None,
) -> Picture:
    """Draw four labelled pictures of each action unit in one picture.

    Args:
        portrait: portrait that draws each picture at its size.
        camera: camera of all pictures.
        units: action units to draw.
        progress: called before each unit with the fraction drawn.
    """
    width, height = portrait.size
    rows = -(-len(units) // UNITS_PER_ROW)
    wide, tall = len(PICTURE_KINDS) * width + UNIT_GAP, height + LABEL_HEIGHT
    paper = Image.new("RGB", (UNITS_PER_ROW * wide - UNIT_GAP, rows * tall + LABEL_HEIGHT), PAPER_COLOUR)
    pen = ImageDraw.Draw(paper)
    pen.text((2, 2), SHEET_HEADING, fill=TEXT_COLOUR)
    for place, number in enumerate(units):
        progress(place / len(units))
        left, top = place % UNITS_PER_ROW * wide, place // UNITS_PER_ROW * tall + LABEL_HEIGHT
        pen.text((left + 2, top + 2), f"{number} {ACTION_UNITS[number].name}", fill=TEXT_COLOUR)
        for column, (intensity, gain) in enumerate(PICTURE_KINDS):
            pixels = portrait.draw({str(number): intensity}, camera, gain=gain)
            paper.paste(Image.fromarray(pixels), (left + column * width, top + LABEL_HEIGHT))
    return np.asarray(paper)
