"""Soft shadow on the floor, on the side away from the sun."""

import numpy as np
import pytest
from PIL import Image

from kinesic.body.arrays import sealed
from kinesic.files.film_file import PixelBox
from kinesic.sim.filming.framing import find_shadow_boxes, project_points
from kinesic.sim.filming.soft_shadow import SHADOW_OPACITY, compute_shadow_outlines, shade
from kinesic.sim.scene_layout import SUN_DIRECTION, SceneView

PICTURE_SIZE = (320, 180)
SCENE_VIEW = SceneView(0.0, sealed([0.0, 0.0, 0.5]), 2.0)
BAR_HEIGHT = 0.4  # [m] above the floor


def bar_shadow() -> np.ndarray:
    """Return the shadow outlines of a bar above the floor."""
    ends = np.array([[[0.0, -0.2, BAR_HEIGHT], [0.0, 0.2, BAR_HEIGHT]]])
    return compute_shadow_outlines(sealed(ends), sealed([0.15, 0.15]), SCENE_VIEW, size=PICTURE_SIZE)


def test_drawn_floor_shadow_lies_along_the_light_direction():
    (outline,) = bar_shadow()[0]
    fallen = np.array([0.0, 0.0, BAR_HEIGHT]) + BAR_HEIGHT / -SUN_DIRECTION[2] * np.array(SUN_DIRECTION)
    assert fallen[2] == pytest.approx(0.0)
    assert outline.mean(axis=0) == pytest.approx(
        project_points(SCENE_VIEW, sealed(fallen), size=PICTURE_SIZE)[:2], abs=2.0
    )
    edges = np.diff(np.vstack([outline, outline[:1]]), axis=0)
    turns = edges[:, 0] * np.roll(edges[:, 1], -1) - edges[:, 1] * np.roll(edges[:, 0], -1)
    assert (turns <= 1e-6).all() or (turns >= -1e-6).all(), "an outline is convex"


def shade_region(box: PixelBox) -> np.ndarray:
    """Return a region of a bright picture with the shadow."""
    left, top, right, low = box
    room = Image.new("RGB", PICTURE_SIZE, (200, 200, 200))
    shade(room, box, bar_shadow()[0])
    return np.asarray(room)[top:low, left:right]


def test_shadow_darkens_the_picture_with_soft_edges():
    seen = shade_region((0, 0, 320, 180))
    x, y = bar_shadow()[0][0].mean(axis=0).astype(int)
    assert seen[y, x, 0] == pytest.approx(200 * (1 - SHADOW_OPACITY), abs=12)
    assert len(np.unique(seen)) > 10, "its edge is no step"
    assert (seen[:20] == 200).all()


def test_shadow_does_not_darken_pixels_outside_its_box():
    seen = shade_region((0, 0, 320, 180)).copy()
    ((left, top, right, low),) = find_shadow_boxes(bar_shadow(), size=PICTURE_SIZE)
    assert (right - left) * (low - top) < 0.5 * 320 * 180
    seen[top:low, left:right] = 200
    assert (np.abs(seen.astype(int) - 200) <= 1).all()


def test_floor_shadow_of_a_picture_region_equals_that_of_the_whole_picture():
    whole, part = shade_region((0, 0, 320, 180)), shade_region((40, 60, 200, 170))
    assert np.abs(part.astype(int) - whole[60:170, 40:200]).max() <= 1
