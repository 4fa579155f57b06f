"""Draw docs/pictures/face-lips.png: the mouths of both heads at eight kinds of sounds."""

from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.expressivity.face.visemes import viseme_of
from kinesic.face.render.camera import CLOSE_CAMERA
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET

SOUNDS = {"m": "m", "f": "f", "th": "θ", "w": "w", "sh": "ʃ", "see": "i", "palm": "ɑ", "you": "u"}  # noqa: RUF001
SIDE, LABEL = 560, 16
MOUTH = (slice(330, 458), slice(195, 365))  # [pixels] rows and columns of the mouth in a picture


def mouth(portrait: Portrait, word: str) -> Picture:
    """Draw the mouth at a sound, with an example word above."""
    pixels = portrait.draw(viseme_of(SOUNDS[word]).units, CLOSE_CAMERA)[MOUTH]
    paper = Image.new("RGB", (pixels.shape[1], pixels.shape[0] + LABEL), (250, 250, 250))
    ImageDraw.Draw(paper).text((4, 2), word, fill=(40, 40, 40))
    paper.paste(Image.fromarray(pixels), (0, LABEL))
    return np.asarray(paper)


def row(variant: Variant) -> Picture:
    """Draw one head's mouth at all sounds."""
    with Portrait(variant, preset=replace(NORMAL_PRESET, samples=2), size=(SIDE, SIDE)) as portrait:
        return np.concatenate([mouth(portrait, word) for word in SOUNDS], axis=1)


sheet = Image.fromarray(np.concatenate([row(variant) for variant in get_args(Variant)]))
sheet.save(Path(__file__).parents[1] / "pictures" / "face-lips.png", optimize=True)
