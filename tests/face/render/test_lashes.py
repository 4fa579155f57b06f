"""Lashes are as dark however small the picture is: neither dots nor stairs."""

import numpy as np

from kinesic.face.render.camera import Camera
from kinesic.face.render.presets import DRAFT

EYE = (slice(0.36, 0.46), slice(0.2, 0.45))  # of the picture
VIEW = Camera(field_deg=15.0)


def cut(pixels: np.ndarray, shares: tuple[slice, slice] = EYE) -> np.ndarray:
    side = len(pixels)
    rows, columns = (slice(int(each.start * side), int(each.stop * side)) for each in shares)
    return pixels[rows, columns].astype(float)


def test_lashes_are_as_dark_in_a_small_picture(gallery):
    found = []
    for side in (100, 200, 400):
        with gallery(DRAFT, (side, side)) as portrait:
            found.append(cut(portrait.draw({"43": 1.0}, VIEW)).mean())
    assert np.ptp(found) < 0.03 * found[-1]


def test_lashes_darken_what_they_stand_before_and_nothing_else(gallery):
    with gallery(DRAFT, (200, 200)) as portrait:
        lashes = portrait.pipeline._lashes
        with_them = portrait.draw({"43": 0.4}, VIEW)
        drawn, lashes.draw = lashes.draw, lambda camera: None
        without = portrait.draw({"43": 0.4}, VIEW)
        lashes.draw = drawn
    changed = np.abs(with_them.astype(int) - without).max(axis=2) > 0
    assert 50 < changed.sum() < 2000
    rows = np.nonzero(changed)[0]
    assert rows.min() > 60
    assert rows.max() < 110
    assert with_them[changed].mean() < without[changed].mean()
