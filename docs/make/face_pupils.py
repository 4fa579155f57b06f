"""Draw docs/pictures/face-pupils.png: eyes in the dark, and in the first second of light."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Picture
from kinesic.body.choices import Variant
from kinesic.face.render.camera import STUDIO_LIGHTS, Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET
from kinesic.face.render.pupils import Pupils, compute_light_on_eyes

SIDE, LABEL = 560, 18
EYES = np.s_[105:255, 100:460]
NEAR_CAMERA = Camera(field_deg=11.0)
DIM_LIGHT, FULL_LIGHT = 0.1, 1.0  # factors on the studio light before and after it is switched on
PICTURE_TIMES = (0.0, 0.2, 0.4, 0.8)  # [s] time after the light is switched on
VARIANTS: tuple[Variant, ...] = ("female", "male")


def eyes(variant: Variant) -> list[Picture]:
    """Draw one head's eyes in the dark and in bright light."""
    pupils, found = Pupils(), []
    with Portrait(variant, preset=NORMAL_PRESET, size=(SIDE, SIDE)) as portrait:

        def look(share: float, seconds: float, text: str) -> None:
            portrait.light(STUDIO_LIGHTS.scaled(share))
            wide = pupils.follow(compute_light_on_eyes(portrait.lights, {}, NEAR_CAMERA), seconds)
            pixels = portrait.draw({}, NEAR_CAMERA, pupil=wide)[EYES]
            paper = Image.new("RGB", (pixels.shape[1], pixels.shape[0] + LABEL), (250, 250, 250))
            ImageDraw.Draw(paper).text((4, 3), f"{text}: {1e3 * wide:.1f} mm", fill=(40, 40, 40))
            paper.paste(Image.fromarray(pixels), (0, LABEL))
            found.append(np.asarray(paper))

        look(DIM_LIGHT, 0.0, f"light {DIM_LIGHT:g}")
        for before, now in zip((0.0, *PICTURE_TIMES), PICTURE_TIMES, strict=False):
            look(FULL_LIGHT, now - before, f"{now:g} s after it is {FULL_LIGHT:g}")
    return found


rows = [np.hstack(eyes(variant)) for variant in VARIANTS]
Image.fromarray(np.vstack(rows)).save(Path(__file__).parents[1] / "pictures" / "face-pupils.png", optimize=True)
