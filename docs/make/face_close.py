"""Draw face.png and face-close.png in docs/pictures: a smile and raised brows, and thirty stills of both heads."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.cli.face import read_emotion
from kinesic.expressivity.face.visemes import viseme_of
from kinesic.face.render.camera import CLOSE_CAMERA, FRONT_CAMERA, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET

TILE_SIDE, LABEL_HEIGHT = 170, 16  # [pixels] side of a still, and height of its label
COLUMNS = 8  # number of stills in a row
LARGE_SIDE = 512  # [pixels] width and height of the two pictures in face.png
EMOTIONS = ("joy", "laugh", "surprise", "fear", "disgust")
EXPRESSIONS: Mapping[str, Mapping[str, float]] = {
    "rest": {},
    **{name: read_emotion(name, 1.0) for name in EMOTIONS},
    **{f"AU {number}": {number: 1.0} for number in ("6", "9", "15", "17", "20")},
    "AU 27 + 25": {"27": 1.0, "25": 1.0},
    "m": viseme_of("m").units,
    "f": viseme_of("f").units,
}
SIDE_LABEL = "-90 degrees"
DOCS = Path(__file__).parents[1]


def labelled(pixels: Picture, text: str) -> Picture:
    """Draw a picture with its name above it."""
    paper = Image.new("RGB", (TILE_SIDE, TILE_SIDE + LABEL_HEIGHT), (250, 250, 250))
    ImageDraw.Draw(paper).text((4, 2), text, fill=(40, 40, 40))
    paper.paste(Image.fromarray(pixels), (0, LABEL_HEIGHT))
    return np.asarray(paper)


def stills(variant: Variant) -> list[Picture]:
    """Draw one head in every expression, and from the side."""
    with Portrait(variant, preset=replace(NORMAL_PRESET, samples=2), size=(TILE_SIDE, TILE_SIDE)) as portrait:
        faces = [labelled(portrait.draw(units, CLOSE_CAMERA), name) for name, units in EXPRESSIONS.items()]
        return [*faces, labelled(portrait.draw({}, replace(FRONT_CAMERA, yaw_deg=-90.0)), SIDE_LABEL)]


def one(variant: Variant, units: Mapping[str, float], camera: Camera) -> Picture:
    """Draw one large picture of a head."""
    with Portrait(variant, preset=replace(NORMAL_PRESET, samples=2), size=(LARGE_SIDE, LARGE_SIDE)) as portrait:
        return portrait.draw(units, camera)


def sheet(heads: list[list[Picture]]) -> Picture:
    """Arrange stills in rows, one head below the other."""
    blank = np.full_like(heads[0][0], 250)
    rows = []
    for first in range(0, len(heads[0]), COLUMNS):
        for head in heads:
            row = head[first : first + COLUMNS]
            rows.append(np.concatenate([*row, *[blank] * (COLUMNS - len(row))], axis=1))
    return np.concatenate(rows)


smile = one("female", {"6": 0.8, "12": 0.9, "25": 0.6}, FRONT_CAMERA)
brows = one("male", {"1": 1.0, "2": 1.0, "26": 0.4}, replace(FRONT_CAMERA, yaw_deg=45.0))
Image.fromarray(np.concatenate([smile, brows], axis=1)).save(DOCS / "pictures" / "face.png", optimize=True)
both = sheet([stills(variant) for variant in get_args(Variant)])
Image.fromarray(both).save(DOCS / "pictures" / "face-close.png", optimize=True)
