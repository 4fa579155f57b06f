"""Tests of details that only close pictures of a face show."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from kinesic.expressivity.face.visemes import viseme_of
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.render.camera import Camera
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import DRAFT_PRESET, NORMAL_PRESET

SIDE = 300  # [pixels] side of the pictures
LEFT_EYE = Camera(field_deg=3.0, pivot=(0.0, 0.03, 0.0))
LEFT_CHEEK = Camera(field_deg=3.0, pivot=(0.0, 0.03, -0.03))
MOUTH = Camera(field_deg=4.0, pivot=(0.012, 0.0, -0.07))


@pytest.fixture(scope="module")
def close(drawable: None) -> Iterator[Portrait]:
    with Portrait("female", preset=DRAFT_PRESET, size=(SIDE, SIDE)) as opened:
        yield opened


def find_part(portrait: Portrait, part: str) -> np.ndarray:
    """Return the mask of pixels that show a part of the head."""
    return np.asarray(portrait.pipeline.geometry.parts() == MESH_PARTS.index(part) + 1)


@pytest.fixture(scope="module")
def eye(close: Portrait) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a picture of an eye without its lashes, one with them, and the mask of the eyeball."""
    lashes = close.pipeline._lashes
    with_them = close.draw({}, LEFT_EYE).astype(float)
    drawn, lashes.draw = lashes.draw, lambda camera: None
    without = close.draw({}, LEFT_EYE).astype(float)
    lashes.draw = drawn
    return without, with_them, find_part(close, "eyes")


def test_drawn_tear_film_is_bright_along_the_lower_lid(eye: tuple[np.ndarray, np.ndarray, np.ndarray]):
    picture, _, ball = eye
    columns = np.flatnonzero(ball.any(axis=0))
    middle = slice(columns[0] + 60, columns[-1] - 60)
    lowest = ball & ~np.roll(ball, -1, axis=0)
    higher = ball & np.roll(lowest, -6, axis=0)
    bright = picture.mean(axis=2)[:, middle]
    assert bright[lowest[:, middle]].mean() > 1.2 * bright[higher[:, middle]].mean()


def test_drawn_tear_film_stays_dark_under_dim_light(close: Portrait):
    lights = close.lights
    close.light(lights.scaled(0.02))
    picture = close.draw({}, LEFT_EYE)
    close.light(lights)
    assert picture[find_part(close, "eyes")].max() < 70


def test_drawn_inner_corner_of_an_eye_is_redder_than_the_outer_corner(eye: tuple[np.ndarray, np.ndarray, np.ndarray]):
    picture, _, ball = eye
    columns = np.flatnonzero(ball.any(axis=0))
    redness = picture[..., 0] / picture[..., 1]
    at = {share: int(columns[0] + share * np.ptp(columns)) for share in (0.08, 0.9)}
    inner, outer = (redness[:, column][ball[:, column]].mean() for column in at.values())
    assert inner > 1.37
    assert outer < 1.1


def test_drawn_lashes_do_not_extend_over_20_pixels_above_the_eyeball(eye: tuple[np.ndarray, np.ndarray, np.ndarray]):
    """Prevent faint lines beyond the tips, which look like stitches."""
    without, with_them, ball = eye
    changed = np.abs(with_them - without).max(axis=2) > 6.0
    highest = np.nonzero(ball)[0].min()
    assert changed[highest - 12 : highest].sum() > 100
    assert not changed[: highest - 20].any()


def test_tongue_at_th_is_paler_than_the_lips(close: Portrait):
    picture = close.draw(dict(viseme_of("θ").units), MOUTH).astype(float)
    a, y, front = np.moveaxis(close.pipeline.geometry.target.read(1)[..., :3], -1, 0)
    lip = find_part(close, "skin") & (np.abs(a) < 0.3) & (np.abs(y + 1.185) < 0.065) & (front > 0.99)
    tongue = find_part(close, "tongue")
    assert tongue.sum() > 1500
    green, red = (np.median(picture[tongue], axis=0) / np.median(picture[lip], axis=0))[[1, 0]]
    assert green > 1.07 * red


def test_close_up_of_a_cheek_has_visible_skin_texture(drawable: None):
    with Portrait("female", preset=NORMAL_PRESET, size=(SIDE, SIDE)) as portrait:
        cheek = portrait.draw({}, LEFT_CHEEK).mean(axis=2)
    assert (cheek - gaussian_filter(cheek, 4.0)).std() > 1.4


def test_pores_vary_specular_but_not_subsurface_light(drawable: None):
    """Expect pores in reflected light only, since scattering spreads wider than pores."""
    with Portrait("female", preset=NORMAL_PRESET, size=(SIDE, SIDE)) as portrait:
        portrait.draw({}, LEFT_CHEEK)
        light = portrait.pipeline._light.target.read(1)[40:-40, 100:-20]
    entering, mirrored = (field - gaussian_filter(field, 4.0) for field in (light[..., 1], light[..., 3]))
    assert entering.std() < 0.004
    assert mirrored.std() > 0.004


def test_hair_highlight_moves_up_with_the_lamp(drawable: None):
    """Move only the lamp, not the normals of the locks."""
    with Portrait("female", preset=DRAFT_PRESET, size=(SIDE, SIDE)) as portrait:
        colours = []
        for towards in ((0.0, 1.5, 0.8), (0.0, -0.8, 0.8)):
            lights = portrait.lights
            portrait.light(replace(lights, key=replace(lights.key, towards=towards)))
            portrait.draw({}, Camera(yaw_deg=180.0))
            hair = portrait.pipeline.geometry.parts() == len(MESH_PARTS) + 1
            colours.append(np.where(hair, portrait.pipeline.geometry.target.read(1)[..., 1], np.nan))
    high, low = slice(30, 100), slice(140, 190)
    above, below = (np.nanmean(picture[high]) / np.nanmean(picture[low]) for picture in colours)
    assert above > 1.05 * below
