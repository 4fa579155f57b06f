"""How bright what is seen between the lips is, in pictures of both heads."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from kinesic.face.assets.mesh import PARTS
from kinesic.face.render.camera import CLOSE
from kinesic.face.render.portrait import Portrait

BRIGHTNESS = np.array([0.299, 0.587, 0.114])
ROUNDED = {"22": 0.8, "25": 0.7, "26": 0.3}


@pytest.fixture(scope="module")
def close(drawable: None) -> Iterator[Portrait]:
    """The male head from nearby."""
    with Portrait("male", size=(192, 192)) as opened:
        yield opened


def brightness(portrait: Portrait, units: dict[str, float], yaw_deg: float = 0.0) -> np.ndarray:
    """(height, width) 0..255, first row on top."""
    return np.asarray(portrait.draw(units, replace(CLOSE, yaw_deg=yaw_deg)) @ BRIGHTNESS)


@pytest.mark.parametrize("units", [ROUNDED, {"27": 0.8}], ids=["rounded", "wide open"])
def test_upper_teeth_are_about_as_bright_as_the_lower_ones(close: Portrait, units: dict[str, float]):
    """Their mesh turns over at the cutting edge, where they must not look as if they faced the floor."""
    bright = brightness(close, units)
    teeth = close.pipeline.geometry.parts() == PARTS.index("teeth") + 1
    rows = np.nonzero(teeth)[0]
    upper = np.arange(len(bright))[:, None] < 0.5 * (rows.min() + rows.max())
    assert 0.75 < np.median(bright[teeth & upper]) / np.median(bright[teeth & ~upper]) < 1.15


def test_the_inside_of_a_cheek_is_darker_than_teeth(close: Portrait):
    """No lamp is mirrored in it, which would set teeth off from the lip."""
    bright = brightness(close, {"6": 0.8, "12": 0.9, "25": 0.8, "26": 0.5}, yaw_deg=45.0)
    geometry = close.pipeline.geometry
    parts, front = geometry.parts(), geometry.target.read(1)[..., 2]
    inside = (parts == PARTS.index("skin") + 1) & (front < 0.0)
    assert inside.sum() > 20
    assert np.percentile(bright[inside], 95) < 0.85 * np.median(bright[parts == PARTS.index("teeth") + 1])


def test_a_mouth_darkens_with_its_depth(close: Portrait):
    bright = brightness(close, {"27": 0.8}, yaw_deg=40.0)
    geometry = close.pipeline.geometry
    depth = -geometry.target.read(1)[..., 2]
    inside = (geometry.parts() == PARTS.index("skin") + 1) & (depth > 0.0)
    quarters = [np.median(each) for each in np.array_split(bright[inside][np.argsort(depth[inside])], 4)]
    assert np.all(np.diff(quarters) < 0.0)
    assert quarters[-1] < 0.4 * quarters[0]


def test_no_lamp_behind_the_head_shines_on_the_inside_of_a_cheek(close: Portrait):
    """It was a bright strip inside the far corner of the lips."""
    bright = brightness(close, {"6": 0.8, "12": 1.0, "25": 0.6}, yaw_deg=60.0)
    geometry = close.pipeline.geometry
    a, y, front = np.moveaxis(geometry.target.read(1)[..., :3], -1, 0)
    mouth = (geometry.parts() == PARTS.index("skin") + 1) & (np.abs(a) < 0.8) & (y < -0.85) & (y > -1.4)
    lip = mouth & (front > 0.99) & (np.abs(y + 1.15) < 0.12) & (np.abs(a) < 0.35)
    assert bright[mouth & (front < 0.0)].max() < 0.87 * np.median(bright[lip])


@pytest.mark.parametrize("jaw", ["26", "27"])
def test_a_mouth_wide_open_shows_the_upper_teeth(close: Portrait, jaw: str):
    close.draw({jaw: 1.0, "25": 1.0}, CLOSE)
    teeth = close.pipeline.geometry.parts() == PARTS.index("teeth") + 1
    rows = np.nonzero(teeth)[0]
    upper = np.arange(len(teeth))[:, None] < 0.5 * (rows.min() + rows.max())
    assert (teeth & upper).sum() > 130
