"""Tests that lashes are equally dark at all picture sizes."""

import numpy as np

from kinesic.face.render.camera import Camera
from kinesic.face.render.presets import DRAFT_PRESET

EYE_WINDOW = (slice(0.36, 0.46), slice(0.2, 0.45))  # rows and columns around an eye, as fractions of the picture
CLOSE_VIEW = Camera(field_deg=15.0)


def cut(pixels: np.ndarray, shares: tuple[slice, slice] = EYE_WINDOW) -> np.ndarray:
    side = len(pixels)
    rows, columns = (slice(int(item.start * side), int(item.stop * side)) for item in shares)
    return pixels[rows, columns].astype(float)


def test_drawn_lashes_are_equally_dark_at_all_picture_sizes(gallery):
    actual = []
    for side in (100, 200, 400):
        with gallery(DRAFT_PRESET, (side, side)) as portrait:
            actual.append(cut(portrait.draw({"43": 1.0}, CLOSE_VIEW)).mean())
    assert np.ptp(actual) < 0.03 * actual[-1]


def test_lashes_darken_only_pixels_behind_them(gallery):
    with gallery(DRAFT_PRESET, (200, 200)) as portrait:
        lashes = portrait.pipeline._lashes
        with_them = portrait.draw({"43": 0.4}, CLOSE_VIEW)
        drawn, lashes.draw = lashes.draw, lambda camera: None
        without = portrait.draw({"43": 0.4}, CLOSE_VIEW)
        lashes.draw = drawn
    changed = np.abs(with_them.astype(int) - without).max(axis=2) > 0
    assert 50 < changed.sum() < 2000
    rows = np.nonzero(changed)[0]
    assert rows.min() > 60
    assert rows.max() < 110
    assert with_them[changed].mean() < without[changed].mean()
