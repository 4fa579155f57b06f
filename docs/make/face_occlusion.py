"""Draw docs/pictures/face-occlusion.png: exact and separable occlusion of each estimator, as thesis Figure 3.10."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import maximum_filter

from kinesic.bench.face.occlusion import colour_difference, read_openness, to_grey
from kinesic.body.arrays import Flags, Picture
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, Estimator, Occlusion

SIDE, LABEL = 256, 16  # [pixels] side of a tile, and height of its label
SMILE = {"6": 0.8, "12": 0.9, "25": 0.6}  # action units -> intensity
SIDE_CAMERA = Camera(yaw_deg=-40.0, field_deg=17.0)
BLACK_DIFFERENCE = 10.0  # [dE] colour difference that is drawn black
ESTIMATORS: dict[Estimator, str] = {
    "depth": "plain depth test",
    "crytek": "above tangent plane",
    "obscurance": "vol. obscurance",
    "horizon": "horizon",
    "angular": "angular",
}


def draw(estimator: Estimator, *, exact: bool) -> tuple[Picture, Picture, Flags]:
    """Return the occlusion buffer, the picture and the head mask."""
    occlusion = Occlusion(size=21, estimator=estimator, exact=exact)
    preset = replace(NORMAL_PRESET, occlusion=occlusion, hair=False, coarse=1)
    with Portrait(preset=preset, size=(SIDE, SIDE)) as portrait:
        picture = portrait.draw(SMILE, SIDE_CAMERA)
        with portrait.pipeline.geometry.context:
            head = portrait.pipeline.geometry.parts() > 0
        return to_grey(read_openness(portrait)), picture, maximum_filter(head, 3)


def difference(exact: Picture, separable: Picture, head: Flags) -> tuple[str, Picture]:
    """Return label and picture of a colour difference, white for zero."""
    found = np.where(head, colour_difference(exact, separable), 0.0)
    return f"mean {found[head].mean():.2f} dE, p95 {np.percentile(found[head], 95):.1f}", to_grey(
        1.0 - found / BLACK_DIFFERENCE
    )


def column(estimator: Estimator) -> Image.Image:
    """Draw buffers, pictures and their differences for one estimator."""
    (buffer, picture, head), (cheap, cheap_picture, _) = (draw(estimator, exact=exact) for exact in (True, False))
    name = ESTIMATORS[estimator]
    tiles = [
        (f"{name}: exact", buffer),
        ("separable", cheap),
        difference(buffer, cheap, head),
        ("picture, separable", cheap_picture),
        difference(picture, cheap_picture, head),
    ]
    paper = Image.new("RGB", (SIDE, len(tiles) * (SIDE + LABEL)), (250, 250, 250))
    pen = ImageDraw.Draw(paper)
    for k, (label, pixels) in enumerate(tiles):
        pen.text((4, k * (SIDE + LABEL) + 2), label, fill=(40, 40, 40))
        paper.paste(Image.fromarray(pixels), (0, k * (SIDE + LABEL) + LABEL))
    return paper


columns = [np.asarray(column(estimator)) for estimator in ESTIMATORS]
sheet = Image.fromarray(np.concatenate(columns, axis=1))
path = Path(__file__).parents[1] / "pictures" / "face-occlusion.png"
sheet.quantize(240, dither=Image.Dither.NONE).save(path, optimize=True)
