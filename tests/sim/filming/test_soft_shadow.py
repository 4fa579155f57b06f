"""A soft shadow falls on the floor, away from the sun, and on nothing else."""

import numpy as np
import pytest
from PIL import Image

from kinesic.body.arrays import sealed
from kinesic.files.film_file import PixelBox
from kinesic.sim.filming.framing import seen_at, shadow_boxes
from kinesic.sim.filming.soft_shadow import DARK, shade, shadow_outlines
from kinesic.sim.scene_layout import SUN, SceneView

SIZE = (320, 180)
VIEW = SceneView(0.0, sealed([0.0, 0.0, 0.5]), 2.0)
HIGH = 0.4  # [m]


def outlines() -> np.ndarray:
    """The shadow of a bar that hangs over the floor."""
    ends = np.array([[[0.0, -0.2, HIGH], [0.0, 0.2, HIGH]]])
    return shadow_outlines(sealed(ends), sealed([0.15, 0.15]), VIEW, size=SIZE)


def test_it_lies_where_the_light_goes():
    (outline,) = outlines()[0]
    fallen = np.array([0.0, 0.0, HIGH]) + HIGH / -SUN[2] * np.array(SUN)
    assert fallen[2] == pytest.approx(0.0)
    assert outline.mean(axis=0) == pytest.approx(seen_at(VIEW, sealed(fallen), size=SIZE)[:2], abs=2.0)
    edges = np.diff(np.vstack([outline, outline[:1]]), axis=0)
    turns = edges[:, 0] * np.roll(edges[:, 1], -1) - edges[:, 1] * np.roll(edges[:, 0], -1)
    assert (turns <= 1e-6).all() or (turns >= -1e-6).all(), "an outline is convex"


def shaded(box: PixelBox) -> np.ndarray:
    """A part of a light room with the shadow in it."""
    left, top, right, low = box
    room = Image.new("RGB", SIZE, (200, 200, 200))
    shade(room, box, outlines()[0])
    return np.asarray(room)[top:low, left:right]


def test_the_room_is_darker_in_it_softly():
    seen = shaded((0, 0, 320, 180))
    x, y = outlines()[0][0].mean(axis=0).astype(int)
    assert seen[y, x, 0] == pytest.approx(200 * (1 - DARK), abs=12)
    assert len(np.unique(seen)) > 10, "its edge is no step"
    assert (seen[:20] == 200).all()


def test_nothing_is_darkened_beyond_its_box():
    seen = shaded((0, 0, 320, 180)).copy()
    ((left, top, right, low),) = shadow_boxes(outlines(), size=SIZE)
    assert (right - left) * (low - top) < 0.5 * 320 * 180
    seen[top:low, left:right] = 200
    assert (np.abs(seen.astype(int) - 200) <= 1).all()


def test_a_part_is_shaded_as_the_whole():
    whole, part = shaded((0, 0, 320, 180)), shaded((40, 60, 200, 170))
    assert np.abs(part.astype(int) - whole[60:170, 40:200]).max() <= 1
