"""Tests of brightness inside the mouth in pictures of both heads."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.choices import Variant
from kinesic.cli.face import read_emotion
from kinesic.expressivity.face.visemes import viseme_of
from kinesic.face.assets.mesh import FACE_VARIANTS, MESH_PARTS
from kinesic.face.render.camera import CLOSE_CAMERA, STUDIO_LIGHTS
from kinesic.face.render.portrait import Portrait
from kinesic.face.render.presets import NORMAL_PRESET, Occlusion

BRIGHTNESS_WEIGHTS = np.array([0.299, 0.587, 0.114])
MOUTH_ROWS, MIDDLE_COLUMNS = slice(290, 430), slice(246, 266)  # of a picture of 512 x 512 pixels
SEAM_SEARCH = slice(40, 100)  # rows of the mouth in which the lips meet
ROUNDED_UNITS = {"22": 0.8, "25": 0.7, "26": 0.3}


@pytest.fixture(scope="module")
def close(drawable: None) -> Iterator[Portrait]:
    """Portrait of the male head from a short distance."""
    with Portrait("male", size=(192, 192)) as opened:
        yield opened


def brightness(portrait: Portrait, units: dict[str, float], yaw_deg: float = 0.0) -> np.ndarray:
    """Return the (height, width) brightness 0..255, top row first."""
    return np.asarray(portrait.draw(units, replace(CLOSE_CAMERA, yaw_deg=yaw_deg)) @ BRIGHTNESS_WEIGHTS)


@pytest.mark.parametrize("units", [ROUNDED_UNITS, {"27": 0.8}], ids=["rounded", "wide open"])
def test_drawn_upper_and_lower_teeth_are_about_equally_bright(close: Portrait, units: dict[str, float]):
    """Expect no dark cutting edge, where the mesh normals turn over."""
    bright = brightness(close, units)
    teeth = close.pipeline.geometry.parts() == MESH_PARTS.index("teeth") + 1
    rows = np.nonzero(teeth)[0]
    upper = np.arange(len(bright))[:, None] < 0.5 * (rows.min() + rows.max())
    assert 0.75 < np.median(bright[teeth & upper]) / np.median(bright[teeth & ~upper]) < 1.15


def test_drawn_inside_of_cheeks_is_darker_than_teeth(close: Portrait):
    """Prevent specular reflection on cheeks, so that teeth stand out."""
    bright = brightness(close, {"6": 0.8, "12": 0.9, "25": 0.8, "26": 0.5}, yaw_deg=45.0)
    geometry = close.pipeline.geometry
    parts, front = geometry.parts(), geometry.target.read(1)[..., 2]
    inside = (parts == MESH_PARTS.index("skin") + 1) & (front < 0.0)
    assert inside.sum() > 20
    assert np.percentile(bright[inside], 95) < 0.85 * np.median(bright[parts == MESH_PARTS.index("teeth") + 1])


def test_drawn_inside_of_the_mouth_darkens_with_depth(close: Portrait):
    bright = brightness(close, {"27": 0.8}, yaw_deg=40.0)
    geometry = close.pipeline.geometry
    depth = -geometry.target.read(1)[..., 2]
    inside = (geometry.parts() == MESH_PARTS.index("skin") + 1) & (depth > 0.0)
    quarters = [np.median(item) for item in np.array_split(bright[inside][np.argsort(depth[inside])], 4)]
    assert np.all(np.diff(quarters) < 0.0)
    assert quarters[-1] < 0.45 * quarters[0]


def test_rim_light_does_not_reach_the_inside_of_cheeks(close: Portrait):
    """Prevent a bright strip of rim light inside the lips."""
    bright = brightness(close, {"6": 0.8, "12": 1.0, "25": 0.6}, yaw_deg=60.0)
    geometry = close.pipeline.geometry
    a, y, front = np.moveaxis(geometry.target.read(1)[..., :3], -1, 0)
    mouth = (geometry.parts() == MESH_PARTS.index("skin") + 1) & (np.abs(a) < 0.8) & (y < -0.85) & (y > -1.4)
    lip = mouth & (front > 0.99) & (np.abs(y + 1.15) < 0.12) & (np.abs(a) < 0.35)
    within = bright[mouth & (front < 0.0)]  # a pixel or two at the edge of the lips is blended with them
    assert len(within) > 8
    assert np.percentile(within, 75) < 0.78 * np.median(bright[lip])


@pytest.mark.parametrize("jaw", ["26", "27"])
def test_wide_open_mouth_shows_the_upper_teeth(close: Portrait, jaw: str):
    close.draw({jaw: 1.0, "25": 1.0}, CLOSE_CAMERA)
    teeth = close.pipeline.geometry.parts() == MESH_PARTS.index("teeth") + 1
    rows = np.nonzero(teeth)[0]
    upper = np.arange(len(teeth))[:, None] < 0.5 * (rows.min() + rows.max())
    assert (teeth & upper).sum() > 130


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_closed_lips_show_only_a_thin_dark_line(drawable: None, variant: Variant):
    with Portrait(variant, size=(512, 512)) as portrait:
        for units in ({}, read_emotion("anger", 1.0), viseme_of("m").units):
            column = np.median(brightness(portrait, dict(units))[MOUTH_ROWS, MIDDLE_COLUMNS], axis=1)
            seam = int(column[SEAM_SEARCH].argmin()) + SEAM_SEARCH.start
            lower_lip = column[seam + 5 : seam + 25].max()
            around = column[seam - 20 : seam + 20]
            assert np.sum(around < 0.5 * lower_lip) <= 9
            assert np.sum(around < 0.35 * lower_lip) <= 4
            assert column[seam] > 0.2 * lower_lip


def test_ambient_occlusion_hardly_changes_direct_light(drawable: None):
    lamps_alone = replace(STUDIO_LIGHTS, sky=(0.0, 0.0, 0.0), ground=(0.0, 0.0, 0.0))
    without = replace(NORMAL_PRESET, occlusion=None, scattering=None)
    strong = replace(without, occlusion=Occlusion(strength=3.0))
    pictures = []
    for preset in (without, strong):
        with Portrait("male", size=(192, 192), preset=preset, lights=lamps_alone) as portrait:
            pictures.append(brightness(portrait, {})[90:150, 60:132])
    assert np.abs(pictures[1] - pictures[0]).mean() < 1.0  # gloss alone is occluded


def test_drawn_teeth_darken_towards_the_corners_of_the_mouth(close: Portrait):
    """Prevent teeth that look like one white bar."""
    picture = brightness(close, dict(read_emotion("laugh", 1.0)))
    with close.pipeline.geometry.context:
        teeth = close.pipeline.geometry.parts() == MESH_PARTS.index("teeth") + 1
    columns = np.nonzero(teeth)[1]
    middle = 0.5 * (columns.min() + columns.max())
    aside = np.abs(np.arange(picture.shape[1])[None, :] - middle) / (0.5 * np.ptp(columns))
    front, outer = (
        np.median(picture[teeth & (aside > low) & (aside < high)]) for low, high in ((0.0, 0.3), (0.75, 1.0))
    )
    assert outer < 0.8 * front
