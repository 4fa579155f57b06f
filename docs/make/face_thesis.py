"""Draw docs/pictures/face-thesis.png: comparisons of the thesis's rendering chapters, each effect on and off."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from kinesic.body.arrays import Floats, Picture
from kinesic.face.render.camera import FRONT_CAMERA, Camera
from kinesic.face.render.effects import Effects, Shading
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, Focus, Occlusion, Preset

SIDE, LABEL = 194, 16
SMILE = {"6": 0.8, "12": 0.9, "25": 0.6}
NEAR_CAMERA = Camera(yaw_deg=-30.0, field_deg=12.0)
SIDE_CAMERA = Camera(yaw_deg=-40.0, field_deg=17.0)
ERROR_GAIN = 4.0  # factor by which occlusion errors are amplified in a tile
DIFFERENCE_GAIN = 8.0  # factor by which differences of two pictures are amplified in a tile
FULL_RESOLUTION = replace(NORMAL_PRESET, coarse=1)
Tile = tuple[str, Picture]
Corner = tuple[int, int]  # row and column, of a part of a picture
EYE, MOUTH, BROW = (48, 70), (150, 120), (70, 97)


def grey(shares: Floats) -> Picture:
    """Convert values 0..1 to a picture."""
    found = np.rint(255 * np.clip(shares, 0.0, 1.0)).astype(np.uint8)
    return np.repeat(found[..., None], 3, axis=2)


def openness(occlusion: Occlusion, *, blurred: bool = True) -> Floats:
    """Return the unoccluded fraction (n, n) of each pixel, optionally before the blur."""
    with Portrait(preset=replace(FULL_RESOLUTION, occlusion=occlusion, hair=False), size=(SIDE, SIDE)) as portrait:
        portrait.draw(SMILE, NEAR_CAMERA)
        found = portrait.pipeline.occlusion
        if found is None:
            raise ValueError("drawn without occlusion")
        passes = [found.march, *found.blurs]
        with portrait.pipeline.geometry.context:
            return passes[-1 if blurred else 0].target.read()[..., 0]


def zoomed(pixels: Picture, corner: Corner) -> Picture:
    """Crop a quarter of a picture and double its width and height."""
    row, column = corner
    return pixels[row : row + SIDE // 2, column : column + SIDE // 2].repeat(2, axis=0).repeat(2, axis=1)


def seen(preset: Preset, effects: Effects, camera: Camera = SIDE_CAMERA) -> Picture:
    """Draw a smiling face with some rendering effects."""
    with Portrait(preset=effects.apply_to(preset), size=(SIDE, SIDE)) as portrait:
        return portrait.draw(SMILE, camera)


def seen_close(preset: Preset, effects: Effects, camera: Camera, corner: Corner) -> Picture:
    """Draw a smiling face at double size and crop a quarter."""
    with Portrait(preset=effects.apply_to(preset), size=(2 * SIDE, 2 * SIDE)) as portrait:
        return close(portrait.draw(SMILE, camera), corner)


def close(pixels: Picture, corner: Corner) -> Picture:
    """Crop a region of one tile from a picture."""
    row, column = corner
    return pixels[row : row + SIDE, column : column + SIDE]


def apart(one: Picture, other: Picture, times: float) -> Picture:
    """Return the difference of two pictures, black for equal pixels."""
    return grey(times * np.abs(one.astype(float) - other.astype(float)).max(axis=2) / 255.0)


def axes() -> list[Tile]:
    """Draw thesis Figure 3.9: occlusion along one and two axes.

    The tiles show one axis, one axis with twice the samples, two axes and the exact result, then the three errors.
    """
    two = Occlusion(size=21)
    settings = (replace(two, axes=1), replace(two, axes=1, size=41), two, replace(two, exact=True))
    found = [openness(each) for each in settings]
    names = ("one axis: 20 samples", "one axis: 40 samples", "two axes: 40 samples", "exact: 420 samples")
    errors = [grey(ERROR_GAIN * np.abs(each - found[-1])) for each in found[:-1]]
    heads = (f"error x {ERROR_GAIN:g}: 20", f"error x {ERROR_GAIN:g}: 40, one", f"error x {ERROR_GAIN:g}: 40, two")
    return [*zip(names, map(grey, found), strict=True), *zip(heads, errors, strict=True)]


def patterns() -> list[Tile]:
    """Draw thesis Figure 3.7: sample patterns and noise, before and after blur.

    Further tiles show the pattern sizes of listing 11.1 and the Gaussian falloff of section 3.3.
    """
    usual = Occlusion(size=21)
    noise = replace(usual, pattern="noise")
    kinds: Sequence[tuple[str, Occlusion, bool]] = (
        ("pattern 4 x 4, not blurred", usual, False),
        ("pattern 4 x 4", usual, True),
        ("noise, not blurred", noise, False),
        ("noise", noise, True),
        ("pattern 2 x 2", replace(usual, tile=2), True),
        ("pattern 8 x 8", replace(usual, tile=8), True),
        ("Gaussian falloff", replace(usual, falloff="gaussian"), True),
    )
    return [(name, zoomed(grey(openness(each, blurred=blurred)), EYE)) for name, each, blurred in kinds]


def levels() -> list[Tile]:
    """Draw thesis Figures 5.2 and 5.3: subsurface scattering by level.

    The tiles show no, uniform and graded scattering, then the levels and the differences.
    """
    asked = (Effects(scattering="none"), Effects(scattering="everywhere"), Effects(scattering="levels"))
    preset = (
        replace(FULL_RESOLUTION, scattering=replace(FULL_RESOLUTION.scattering, steps=5))
        if FULL_RESOLUTION.scattering
        else FULL_RESOLUTION
    )
    none, everywhere, in_levels = (seen_close(preset, each, NEAR_CAMERA, MOUTH) for each in asked)
    with Portrait(preset=asked[2].apply_to(preset), size=(2 * SIDE, 2 * SIDE)) as portrait:
        portrait.draw(SMILE, NEAR_CAMERA)
        scatter = portrait.pipeline.scatter
        if scatter is None:
            raise ValueError("drawn without scattering")
        with portrait.pipeline.geometry.context:
            chosen = close(grey(scatter.levels() / 255.0), MOUTH)
    return [
        ("no scattering", none),
        ("everywhere", everywhere),
        ("in 3 levels", in_levels),
        ("the levels: white all", chosen),
        (f"everywhere - none x {DIFFERENCE_GAIN:g}", apart(everywhere, none, DIFFERENCE_GAIN)),
        (f"levels - none x {DIFFERENCE_GAIN:g}", apart(in_levels, none, DIFFERENCE_GAIN)),
        (f"everywhere - levels x {DIFFERENCE_GAIN:g}", apart(everywhere, in_levels, DIFFERENCE_GAIN)),
    ]


def planes() -> list[Tile]:
    """Draw depth of field and shadows (thesis section 12.1)."""

    def at(plane: float | None, within: float = 0.0) -> Preset:
        return replace(NORMAL_PRESET, focus=Focus(circle=0.12, plane=plane, within=within))

    def shaded(shadow: Shading) -> Picture:
        return seen_close(NORMAL_PRESET, Effects(shadow=shadow, eyeshade=True), FRONT_CAMERA, BROW)

    return [
        ("all sharp", seen(NORMAL_PRESET, Effects())),
        ("sharp at the nearer eye", seen(at(None), Effects())),
        ("sharp at 0.88 m", seen(at(0.88), Effects())),
        ("sharp from 0.75 to 0.8 m", seen(at(0.775, 0.025), Effects())),
        ("no shadow", shaded("none")),
        ("plain shadow", shaded("plain")),
        ("coloured shadow", shaded("coloured")),
    ]


def row(tiles: Sequence[Tile]) -> Picture:
    """Arrange pictures side by side, each below its name."""
    paper = Image.new("RGB", (SIDE * len(tiles), SIDE + LABEL), (250, 250, 250))
    pen = ImageDraw.Draw(paper)
    for k, (name, pixels) in enumerate(tiles):
        pen.text((k * SIDE + 4, 2), name, fill=(40, 40, 40))
        paper.paste(Image.fromarray(pixels), (k * SIDE, LABEL))
    return np.asarray(paper)


sheet = Image.fromarray(np.concatenate([row(make()) for make in (axes, patterns, levels, planes)]))
picture = Path(__file__).parents[1] / "pictures" / "face-thesis.png"
sheet.quantize(192, dither=Image.Dither.NONE).save(picture, optimize=True)
