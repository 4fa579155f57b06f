import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from kinesic.body.choices import Variant
from kinesic.face.assets import paint
from kinesic.face.assets.chart import WINDOW_LEFT_RIGHT, WINDOW_LOW_HIGH
from kinesic.face.assets.mesh import FACE_VARIANTS
from kinesic.face.assets.paint import COMPLEXIONS, paint_iris, paint_skin


def at(pixels: np.ndarray, a: float, y: float) -> np.ndarray:
    """Return the mean colour near a place of the chart."""
    size = len(pixels)
    column = round((a - WINDOW_LEFT_RIGHT[0]) / (WINDOW_LEFT_RIGHT[1] - WINDOW_LEFT_RIGHT[0]) * size)
    row = round((y - WINDOW_LOW_HIGH[0]) / (WINDOW_LOW_HIGH[1] - WINDOW_LOW_HIGH[0]) * size)
    return pixels[row - 6 : row + 6, column - 6 : column + 6].mean(axis=(0, 1))


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_painted_brows_are_dark_and_lips_red(variant: Variant):
    complexion = COMPLEXIONS[variant]
    painted = paint_skin(complexion)
    assert painted.min() >= 0.0
    assert painted.max() <= 1.0
    forehead = at(painted, 0.3, 0.9)
    np.testing.assert_allclose(forehead[:3], complexion.skin, rtol=0.15)
    assert 0.6 < forehead[3] < 0.75  # oily
    assert at(painted, 1.3, -0.2)[3] > forehead[3] + 0.05  # a temple
    for side in (-1, 1):
        assert at(painted, side * 0.6, complexion.brow[2][1])[:3].sum() < 0.6 * forehead[:3].sum()
    lip = at(painted, 0.0, -1.2)
    assert lip[3] < 0.2
    assert lip[0] / lip[1] > 1.2 * forehead[0] / forehead[1]


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_painted_skin_pores_are_darker_and_drier_than_the_skin_around_them(variant: Variant):
    painted = paint_skin(COMPLEXIONS[variant])
    rows, columns = slice(560, 620), slice(600, 700)  # of a cheek
    dryness = painted[rows, columns, 3] - gaussian_filter(painted[rows, columns, 3], 6.0)
    brightness = painted[rows, columns, :3].sum(axis=2)
    pores = dryness > np.percentile(dryness, 90)
    assert brightness[pores].mean() < 0.98 * brightness[~pores].mean()


def test_skin_painting_is_deterministic():
    np.testing.assert_array_equal(paint_skin(COMPLEXIONS["male"]), paint_skin(COMPLEXIONS["male"]))


def test_painted_brows_are_symmetric():
    painted = paint_skin(COMPLEXIONS["female"])[700:760, :, :3]
    smooth = gaussian_filter(painted, (3.0, 3.0, 0.0))  # pores and spots differ
    assert np.abs(smooth - smooth[:, ::-1]).mean() < 0.01


def test_painted_eye_has_pupil_iris_and_white():
    eye = paint_iris(COMPLEXIONS["female"])
    middle = len(eye) // 2
    pupil, coloured, white = (eye[middle, middle + step].mean() for step in (0, len(eye) // 6, len(eye) // 3))
    assert pupil < 0.02 < coloured < white


@pytest.mark.parametrize("size", [0.6, 4.0])
def test_blur_restricted_to_painted_pixels_equals_the_full_blur(size: float):
    drawn = np.zeros((60, 80))
    drawn[20:31, 70:78] = np.random.default_rng(1).uniform(0.1, 1.0, (11, 8))
    np.testing.assert_array_equal(paint._blur(drawn, size), gaussian_filter(drawn, size))
    assert not paint._blur(np.zeros((5, 7)), size).any()


def test_painted_colour_is_blended_by_its_opacity():
    under = np.random.default_rng(2).uniform(0.0, 1.0, (9, 6, 3))
    fraction = np.zeros((9, 6))
    fraction[2:5, 3] = 0.25, 1.0, 0.5
    actual = under.copy()
    paint._mix_colour(actual, (0.0, 0.5, 1.0), fraction)
    np.testing.assert_allclose(actual, under + fraction[..., None] * (np.array([0.0, 0.5, 1.0]) - under), atol=1e-15)
    actual = under.copy()
    paint._mix_colour(actual, (0.0, 0.5, 1.0), np.zeros((9, 6)))
    assert np.array_equal(actual, under)
