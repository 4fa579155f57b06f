"""Draw docs/pictures/face-light.png: the contribution of each effect, and the head from every side."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET, FULL_PRESET, NORMAL_PRESET, Preset

SIDE, LABEL = 194, 18
SMILE = {"6": 0.8, "12": 0.9, "1": 0.4}
SIDE_CAMERA = Camera(yaw_deg=-28.0, field_deg=17.0)
EFFECT_STEPS = (
    ("light alone", DRAFT_PRESET),
    ("+ wrinkles", replace(DRAFT_PRESET, wrinkles=True, smooth=True)),
    ("+ occlusion", replace(NORMAL_PRESET, shadow=None, scattering=None)),
    ("+ shadow", replace(NORMAL_PRESET, scattering=None)),
    ("+ skin: normal", NORMAL_PRESET),
    ("full", FULL_PRESET),
    ("an eyeshade", replace(FULL_PRESET, eyeshade=True)),
)
VIEWS = ((-90.0, {"4": 1.0}), (-60.0, {"27": 0.8}), (-30.0, {"20": 1.0}), (0.0, SMILE))
VIEWS += ((45.0, {"1": 1.0, "2": 1.0}), (90.0, {"10": 1.0, "4": 0.6}), (180.0, {"12": 1.0}))


def drawn(preset: Preset, units: dict[str, float], camera: Camera) -> Picture:
    """Draw a face with a rendering preset."""
    with Portrait(preset=preset, size=(SIDE, SIDE)) as portrait:
        return portrait.draw(units, camera)


def labelled(pixels: Picture, text: str) -> Picture:
    """Draw a picture with its name above it."""
    paper = Image.new("RGB", (SIDE, SIDE + LABEL), (250, 250, 250))
    ImageDraw.Draw(paper).text((4, 3), text, fill=(40, 40, 40))
    paper.paste(Image.fromarray(pixels), (0, LABEL))
    return np.asarray(paper)


effects = [labelled(drawn(preset, SMILE, SIDE_CAMERA), name) for name, preset in EFFECT_STEPS]
views = [labelled(drawn(NORMAL_PRESET, units, Camera(yaw_deg=yaw)), f"normal, {yaw:g} deg") for yaw, units in VIEWS]
sheet = Image.fromarray(np.concatenate([np.concatenate(effects, axis=1), np.concatenate(views, axis=1)]))
sheet.save(Path(__file__).parents[1] / "pictures" / "face-light.png", optimize=True)
