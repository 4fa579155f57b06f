"""A contact sheet: every action unit low and high, with and without wrinkles (thesis Figures 4.4 to 4.6)."""

from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.action_units import UNITS
from kinesic.body.arrays import Picture
from kinesic.face.render.camera import CLOSE, Camera
from kinesic.face.render.portrait import Portrait

LOW, HIGH = 0.4, 1.0
KINDS = ((LOW, 0.0), (LOW, 1.0), (HIGH, 0.0), (HIGH, 1.0))  # intensity and gain of the wrinkles of each picture
ACROSS = 3  # action units in a row
LABEL = 16  # [pixels] above each
GAP = 6  # [pixels] between units
PAPER, INK = (250, 250, 250), (40, 40, 40)
HEADINGS = f"of each: {LOW:g} plain, {LOW:g} with wrinkles, {HIGH:g} plain, {HIGH:g} with wrinkles"


def draw_units_sheet(
    portrait: Portrait,
    camera: Camera = CLOSE,
    *,
    units: Sequence[int] = tuple(UNITS),
    progress: Callable[[float], None] = lambda share: None,
) -> Picture:
    """Draws four pictures of each action unit under its number and name, in one picture.

    Args:
        portrait: that draws them, each at its size.
        camera: where all are seen from.
        units: which of them.
        progress: gets the share of them that is drawn, before each.
    """
    width, height = portrait.size
    rows = -(-len(units) // ACROSS)
    wide, tall = len(KINDS) * width + GAP, height + LABEL
    paper = Image.new("RGB", (ACROSS * wide - GAP, rows * tall + LABEL), PAPER)
    pen = ImageDraw.Draw(paper)
    pen.text((2, 2), HEADINGS, fill=INK)
    for place, number in enumerate(units):
        progress(place / len(units))
        left, top = place % ACROSS * wide, place // ACROSS * tall + LABEL
        pen.text((left + 2, top + 2), f"{number} {UNITS[number].name}", fill=INK)
        for column, (intensity, gain) in enumerate(KINDS):
            pixels = portrait.draw({str(number): intensity}, camera, gain=gain)
            paper.paste(Image.fromarray(pixels), (left + column * width, top + LABEL))
    return np.asarray(paper)
